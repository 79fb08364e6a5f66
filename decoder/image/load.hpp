// SPDX-License-Identifier: Apache-2.0
// Image files to grey images.
#pragma once

#include <filesystem>
#include <string>

#include "decoder/image/gray.hpp"
#include "decoder/image/jpeg.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

inline constexpr double kMaxImagePixels = 200e6;

// The pixels as stored: EXIF orientation is ignored, because calibration and corners refer to the
// sensor. Colour becomes luma; deeper samples are scaled to 8 bits. Fails on files that are no
// image or no regular file, are truncated, or have more than 200 million pixels.
Result<GrayImage> load_gray_image(const std::filesystem::path& path);

// The same, with the warnings of its decoder (JPEG alone).
Result<DecodedImage> load_image(const std::filesystem::path& path);

// The same from an image file's bytes; `name` begins the message of an error.
Result<DecodedImage> decode_image(const std::string& name, const std::string& bytes);

// The image alone.
Result<GrayImage> decode_gray_image(const std::string& name, const std::string& bytes);

// The bytes of an image file of the format that the name's extension says (PNG, JPEG and others);
// `jpeg_quality` 1 to 100 concerns JPEG only.
Result<std::string> encode_gray_image(const std::filesystem::path& name, const GrayView& image,
                                      int jpeg_quality = 95);

// Writes the file of that name, whole or not at all.
Result<void> save_gray_image(const std::filesystem::path& path, const GrayView& image,
                             int jpeg_quality = 95);

}  // namespace tagsmith::detail
