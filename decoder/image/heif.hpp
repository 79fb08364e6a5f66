// SPDX-License-Identifier: Apache-2.0
// HEIF files, the HEIC photos of phones among them, to images.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "decoder/image/gray.hpp"
#include "decoder/image/jpeg.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// True when the bytes begin as a still image of ISO/IEC 23008-12 does, whose pictures are of HEVC
// or AV1.
bool is_heif(std::string_view bytes);

// True when the bytes begin as a video does: ISO base media (MP4, MOV), Matroska, AVI, MPEG.
bool is_video(std::string_view bytes);

// The way to turn a video into pictures that this program reads.
inline constexpr const char* kFramesOfVideo =
    "a video's frames: ffmpeg -i VIDEO -qscale:v 2 frame-%04d.jpg";

// The orientation in which the primary image must be shown, as EXIF counts (1 to 8), by its
// rotation and mirroring (ISO/IEC 23008-12, 6.5.10 and 6.5.12); nothing where the file states
// neither.
std::optional<int> heif_orientation(std::string_view bytes);

// The TIFF structure of the primary image's EXIF; empty where there is none.
std::string heif_exif(std::string_view bytes);

// The luma of the primary image as stored, by libheif, which is loaded when the first file needs
// it. Fails, with the library's message, where decoding fails, and before memory for more than
// `most_pixels` is allocated.
Result<GrayImage> decode_heif(std::string_view bytes, double most_pixels);

// The same in colour.
Result<ColourImage> decode_heif_colour(std::string_view bytes, double most_pixels);

}  // namespace tagsmith::detail
