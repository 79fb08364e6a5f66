// SPDX-License-Identifier: Apache-2.0
// JPEG files that say which way up they were taken.
#pragma once

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

}  // namespace tagsmith::detail::test
