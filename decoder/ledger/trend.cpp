// SPDX-License-Identifier: Apache-2.0
#include "decoder/ledger/trend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace tagsmith::detail {
namespace {

// Student's t that is exceeded with a probability of 0.1, so that 0.8 lie within it on both sides.
// Beyond the table by Cornish and Fisher's expansion (Abramowitz and Stegun 26.7.5).
double student_t(std::size_t degrees_of_freedom) {
  constexpr std::array kTable{3.0777, 1.8856, 1.6377, 1.5332, 1.4759,
                              1.4398, 1.4149, 1.3968, 1.3830, 1.3722};
  if (degrees_of_freedom <= kTable.size()) return kTable[degrees_of_freedom - 1];
  constexpr double kNormal = 1.28155;
  const auto n = static_cast<double>(degrees_of_freedom);
  const double cube = kNormal * kNormal * kNormal;
  return kNormal + (cube + kNormal) / (4 * n) +
         (5 * cube * kNormal * kNormal + 16 * cube + 3 * kNormal) / (96 * n * n);
}

// Where a x^2 + b x + c is 0, the lesser one first; infinite where there is no such place.
std::pair<double, double> roots(double a, double b, double c) {
  const double inside = b * b - 4 * a * c;
  if (!(inside >= 0) || a == 0) return {-INFINITY, INFINITY};
  const double q = -(b + std::copysign(std::sqrt(inside), b)) / 2;
  const double other = q == 0 ? 0 : c / q;
  return std::minmax({q / a, other});
}

}  // namespace

std::optional<Trend> fit_trend(const std::vector<TrendPoint>& points) {
  if (points.size() < kLeastTrendDays) return std::nullopt;
  Trend trend{points.size(), points.front().day, points.back().day};
  const auto count = static_cast<double>(points.size());
  for (const TrendPoint& point : points) {
    trend.middle += point.day / count;
    trend.level += point.value / count;
  }
  double product = 0;
  for (const TrendPoint& point : points) {
    trend.spread += (point.day - trend.middle) * (point.day - trend.middle);
    product += (point.day - trend.middle) * (point.value - trend.level);
  }
  if (!(trend.spread > 0)) return std::nullopt;
  trend.slope = product / trend.spread;
  double squares = 0;
  for (const TrendPoint& point : points) squares += std::pow(point.value - trend.at(point.day), 2);
  trend.scatter = std::sqrt(squares / (count - 2));
  return trend;
}

Crossing crossing_of(const Trend& trend, double limit) {
  // From the middle on, the line's confidence band is above and edge(x) below it by
  // k sqrt(1 / n + x^2 / spread); the band's edges are at the limit where the square of the line's
  // height is that of the half width.
  const double k = student_t(trend.days - 2) * trend.scatter;
  const double height = trend.level - limit;
  const double a = trend.slope * trend.slope - k * k / trend.spread;
  const double c = height * height - k * k / static_cast<double>(trend.days);
  const auto [lesser, greater] = roots(a, 2 * trend.slope * height, c);
  const bool surely_falls = a > 0 && trend.slope < 0;
  const bool surely_above = c > 0;  // in the middle
  Crossing crossing;
  const auto set = [&](std::optional<double>& day, double from_middle) {
    if (std::isfinite(from_middle)) day = std::max(trend.last, trend.middle + from_middle);
  };
  if (trend.slope < 0) set(crossing.expected, -height / trend.slope);
  if (surely_falls) set(crossing.latest, greater);
  if (!surely_above) {
    crossing.earliest = trend.last;
  } else if (surely_falls) {
    set(crossing.earliest, lesser);
  } else if (a < 0) {
    set(crossing.earliest, greater);
  }
  return crossing;
}

}  // namespace tagsmith::detail
