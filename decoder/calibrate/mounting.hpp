// SPDX-License-Identifier: Apache-2.0
// Where a vehicle's cameras stand and look, from a drive past surveyed tags.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/localize/observation.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// How a camera is mounted, as fitted.
struct FittedMounting {
  std::string camera;
  Pose vehicle_from_camera;
  // Of x, y, z in vehicle axes, metres, and of yaw, pitch, roll, radians; 0 for what is held.
  Eigen::Matrix<double, 6, 1> sigma = Eigen::Matrix<double, 6, 1>::Zero();
  std::array<bool, 6> held{};  // not determined by the run: as the rig has it
  std::size_t tags = 0;        // pictures of tags that the fit uses
  std::size_t left_out = 0;    // those that contradict it
};

// A range sensor's reading minus the distance from O to its wall.
struct FittedRange {
  std::string name;
  double offset = 0;     // median, metres
  double sigma = 0;      // of the offset
  std::size_t rows = 0;  // that measured it
};

struct MountingFit {
  std::vector<FittedMounting> cameras;  // in the rig's order
  std::vector<FittedRange> ranges;      // of those that were measured
  std::size_t rows = 0;                 // that the fit uses
  std::size_t places_apart = 0;         // of these: DriveFit
  double chi_square = 0;                // of corners, plates and vehicles that the fit uses
  int degrees_of_freedom = 0;
  // Root of chi-square over the degrees of freedom, at least 1: all sigmas are multiplied by it.
  double sigma_factor = 1;
};

// The mounting of all cameras at once, with the vehicle's pose in each row and the plates' places
// within the survey's sigmas. The mounting in the rig is where the search starts; a camera that
// looks in quite another direction is found from single tags.
//
// The vehicle's own axes are defined by the drive: forward is the center line's direction, or
// against it in rows that the rig's mounting shows to point backward, and level is the floor, as
// the mean of all rows; the sigmas include the rows' scatter about it, from place to place, or what
// the rig says of the vehicle's stance where fewer than four places show none. Pictures of tags
// cannot distinguish a vehicle that stands askew in every row from cameras that are all turned. The
// origin O is where the rig's positions put it: what the run determines worse than a tape (a common
// shift of all cameras, or all of a single one) is held.
//
// Tags that fit worse than chance allows are left out: a plate that hangs wrong does not change the
// mounting. Fails, with the reason, where fewer than three rows show tags or the fit does not
// converge.
Result<MountingFit> fit_mounting(std::span<const Observation> rows, const Survey& survey,
                                 const Rig& rig);

}  // namespace tagsmith::detail
