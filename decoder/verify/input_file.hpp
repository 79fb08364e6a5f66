// SPDX-License-Identifier: Apache-2.0
// A file to be verified, read once: its hash and its picture come from the same bytes.
#pragma once

#include <filesystem>
#include <string>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

struct InputFile {
  std::filesystem::path path;
  std::string bytes;
  std::string sha256;
};

// Fails when the file cannot be read, is no regular file, or has more than 512 MiB.
Result<InputFile> read_input_file(const std::filesystem::path& path);

}  // namespace tagsmith::detail
