// SPDX-License-Identifier: Apache-2.0
// The paper's distance and position: Xu, Yang, You, Li, Kim (2017), PLoS ONE 12(1): e0171012,
// equations (6)-(23).
#pragma once

#include <string>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// D, the distance from the camera to corner P, metres, by (6)-(10). `p` and `q` are the projections
// P' and Q', `centre` the image's centre S, `focal_px` the focal length in pixels (f / (M/m)),
// `edge_length` the true length of PQ (H_CI). Exact for a level camera without distortion and a
// vertical PQ. Infinite when P' and Q' coincide.
double paper_distance(const PixelPoint& p, const PixelPoint& q, const PixelPoint& centre,
                      double focal_px, double edge_length);

// True when the tag's P lies above a level camera: y_P' < n/2, Y growing downwards. The text prints
// the opposite inequality, which contradicts its own figures and Table 4.
bool paper_tag_is_above(const PixelPoint& p, const PixelPoint& centre);

// What the closed form needs. World frame: right-handed, z up. (The frame of the paper's Table 4 is
// left-handed: its x grows to the left of the drive. Mirror it first, see Grid.)
struct ClosedFormInput {
  Eigen::Vector3d p1_in_world = Eigen::Vector3d::Zero();  // corner P of the tag on the left wall
  Eigen::Vector3d p2_in_world = Eigen::Vector3d::Zero();  // and on the right wall
  double pair_angle = 0;       // theta between P1P2 and the perpendicular to the wall, radians
  double tunnel_width = 0;     // W_T
  double wall_distance = 0;    // d, horizontal, from O to the left wall
  double distance1 = 0;        // D1 from O to P1
  double distance2 = 0;        // D2 from O to P2
  double heading = 0;          // of the drive at the pair, radians from +y towards +x
  bool tags_are_above = true;  // the corners P lie above O
};

enum class NoSolution {
  not_finite,             // an input is not a finite number, or a length is not positive
  pair_angle_degenerate,  // theta is 0 (d says nothing new) or 90 degrees
  spheres_do_not_meet,    // r^2 < 0: D1 and D2 fit no point at all
  no_real_height,         // r^2 < (a / tan theta)^2: d is inconsistent with D1 and D2
  circles_do_not_meet,    // (22) and (23) have no common point
};

struct ClosedFormFailure {
  NoSolution reason = NoSolution::not_finite;
  std::string message;  // with the numbers
};

// O, the vehicle's centre, in the world frame, by (11)-(23). Of the two intersections of (22) and
// (23) the paper uses the one with the smaller y; this function uses the one further back along the
// drive, which is the same in a straight tunnel along +y. The paper gives both corners P one height
// H_P; of two heights the mean is used.
//
// The result depends on d through 1 / tan(theta): 1 cm of d moves it 5.6 cm along the paper's
// corridor, and often leaves no real solution, which the paper does not mention.
tl::expected<Eigen::Vector3d, ClosedFormFailure> paper_position(const ClosedFormInput& input);

}  // namespace tagsmith::detail
