// SPDX-License-Identifier: Apache-2.0
// Whole-file reading with a limit, writing that leaves no half-written file, and objects in the
// place of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// ---- Reading and writing.

// The file's bytes. Fails when it cannot be opened, is a directory, or exceeds `max_bytes`.
Result<std::string> read_file(const std::filesystem::path& path,
                              std::uintmax_t max_bytes = 64U << 20U);

// A name beside the file for what takes its place when it is whole; short, however long the file's
// own is.
std::filesystem::path temporary_beside(const std::filesystem::path& file);

// Writes beside the target, then renames: a reader sees the old file or the whole new one. Missing
// folders are made. A link stays, its target is replaced; a stream (is_stream) is written to.
Result<void> write_file(const std::filesystem::path& path, std::string_view bytes);

// Whether a write-protected file exists: its owner does not expect it to be replaced.
bool is_write_protected(const std::filesystem::path& file);

// As read_file, of regular files alone: a pipe or device, which might never end, is refused.
Result<std::string> read_regular_file(const std::filesystem::path& path, std::uintmax_t max_bytes);

// The next line without its end; nothing at the stream's end. Of a longer line than `most` bytes,
// its first `most` + 1: the rest is still to be read.
std::optional<std::string> read_line(std::istream& stream, std::size_t most);

// ---- Objects in the place of a file: links, pipes, devices, folders.

// "pipe", "socket", "device", "folder", "file".
std::string file_type(const std::filesystem::file_status& status);

// True if the object exists and is neither a file nor a folder: a pipe or device, which might never
// end.
bool is_special(const std::filesystem::file_status& status);

// The target of what is written to `path`: the end of its symbolic links, whether it exists or not.
// Links within /proc, which represent open files (/dev/stdout leads there), are kept.
std::filesystem::path behind_links(const std::filesystem::path& path);

// True when the target of `path` is open or endless, such as a pipe, a device or standard output,
// which no file can replace.
bool is_stream(const std::filesystem::path& path);

}  // namespace tagsmith::detail
