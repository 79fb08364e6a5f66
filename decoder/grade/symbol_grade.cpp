// SPDX-License-Identifier: Apache-2.0
#include "decoder/grade/symbol_grade.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include <fmt/format.h>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kScans = 10;
constexpr double kScannedHeight = 0.8;  // of the bars, ISO/IEC 15416 5.1
constexpr double kAperture = 0.5;       // modules
constexpr int kSamplesPerModule = 10;

// Places of a scan in the frame's unit square, at one offset within the aperture: place i is at
// ((begin + step * i + offset) / length, v).
struct ScanPlaces {
  double begin = 0, step = 0, offset = 0, length = 0;  // modules
  double v = 0;
};

// Adds the light at each place, between pixels, to `sums`. Loops are apart for vectors.
TAGSMITH_WIDE void add_light(const GrayView& image, const Homography& image_from_frame,
                             const ScanPlaces& places, std::span<double> sums) {
  constexpr std::size_t kBlock = 64;
  const ToneCurve& tone = ToneCurve::of(image);
  std::array<double, kBlock> right, down, upper_left, upper_right, lower_left, lower_right;
  std::array<int, kBlock> left, top;
  for (std::size_t first = 0; first < sums.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, sums.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const auto place = static_cast<double>(static_cast<int>(first + i));
      const double u = (places.begin + places.step * place + places.offset) / places.length;
      const PixelPoint at = image_from_frame(u, places.v);
      right[i] = at.x;
      down[i] = at.y;
    }
    // A place before the first pixel is cut to it, whether by truncation or by rounding down.
    for (std::size_t i = 0; i < count; ++i) {
      const int x = static_cast<int>(right[i]), y = static_cast<int>(down[i]);
      left[i] = x < 0 ? 0 : x < image.width - 2 ? x : image.width - 2;
      top[i] = y < 0 ? 0 : y < image.height - 2 ? y : image.height - 2;
      right[i] -= left[i];
      down[i] -= top[i];
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* upper = image.row(top[i]) + left[i];
      const std::uint8_t* lower = upper + image.stride;
      upper_left[i] = tone.light_of(upper[0]);
      upper_right[i] = tone.light_of(upper[1]);
      lower_left[i] = tone.light_of(lower[0]);
      lower_right[i] = tone.light_of(lower[1]);
    }
    double* to = sums.data() + first;
    for (std::size_t i = 0; i < count; ++i) {
      to[i] += (1 - down[i]) * ((1 - right[i]) * upper_left[i] + right[i] * upper_right[i]) +
               down[i] * ((1 - right[i]) * lower_left[i] + right[i] * lower_right[i]);
    }
  }
}

// The aperture's offsets in modules: about one a pixel.
std::vector<PixelPoint> aperture_of(double module_px) {
  const int steps = std::max(1, static_cast<int>(std::lround(kAperture * module_px)));
  std::vector<PixelPoint> offsets;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const PixelPoint offset{kAperture * ((i + 0.5) / steps - 0.5),
                              kAperture * ((j + 0.5) / steps - 0.5)};
      if (length(offset) <= kAperture / 2) offsets.push_back(offset);
    }
  }
  return offsets;
}

// The scan at the height v (0 at the frame's upper inner edge), between its left and right ones.
std::vector<double> scan_at(const GrayView& image, const Homography& image_from_frame,
                            const std::vector<PixelPoint>& aperture, double modules_long,
                            double modules_high, double v) {
  const auto samples = static_cast<std::size_t>(modules_long * kSamplesPerModule);
  std::vector<double> light(samples, 0.0);
  // The aperture stays inside the frame's edge.
  const double begin = kAperture;
  const double step = (modules_long - 2 * kAperture) / static_cast<double>(samples - 1);
  for (const PixelPoint& offset : aperture) {
    const double at_v = v + offset.y / modules_high;
    add_light(image, image_from_frame, {begin, step, offset.x, modules_long, at_v}, light);
  }
  for (double& sum : light) sum /= static_cast<double>(aperture.size());
  return light;
}

void to_reflectance(std::vector<double>& light, const ReflectanceReferences& references) {
  const double scale = (references.white_reflectance - references.black_reflectance) /
                       (references.white_light - references.black_light);
  for (double& value : light) {
    value = references.black_reflectance + scale * (value - references.black_light);
  }
}

// The means of the parameters that were graded; which are, is the same in every scan.
SymbolGrade means_of(const std::vector<ScanGrade>& scans) {
  SymbolGrade symbol;
  const auto count = static_cast<double>(scans.size());
  double least = 4;
  for (std::size_t i = 0; i < kGradeParameters; ++i) {
    if (!scans.front().grades[i]) continue;
    const auto parameter = static_cast<GradeParameter>(i);
    ParameterMean mean;
    double value = 0;
    for (const ScanGrade& scan : scans) {
      mean.grade += *scan.grades[i];
      value += value_of(scan.parameters, parameter).value_or(0);
    }
    mean.grade /= count;
    if (value_of(scans.front().parameters, parameter)) mean.value = value / count;
    if (mean.grade < least) symbol.worst = parameter;
    least = std::min(least, mean.grade);
    symbol.means[i] = mean;
  }
  return symbol;
}

SymbolGrade combine(const std::vector<ScanGrade>& scans, bool absolute) {
  SymbolGrade symbol = means_of(scans);
  symbol.absolute = absolute;
  const ScanGrade* decoded = nullptr;
  double sum = 0;
  for (const ScanGrade& scan : scans) {
    sum += scan.grade;
    if (!scan.parameters.digits) continue;
    if (decoded != nullptr && decoded->parameters.digits != scan.parameters.digits) {
      symbol.worst = GradeParameter::decode;
      return symbol;
    }
    decoded = &scan;
  }
  symbol.grade = std::round(10 * sum / static_cast<double>(scans.size())) / 10;
  return symbol;
}

}  // namespace

Result<SymbolGrade> grade_symbol(const GrayView& image, const Quad& corners,
                                 const SymbolLayout& layout,
                                 const std::optional<ReflectanceReferences>& references) {
  const double modules_long = layout.modules();
  const Homography image_from_frame = homography_to(corners);
  const double module_px = distance(image_from_frame(0.5 - 0.5 / modules_long, 0.5),
                                    image_from_frame(0.5 + 0.5 / modules_long, 0.5));
  if (module_px < kLeastGradedModule) {
    return fail(fmt::format("{:.1f} pixels a module, {} are needed to grade the print", module_px,
                            kLeastGradedModule));
  }
  for (const PixelPoint& corner : corners) {
    const bool inside = corner.x >= 0 && corner.y >= 0 && corner.x <= image.width - 1 &&
                        corner.y <= image.height - 1;
    if (!inside) return fail("the tag leaves the picture");
  }
  const double modules_high = modules_long * height_of(corners) / length_of(corners);
  const std::vector<PixelPoint> aperture = aperture_of(module_px);
  const double middle = (layout.bars_top + layout.bars_bottom) / 2;
  const double half = kScannedHeight * layout.bar_height() / 2;
  std::vector<ScanGrade> scans;
  for (int i = 0; i < kScans; ++i) {
    const double v = middle + half * ((2 * i + 1.0) / kScans - 1);
    std::vector<double> light =
        scan_at(image, image_from_frame, aperture, modules_long, modules_high, v);
    if (references) to_reflectance(light, *references);
    scans.push_back(
        grade_scan(light, GradeOptions{references.has_value(), kAperture, image.is_negative}));
  }
  return combine(scans, references.has_value());
}

std::string to_string(const SymbolGrade& grade) {
  if (grade.grade >= 4) return "4.0";
  return fmt::format("{:.1f} ({})", grade.grade, to_string(grade.worst));
}

}  // namespace tagsmith::detail
