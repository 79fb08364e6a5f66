// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/measure_printer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/tag/printer_test.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using PixelFromSheet = Eigen::Transform<double, 2, Eigen::Affine>;

struct CornerPairs {
  std::vector<Vector2d> on_sheet;
  std::vector<Vector2d> in_scan;
};

// The corners of the marks that were read, and how many of these there are.
CornerPairs corners_of_marks(const PrinterTest& test, const ReadResult& read) {
  CornerPairs pairs;
  for (std::size_t i = 0; i < test.marks.size(); ++i) {
    const auto found = std::ranges::find(read.tags, test.codes[i], &Reading::digits);
    if (found == read.tags.end()) continue;
    const std::array<PlatePoint, 4> corners = corners_of(test.marks[i].frame_inner);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      pairs.on_sheet.emplace_back(corners[corner].x, corners[corner].y);
      pairs.in_scan.emplace_back(found->corners[corner].x, found->corners[corner].y);
    }
  }
  return pairs;
}

// Least squares.
PixelFromSheet fitted(const CornerPairs& pairs) {
  const auto count = static_cast<Eigen::Index>(pairs.on_sheet.size());
  Eigen::MatrixX3d places(count, 3);
  Eigen::MatrixX2d pixels(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    places.row(i) << pairs.on_sheet[static_cast<std::size_t>(i)].transpose(), 1;
    pixels.row(i) = pairs.in_scan[static_cast<std::size_t>(i)].transpose();
  }
  const Eigen::Matrix<double, 3, 2> solution = least_squares(places, pixels);
  PixelFromSheet pixel_from_sheet;
  pixel_from_sheet.setIdentity();
  pixel_from_sheet.affine() = solution.transpose();
  return pixel_from_sheet;
}

// Root mean square, pixels.
double error_of(const CornerPairs& pairs, const PixelFromSheet& pixel_from_sheet) {
  double sum = 0;
  for (std::size_t i = 0; i < pairs.on_sheet.size(); ++i) {
    sum += (pixel_from_sheet * pairs.on_sheet[i] - pairs.in_scan[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(pairs.on_sheet.size()));
}

// The light of the scan by places of the sheet.
class SheetLight {
 public:
  SheetLight(const GrayView& scan, const PixelFromSheet& pixel_from_sheet)
      : scan_(scan), pixel_from_sheet_(pixel_from_sheet) {}

  double at(const Vector2d& place) const {
    const Vector2d pixel = pixel_from_sheet_ * place;
    const double level = sample_bilinear(scan_, {pixel.x(), pixel.y()});
    const auto below = static_cast<int>(level);
    const ToneCurve& curve = ToneCurve::srgb();
    const double low = curve.light_of(below);
    return low + (level - below) * (curve.light_of(std::min(below + 1, 255)) - low);
  }

  // The light in the middle of the rectangle, which blur does not reach.
  double mean(const Rectangle& r) const {
    constexpr int kSteps = 40;
    double sum = 0;
    for (int row = 0; row < kSteps; ++row) {
      for (int column = 0; column < kSteps; ++column) {
        const double right = 0.25 + 0.5 * (column + 0.5) / kSteps;
        const double down = 0.25 + 0.5 * (row + 0.5) / kSteps;
        sum += at({r.x + right * r.width, r.y + down * r.height});
      }
    }
    return sum / (kSteps * kSteps);
  }

 private:
  GrayView scan_;
  PixelFromSheet pixel_from_sheet_;
};

// The bar's width on the sheet: the ink across it, however blurred its edges are. The paper beside
// it is white.
double ink_width(const SheetLight& light, const Rectangle& bar, bool upright, double black) {
  constexpr double kStep = 0.00002;
  constexpr int kLines = 48;
  const double wide = upright ? bar.width : bar.height;
  const int steps = static_cast<int>(std::lround((wide + 2 * kBarSurround) / kStep));
  std::vector<double> profile(static_cast<std::size_t>(steps), 0);
  for (int step = 0; step < steps; ++step) {
    const double across = -kBarSurround + (step + 0.5) * kStep;
    for (int line = 0; line < kLines; ++line) {
      const double along = 0.1 + 0.8 * (line + 0.5) / kLines;
      const Vector2d place = upright ? Vector2d(bar.x + across, bar.y + along * bar.height)
                                     : Vector2d(bar.x + along * bar.width, bar.y + across);
      profile[static_cast<std::size_t>(step)] += light.at(place) / kLines;
    }
  }
  const auto ends = static_cast<std::size_t>(0.0008 / kStep);
  double white = 0;
  for (std::size_t i = 0; i < ends; ++i) {
    white += (profile[i] + profile[profile.size() - 1 - i]) / (2.0 * static_cast<double>(ends));
  }
  double ink = 0;
  for (const double level : profile) ink += (white - level) / (white - black) * kStep;
  return ink;
}

std::vector<double> growths(const SheetLight& light, const std::vector<Rectangle>& bars,
                            bool upright, double black, double scale) {
  std::vector<double> all;
  for (const Rectangle& bar : bars) {
    const double drawn = upright ? bar.width : bar.height;
    all.push_back((ink_width(light, bar, upright, black) - drawn) * scale);
  }
  return all;
}

// The mean without the least and the greatest. Edges are printed on whole dots, so that single bars
// are half a dot off in either direction.
double mean_of_most(std::vector<double> values) {
  std::ranges::sort(values);
  return std::accumulate(values.begin() + 1, values.end() - 1, 0.0) /
         static_cast<double>(values.size() - 2);
}

// The share of the area that is covered (Murray and Davies 1936), of the patch at one half.
double dot_gain(const PrinterTest& test, const SheetLight& light, double white, double black) {
  const auto half = std::ranges::find_if(
      test.tones, [](const TonePatch& tone) { return std::abs(tone.cover - 0.5) < 0.01; });
  return (white - light.mean(half->square)) / (white - black) - half->cover;
}

std::string percent(double share) { return format_number(share * 100, 2) + " %"; }

// Why the scan cannot be used as a measurement; empty = it can.
std::string objection(const PrinterScale& scale, double error_px, double dots_per_inch) {
  constexpr double kFlat = 0.0004;  // metres
  if (!is_usual(scale)) {
    return fmt::format(
        "the sheet is {} of its width and {} of its height at {} dpi, expected shares of {}: print "
        "at 100 %, without \"fit to page\"; if it was, is that the scan's resolution?",
        percent(scale.right), percent(scale.down), format_number(dots_per_inch), usual_scales());
  }
  const double error = error_px * kMetresPerInch / dots_per_inch;
  if (error <= kFlat) return {};
  return fmt::format(
      "the marks are {} mm off the sheet's form, expected at most {}: lay the sheet flat on the "
      "glass; a photo will not do",
      format_number(error * 1000, 2), format_number(kFlat * 1000));
}

}  // namespace

Result<PrinterMeasurement> measure_printer(const std::string& name, const GrayView& scan,
                                           double dots_per_inch) {
  const PrinterTest test = printer_test();
  const CornerPairs pairs = corners_of_marks(test, read_tags(scan, {}));
  const std::size_t marks = pairs.on_sheet.size() / 4;
  if (marks < test.marks.size()) {
    return fail(fmt::format(
        "{}: {} of the {} marks of a printer test were read, expected all: scan the whole sheet "
        "at 300 dpi or more (the sheet: tagsmith printer -o FILE)",
        name, marks, test.marks.size()));
  }
  const PixelFromSheet pixel_from_sheet = fitted(pairs);
  const double error_px = error_of(pairs, pixel_from_sheet);
  const double metres_per_pixel = kMetresPerInch / dots_per_inch;
  PrinterMeasurement found;
  PrinterScale& scale = found.profile.scale;
  scale = {pixel_from_sheet.linear().col(0).norm() * metres_per_pixel,
           pixel_from_sheet.linear().col(1).norm() * metres_per_pixel};
  if (const std::string problem = objection(scale, error_px, dots_per_inch); !problem.empty()) {
    return fail(name + ": " + problem);
  }
  const SheetLight light(scan, pixel_from_sheet);
  const double white = light.mean(test.tones.front().square);
  const double black = light.mean(test.tones.back().square);
  constexpr double kLeastContrast = 0.3;
  if (white - black < kLeastContrast) {
    return fail(
        fmt::format("{}: black and white of the tones differ by {} of full light, expected "
                    "at least {}: scan in grey, without automatic enhancement",
                    name, format_number(white - black, 2), kLeastContrast));
  }
  const std::vector<double> right = growths(light, test.upright, true, black, scale.right);
  const std::vector<double> down = growths(light, test.lying, false, black, scale.down);
  found.profile.growth_right = mean_of_most(right);
  found.profile.growth_down = mean_of_most(down);
  found.profile.dot_gain = dot_gain(test, light, white, black);
  double sum = 0;
  for (const double growth : right) sum += std::pow(growth - found.profile.growth_right, 2);
  for (const double growth : down) sum += std::pow(growth - found.profile.growth_down, 2);
  found.growth_spread = std::sqrt(sum / static_cast<double>(right.size() + down.size()));
  found.mark_error = error_px * metres_per_pixel;
  return found;
}

}  // namespace tagsmith::detail
