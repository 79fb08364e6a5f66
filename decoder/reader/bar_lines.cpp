// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "decoder/image/tone_curve.hpp"

namespace tagsmith {
namespace {

float light_at(const GrayView& image, const ToneCurve& tone, PixelPoint at) {
  const double x = std::clamp(at.x, 0.0, image.width - 1.0);
  const double y = std::clamp(at.y, 0.0, image.height - 1.0);
  const int left = std::min(static_cast<int>(x), std::max(0, image.width - 2));
  const int top = std::min(static_cast<int>(y), std::max(0, image.height - 2));
  const int right = std::min(left + 1, image.width - 1);
  const int bottom = std::min(top + 1, image.height - 1);
  const double u = x - left;
  const double v = y - top;
  return static_cast<float>(
      (1 - v) * ((1 - u) * tone.light_of(image.at(left, top)) +
                 u * tone.light_of(image.at(right, top))) +
      v * ((1 - u) * tone.light_of(image.at(left, bottom)) +
           u * tone.light_of(image.at(right, bottom))));
}

double sharpness(const ScanLine& line) {
  double sum = 0;
  for (std::size_t i = 2; i < line.size(); ++i) {
    const double difference = line[i] - line[i - 2];
    sum += difference * difference;
  }
  return sum;
}

PixelPoint turned(PixelPoint vector, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * vector.x - s * vector.y, s * vector.x + c * vector.y};
}

// Distances from the centre along `direction` at which the line leaves the image.
std::array<double, 2> inside(const GrayView& image, PixelPoint centre, PixelPoint direction,
                             double reach) {
  double low = -reach;
  double high = reach;
  const auto clip = [&](double at, double slope, double size) {
    if (std::abs(slope) < 1e-9) return;
    const double a = (-0.5 - at) / slope;
    const double b = (size - 0.5 - at) / slope;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  };
  clip(centre.x, direction.x, image.width);
  clip(centre.y, direction.y, image.height);
  return {low, std::max(low, high)};
}

}  // namespace

LineFrame line_frame_for(const GrayView& image, const BarRegion& region) {
  constexpr double kBeyond = 0.5;  // of the length, on both sides
  constexpr double kStepsPerModule = 5;
  constexpr double kMostLean = 8;  // degrees that the bars may lean from the region's direction
  LineFrame frame{region.centre, region.across, {-region.across.y, region.across.x}, 0, 0, 0};
  frame.step = std::clamp(region.length / 95 / kStepsPerModule, 0.2, 2.0);
  const auto [low, high] = inside(image, region.centre, region.across, region.length * (0.5 + kBeyond));
  frame.begin = low;
  frame.count = static_cast<std::size_t>((high - low) / frame.step);
  double best = -1;
  const PixelPoint upright = frame.along;
  for (double lean = -kMostLean; lean <= kMostLean; lean += 1) {
    LineFrame leaning = frame;
    leaning.along = turned(upright, lean * std::acos(-1.0) / 180);
    const double sharp = sharpness(light_along(image, leaning, 0, 0.6 * region.height));
    if (sharp <= best) continue;
    best = sharp;
    frame.along = leaning.along;
  }
  return frame;
}

ScanLine light_along(const GrayView& image, const LineFrame& frame, double offset,
                     double thickness) {
  constexpr int kMostRows = 24;
  const int rows = std::clamp(static_cast<int>(std::lround(thickness)), 1, kMostRows);
  const ToneCurve& tone = ToneCurve::srgb();
  ScanLine line(frame.count, 0.0F);
  for (int row = 0; row < rows; ++row) {
    const double at = offset + ((row + 0.5) / rows - 0.5) * thickness;
    for (std::size_t i = 0; i < line.size(); ++i) {
      line[i] += light_at(image, tone, frame.pixel(static_cast<double>(i) + 0.5, at));
    }
  }
  for (float& sample : line) sample /= static_cast<float>(rows);
  return line;
}

}  // namespace tagsmith
