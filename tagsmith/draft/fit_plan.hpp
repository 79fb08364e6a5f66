// SPDX-License-Identifier: Apache-2.0
// Lines and arcs through points of walls and center line, seen from above. Internal to
// tagsmith/survey.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {

// A point in the world, and where across the tunnel it lies: `side` tunnel half widths to the right
// of the center line (-1, 0, 1).
struct PlanPoint {
  Eigen::Vector2d p{0, 0};
  int side = 0;
  double plate_half = 0;         // > 0: P of a plate, whose middle is on the wall; half of L_CI
  std::optional<double> offset;  // of p itself, where it is known: then the width says nothing
  std::size_t index = 0;         // in the list of points
};

struct PlanFit {
  Centerline line;                // level; begins and ends beyond the points
  double width = 0;               // void when the offsets of all points are known
  std::vector<double> residuals;  // metres to the right of where the fit has the point
  std::vector<double> chainages;
  double heading_sigma = 0;  // of the line beside the points where it is greatest, radians
  // Indices of points: a slip of a metre in one of these would leave it within the tolerance,
  // because the line follows it alone.
  std::vector<std::size_t> unchecked;
};

// The fit with the fewest elements, up to `most_elements`, whose residuals are within the tolerance
// and that no further element improves by more than chance: the tolerance refuses points, their
// scatter decides the shape. If none is within the tolerance, the one that most points fit. Nothing
// when the points show no line: fewer than two on the center line, or on either wall. Of a long
// list a part that is spread evenly over it is fitted, so that the time does not grow with the
// list. The heading's standard deviation is that beside plates, or beside all points where no
// plate hangs.
std::optional<PlanFit> fit_plan(const std::vector<PlanPoint>& points, double tolerance,
                                int most_elements);

// The width at which walls stand beside the line, and how far the points are off them.
PlanFit plan_along(const Centerline& line, const std::vector<PlanPoint>& points);

inline constexpr double kFinest = 1e-4;  // lists are written to the millimetre or its tenth
inline constexpr double kChance = 0.01;  // an element that noise explains as likely is none

// The probability that noise alone lowers a sum of squares from `before` to `after`, which has
// `freedom` degrees of freedom, by the best of `places` places for a piece with two numbers to
// adjust, as many pieces as `pieces` (F-test, Bonferroni's bound). May exceed 1.
double chance_of(double before, double after, double freedom, int pieces, double places);

}  // namespace tagsmith::detail
