// SPDX-License-Identifier: Apache-2.0
// Numbers in the bytes of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tagsmith::detail {

// Bytes as numbers; reading beyond the end gives 0 and is remembered.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes, bool big_endian = false)
      : bytes_(bytes), big_endian_(big_endian) {}

  std::uint32_t number(std::size_t offset, std::size_t size) {
    if (offset > bytes_.size() || bytes_.size() - offset < size) {
      beyond_ = true;
      return 0;
    }
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t at = offset + (big_endian_ ? i : size - 1 - i);
      value = value << 8U | static_cast<unsigned char>(bytes_[at]);
    }
    return value;
  }

  bool beyond() const { return beyond_; }

 private:
  std::string_view bytes_;
  bool big_endian_;
  bool beyond_ = false;
};

}  // namespace tagsmith::detail
