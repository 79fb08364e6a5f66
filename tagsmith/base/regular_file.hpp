// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// As read_file, of regular files alone: a pipe or device, which might never end, is refused.
Result<std::string> read_regular_file(const std::filesystem::path& path, std::uintmax_t max_bytes);

}  // namespace tagsmith::detail
