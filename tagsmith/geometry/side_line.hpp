// SPDX-License-Identifier: Apache-2.0
// Lines that run beside the center line at a distance that changes: walls, seen from above.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/chainage_profile.hpp"

namespace tagsmith::detail {

// Offsets here are metres to the right of the center line, negative to its left.

// The point so far beside the center line, at the height of its floor.
Eigen::Vector3d point_beside(const Centerline& line, double chainage, double offset);

// Direction of the side line about a chainage, radians from +y towards +x: what a straight board of
// length `span` on it has. Steps do not turn it.
double side_heading(const Centerline& line, const ChainageProfile& offset, double chainage,
                    double span);

// How much the direction of such a board scatters about that of stretches eight times as long, one
// standard deviation in radians: that of rough rock, on the whole or where it is roughest. Corners,
// where the side line turns with reason, count only where a fifth of all boards, or half of 28 in a
// row, lie beside one.
double side_roughness(const ChainageProfile& offset, double span);

// A corner of a side line drawn as straight pieces.
struct SidePoint {
  double chainage = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // z of the center line's floor
};

// The side line over [from, to] as straight pieces that miss it by at most `sag` metres. A step is
// two points of one chainage.
std::vector<SidePoint> side_points(const Centerline& line, const ChainageProfile& offset,
                                   double from, double to, double sag);

// The side line's point nearest to `position`, of those near the center line's point nearest to it:
// round a bend the line may come nearer again.
Eigen::Vector2d nearest_on_side(const Centerline& line, const ChainageProfile& offset,
                                const Eigen::Vector2d& position);

}  // namespace tagsmith::detail
