// SPDX-License-Identifier: Apache-2.0
// What stands where a file is expected: links, pipes, devices, folders.
#pragma once

#include <filesystem>
#include <string>

namespace tagsmith::detail {

// "pipe", "socket", "device", "folder", "file".
std::string file_type(const std::filesystem::file_status& status);

// True of what is there and neither a file nor a folder: a pipe or device, which might never end.
bool is_special(const std::filesystem::file_status& status);

// Where what is written to `path` goes: the end of its symbolic links, there or not. Links within
// /proc, which stand for open files (/dev/stdout leads there), are kept.
std::filesystem::path behind_links(const std::filesystem::path& path);

// True when what is written to `path` goes into something open or endless, such as a pipe, a device
// or standard output, which no file can replace.
bool is_stream(const std::filesystem::path& path);

}  // namespace tagsmith::detail
