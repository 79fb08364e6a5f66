// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/crossing_lines.hpp"

#include <algorithm>
#include <optional>

#include "decoder/feature_frame/tuning.hpp"

namespace tagsmith::detail {
namespace {

// One end of a stroke: places about it in thicknesses of the strokes, from the inner corner on.
struct StrokeEnd {
  const GrayView& image;
  const FrameHomography& map;
  PixelPoint corner;       // of the unit square, as the next two
  PixelPoint beyond, out;  // from the stroke's end onwards; across the stroke away from the frame

  // The mean level of a piece as long as one and a half thicknesses, which begins so far beyond the
  // corner; none where it leaves the image.
  std::optional<double> level(double from, double outwards) const {
    double sum = 0;
    for (const double step : {0.0, 0.25, 0.5, 1.0, 1.5}) {
      const PixelPoint unit = corner + (from + step) * beyond + outwards * out;
      const PixelPoint at = map(unit.x, unit.y);
      if (!is_inside(image, at)) return std::nullopt;
      sum += sample_bilinear(image, at);
    }
    return sum / 5;
  }

  // Whether a line goes on there that is nearer to the stroke's darkness than to what is on either
  // side of it.
  bool goes_on() const {
    const auto stroke = level(-3, 0.5), line = level(1.5, 0.5);
    const auto inner = level(1.5, -0.75), outer = level(1.5, 1.75);
    if (!stroke || !line || !inner || !outer) return false;
    const double beside = std::min(*inner, *outer);
    return beside - *line >= kSide.least_fall && *line < (*stroke + beside) / 2;
  }
};

}  // namespace

bool lies_between_crossing_lines(const GrayView& image, const RefinedFrame& frame,
                                 const FrameShape& shape) {
  const FrameHomography map(frame.corners, frame.lens);
  const double along = shape.stroke / shape.length, upright = shape.stroke / shape.height;
  int count = 0;
  for (const PixelPoint corner : Quad{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}) {
    const PixelPoint right{corner.x > 0 ? along : -along, 0};
    const PixelPoint down{0, corner.y > 0 ? upright : -upright};
    count += StrokeEnd{image, map, corner, right, down}.goes_on() ? 1 : 0;
    count += StrokeEnd{image, map, corner, down, right}.goes_on() ? 1 : 0;
  }
  return count > 4;
}

}  // namespace tagsmith::detail
