// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "decoder/image/line_levels.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/running.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// Weights of the pixels before, at, after and two after a place at `t` of the way (Keys 1981,
// a = -1/2). Linear interpolation would blur most halfway between pixels, which at one or two
// pixels a module looks like other bars.
Eigen::Array4f cubic_weights(float t) {
  using Four = Eigen::Array4f;
  return Four(0, 1, 0, 0) +
         t * (Four(-0.5F, 0, 0.5F, 0) +
              t * (Four(1, -2.5F, 2, -0.5F) + t * Four(-0.5F, 1.5F, -1.5F, 0.5F)));
}

// Light between the pixels of which `row_of(j)` gives the four in row j of four.
template <class RowOf>
float interpolated(const RowOf& row_of, float across, float down) {
  const Eigen::Array4f weights = cubic_weights(down);
  Eigen::Array4f columns = weights[0] * row_of(0);
  for (int j = 1; j < 4; ++j) columns += weights[j] * row_of(j);
  return (cubic_weights(across) * columns).sum();
}

// Beyond the image its border pixels are repeated.
float light_at(const SampledLight& light, PixelPoint at) {
  const double x = std::clamp(at.x, 0.0, light.width() - 1.0);
  const double y = std::clamp(at.y, 0.0, light.height() - 1.0);
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const auto row_of = [&](int j) {
    const float* row = light.row(std::clamp(top + j - 1, 0, light.height() - 1));
    Eigen::Array4f pixels;
    for (int i = 0; i < 4; ++i) pixels[i] = row[std::clamp(left + i - 1, 0, light.width() - 1)];
    return pixels;
  };
  return interpolated(row_of, static_cast<float>(x - left), static_cast<float>(y - top));
}

// Whether all pixels that light_at uses lie in the image.
bool has_light_at(const SampledLight& light, PixelPoint at) {
  return at.x >= 1 && at.y >= 1 && at.x < light.width() - 2 && at.y < light.height() - 2;
}

// The same for such a place.
float light_inside(const SampledLight& light, PixelPoint at) {
  const int left = static_cast<int>(at.x), top = static_cast<int>(at.y);
  const float* corner = light.row(top - 1) + left - 1;
  const std::ptrdiff_t width = light.width();
  const auto row_of = [&](int j) { return Eigen::Map<const Eigen::Array4f>(corner + j * width); };
  return interpolated(row_of, static_cast<float>(at.x - left), static_cast<float>(at.y - top));
}

// Adds the light along one thin line to `line`.
void add_light(SampledLight& light, const LineFrame& frame, double offset, ScanLine& line) {
  if (line.empty()) return;
  const auto at = [&](std::size_t i) { return frame.pixel(static_cast<double>(i) + 0.5, offset); };
  std::size_t first = 0, end = line.size();
  const auto [top, bottom] = std::minmax({at(first).y, at(end - 1).y});
  const auto row_at = [&](double y) {
    return static_cast<int>(std::clamp(y, 0.0, light.height() - 1.0));
  };
  light.make_rows(row_at(top) - 1, row_at(bottom) + 2);
  while (first < end && !has_light_at(light, at(first))) ++first;
  while (end > first && !has_light_at(light, at(end - 1))) --end;
  for (std::size_t i = 0; i < first; ++i) line[i] += light_at(light, at(i));
  for (std::size_t i = first; i < end; ++i) line[i] += light_inside(light, at(i));
  for (std::size_t i = end; i < line.size(); ++i) line[i] += light_at(light, at(i));
}

// The thin lines that a thick one is the mean of: how many, and where one of them runs.
int rows_of(double thickness) {
  return std::clamp(static_cast<int>(std::lround(thickness)), 1, kBarLines.most_rows);
}

double row_offset(int row, int rows, double thickness) {
  return ((row + 0.5) / rows - 0.5) * thickness;
}

double sharpness(const ScanLine& line) {
  std::array<float, 4> sums{};  // side by side
  for (std::size_t i = 2; i + 4 <= line.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) {
      const float difference = line[i + k] - line[i + k - 2];
      sums[k] += difference * difference;
    }
  }
  return static_cast<double>(sums[0] + sums[1] + sums[2] + sums[3]);
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

namespace {

// How far the bars lean from the frame's own `along`, radians: the lean with the sharpest thick
// line. Its rows are sampled once and moved against each other by whole samples.
double lean_of(SampledLight& light, const LineFrame& frame, double thickness) {
  constexpr double kDegree = std::numbers::pi / 180;
  const int rows = rows_of(thickness);
  const double farthest = thickness / 2 * std::sin(kBarLines.most_lean * kDegree);
  const auto extra = static_cast<std::size_t>(farthest / frame.step) + 1;
  LineFrame longer = frame;
  longer.begin -= static_cast<double>(extra) * frame.step;
  longer.count += 2 * extra;
  std::vector<ScanLine> lines;
  for (int row = 0; row < rows; ++row) {
    lines.emplace_back(longer.count, 0.0F);
    add_light(light, longer, row_offset(row, rows, thickness), lines.back());
  }
  double best = -1, lean = 0;
  for (int degrees = -kBarLines.most_lean; degrees <= kBarLines.most_lean; ++degrees) {
    ScanLine sum(frame.count, 0.0F);
    for (int row = 0; row < rows; ++row) {
      const double across = row_offset(row, rows, thickness) * std::sin(degrees * kDegree);
      const auto shift = static_cast<std::ptrdiff_t>(std::lround(across / frame.step));
      const float* from = lines[static_cast<std::size_t>(row)].data() +
                          (static_cast<std::ptrdiff_t>(extra) - shift);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += from[i];
    }
    const double sharp = sharpness(sum);
    if (sharp <= best) continue;
    best = sharp;
    lean = degrees * kDegree;
  }
  return lean;
}

}  // namespace

LineFrame line_frame_for(SampledLight& light, const BarRegion& region) {
  constexpr double kStepsPerModule = 5;
  LineFrame frame{region.centre, region.across, {-region.across.y, region.across.x}, 0, 0, 0};
  frame.step = std::clamp(region.length / 95 / kStepsPerModule, 0.2, 2.0);
  const auto [low, high] =
      inside(light.image(), region.centre, region.across, region.length * (0.5 + kBarLines.beyond));
  frame.begin = low;
  frame.count = static_cast<std::size_t>((high - low) / frame.step);
  frame.along = turned(frame.along, lean_of(light, frame, region.height));
  return frame;
}

ScanLine light_along(SampledLight& light, const LineFrame& frame, double offset, double thickness) {
  const int rows = rows_of(thickness);
  ScanLine line(frame.count, 0.0F);
  for (int row = 0; row < rows; ++row) {
    add_light(light, frame, offset + row_offset(row, rows, thickness), line);
  }
  for (float& sample : line) sample /= static_cast<float>(rows);
  return line;
}

namespace {

// How often a line turns dark; differences below kProfile.odd count as noise.
int count_of_bars(const std::vector<float>& darkness) {
  int bars = 0;
  bool was_dark = false;
  for (const float at : darkness) {
    const double limit = 0.5 + (was_dark ? -kProfile.odd : kProfile.odd) / 2;
    const bool is_dark = static_cast<double>(at) > limit;
    if (is_dark && !was_dark) ++bars;
    was_dark = is_dark;
  }
  return bars;
}

// What light_along() gives, rounded to a grey level and interpolated linearly: that is enough for a
// quick check.
ScanLine roughly_along(const GrayView& image, const LineFrame& frame, double offset,
                       double thickness) {
  const ToneCurve& tone = ToneCurve::of(image);
  const int rows = rows_of(thickness);
  std::vector<double> levels(frame.count);
  ScanLine line(frame.count, 0.0F);
  for (int row = 0; row < rows; ++row) {
    const PixelPoint begin = frame.pixel(0.5, offset + row_offset(row, rows, thickness));
    sample_line(image, {begin, frame.step * frame.across}, levels);
    for (std::size_t i = 0; i < line.size(); ++i) {
      line[i] += tone.light_near(levels[i]) / static_cast<float>(rows);
    }
  }
  return line;
}

}  // namespace

bool has_bars(const GrayView& image, const BarRegion& region, int least) {
  constexpr double kStepsPerModule = 3;
  LineFrame frame{region.centre, region.across, {-region.across.y, region.across.x}, 0, 0, 0};
  frame.step = std::clamp(region.length / kModuleCount / kStepsPerModule, 0.25, 8.0);
  const auto [low, high] = inside(image, region.centre, region.across, 0.5 * region.length);
  frame.begin = low;
  frame.count = static_cast<std::size_t>((high - low) / frame.step);
  if (frame.count < 60) return false;
  // Between wide bars blurred narrow ones are told from the white next to them, not from that of a
  // whole digit.
  const std::size_t nearby = frame.count / 20;
  return std::ranges::any_of(std::array{-0.1, 0.1, 0.3}, [&](double share) {
    const ScanLine line =
        roughly_along(image, frame, share * region.height, std::min(12.0, region.height / 8));
    return count_of_bars(local_darkness(line, nearby)) >= least;
  });
}

}  // namespace tagsmith::detail
