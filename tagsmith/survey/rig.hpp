// SPDX-License-Identifier: Apache-2.0
// A vehicle's cameras and range sensors.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Standard deviations of a camera's calibration; 0 = exact.
struct CalibrationSigma {
  double position = 0;  // of each coordinate of the camera's place, metres
  double angle = 0;     // of its mounting about each axis, radians
  double focal = 0;     // relative, of both focal lengths together
  double center = 0;    // of each coordinate of the principal point, pixels
  // How far sharpening and a tone curve move the edges of a frame in its image, all outward or all
  // inward, pixels.
  double edge = 0;
  double radial = 0;  // of the first coefficient of its distortion
  // Changes by autofocus and stabilisation from picture to picture: of the focal lengths (relative)
  // and of each coordinate of the principal point (pixels).
  double focal_drift = 0;
  double center_drift = 0;
  // How far the vehicle drives while a rolling shutter passes over the image, metres.
  double shutter = 0;
  // How far the vehicle drives between the moment of a row and that of the camera's photo, metres.
  double delay = 0;
  // The error that no coefficient of its distortion describes: pixels in the image's corners, less
  // towards the centre by the third power of the distance.
  double warp = 0;
};

// Vehicle frame: origin O, x forward, y left, z up (REP-103).
struct RigCamera {
  std::string name;
  Camera camera;
  Pose vehicle_from_camera;
  std::optional<Side> side;        // the wall that it faces, where the rig states it
  std::optional<double> exposure;  // seconds
  std::optional<double> blur_px;   // standard deviation of its point spread, pixels
  // From the first row's exposure to the last row's, seconds: a rolling shutter. Nothing or 0 = a
  // global shutter.
  std::optional<double> readout;
  // How much earlier or later than the moment of a row it takes its photo, seconds, a standard
  // deviation. Nothing or 0 = all cameras are triggered together.
  std::optional<double> delay;
  CalibrationSigma calibration_sigma{};
  // The values that the file does not state and that the reader assumed (assumptions.hpp), in
  // words; empty = none.
  std::string assumed_sigma{};
  // Depth of field; both or neither. Without them everything is in focus.
  std::optional<double> focus;          // distance of sharp focus, metres
  std::optional<double> aperture;       // diameter of the lens opening, metres
  std::filesystem::path calibration{};  // file that says the intrinsics; empty = the rig does
};

struct RigRange {
  std::string name;
  Side wall = Side::left;
  double min = 0;    // metres
  double max = 0;    // metres
  double sigma = 0;  // standard deviation, metres
};

// How far the vehicle strays from the center line, for planning.
struct VehicleEnvelope {
  double lateral = 0;  // metres to either side
  double yaw = 0;      // radians to either side
  double speed = 0;    // metres a second
  double roll = 0;     // radians to either side
  double pitch = 0;
};

struct Rig {
  std::filesystem::path file;
  std::string name;
  std::vector<RigCamera> cameras;
  std::vector<RigRange> ranges;
  double vehicle_height = 0;  // of O above the floor
  double height_sigma = 0;    // prior of the height, metres
  double roll_sigma = 0;      // attitude priors, radians
  double pitch_sigma = 0;
  std::optional<VehicleEnvelope> envelope;
};

// Metres a second: assumed where a camera has a readout or a delay and no envelope states the
// speed.
inline constexpr double kUsualSpeed = 2;

// True when a camera reads the rows of an image one after another.
bool has_rolling_shutter(const Rig& rig);

// True when a camera is not triggered together with the others.
bool has_delay(const Rig& rig);

// Metres a second: the envelope's; without one kUsualSpeed where a camera has a rolling shutter or
// a delay, else 0: nothing is said of a vehicle that drives.
double usual_speed(const Rig& rig);

// Sets each camera's CalibrationSigma::shutter and delay by its readout and delay and the vehicle's
// speed; 0 without these.
void set_motion_sigmas(Rig& rig);

// True when a rig's stance gives its pictures' up: it stands level on its wheels, its roll's and
// pitch's standard deviations are below 15 degrees.
bool stands_level(const Rig& rig);

const RigCamera* find_camera(const Rig& rig, std::string_view name);

// A camera looking sideways from O: alpha (radians) between its level optical axis and the cross
// section, to the left or right and forward (Xu et al. 2017, Fig 11). Yaw is 90 deg - alpha.
Pose vehicle_from_side_camera(Side side, double alpha);

// vehicle_from_camera of a camera at `position` whose optical axis has this attitude; at zero it
// looks forward, upright.
Pose vehicle_from_camera(double yaw, double pitch, double roll, const Eigen::Vector3d& position);

// The attitude that gives this vehicle_from_camera; pitch within a quarter turn either way, yaw and
// roll within half a turn.
struct MountingAngles {
  double yaw = 0;
  double pitch = 0;
  double roll = 0;
};

MountingAngles mounting_angles(const Pose& vehicle_from_camera);

// A vehicle at `position_in_world` with this heading (radians from +y towards +x, world frame),
// level.
Pose world_from_vehicle(const Eigen::Vector3d& position_in_world, double heading);

// Fails only when the file cannot be read at all.
Result<Diagnosed<Rig>> read_rig(const std::filesystem::path& path);

// The same for text that is or will be the content of the file at `path`.
Diagnosed<Rig> read_rig_text(const std::filesystem::path& path, std::string_view text);

// The rig, or all its errors in one message.
Result<Rig> load_rig(const std::filesystem::path& path);

}  // namespace tagsmith::detail
