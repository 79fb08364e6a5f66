// SPDX-License-Identifier: Apache-2.0
// Whole-file reading with a limit, and writing that leaves no half-written file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// The file's bytes. Fails when it cannot be opened, is a directory, or exceeds `max_bytes`.
Result<std::string> read_file(const std::filesystem::path& path,
                              std::uintmax_t max_bytes = 64U << 20U);

// Writes beside the target, then renames: a reader sees the old file or the whole new one. Missing
// folders are made. A link stays, its target is replaced; a stream (stream.hpp) is written to.
Result<void> write_file(const std::filesystem::path& path, std::string_view bytes);

// Whether a file is there that nobody may write: to replace it is not what its owner expects.
bool is_write_protected(const std::filesystem::path& file);

}  // namespace tagsmith::detail
