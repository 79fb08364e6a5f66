// SPDX-License-Identifier: Apache-2.0
// The tunnel that surveyed points describe: a center line of lines and arcs, width, grades, height.
#pragma once

#include <optional>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

struct TunnelFitOptions {
  // A point that is farther from the fit than this is off, metres: across (walls and the plates on
  // them), and up and down (floors of rock are rough).
  double tolerance = 0.03;
  double floor_tolerance = 0.25;
  // H_P, where the list has no floor points: the floor is that far below each tag.
  std::optional<double> mount_height;
  std::optional<double> roof_height;  // of the roof above the floor, where there are no roof points
  // Walls that run through their points, and a roof through its own, instead of one width and one
  // height. The center line then comes from its own points (CL), or from the offsets that the list
  // states, and a wrong point of a wall cannot be distinguished from a bulge; without either it
  // runs midway between walls that are straight within the tolerance.
  bool measured_walls = false;
  // The center line as designed, level, in the world: used unchanged, and only prolonged where
  // points lie beyond its ends.
  std::optional<Centerline> alignment;
};

// Where a point lies relative to the fitted tunnel, metres.
struct PointResidual {
  double chainage = 0;
  std::optional<double> across;  // further to the right than fitted; nothing for floor and roof
  std::optional<double> up;      // above the fitted floor or roof
};

struct TunnelFit {
  Tunnel tunnel;
  std::vector<PointResidual> residuals;  // of the points one by one
  double rms_across = 0;
  double rms_up = 0;
  double heading_sigma = 0;  // of the center line as fitted, where it is greatest, radians
  std::vector<std::size_t> unchecked;  // points that the center line follows alone (PlanFit)
};

// Fits the fewest lines and arcs, joined without bends (at most kMostFittedElements), with which
// every point is within the tolerances: plates are tangent to their wall at their middle, as a
// survey places them. Points of one kind must be listed along the drive; a point or two that lie
// aside from the others are found and named. Where the list states chainages, the line starts where
// they do, else a plate's length before the first point. Fails, naming the points, when some fit no
// tunnel, when left and right are exchanged, and when something cannot be known (width, floor,
// roof). A list that states offsets and fits no one width gets measured walls automatically: the
// offsets check the points.
Result<TunnelFit> fit_tunnel(const std::vector<SurveyedPoint>& points, const Grid& grid,
                             const TagTemplate& tag, const TunnelFitOptions& options);

// The elements between two chainages of their line; an element before the first one's start, or
// beyond the last one's end, is prolonged.
std::vector<CenterlineElement> elements_between(const std::vector<CenterlineElement>& elements,
                                                double from, double to);

inline constexpr int kMostFittedElements = 12;

}  // namespace tagsmith::detail
