// SPDX-License-Identifier: Apache-2.0
// A vehicle's cameras and range sensors.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tagsmith/export.hpp>
#include <tagsmith/geometry.hpp>
#include <tagsmith/survey.hpp>

namespace tagsmith {

enum class LensModel {
  perspective,  // OpenCV calib3d; ROS plumb_bob and rational_polynomial, kalibr radtan
  fisheye,      // OpenCV fisheye; ROS and kalibr equidistant
};

// A camera's intrinsics, pixels.
struct CameraModel {
  int width = 0;
  int height = 0;
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;
  // perspective: k1, k2, p1, p2, k3, k4, k5, k6; fisheye: k1, k2, k3, k4, the rest unused.
  std::array<double, 8> distortion{};
  LensModel lens = LensModel::perspective;
};

// x_vehicle = rotation * x_camera + translation.
struct Mounting {
  Matrix<3> rotation{{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}}};  // looks forward, upright
  Vector3 translation{};                                    // metres
};

// The mounting of a camera at `position` (vehicle frame, metres) that looks forward and upright
// and is then turned: yaw to the left, pitch down, roll to the right are positive.
TAGSMITH_EXPORT Mounting mounting(const Vector3& position, double yaw, double pitch = 0,
                                  double roll = 0);

// Standard deviations of a camera's calibration; 0 = exact.
struct CalibrationSigma {
  double position = 0;  // of each coordinate of its place, metres
  double angle = 0;     // about each axis
  double focal = 0;     // relative, of both focal lengths together
  double center = 0;    // of each coordinate of the principal point, pixels
  double edge = 0;      // of how far tone curve and sharpening move edges, pixels
};

struct RigCamera {
  std::string name;
  CameraModel model;
  Mounting vehicle_from_camera;
  std::optional<Side> side{};               // the wall it looks at
  std::optional<double> exposure{};         // seconds
  std::optional<CalibrationSigma> sigma{};  // absent = usual values of a careful hand calibration
};

// How long a camera with a rolling shutter takes to read its rows one after another.
struct Readout {
  std::string camera;
  double seconds = 0;  // from the first row to the last
};

// A sensor of the distance from O's height to a wall, across the drive.
struct RigRange {
  std::string name;
  Side wall = Side::left;
  double min = 0;    // metres
  double max = 0;    // metres
  double sigma = 0;  // metres
};

// How far the vehicle may be off the center line, for plans; its speed also for rolling shutters.
struct Envelope {
  double lateral = 0;  // metres to either side
  double yaw = 0;      // to either side
  double speed = 0;    // metres a second
  double roll = 0;     // to either side
  double pitch = 0;
};

// The parts of a rig.
struct RigDescription {
  std::string name;
  std::vector<RigCamera> cameras;
  std::vector<RigRange> ranges;
  double vehicle_height = 0;   // of O above the floor, metres
  double height_sigma = 0.05;  // metres
  double roll_sigma = 0.0349;  // of the vehicle's stance: 2 degrees
  double pitch_sigma = 0.0349;
  std::optional<Envelope> envelope{};
};

// An immutable rig; copies share it. A rig that was moved from may only be assigned to.
class TAGSMITH_EXPORT Rig {
 public:
  // Fails with ErrorCode::invalid_argument on a rig without a camera, names that are empty or not
  // unique, and sizes, focal lengths or sigmas that are not above zero.
  explicit Rig(const RigDescription& description);

  // The same where cameras have rolling shutters. Fails also on a readout of no camera, below zero
  // or above ten seconds.
  Rig(const RigDescription& description, const std::vector<Readout>& readouts);

  const RigDescription& description() const;
  const std::string& name() const { return description().name; }
  const std::vector<RigCamera>& cameras() const { return description().cameras; }

  // Of those cameras that state one.
  std::vector<Readout> readouts() const;

  // Shared by the parts of the library; of no use to others.
  struct Data;
  explicit Rig(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

}  // namespace tagsmith
