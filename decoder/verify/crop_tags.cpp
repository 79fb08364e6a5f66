// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/crop_tags.hpp"

#include <algorithm>

#include "decoder/image/transform.hpp"

namespace tagsmith::detail {

std::optional<GrayImage> crop_around(const GrayView& image, const FrameCorners& corners,
                                     int orientation) {
  constexpr int kMostCrop = 800;
  const PixelBox box = box_around(corners, 0.5 * extent_of(corners), image);
  if (box.width() < 2 || box.height() < 2) return std::nullopt;
  GrayImage crop = copy_of(part_of(image, box));
  if (image.is_negative) crop = exchange_black_and_white(crop.view());  // shown as it is
  while (crop.width > kMostCrop) crop = half_size(crop.view());
  return orientation == 1 ? std::move(crop) : turn_upright(crop.view(), orientation);
}

void crop_faults(const GrayView& image, std::vector<VerifiedTag>& tags, int orientation) {
  for (VerifiedTag& tag : tags) {
    const FaultPicture& shown = tag.picture;
    const bool is_shown = shown.image || !shown.jpeg.empty() || !shown.file.empty();
    if (is_shown || !tag.finding.is_fault()) continue;
    tag.picture.image = crop_around(image, tag.corners, orientation);
  }
}

GrayImage small_picture(const GrayView& image, int orientation) {
  constexpr int kMostSide = 480;
  GrayImage small = shrunk_to(image, kMostSide);
  if (image.is_negative) small = exchange_black_and_white(small.view());
  return orientation == 1 ? small : turn_upright(small.view(), orientation);
}

}  // namespace tagsmith::detail
