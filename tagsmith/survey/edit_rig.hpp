// SPDX-License-Identifier: Apache-2.0
// Updates of rig files with the measured values of their cameras.
#pragma once

#include <string>
#include <string_view>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"

namespace tagsmith::detail {

// The values of a calibrated camera that a rig uses.
struct CalibratedIntrinsics {
  std::string file;  // its path as in the rig: relative to the rig's folder, or absolute
  double focal = 0;  // CalibrationSigma's
  double center = 0;
};

// The keys of a rig: `calibration`, and `focal` and `center` of `sigma`.
std::string calibration_value(const CalibratedIntrinsics& intrinsics);
std::string focal_value(const CalibratedIntrinsics& intrinsics);
std::string center_value(const CalibratedIntrinsics& intrinsics);

// The rig file's text in which the camera has this calibration instead of the intrinsics that it
// had, and its sigmas; everything else of it stays, comments included. A camera that was wholly
// called exact (`sigma: 0`) keeps exact what is not calibrated. Fails where the rig has no such
// camera, naming those that it has, and where the layout of the file does not allow the change.
Result<std::string> rig_with_calibration(std::string_view rig_text, const std::string& camera,
                                         const CalibratedIntrinsics& intrinsics);

// The values of a camera's fitted mounting that a rig uses.
struct CalibratedMounting {
  MountingAngles angles;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // in the vehicle frame, metres
  double position_sigma = 0;                           // 0 = as the rig says
  double angle_sigma = 0;                              // radians
};

// The rig file's text with this mounting of the camera, by `yaw`, `pitch`, `roll` and `position`,
// with its sigmas; everything else of it stays, comments included. Fails as rig_with_calibration.
Result<std::string> rig_with_mounting(std::string_view rig_text, const std::string& camera,
                                      const CalibratedMounting& mounting);

}  // namespace tagsmith::detail
