// SPDX-License-Identifier: Apache-2.0
// JPEG files that say which way up they were taken, and by what lens.
#pragma once

#include <cstddef>
#include <string>

namespace tagsmith::detail::test {

// The JPEG with an EXIF segment that says this orientation (CIPA DC-008, tag 274).
inline std::string with_orientation(const std::string& jpeg, int orientation) {
  std::string exif(
      "\xFF\xE1\x00\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  exif[29] = static_cast<char>(orientation);
  return jpeg.substr(0, 2) + exif + jpeg.substr(2);
}

// The number in `size` bytes, the least first.
inline std::string little_endian(std::size_t number, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i, number >>= 8) bytes += static_cast<char>(number & 0xFF);
  return bytes;
}

// The TIFF structure of a photo by Maker's "Model", of this focal length and its equivalent on 35
// mm film in whole millimetres (tags 271, 272, 34665, 37386, 41989).
inline std::string tiff_of_lens(const std::string& model, std::size_t equivalent) {
  const auto entry = [](int tag, int type, std::size_t count, std::size_t value) {
    return little_endian(static_cast<std::size_t>(tag), 2) +
           little_endian(static_cast<std::size_t>(type), 2) + little_endian(count, 4) +
           little_endian(value, 4);
  };
  constexpr std::size_t kTexts = 8 + 2 + 3 * 12 + 4;
  const std::string texts = std::string("Maker\0", 6) + model + std::string(1, '\0');
  const std::size_t exif = kTexts + texts.size();
  const std::size_t rational = exif + 2 + 2 * 12 + 4;
  return std::string("II*\0\x08\0\0\0\x03\0", 10) + entry(271, 2, 6, kTexts) +
         entry(272, 2, model.size() + 1, kTexts + 6) + entry(34665, 4, 1, exif) +
         little_endian(0, 4) + texts + little_endian(2, 2) + entry(37386, 5, 1, rational) +
         entry(41989, 3, 1, equivalent) + little_endian(0, 4) + little_endian(543, 4) +
         little_endian(100, 4);
}

// The JPEG with an EXIF segment that says this lens.
inline std::string with_lens(const std::string& jpeg, const std::string& model,
                             std::size_t equivalent) {
  const std::string exif = std::string("Exif\0\0", 6) + tiff_of_lens(model, equivalent);
  const std::size_t length = exif.size() + 2;
  return jpeg.substr(0, 2) + "\xFF\xE1" + static_cast<char>(length >> 8) +
         static_cast<char>(length & 0xFF) + exif + jpeg.substr(2);
}

// The JPEG with an EXIF segment that says when it was taken, as "2026:03:31 14:05:09", and the
// offset from universal time unless that is empty (tags 34665, 36867, 36881).
inline std::string with_moment(const std::string& jpeg, const std::string& moment,
                               const std::string& offset = "") {
  const auto entry = [](std::size_t tag, std::size_t type, std::size_t count, std::size_t value) {
    return little_endian(tag, 2) + little_endian(type, 2) + little_endian(count, 4) +
           little_endian(value, 4);
  };
  constexpr std::size_t kExif = 8 + 2 + 12 + 4;
  constexpr std::size_t kTexts = kExif + 2 + 2 * 12 + 4;
  const std::string exif =
      std::string("Exif\0\0II*\0\x08\0\0\0\x01\0", 16) + entry(34665, 4, 1, kExif) +
      little_endian(0, 4) + std::string("\x02\0", 2) + entry(36867, 2, moment.size() + 1, kTexts) +
      entry(36881, 2, offset.size() + 1, kTexts + moment.size() + 1) + little_endian(0, 4) +
      moment + std::string(1, '\0') + offset + std::string(1, '\0');
  return jpeg.substr(0, 2) + "\xFF\xE1" + static_cast<char>((exif.size() + 2) >> 8U) +
         static_cast<char>((exif.size() + 2) & 0xFFU) + exif + jpeg.substr(2);
}

}  // namespace tagsmith::detail::test
