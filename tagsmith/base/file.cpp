// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/file.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <istream>
#include <system_error>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/text.hpp"

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

// The entries of a folder by name; at most so many are looked at.
std::vector<std::string> names_in(const fs::path& folder) {
  constexpr std::size_t kMost = 10'000;
  std::error_code error;
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    names.push_back(entry.path().filename().string());
    if (names.size() == kMost) break;
  }
  std::ranges::sort(names);
  return names;
}

// The missing file's likely other name.
std::string likely_name(const fs::path& missing) {
  const fs::path folder = missing.parent_path();
  std::error_code error;
  if (!folder.empty() && !fs::exists(folder, error)) {
    return ", nor a folder " + folder.string() + likely_name(folder);
  }
  const auto near =
      nearest_word(missing.filename().string(), names_in(folder.empty() ? "." : folder));
  return near ? ", did you mean " + (folder / *near).string() + "?" : "";
}

// The files of the kind that is usually requested by name.
std::string yaml_files_in(const fs::path& folder) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> found;
  for (const std::string& name : names_in(folder)) {
    if (name.ends_with(".yaml") || name.ends_with(".yml"))
      found.push_back((folder / name).string());
  }
  if (found.empty()) return "";
  const std::string more = found.size() > kMost ? ", ..." : "";
  found.resize(std::min(found.size(), kMost));
  return fmt::format("; in it there is {}{}", fmt::join(found, ", "), more);
}

}  // namespace

Result<std::string> read_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status) && fs::is_symlink(path, error)) {
    return fail(fmt::format("{}: is a link to {}, which is not there", path.string(),
                            fs::read_symlink(path, error).string()));
  }
  if (!fs::exists(status)) return fail(path.string() + ": no such file" + likely_name(path));
  if (fs::is_directory(status)) {
    return fail(path.string() + ": is a directory, expected a file" + yaml_files_in(path));
  }
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

fs::path temporary_beside(const fs::path& file) {
  const std::size_t own = std::hash<std::string>{}(file.filename().string());
  return file.parent_path() / (".tmp" + std::to_string(::getpid()) + "-" + std::to_string(own));
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
  const fs::path temporary = temporary_beside(target);
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

bool is_write_protected(const std::filesystem::path& file) {
  using std::filesystem::perms;
  std::error_code absent;
  const std::filesystem::file_status status = std::filesystem::status(file, absent);
  const perms writable = perms::owner_write | perms::group_write | perms::others_write;
  return std::filesystem::is_regular_file(status) &&
         (status.permissions() & writable) == perms::none;
}

Result<std::string> read_regular_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (is_special(status)) {
    return fail(path.string() + ": is a " + file_type(status) + ", expected a regular file");
  }
  return read_file(path, max_bytes);
}

std::optional<std::string> read_line(std::istream& stream, std::size_t most) {
  constexpr int kEnd = std::istream::traits_type::eof();
  int next = stream.get();
  if (next == kEnd) return std::nullopt;
  std::string line;
  for (; next != kEnd && next != '\n'; next = stream.get()) {
    line += static_cast<char>(next);
    if (line.size() > most) break;
  }
  return line;
}

// ---- Objects in the place of a file.

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
