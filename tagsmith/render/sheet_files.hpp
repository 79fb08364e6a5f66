// SPDX-License-Identifier: Apache-2.0
// Sheets as files, in the format that the file name gives.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

enum class SheetFormat { pdf, svg, png };

// By the file's extension, in any case of letters; nothing for other extensions.
std::optional<SheetFormat> sheet_format_of(const std::filesystem::path& path);

struct SheetFile {
  std::filesystem::path path;
  std::string bytes;
};

// The sheets in the format of the path's extension. A PDF is one file; of the other formats each
// sheet is a file, several as NAME-1.svg, NAME-2.svg ... Equal sheets give equal bytes. Fails on
// other extensions and without sheets.
Result<std::vector<SheetFile>> render_sheets(std::span<const Sheet> sheets,
                                             const std::filesystem::path& path);

}  // namespace tagsmith::detail
