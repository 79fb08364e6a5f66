// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/stream.hpp"

#include <system_error>

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

bool is_in_proc(const fs::path& path) { return path.string().starts_with("/proc/"); }

}  // namespace

bool is_special(const fs::file_status& status) {
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

std::string file_type(const fs::file_status& status) {
  if (fs::is_fifo(status)) return "pipe";
  if (fs::is_socket(status)) return "socket";
  if (fs::is_directory(status)) return "folder";
  return is_special(status) ? "device" : "file";
}

fs::path behind_links(const fs::path& path) {
  constexpr int kMostLinks = 40;  // as many as Linux follows
  fs::path target = path;
  std::error_code error;
  for (int i = 0; i < kMostLinks && !is_in_proc(target) && fs::is_symlink(target, error); ++i) {
    target = target.parent_path() / fs::read_symlink(target, error);
  }
  return target;
}

bool is_stream(const fs::path& path) {
  std::error_code ignored;
  const fs::path target = behind_links(path);
  return is_special(fs::status(target, ignored)) ||
         (is_in_proc(target) && fs::is_regular_file(target, ignored));
}

}  // namespace tagsmith::detail
