// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), in hexadecimal.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

std::string sha256(std::string_view bytes);

// Of a file's content, whatever its size.
Result<std::string> sha256_of_file(const std::filesystem::path& path);

}  // namespace tagsmith::detail
