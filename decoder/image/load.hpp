// SPDX-License-Identifier: Apache-2.0
// Image files to grey images.
#pragma once

#include <filesystem>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith {

// The pixels as stored: EXIF orientation is ignored, because calibration and corners refer to the
// sensor. Colour becomes luma; 16-bit samples are scaled to 8. Fails on files that are no image,
// are truncated, or have more than 200 million pixels.
Result<GrayImage> load_gray_image(const std::filesystem::path& path);

// Writes PNG or JPEG by the file's extension, whole or not at all.
Result<void> save_gray_image(const std::filesystem::path& path, const GrayView& image);

}  // namespace tagsmith
