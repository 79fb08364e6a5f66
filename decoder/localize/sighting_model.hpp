// SPDX-License-Identifier: Apache-2.0
// How a rig's cameras see a plate's corners, and how that changes with the vehicle, the plate and
// the calibration. Localization fits the vehicle with it, the check of hung plates fits the plates.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/tunnel.hpp"

namespace tagsmith::detail {

// A plate of which something was seen.
struct SightedPlate {
  std::string name;
  Side side = Side::left;  // the wall on which it hangs
  Pose world_from_plate;
  double length = 0;  // of the feature frame's inner edge, metres
  double height = 0;
  // Variances of its shift in world axes and of its turn about P in its own axes.
  Eigen::Matrix<double, 6, 1> survey_variance = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> coding_variance = Eigen::Matrix<double, 6, 1>::Zero();
};

// The plate's index among the plates, to which it is added when none of them has its name.
std::size_t plate_index(std::vector<SightedPlate>& plates, SightedPlate plate);

// The camera's index in the rig; nothing when the rig has none of this name.
std::optional<std::size_t> camera_index(const Rig& rig, std::string_view name);

// From one pose of the vehicle to another, in the order of vehicle_parameter.
Eigen::Matrix<double, 6, 1> pose_difference(const VehiclePose& from, const VehiclePose& to);

// A plate's corners in one camera's image, P, F, lower right, Q, as u, v, u, v, ...
struct Sighting {
  std::size_t camera = 0;  // of the rig
  std::size_t plate = 0;   // of the problem
  Eigen::Matrix<double, 8, 1> pixels = Eigen::Matrix<double, 8, 1>::Zero();
  CornerCovariance covariance = CornerCovariance::Identity();
  // How the corners move when all four edges move outward by one standard deviation of the camera's
  // `edge`. Its share is kept apart from the covariance: it counts where pictures are compared and
  // in a position's covariance, but it does not weigh them.
  Eigen::Matrix<double, 8, 1> by_edges = Eigen::Matrix<double, 8, 1>::Zero();

  // How they move when the focal length and each coordinate of the principal point are off by one
  // standard deviation of the camera's drift, the same for all sightings of one picture.
  Eigen::Matrix<double, 8, 3> by_drift = Eigen::Matrix<double, 8, 3>::Zero();

  CornerCovariance covariance_with_edges() const {
    return covariance + by_edges * by_edges.transpose();
  }
};

// Chi-square of a plate's eight corner coordinates less the six of its best pose: what is exceeded
// once in a thousand.
inline constexpr double kCornersAsStated = 13.8;

// The factor of the corners' covariance with which this chi-square is as stated: 1 where it is so
// already; nothing where the factor is too great to be believed.
std::optional<double> factor_to_explain(double chi_square);

// A camera's calibration errors: its mounting (shift in vehicle axes, turn), the relative change of
// its focal lengths, its principal point, the first coefficient of its distortion; and the
// vehicle's motion (shift, turn) while its shutter passes over the image, and until its photo is
// taken.
inline constexpr Eigen::Index kCalibrationCount = 22;
inline constexpr Eigen::Index kMotion = 10;                            // where the first begins
inline constexpr Eigen::Index kDelay = 16;                             // and the second
inline constexpr Eigen::Index kMotions = kCalibrationCount - kMotion;  // parameters of both
inline constexpr Eigen::Index kSightingRows = 8;

// Which of the rig's calibration parameters are uncertain, and their standard deviations.
struct CalibrationLayout {
  std::vector<std::array<int, kCalibrationCount>> places;  // a camera each; -1 = exact
  std::vector<double> sigmas;
};

// What is the same in all pictures of a drive: all but the vehicle's motion.
CalibrationLayout calibration_layout(const Rig& rig);

// Of the pictures of one moment.
CalibrationLayout calibration_layout_of_moment(const Rig& rig);

struct CalibratedCamera {
  Camera camera;
  Pose vehicle_from_camera;
  // Of the vehicle, as ObservedPoint::by_motion and by_delay take it.
  Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> delay = Eigen::Matrix<double, 6, 1>::Zero();
};

// The rig's camera (by index) with these errors of the layout's parameters; empty = none.
CalibratedCamera calibrated(const RigCamera& camera, const CalibrationLayout& layout,
                            std::size_t index, const Eigen::VectorXd& calibration);

// Where a sighting's corners should be, pixels, and the derivatives (observation_model.hpp).
struct SightingRows {
  Eigen::Matrix<double, kSightingRows, 1> predicted;
  Eigen::Matrix<double, kSightingRows, 6> by_vehicle;
  Eigen::Matrix<double, kSightingRows, 6> by_plate;
  Eigen::Matrix<double, kSightingRows, kCalibrationCount> by_calibration;
};

// `calibration`: the errors of the layout's parameters; empty = none. Nothing when a corner cannot
// be seen from there.
std::optional<SightingRows> sighting_rows(const Rig& rig, const CalibrationLayout& layout,
                                          const Eigen::VectorXd& calibration,
                                          const VehicleFrame& vehicle, const SightedPlate& plate,
                                          std::size_t camera);

// How the corners move by one standard deviation of each part of the vehicle's motions, the same
// for all sightings of one picture.
Eigen::Matrix<double, kSightingRows, kMotions> by_motion_sigmas(const SightingRows& rows,
                                                                const RigCamera& camera);

// The camera's poses that a sighting by itself allows (plate_poses): world_from_camera. Nothing
// when the corners are no picture of a rectangle.
std::optional<std::array<Pose, 2>> camera_poses_from(const Camera& camera,
                                                     const SightedPlate& plate,
                                                     const Sighting& sighting);

// The vehicle's poses that a sighting alone allows if the plate is at its stated place: those of
// plate_poses. Nothing when the corners cannot be the picture of a rectangle.
std::optional<std::array<VehiclePose, 2>> vehicle_poses_from(const Rig& rig,
                                                             const SightedPlate& plate,
                                                             const Sighting& sighting);

}  // namespace tagsmith::detail
