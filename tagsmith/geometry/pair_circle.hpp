// SPDX-License-Identifier: Apache-2.0
// The circle on which two measured distances put a vehicle, cut by the distance to a wall: the
// middle of the closed form of Xu et al. (2017). The localizer solves with it, the planner predicts
// with it.
#pragma once

namespace tagsmith::detail {

// D1, D2 from O to the corners P1, P2 of a pair and d from O to the left wall, metres.
struct PairDistances {
  double distance1 = 0;
  double distance2 = 0;
  double wall_distance = 0;
};

// E is the foot of O on the line P1P2, e the circle about E on which O lies. Metres.
struct PairCircle {
  double p1_e = 0;
  double p2_e = 0;
  double er = 0;    // of O across P1P2, horizontally: (a / tan(theta)) of (18)
  double r_sq = 0;  // square of e's radius; below zero where D1 and D2 meet nowhere

  // Square of O's height above or below the tags; below zero where there is no real solution.
  double height_difference_sq() const { return r_sq - er * er; }
};

// (11)-(17), with P1P2 = W_T / cos(theta). `pair_angle` is theta, more than 0.
PairCircle pair_circle(const PairDistances& distances, double tunnel_width, double pair_angle);

}  // namespace tagsmith::detail
