// SPDX-License-Identifier: Apache-2.0
// A straight line through what was measured day by day, and when it falls to a limit.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tagsmith::detail {

struct TrendPoint {
  double day = 0;
  double value = 0;
};

// Fewer days show no trend: two points are on a line whatever they are.
inline constexpr std::size_t kLeastTrendDays = 3;

// Of the intervals that are stated: they hold the true day so often.
inline constexpr double kTrendConfidence = 0.80;

// The least-squares line.
struct Trend {
  std::size_t days = 0;
  double first = 0;    // day
  double last = 0;     // day
  double middle = 0;   // mean of the days
  double spread = 0;   // sum of the squared distances from it
  double level = 0;    // at the middle
  double slope = 0;    // per day
  double scatter = 0;  // standard deviation of a day's value about the line

  double at(double day) const { return level + slope * (day - middle); }
};

// Nothing of fewer than kLeastTrendDays different days. The points are in the order of their days.
std::optional<Trend> fit_trend(const std::vector<TrendPoint>& points);

// When a line that falls is at the limit, not before the trend's last day; and the interval that
// holds the true day with kTrendConfidence.
struct Crossing {
  std::optional<double> expected;  // nothing of a line that does not fall
  std::optional<double> earliest;  // nothing = never
  std::optional<double> latest;    // nothing = perhaps never
};

// Of a trend that is above the limit on its last day. Exact where values scatter normally about a
// line (Fieller, J. Royal Statistical Society B 16, 1954: 175).
Crossing crossing_of(const Trend& trend, double limit);

}  // namespace tagsmith::detail
