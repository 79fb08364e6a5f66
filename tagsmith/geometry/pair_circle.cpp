// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/pair_circle.hpp"

#include <cmath>

namespace tagsmith::detail {

PairCircle pair_circle(const PairDistances& distances, double tunnel_width, double pair_angle) {
  const double cosine = std::cos(pair_angle);
  const double pair_length = tunnel_width / cosine;  // P1P2
  const double d1_sq = distances.distance1 * distances.distance1;
  const double d2_sq = distances.distance2 * distances.distance2;
  PairCircle circle;
  circle.p1_e = (d1_sq - d2_sq + pair_length * pair_length) / (2 * pair_length);
  circle.p2_e = pair_length - circle.p1_e;
  circle.r_sq = d1_sq - circle.p1_e * circle.p1_e;
  // The a of (14): d cos(theta) + d sin(theta) tan(theta) is d / cos(theta).
  const double a = circle.p1_e - distances.wall_distance / cosine;
  circle.er = a / std::tan(pair_angle);
  return circle;
}

}  // namespace tagsmith::detail
