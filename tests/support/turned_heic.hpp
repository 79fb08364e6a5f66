// SPDX-License-Identifier: Apache-2.0
// HEIC files that say which way up they are to be shown.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

namespace tagsmith::detail::test {

inline std::string big_endian(std::size_t value) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    bytes += static_cast<char>(value >> shift & 0xFFU);
  }
  return bytes;
}

inline std::size_t number_at(const std::string& bytes, std::size_t at) {
  std::size_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i)
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
  return value;
}

// The HEIC of one picture without EXIF, as heif-enc writes it, with the property `irot` (quarters
// anticlockwise) and after it, where an axis is given, `imir` (ISO/IEC 23008-12, 6.5.10
// and 6.5.12).
inline std::string turned_heic(std::string heic, unsigned quarters, std::optional<unsigned> axis) {
  const auto start_of = [&](const char* type) {
    const std::size_t at = heic.find(type);
    if (at == std::string::npos) throw std::runtime_error(std::string("no box ") + type);
    return at - 4;
  };
  std::string properties = big_endian(9) + "irot" + static_cast<char>(quarters);
  if (axis) properties += big_endian(9) + "imir" + static_cast<char>(*axis);
  const std::size_t ipco = start_of("ipco");
  const std::size_t ipma = start_of("ipma");
  std::size_t count = 0;
  for (std::size_t at = ipco + 8; at < ipco + number_at(heic, ipco); at += number_at(heic, at)) {
    ++count;
  }
  std::string numbers(1, static_cast<char>(0x80U | (count + 1)));
  if (axis) numbers += static_cast<char>(0x80U | (count + 2));
  const std::size_t added = properties.size() + numbers.size();
  const std::size_t data = start_of("mdat") + 8;
  const auto grow = [&](std::size_t box, std::size_t by) {
    heic.replace(box, 4, big_endian(number_at(heic, box) + by));
  };
  grow(start_of("meta"), added);
  grow(start_of("iprp"), added);
  const std::size_t offset = heic.find(big_endian(data), start_of("iloc"));
  heic.replace(offset, 4, big_endian(data + added));
  constexpr std::size_t kCount = 8 + 4 + 4 + 2;  // header, version, entries, item's number
  heic[ipma + kCount] = static_cast<char>(heic[ipma + kCount] + static_cast<char>(numbers.size()));
  const std::size_t end = ipma + number_at(heic, ipma);
  grow(ipma, numbers.size());
  heic.insert(end, numbers);
  const std::size_t last = ipco + number_at(heic, ipco);
  grow(ipco, properties.size());
  heic.insert(last, properties);
  return heic;
}

}  // namespace tagsmith::detail::test
