// SPDX-License-Identifier: Apache-2.0
// The files that a command line names.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// Extensions of the pictures that load_gray_image reads, and those, PDF and SVG.
std::span<const std::string_view> image_extensions();
std::span<const std::string_view> image_and_pdf_extensions();

// How many files of each kind were skipped: "mp4", "pipe", "folder".
using SkippedFiles = std::map<std::string, std::size_t>;

// The files that a command line names, and what its folders hold besides.
struct FileList {
  std::vector<std::filesystem::path> files;
  SkippedFiles skipped;
};

// Each argument in turn: a file is itself (whether it exists is found when it is read), a folder is
// the files directly in it with one of the extensions (in any case), sorted by name, and "-" is the
// lines of `standard_input`, one file each. Anything else in a folder is counted as skipped. Fails
// when a folder holds no such file or cannot be listed, and when "-" names nothing.
Result<FileList> list_files(const std::vector<std::string>& arguments,
                            std::span<const std::string_view> extensions,
                            std::istream& standard_input);

// "2 mp4, 1 pipe", with what to do about videos.
std::string skipped_in_words(const SkippedFiles& skipped);

}  // namespace tagsmith::detail
