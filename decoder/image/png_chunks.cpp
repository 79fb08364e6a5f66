// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/png_chunks.hpp"

#include <cstddef>
#include <cstdint>
#include <zlib.h>

#include "decoder/image/bytes.hpp"

namespace tagsmith::detail {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kSignature = "\x89PNG\r\n\x1A\n"sv;

// Of a chunk's type and data (ISO/IEC 15948, 5.5).
std::uint32_t checksum_of(std::string_view bytes) {
  const auto* first = reinterpret_cast<const Bytef*>(bytes.data());
  return static_cast<std::uint32_t>(crc32_z(0, first, bytes.size()));
}

// ISO/IEC 15948, 5.4: the first letter of a critical chunk's type is a capital.
bool makes_pixels(std::string_view type) {
  return (type[0] >= 'A' && type[0] <= 'Z') || type == "tRNS"sv;
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.starts_with(kSignature); }

Result<std::string> png_of_pixels(std::string_view bytes) {
  constexpr std::size_t kAround = 12;  // length, type, checksum
  std::string kept(bytes.substr(0, kSignature.size()));
  Bytes numbers(bytes, true);
  for (std::size_t at = kSignature.size(); at < bytes.size();) {
    const std::size_t left = bytes.size() - at;
    const std::size_t length = left < kAround ? 0 : numbers.number(at, 4);
    if (left < kAround || length > left - kAround) return fail("a chunk goes beyond its end");
    const std::string_view type = bytes.substr(at + 4, 4);
    if (makes_pixels(type)) {
      if (checksum_of(bytes.substr(at + 4, 4 + length)) != numbers.number(at + 8 + length, 4)) {
        return fail("the checksum of a chunk is wrong");
      }
      kept += bytes.substr(at, kAround + length);
    }
    if (type == "IEND"sv) return kept;
    at += kAround + length;
  }
  return fail("its last chunk is missing");
}

}  // namespace tagsmith::detail
