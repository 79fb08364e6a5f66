// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/symbology/upca.hpp"

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

namespace {

// How often a line turns dark.
int count_of_bars(const std::vector<float>& darkness) {
  constexpr float kDark = 0.6F, kBright = 0.4F;
  int bars = 0;
  bool dark = false;
  for (const float at : darkness) {
    if (!dark && at > kDark) ++bars;
    if (at > kDark || at < kBright) dark = at > kDark;
  }
  return bars;
}

// Greatest correlation of two lines, one moved along the other by up to `most` samples.
float likeness(const std::vector<float>& a, const std::vector<float>& b, int most) {
  float best = -1;
  const int size = static_cast<int>(std::min(a.size(), b.size()));
  for (int shift = -most; shift <= most; ++shift) {
    float sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0, n = 0;
    for (int i = std::max(0, -shift); i < std::min(size, size - shift); ++i) {
      const float x = a[static_cast<std::size_t>(i)];
      const float y = b[static_cast<std::size_t>(i + shift)];
      sa += x;
      sb += y;
      saa += x * x;
      sbb += y * y;
      sab += x * y;
      n += 1;
    }
    if (n < 40) continue;
    const float variance = (saa - sa * sa / n) * (sbb - sb * sb / n);
    best = std::max(best, (sab - sa * sb / n) / std::sqrt(std::max(variance, 1e-6F)));
  }
  return best;
}

}  // namespace

bool has_bars(const GrayView& image, const BarRegion& region) {
  constexpr int kLeast = 12;  // of a symbol's 30 bars
  constexpr int kMost = 34;
  constexpr double kStepsPerModule = 3;
  constexpr double kApart = 0.2;  // of the height: two lines that should be alike
  constexpr double kMostLean = 0.25;
  constexpr float kAlike = 0.6F;
  LineFrame frame{region.centre, region.across, {-region.across.y, region.across.x}, 0, 0, 0};
  frame.step = std::clamp(region.length / kModuleCount / kStepsPerModule, 0.25, 8.0);
  const auto [low, high] = inside(image, region.centre, region.across, 0.5 * region.length);
  frame.begin = low;
  frame.count = static_cast<std::size_t>((high - low) / frame.step);
  if (frame.count < 60) return false;
  std::vector<float> before;
  for (const double share : {-0.3, -0.1, 0.1, 0.3}) {
    const ScanLine line =
        light_along(image, frame, share * region.height, std::min(12.0, region.height / 8));
    std::vector<float> darkness = local_darkness(line, line.size() / 10);
    const int bars = count_of_bars(darkness);
    const int most = static_cast<int>(kMostLean * kApart * region.height / frame.step) + 1;
    if (!before.empty() && bars >= kLeast && bars <= kMost &&
        likeness(before, darkness, most) > kAlike) {
      return true;
    }
    before = std::move(darkness);
  }
  return false;
}

}  // namespace tagsmith
