// SPDX-License-Identifier: Apache-2.0
// Copies of pictures with marks on them, for people.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// An outlined quadrilateral with lines of text on a plate of its colour; its first corner, which is
// the tag's P, has a disc.
struct PictureMark {
  std::array<PixelPoint, 4> outline{};
  std::array<std::uint8_t, 3> colour{};  // red, green, blue
  std::vector<std::string> words;
};

struct AnnotatedPicture {
  std::string extension;  // ".jpg" or ".png"
  std::string bytes;
};

// The picture in its colours with the marks, turned upright as its EXIF orientation says (the
// outlines are in pixels as stored). JPEG and WebP become JPEG, all else PNG. `caption`:
// lines at the top. Characters beyond ASCII become "?". `name` begins the message of an error.
Result<AnnotatedPicture> annotate_picture(const std::string& name, const std::string& bytes,
                                          const std::vector<PictureMark>& marks,
                                          const std::vector<std::string>& caption = {});

}  // namespace tagsmith::detail
