// SPDX-License-Identifier: Apache-2.0
// Seen tags with their distances from the cameras, as the paper's method takes them: Xu et al.
// (2017), equation (10).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A length and its standard deviation, metres.
struct Length {
  double value = 0;
  double sigma = 0;
};

// How far the vehicle leans from level on the drive's grade, radians.
struct Lean {
  double roll = 0;
  double pitch = 0;
};

// A seen tag with its distance D from the camera.
struct RangedTag {
  const SeenTag* seen = nullptr;
  const RigCamera* camera = nullptr;
  double grade = 0;       // of the drive at the tag: rise per horizontal metre
  Length distance;        // with what is uncertain of this camera and this tag alone
  bool is_above = false;  // its P, of the camera
  double by_roll = 0;     // change of D by one standard deviation of the vehicle's roll, metres
  double by_pitch = 0;
};

// The attitude of the vehicle on a drive that rises, from a level one of the same heading. Vehicle
// frames: x forward, y left, z up.
Eigen::Matrix3d level_from_vehicle(double grade, const Lean& lean = {});

// The tags on this wall that a camera of the rig saw, without those that an attitude of their own
// turns out of the wall and those at the border of what the camera's lens model covers.
std::vector<RangedTag> ranged_tags(const Observation& observation,
                                   const std::vector<Survey>& surveys, const Rig& rig, Side side);

}  // namespace tagsmith::detail
