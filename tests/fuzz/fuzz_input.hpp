// SPDX-License-Identifier: Apache-2.0
// What the fuzz targets make of the bytes that they are given.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <unistd.h>

#include <sys/mman.h>

namespace tagsmith::detail::fuzz {

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// A file in memory with these bytes, for what reads files by their path.
class FileInMemory {
 public:
  explicit FileInMemory(std::string_view bytes) : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
    while (!bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written <= 0) break;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  ~FileInMemory() { close(descriptor_); }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;

  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

// Numbers from the bytes, in order; zeros when they are used up.
class Numbers {
 public:
  explicit Numbers(std::string_view bytes) : bytes_(bytes) {}

  bool is_empty() const { return bytes_.empty(); }

  // From 0 to `most`.
  int integer(int most) { return static_cast<int>(take<std::uint16_t>() % (most + 1)); }

  // From `low` to `high`, in 65,536 steps.
  double real(double low, double high) {
    return low + (high - low) * take<std::uint16_t>() / 65535.0;
  }

  // Any double at all: infinities and what is no number, too.
  double any_double() { return take<double>(); }

 private:
  template <class Value>
  Value take() {
    Value value{};
    const std::size_t count = std::min(sizeof value, bytes_.size());
    std::memcpy(&value, bytes_.data(), count);
    bytes_.remove_prefix(count);
    return value;
  }

  std::string_view bytes_;
};

}  // namespace tagsmith::detail::fuzz
