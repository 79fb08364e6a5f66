// SPDX-License-Identifier: Apache-2.0
// Pictures cut across the bars of a tag.
#pragma once

#include <algorithm>
#include <array>
#include <random>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail::bench {

inline constexpr double kLeastCroppedModule = 1.4;  // pixels, of cut tags that count

// The share of the bars' length of which all but the ends' height is in a picture.
inline double share_in_sight(const FrameCorners& corners, int width, int height) {
  constexpr int kPlaces = 400;
  constexpr double kQuiet = 9.0 / 113;
  const Homography map = homography_to(corners);
  int seen = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double u = kQuiet + (1 - 2 * kQuiet) * (i + 0.5) / kPlaces;
    seen += std::ranges::all_of(std::array{0.2, 0.5, 0.8}, [&](double v) {
      const PixelPoint at = map(u, v);
      return at.x >= 0 && at.y >= 0 && at.x <= width - 1 && at.y <= height - 1;
    });
  }
  return static_cast<double>(seen) / kPlaces;
}

// Columns of a picture.
struct Crop {
  int first = 0;
  int width = 0;
};

// Cut at a share of a tag's length from P, so that what is left of there stays, or what is right.
inline Crop crop_at(double u, bool keeps_left, const FrameCorners& corners, int width) {
  const double middle = homography_to(corners)(u, 0.5).x;
  const bool is_before = (corners[0].x < corners[1].x) == keeps_left;
  const int cut = std::clamp(static_cast<int>(middle), 1, width - 2);
  return is_before ? Crop{0, cut} : Crop{cut, width - cut};
}

// Cut across the bars of a tag at a drawn place, from its left or its right.
inline Crop random_crop(const FrameCorners& corners, int width, std::mt19937_64& random) {
  const double u = std::uniform_real_distribution(0.25, 0.95)(random);
  const bool keeps_left = random() % 2 == 0;
  return crop_at(u, keeps_left, corners, width);
}

// Cut 0.5 to 6 modules inside the left or the right side of a frame, beside the bars.
inline Crop side_crop(const FrameCorners& corners, int width, std::mt19937_64& random) {
  const double inside = std::uniform_real_distribution(0.5, 6.0)(random) / 113;
  const bool keeps_left = random() % 2 == 0;
  return crop_at(keeps_left ? 1 - inside : inside, keeps_left, corners, width);
}

// Rows of a picture.
struct RowCrop {
  int first = 0;
  int height = 0;
};

// Cut at a share of the height of an upright frame's inside, so that what is above stays, or what
// is below.
inline RowCrop row_crop_at(double v, bool keeps_above, const FrameCorners& corners, int height) {
  const double middle = homography_to(corners)(0.5, v).y;
  const bool is_before = (corners[0].y < corners[3].y) == keeps_above;
  const int cut = std::clamp(static_cast<int>(middle), 1, height - 2);
  return is_before ? RowCrop{0, cut} : RowCrop{cut, height - cut};
}

inline GrayView cropped(GrayView image, const RowCrop& crop) {
  image.data = image.row(crop.first);
  image.height = crop.height;
  return image;
}

inline GrayView cropped(GrayView image, const Crop& crop) {
  image.data += crop.first;
  image.width = crop.width;
  return image;
}

inline FrameCorners moved(FrameCorners corners, PixelPoint by) {
  for (PixelPoint& corner : corners) corner = corner + by;
  return corners;
}

}  // namespace tagsmith::detail::bench
