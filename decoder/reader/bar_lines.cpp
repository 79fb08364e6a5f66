// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "decoder/image/tone_curve.hpp"

namespace tagsmith {
namespace {

// Weights of the pixels before, at, after and two after a place at `t` of the way (Keys 1981,
// a = -1/2). Linear interpolation would blur most halfway between pixels, which at one or two
// pixels a module looks like other bars.
std::array<double, 4> cubic_weights(double t) {
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
          0.5 * (t3 - t2)};
}

// Beyond the image its border pixels continue.
float light_at(const GrayView& image, const ToneCurve& tone, PixelPoint at) {
  const double x = std::clamp(at.x, 0.0, image.width - 1.0);
  const double y = std::clamp(at.y, 0.0, image.height - 1.0);
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const std::array<double, 4> across = cubic_weights(x - left);
  const std::array<double, 4> down = cubic_weights(y - top);
  double light = 0;
  for (int j = 0; j < 4; ++j) {
    const std::uint8_t* row = image.row(std::clamp(top + j - 1, 0, image.height - 1));
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
      sum += across[static_cast<std::size_t>(i)] *
             tone.light_of(row[std::clamp(left + i - 1, 0, image.width - 1)]);
    }
    light += down[static_cast<std::size_t>(j)] * sum;
  }
  return static_cast<float>(light);
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
  const auto [low, high] =
      inside(image, region.centre, region.across, region.length * (0.5 + kBeyond));
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
