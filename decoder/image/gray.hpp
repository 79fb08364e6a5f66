// SPDX-License-Identifier: Apache-2.0
// Grey images as plain memory, so that the reader can be called without OpenCV; positions in them
// and the grey levels there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace tagsmith::detail {

// ---- Images.

// A view of 8-bit grey samples, row by row; does not own them. Pixel (0, 0) is the upper left one.
struct GrayView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes from one row to the next
  bool is_negative = false;   // samples are 255 minus what the camera stored (ToneCurve::of)

  const std::uint8_t* row(int y) const { return data + y * stride; }
  std::uint8_t at(int x, int y) const { return row(y)[x]; }
};

// An image that owns its samples, without padding between rows.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> samples;
  bool is_negative = false;  // as GrayView's

  GrayView view() const { return {samples.data(), width, height, width, is_negative}; }
};

// ---- Pixel positions and the small vector arithmetic they need.

// A pixel position or a difference of two; (0, 0) is the centre of the upper left pixel.
struct PixelPoint {
  double x = 0;
  double y = 0;
};

inline PixelPoint operator+(PixelPoint a, PixelPoint b) { return {a.x + b.x, a.y + b.y}; }
inline PixelPoint operator-(PixelPoint a, PixelPoint b) { return {a.x - b.x, a.y - b.y}; }
inline PixelPoint operator*(double scale, PixelPoint a) { return {scale * a.x, scale * a.y}; }
inline double dot(PixelPoint a, PixelPoint b) { return a.x * b.x + a.y * b.y; }
inline double cross(PixelPoint a, PixelPoint b) { return a.x * b.y - a.y * b.x; }
// Squares of pixels cannot overflow, so this needs no std::hypot, which is ten times as slow.
inline double length(PixelPoint a) { return std::sqrt(dot(a, a)); }
inline double distance(PixelPoint a, PixelPoint b) { return length(b - a); }

// ---- Parts of an image.

// Pixels from the upper left one up to before a lower right one.
struct PixelBox {
  int left, top, right, bottom;

  int width() const { return right - left; }
  int height() const { return bottom - top; }
  PixelPoint first() const { return {static_cast<double>(left), static_cast<double>(top)}; }
};

// The longer side of the upright rectangle around points, pixels.
template <class Points>
double extent_of(const Points& points) {
  const auto [left, right] = std::ranges::minmax(points, {}, &PixelPoint::x);
  const auto [top, bottom] = std::ranges::minmax(points, {}, &PixelPoint::y);
  return std::max(right.x - left.x, bottom.y - top.y);
}

// The pixels of an image around points, with so many more on each side, as far as the image has
// them: none where all points are beyond one of its borders. Of points that are no number, any.
template <class Points>
PixelBox box_around(const Points& points, double margin, const GrayView& image) {
  const auto [left, right] = std::ranges::minmax(points, {}, &PixelPoint::x);
  const auto [top, bottom] = std::ranges::minmax(points, {}, &PixelPoint::y);
  const auto pixel = [](double at, int size) {  // 0 for what is no number
    return at > 0 ? static_cast<int>(std::min(at, static_cast<double>(size))) : 0;
  };
  const int first_x = pixel(left.x - margin, image.width);
  const int first_y = pixel(top.y - margin, image.height);
  return {first_x, first_y, std::max(first_x, pixel(std::ceil(right.x + margin) + 1, image.width)),
          std::max(first_y, pixel(std::ceil(bottom.y + margin) + 1, image.height))};
}

inline GrayView part_of(const GrayView& image, const PixelBox& box) {
  return {image.row(box.top) + box.left, box.width(), box.height(), image.stride,
          image.is_negative};
}

// ---- Grey levels at a position.

// Whether a place has pixels on all sides.
inline bool is_inside(const GrayView& image, PixelPoint at) {
  return at.x >= 0 && at.y >= 0 && at.x <= image.width - 1.001 && at.y <= image.height - 1.001;
}

// The grey level between pixels at a place inside the image.
inline double interpolate(const GrayView& image, PixelPoint at) {
  const int x0 = static_cast<int>(at.x);
  const int y0 = static_cast<int>(at.y);
  const double fx = at.x - x0;
  const double fy = at.y - y0;
  const std::uint8_t* upper = image.row(y0) + x0;
  const std::uint8_t* lower = upper + image.stride;
  const double above = upper[0] + fx * (upper[1] - upper[0]);
  const double below = lower[0] + fx * (lower[1] - lower[0]);
  return above + fy * (below - above);
}

// The grey level between pixels; beyond the image that of its border. A coordinate that is no
// number counts as 0.
inline double sample_bilinear(const GrayView& image, PixelPoint at) {
  return interpolate(image, {at.x > 0 ? std::min(at.x, image.width - 1.001) : 0.0,
                             at.y > 0 ? std::min(at.y, image.height - 1.001) : 0.0});
}

// The grey level of the nearest pixel; nothing beyond the centres of the outermost ones, and for a
// place that is no number.
inline std::optional<std::uint8_t> sample_nearest(const GrayView& image, PixelPoint at) {
  const bool inside = at.x >= 0 && at.y >= 0 && at.x <= image.width - 1 && at.y <= image.height - 1;
  if (!inside) return std::nullopt;
  return image.at(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)));
}

}  // namespace tagsmith::detail
