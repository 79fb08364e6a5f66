// SPDX-License-Identifier: Apache-2.0
// JPEG files to grey images.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

struct DecodedImage {
  GrayImage image;
  std::string warning;  // the damage that the decoder repaired, in its words; empty = none
};

// The meaning of a warning of the decoder, for people.
inline std::string damaged_in_words(const std::string& warning) {
  return "the file is damaged, and a part of the picture may be wrong: " + warning;
}

// The luma of a JPEG file (ITU-T T.81) of one or three components, as stored, by libjpeg: the rows
// are decoded into the image without a copy, chroma is only skipped. Nothing for other numbers of
// components, as CMYK has. Fails, with the decoder's message, where decoding fails, and before
// memory for more than `most_pixels` is allocated.
Result<std::optional<DecodedImage>> decode_jpeg(std::string_view bytes, double most_pixels);

// Rows of pixels, each blue, green, red.
struct ColourImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples;
};

// The same in colour.
Result<std::optional<ColourImage>> decode_jpeg_colour(std::string_view bytes, double most_pixels);

}  // namespace tagsmith::detail
