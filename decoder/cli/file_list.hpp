// SPDX-License-Identifier: Apache-2.0
// The files that a command line means.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith {

// Extensions of the pictures that load_gray_image reads, and those, PDF and SVG.
std::span<const std::string_view> image_extensions();
std::span<const std::string_view> image_and_pdf_extensions();

// Each argument in turn: a file is itself (there or not: reading it tells), a folder is the files
// directly in it with one of the extensions (in any case), sorted by name, and "-" is the lines of
// `standard_input`, one file each. Fails when a folder holds no such file or cannot be listed, and
// when "-" names nothing.
Result<std::vector<std::filesystem::path>> list_files(const std::vector<std::string>& arguments,
                                                      std::span<const std::string_view> extensions,
                                                      std::istream& standard_input);

}  // namespace tagsmith
