// SPDX-License-Identifier: Apache-2.0
#include "decoder/grade/grade.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// ---- One scan: bars, spaces and edges.

namespace {

constexpr double kModules = kModuleCount;

// A bar, a space, or a quiet zone: samples [begin, end).
struct Region {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool bar = false;
  double extreme = 0;  // greatest reflectance of a space, least of a bar
};

// Regions on either side of the global threshold, quiet zones included.
std::vector<Region> regions_of(std::span<const double> reflectance, double threshold) {
  std::vector<Region> regions;
  for (std::size_t i = 0; i < reflectance.size(); ++i) {
    const bool bar = reflectance[i] < threshold;
    if (regions.empty() || regions.back().bar != bar) {
      regions.push_back({i, i, bar, reflectance[i]});
    }
    Region& region = regions.back();
    region.end = i + 1;
    region.extreme =
        bar ? std::min(region.extreme, reflectance[i]) : std::max(region.extreme, reflectance[i]);
  }
  return regions;
}

// Where the profile crosses the middle between the extremes of two neighbouring regions, samples.
double edge_between(std::span<const double> reflectance, const Region& before,
                    const Region& after) {
  const double level = (before.extreme + after.extreme) / 2;
  // From the later region's extreme back to the first crossing, which is the edge.
  std::size_t i = after.begin;
  const auto beyond = [&](std::size_t at) {
    return after.bar ? reflectance[at] < level : reflectance[at] > level;
  };
  while (i + 1 < after.end && !beyond(i)) ++i;
  while (i > before.begin && beyond(i - 1)) --i;
  if (i == 0) return 0;
  const double a = reflectance[i - 1];
  const double b = reflectance[i];
  const double share = b == a ? 0.5 : std::clamp((level - a) / (b - a), 0.0, 1.0);
  return static_cast<double>(i - 1) + share;
}

// ISO/IEC 15416 5.4.7: the greatest peak minus the least valley within an element; 0 where it has
// only one turning point.
double nonuniformity(std::span<const double> reflectance, const Region& region) {
  double peak = -1;
  double valley = 2;
  const std::span<const double> part = reflectance.subspan(region.begin, region.end - region.begin);
  for (std::size_t i = 1; i + 1 < part.size(); ++i) {
    if (part[i] >= part[i - 1] && part[i] > part[i + 1]) peak = std::max(peak, part[i]);
    if (part[i] <= part[i - 1] && part[i] < part[i + 1]) valley = std::min(valley, part[i]);
  }
  // An element's own extreme is a turning point even where it lies at its end.
  if (!region.bar && valley < 2) peak = std::max(peak, region.extreme);
  if (region.bar && peak > -1) valley = std::min(valley, region.extreme);
  return peak > valley ? peak - valley : 0;
}

// ---- One scan: the reference decode.

struct DigitDecode {
  std::optional<std::uint8_t> digit;
  double decodability = 0;
};

double bars_of(std::span<const std::uint8_t> elements, bool left_half) {
  return left_half ? elements[1] + elements[3] : elements[0] + elements[2];
}

// The digits whose like edges lie these whole numbers of modules apart.
std::vector<std::uint8_t> digits_with(int first, int second) {
  std::vector<std::uint8_t> digits;
  for (std::uint8_t digit = 0; digit < 10; ++digit) {
    const auto& elements = kDigitElements[digit];
    if (elements[0] + elements[1] == first && elements[1] + elements[2] == second) {
      digits.push_back(digit);
    }
  }
  return digits;
}

// How far a distance lies from the nearest threshold (1.5, 2.5 ... modules), 1 at the middle.
double clearance(double modules) { return 2 * (0.5 - std::abs(modules - std::round(modules))); }

// One digit from its four widths in any unit; the left half's begin with a space.
DigitDecode decode_digit(std::span<const double> widths, bool left_half) {
  const double module = std::accumulate(widths.begin(), widths.end(), 0.0) / kModulesPerDigit;
  const double first = (widths[0] + widths[1]) / module;
  const double second = (widths[1] + widths[2]) / module;
  const std::vector<std::uint8_t> digits =
      digits_with(static_cast<int>(std::round(first)), static_cast<int>(std::round(second)));
  DigitDecode decode;
  decode.decodability = std::min(clearance(first), clearance(second));
  if (digits.empty()) return {std::nullopt, 0};
  decode.digit = digits.front();
  if (digits.size() == 1) return decode;
  // 1 and 7, 2 and 8: distinguished by the sum of the two bars, whose threshold lies halfway.
  const double bars = (left_half ? widths[1] + widths[3] : widths[0] + widths[2]) / module;
  const double a = bars_of(kDigitElements[digits[0]], left_half);
  const double b = bars_of(kDigitElements[digits[1]], left_half);
  decode.digit = std::abs(bars - a) < std::abs(bars - b) ? digits[0] : digits[1];
  decode.decodability = std::min(decode.decodability, std::min(1.0, std::abs(bars - (a + b) / 2)));
  return decode;
}

void decode_symbol(std::span<const double> edges, ScanParameters& parameters) {
  std::vector<double> widths;
  for (std::size_t i = 1; i < edges.size(); ++i) widths.push_back(edges[i] - edges[i - 1]);
  Digits digits{};
  bool decoded = true;
  parameters.decodability = 1;
  for (int i = 0; i < kDigitCount; ++i) {
    const auto first = static_cast<std::size_t>(first_element_of_digit(i));
    const DigitDecode decode =
        decode_digit(std::span(widths).subspan(first, kElementsPerDigit), i < kDigitCount / 2);
    parameters.decodability = std::min(parameters.decodability, decode.decodability);
    decoded = decoded && decode.digit.has_value();
    digits[static_cast<std::size_t>(i)] = decode.digit.value_or(0);
  }
  const bool valid =
      has_check_digit(CheckDigit::gs1, digits) || has_check_digit(CheckDigit::sum10, digits);
  if (decoded && valid) parameters.digits = digits;
  if (!parameters.digits) parameters.decodability = 0;
}

// ---- One scan: grades.

// Continuous between the limits of the grades 4, 3, 2 and 1; below the last one in proportion.
double grade_of(double value, const std::array<double, 4>& limits) {
  if (value >= limits[0]) return 4;
  for (std::size_t i = 1; i < limits.size(); ++i) {
    if (value < limits[i]) continue;
    return 4 - static_cast<double>(i) + (value - limits[i]) / (limits[i - 1] - limits[i]);
  }
  return std::max(0.0, value / limits[3]);
}

double defects_grade(double defects) {
  std::array<double, 4> limits = grade_limits(GradeParameter::defects);
  if (defects > limits[3]) return std::max(0.0, 1 - (defects - limits[3]) / 0.05);
  for (double& limit : limits) limit = -limit;
  return grade_of(-defects, limits);
}

double pass(bool passed) { return passed ? 4 : 0; }

void set_grades(const GradeOptions& options, ScanGrade& scan) {
  const ScanParameters& p = scan.parameters;
  const auto set = [&](GradeParameter parameter, double grade) {
    scan.grades[static_cast<std::size_t>(parameter)] = grade;
  };
  const auto graded = [&](GradeParameter parameter) {
    return grade_of(*value_of(p, parameter), grade_limits(parameter));
  };
  set(GradeParameter::decode, pass(p.digits.has_value()));
  set(GradeParameter::minimum_reflectance,
      pass(p.least_reflectance <= 0.5 * p.greatest_reflectance));
  set(GradeParameter::modulation, graded(GradeParameter::modulation));
  set(GradeParameter::defects, defects_grade(p.defects));
  set(GradeParameter::decodability, graded(GradeParameter::decodability));
  constexpr double kMeasuring = 0.5;  // modules by which the ends of a quiet zone are uncertain
  set(GradeParameter::quiet_zone, pass(p.quiet_zone >= kQuietZoneModules - kMeasuring));
  if (options.absolute) {
    set(GradeParameter::symbol_contrast, graded(GradeParameter::symbol_contrast));
    set(GradeParameter::minimum_edge_contrast, pass(p.minimum_edge_contrast >= 0.15));
  }
  scan.grade = 4;
  for (std::size_t i = 0; i < kGradeParameters; ++i) {
    if (!scan.grades[i] || *scan.grades[i] >= scan.grade) continue;
    scan.grade = *scan.grades[i];
    scan.worst = static_cast<GradeParameter>(i);
  }
}

}  // namespace

std::string to_string(GradeParameter parameter) {
  constexpr std::array kNames{
      "decode",     "symbol_contrast", "minimum_reflectance", "minimum_edge_contrast",
      "modulation", "defects",         "decodability",        "quiet_zone"};
  return kNames[static_cast<std::size_t>(parameter)];
}

std::optional<double> value_of(const ScanParameters& scan, GradeParameter parameter) {
  const std::array<std::optional<double>, kGradeParameters> values{
      std::nullopt,    scan.symbol_contrast, scan.least_reflectance, scan.minimum_edge_contrast,
      scan.modulation, scan.defects,         scan.decodability,      scan.quiet_zone};
  return values[static_cast<std::size_t>(parameter)];
}

std::array<double, 4> grade_limits(GradeParameter parameter) {
  switch (parameter) {
    case GradeParameter::symbol_contrast:
      return {0.70, 0.55, 0.40, 0.20};
    case GradeParameter::modulation:
      return {0.70, 0.60, 0.50, 0.40};
    case GradeParameter::defects:
      return {0.15, 0.20, 0.25, 0.30};
    case GradeParameter::decodability:
      return {0.62, 0.50, 0.37, 0.25};
    default:
      return {};
  }
}

ScanGrade grade_scan(std::span<const double> reflectance, const GradeOptions& options) {
  ScanGrade scan;
  ScanParameters& p = scan.parameters;
  if (reflectance.empty()) {
    set_grades(options, scan);
    return scan;
  }
  const auto [least, greatest] = std::ranges::minmax(reflectance);
  p.least_reflectance = least;
  p.greatest_reflectance = greatest;
  p.symbol_contrast = p.greatest_reflectance - p.least_reflectance;
  const std::vector<Region> regions =
      regions_of(reflectance, (p.greatest_reflectance + p.least_reflectance) / 2);
  std::vector<double> edges;
  p.minimum_edge_contrast = p.symbol_contrast;
  for (std::size_t i = 1; i < regions.size(); ++i) {
    edges.push_back(edge_between(reflectance, regions[i - 1], regions[i]));
    p.minimum_edge_contrast =
        std::min(p.minimum_edge_contrast, std::abs(regions[i].extreme - regions[i - 1].extreme));
  }
  double worst = 0;
  for (const Region& region : regions) worst = std::max(worst, nonuniformity(reflectance, region));
  if (p.symbol_contrast > 0) {
    p.modulation = p.minimum_edge_contrast / p.symbol_contrast;
    p.defects = worst / p.symbol_contrast;
  }
  const bool complete = regions.size() == kElementCount + 2 && !regions.front().bar;
  if (complete) {
    decode_symbol(edges, p);
    const double module = (edges.back() - edges.front()) / kModules;
    const double after = static_cast<double>(reflectance.size()) - 1 - edges.back();
    p.quiet_zone = std::min(edges.front(), after) / module + options.quiet_beyond;
  }
  if (options.is_negative) {
    p.least_reflectance = 1 - greatest;
    p.greatest_reflectance = 1 - least;
  }
  set_grades(options, scan);
  return scan;
}

// ---- A symbol in a picture.

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

// Adds the light at each place, between pixels, to `sums`. Loops are separate for vectorisation.
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
