// SPDX-License-Identifier: Apache-2.0
// What an image file says about itself before it is decoded.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace tagsmith::detail {

struct ImageHeader {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool complete = true;  // false when the file's end is missing, as far as the format tells it
};

// The header of a PNG, JPEG, WebP, TIFF, PNM (P1-P6) or BMP file; nothing for any other bytes and
// for headers cut short. Decoders allocate what a header asks for, so it is read first.
std::optional<ImageHeader> read_image_header(std::string_view bytes);

// Which way up a JPEG is to be shown, 1 (as stored) to 8 (EXIF, CIPA DC-008, tag Orientation);
// nothing for all others and where it is not said.
std::optional<int> exif_orientation(std::string_view bytes);

// The same of any format that says it: JPEG by its EXIF, HEIF by its own properties.
std::optional<int> shown_orientation(std::string_view bytes);

}  // namespace tagsmith::detail
