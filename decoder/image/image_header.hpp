// SPDX-License-Identifier: Apache-2.0
// What an image file states about itself before it is decoded.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace tagsmith::detail {

struct ImageHeader {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool complete = true;   // false when the file's end is missing, as far as the format shows it
  bool has_more = false;  // further pages of a TIFF, an animation of a WebP
};

// The header of a PNG, JPEG, WebP, TIFF, PNM (P1-P6) or BMP file; nothing for any other bytes and
// for headers cut short. Decoders allocate what a header asks for, so it is read first.
std::optional<ImageHeader> read_image_header(std::string_view bytes);

}  // namespace tagsmith::detail
