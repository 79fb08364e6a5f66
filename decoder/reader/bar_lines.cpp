// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <utility>
#include <vector>

#include "decoder/scan/running.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

// Four neighbouring pixels side by side, in the compiler's own vectors.
using Floats = float __attribute__((vector_size(4 * sizeof(float))));

// Weights of the pixels before, at, after and two after a place at `t` of the way (Keys 1981,
// a = -1/2). Linear interpolation would blur most halfway between pixels, which at one or two
// pixels a module looks like other bars.
constexpr Floats kConstant{0, 1, 0, 0};
constexpr Floats kLinear{-0.5F, 0, 0.5F, 0};
constexpr Floats kSquare{1, -2.5F, 2, -0.5F};
constexpr Floats kCube{-0.5F, 1.5F, -1.5F, 0.5F};

Floats cubic_weights(float t) { return kConstant + t * (kLinear + t * (kSquare + t * kCube)); }

float sum_of(Floats values) { return (values[0] + values[1]) + (values[2] + values[3]); }

// Beyond the image its border pixels continue.
float light_at(const SampledLight& light, PixelPoint at) {
  const double x = std::clamp(at.x, 0.0, light.width() - 1.0);
  const double y = std::clamp(at.y, 0.0, light.height() - 1.0);
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const Floats across = cubic_weights(static_cast<float>(x - left));
  const Floats down = cubic_weights(static_cast<float>(y - top));
  Floats columns{};
  for (int j = 0; j < 4; ++j) {
    const float* row = light.row(std::clamp(top + j - 1, 0, light.height() - 1));
    Floats pixels{};
    for (int i = 0; i < 4; ++i) pixels[i] = row[std::clamp(left + i - 1, 0, light.width() - 1)];
    columns += down[j] * pixels;
  }
  return sum_of(across * columns);
}

// Whether all pixels that light_at takes are the image's.
bool is_inside(const SampledLight& light, PixelPoint at) {
  return at.x >= 1 && at.y >= 1 && at.x < light.width() - 2 && at.y < light.height() - 2;
}

// A thin line: its samples are taken at start + i * step.
struct ThinLine {
  PixelPoint start;
  PixelPoint step;

  PixelPoint at(std::size_t i) const { return start + static_cast<double>(i) * step; }
};

// Eight samples at a time, in the compiler's own vectors.
constexpr std::size_t kTogether = 8;
using Eight = float __attribute__((vector_size(kTogether * sizeof(float))));
using FourDoubles = double __attribute__((vector_size(4 * sizeof(double))));
using FourInts = std::int32_t __attribute__((vector_size(4 * sizeof(std::int32_t))));

// Samples whose places are found before their light is: a cache's fill.
constexpr std::size_t kBlock = 64;

// Of a block's places along x or y: the pixels before them, and the weights, by tap, that
// cubic_weights has there.
struct Taps {
  std::array<std::int32_t, kBlock> pixel;
  std::array<std::array<float, kBlock>, 4> weight;
};

// Of the `count` places at start + (first + i) * step, in eights.
inline void find_taps(double start, double step, double first, std::size_t count, Taps& taps) {
  constexpr FourDoubles kNext{0, 1, 2, 3};
  for (std::size_t i = 0; i < count; i += kTogether) {
    const FourDoubles here = start + ((first + static_cast<double>(i)) + kNext) * step;
    const FourDoubles later = start + ((first + static_cast<double>(i + 4)) + kNext) * step;
    const FourInts pixel = __builtin_convertvector(here, FourInts);
    const FourInts later_pixel = __builtin_convertvector(later, FourInts);
    std::memcpy(&taps.pixel[i], &pixel, sizeof pixel);
    std::memcpy(&taps.pixel[i + 4], &later_pixel, sizeof pixel);
    const Floats beyond =
        __builtin_convertvector(here - __builtin_convertvector(pixel, FourDoubles), Floats);
    const Floats later_beyond =
        __builtin_convertvector(later - __builtin_convertvector(later_pixel, FourDoubles), Floats);
    const Eight t = __builtin_shufflevector(beyond, later_beyond, 0, 1, 2, 3, 4, 5, 6, 7);
    for (std::size_t tap = 0; tap < 4; ++tap) {
      const Eight weight =
          kConstant[tap] + t * (kLinear[tap] + t * (kSquare[tap] + t * kCube[tap]));
      std::memcpy(&taps.weight[tap][i], &weight, sizeof weight);
    }
  }
}

// Adds to eight samples what their four columns of pixels give by the weights across.
inline void add_columns(const Floats* columns, const Taps& across, std::size_t first,
                        float* samples) {
  const Eight p0 = __builtin_shufflevector(columns[0], columns[4], 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight p1 = __builtin_shufflevector(columns[1], columns[5], 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight p2 = __builtin_shufflevector(columns[2], columns[6], 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight p3 = __builtin_shufflevector(columns[3], columns[7], 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight a = __builtin_shufflevector(p0, p1, 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight b = __builtin_shufflevector(p0, p1, 2, 10, 3, 11, 6, 14, 7, 15);
  const Eight c = __builtin_shufflevector(p2, p3, 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight d = __builtin_shufflevector(p2, p3, 2, 10, 3, 11, 6, 14, 7, 15);
  std::array<Eight, 4> weights;
  for (std::size_t tap = 0; tap < 4; ++tap) {
    std::memcpy(&weights[tap], &across.weight[tap][first], sizeof(Eight));
  }
  Eight sum;
  std::memcpy(&sum, samples, sizeof sum);
  sum += (weights[0] * __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13) +
          weights[1] * __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15)) +
         (weights[2] * __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13) +
          weights[3] * __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15));
  std::memcpy(samples, &sum, sizeof sum);
}

// Adds light_at for those samples from `first` on, before `end`, all inside; as far as eight are
// left. Returns where it ended.
TAGSMITH_WIDE std::size_t add_inside(const SampledLight& light, const ThinLine& thin,
                                     std::size_t first, std::size_t end, float* samples) {
  const std::ptrdiff_t stride = light.width();
  const float* corner = light.row(0);
  Taps across, down;
  std::array<Floats, kBlock> columns;
  while (first + kTogether <= end) {
    const std::size_t count = std::min(kBlock, (end - first) / kTogether * kTogether);
    const auto at = static_cast<double>(static_cast<std::ptrdiff_t>(first));
    find_taps(thin.start.x, thin.step.x, at, count, across);
    find_taps(thin.start.y, thin.step.y, at, count, down);
    for (std::size_t i = 0; i < count; ++i) {
      const float* row = corner + (down.pixel[i] - 1) * stride + (across.pixel[i] - 1);
      std::array<Floats, 4> pixels;
      for (std::size_t tap = 0; tap < 4; ++tap, row += stride) {
        std::memcpy(&pixels[tap], row, sizeof(Floats));
      }
      columns[i] = ((down.weight[0][i] * pixels[0] + down.weight[1][i] * pixels[1]) +
                    down.weight[2][i] * pixels[2]) +
                   down.weight[3][i] * pixels[3];
    }
    for (std::size_t i = 0; i < count; i += kTogether) {
      add_columns(&columns[i], across, i, samples + first + i);
    }
    first += count;
  }
  return first;
}

// Adds the light along one thin line to `line`.
void add_light(SampledLight& light, const LineFrame& frame, double offset, ScanLine& line) {
  if (line.empty()) return;
  const ThinLine thin{frame.pixel(0.5, offset), frame.step * frame.across};
  std::size_t first = 0, end = line.size();
  const auto [top, bottom] = std::minmax({thin.at(first).y, thin.at(end - 1).y});
  const auto row_at = [&](double y) {
    return static_cast<int>(std::clamp(y, 0.0, light.height() - 1.0));
  };
  light.make_rows(row_at(top) - 1, row_at(bottom) + 2);
  while (first < end && !is_inside(light, thin.at(first))) ++first;
  while (end > first && !is_inside(light, thin.at(end - 1))) --end;
  for (std::size_t i = 0; i < first; ++i) line[i] += light_at(light, thin.at(i));
  first = add_inside(light, thin, first, end, line.data());
  for (std::size_t i = first; i < line.size(); ++i) line[i] += light_at(light, thin.at(i));
}

// The thin lines that a thick one is the mean of: how many, and where one of them runs.
int rows_of(double thickness) {
  constexpr int kMostRows = 24;
  return std::clamp(static_cast<int>(std::lround(thickness)), 1, kMostRows);
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

// How far the bars lean from the frame's own `along`, radians: so that a thick line is sharpest.
// Its rows are taken once and moved against each other by whole samples.
double lean_of(SampledLight& light, const LineFrame& frame, double thickness) {
  constexpr int kMostLean = 8;  // degrees
  constexpr double kDegree = std::numbers::pi / 180;
  const int rows = rows_of(thickness);
  const double farthest = thickness / 2 * std::sin(kMostLean * kDegree);
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
  for (int degrees = -kMostLean; degrees <= kMostLean; ++degrees) {
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
  constexpr double kBeyond = 0.5;  // of the length, on both sides
  constexpr double kStepsPerModule = 5;
  constexpr double kThickness = 0.6;  // of the height
  LineFrame frame{region.centre, region.across, {-region.across.y, region.across.x}, 0, 0, 0};
  frame.step = std::clamp(region.length / 95 / kStepsPerModule, 0.2, 2.0);
  const auto [low, high] =
      inside(light.image(), region.centre, region.across, region.length * (0.5 + kBeyond));
  frame.begin = low;
  frame.count = static_cast<std::size_t>((high - low) / frame.step);
  frame.along = turned(frame.along, lean_of(light, frame, kThickness * region.height));
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

bool has_bars(SampledLight& light, const BarRegion& region) {
  constexpr int kLeast = 12;  // of a symbol's 30 bars
  constexpr int kMost = 34;
  constexpr double kStepsPerModule = 3;
  constexpr double kApart = 0.2;  // of the height: two lines that should be alike
  constexpr double kMostLean = 0.25;
  constexpr float kAlike = 0.6F;
  LineFrame frame{region.centre, region.across, {-region.across.y, region.across.x}, 0, 0, 0};
  frame.step = std::clamp(region.length / kModuleCount / kStepsPerModule, 0.25, 8.0);
  const auto [low, high] = inside(light.image(), region.centre, region.across, 0.5 * region.length);
  frame.begin = low;
  frame.count = static_cast<std::size_t>((high - low) / frame.step);
  if (frame.count < 60) return false;
  std::vector<float> before;
  for (const double share : {-0.3, -0.1, 0.1, 0.3}) {
    const ScanLine line =
        light_along(light, frame, share * region.height, std::min(12.0, region.height / 8));
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
