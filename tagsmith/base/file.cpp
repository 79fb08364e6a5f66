// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/file.hpp"

#include <fstream>
#include <system_error>
#include <unistd.h>

#include "tagsmith/base/stream.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

// Appends, because a shell's `>> FILE` may stand behind /dev/stdout.
Result<void> write_stream(const fs::path& path, std::string_view bytes) {
  std::ofstream stream(path, std::ios::binary | std::ios::app);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) return fail(path.string() + ": cannot be written");
  return {};
}

}  // namespace

Result<std::string> read_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return fail(path.string() + ": no such file");
  if (fs::is_directory(status)) return fail(path.string() + ": is a directory, expected a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return fail(path.string() + ": cannot be opened for reading");
  std::string bytes;
  char buffer[1U << 16U];
  while (stream.read(buffer, sizeof buffer), stream.gcount() > 0) {
    bytes.append(buffer, static_cast<std::size_t>(stream.gcount()));
    if (bytes.size() > max_bytes) {
      return fail(path.string() + ": larger than the limit of " + std::to_string(max_bytes) +
                  " bytes");
    }
  }
  if (stream.bad()) return fail(path.string() + ": could not be read to its end");
  return bytes;
}

Result<void> write_file(const fs::path& path, std::string_view bytes) {
  std::error_code error;
  const fs::path target = behind_links(path);
  if (is_stream(target)) return write_stream(target, bytes);
  if (target.has_parent_path()) fs::create_directories(target.parent_path(), error);
  if (error) return fail(path.string() + ": its folder cannot be made: " + error.message());
  if (fs::is_directory(target, error)) {
    return fail(path.string() + ": is a directory, expected a file");
  }
  if (fs::is_symlink(target, error))
    return fail(path.string() + ": is a link that leads to itself");
  fs::path temporary = target;
  temporary += ".tmp" + std::to_string(::getpid());
  std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) {
    fs::remove(temporary, error);
    return fail(path.string() + ": cannot be written");
  }
  fs::rename(temporary, target, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return fail(path.string() + ": cannot be written: " + error.message());
  }
  return {};
}

}  // namespace tagsmith::detail
