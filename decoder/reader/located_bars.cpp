// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/located_bars.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/region_scan.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/tuning.hpp"

namespace tagsmith::detail {
namespace {

// Fits the modules of the lines' boundaries. Lines that explain little of their bars, which may
// have taken something else for the outermost ones, and boundaries that most others contradict
// count little.
LocatedBars fit_bars(const RegionScan& scan, PixelPoint centre) {
  constexpr double kUnit = 100;        // pixels: conditions the equations
  constexpr double kLeastCost = 0.05;  // of a line: lower costs say nothing of how sure it is
  LocatedBars bars;
  bars.centre = centre;
  for (int round = 0; round < kDecode.rounds; ++round) {
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
    for (const ReadLine& line : scan.lines) {
      const double cost = std::max(kLeastCost, line.reading.alignment.cost_per_module);
      for (std::size_t i = 0; i < kBoundaryModules.size(); ++i) {
        const PixelPoint pixel =
            scan.frame.pixel(line.reading.alignment.boundaries[i], line.offset);
        const PixelPoint p = 1 / kUnit * (pixel - centre);
        const double module = kBoundaryModules[i];
        const double below = 1 + kUnit * dot(bars.c, p);
        const double off = (bars.a + kUnit * dot(bars.b, p)) / below - module;
        const double ratio = round == 0 ? 0 : off / kBarLines.off;
        const double weight = 1 / (cost * cost * below * below * (1 + ratio * ratio));
        Eigen::Matrix<double, 5, 1> row;
        row << 1, p.x, p.y, -module * p.x, -module * p.y;
        normal += weight * row * row.transpose();
        right += weight * module * row;
      }
    }
    const Eigen::Matrix<double, 5, 1> x = normal.ldlt().solve(right);
    bars.a = x[0];
    bars.b = {x[1] / kUnit, x[2] / kUnit};
    bars.c = {x[3] / kUnit, x[4] / kUnit};
  }
  return bars;
}

}  // namespace

std::optional<LocatedBars> locate_bars(SampledLight& image, const BarRegion& region) {
  auto first = first_line(image, region, Wanted::alignment);
  if (!first) return std::nullopt;
  const auto& boundaries = first->line.reading.alignment.boundaries;
  const double middle = (boundaries.front() + boundaries.back()) / 2;
  const RegionScan scan = scan_region(image, region, *std::move(first), Wanted::alignment);
  const double offset = (scan.lines.front().offset + scan.lines.back().offset) / 2;
  LocatedBars bars = fit_bars(scan, scan.frame.pixel(middle, offset));
  bars.height = scan.lines.back().offset - scan.lines.front().offset + scan.spacing;
  return bars;
}

}  // namespace tagsmith::detail
