// SPDX-License-Identifier: Apache-2.0
// Copies of verified photos that show what was found where.
#pragma once

#include <filesystem>
#include <optional>

#include "decoder/verify/verified_file.hpp"
#include "decoder/verify/verify_file.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet_files.hpp"

namespace tagsmith::detail {

// NAME-HASH.jpg (of lossless pictures .png) in the folder, HASH being of the whole path: photos of
// several folders often have one name. Each tag is outlined in the colour of its status, with its
// name, status, grade and what is wrong. Print files (PDF, SVG) have no copy. Fails when the
// picture cannot be decoded.
Result<std::optional<SheetFile>> annotated_copy(const std::filesystem::path& folder,
                                                const InputFile& file,
                                                const VerifiedFile& verified);

}  // namespace tagsmith::detail
