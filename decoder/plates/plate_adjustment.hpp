// SPDX-License-Identifier: Apache-2.0
// The adjustment of hung plates: where all vehicles stood and all plates hang, fitted at once to
// every picture and to the survey, each weighted by its covariance.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "decoder/plates/adjustment_problem.hpp"

namespace tagsmith::detail {

// Where the pictures and all other plates put a plate, minus its surveyed place. Its own surveyed
// place is not used for it.
struct PlateOffset {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // of corner P, world axes, metres
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // rotation vector in its surveyed axes, radians
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  // of both
  // Against the survey, whose own variances are counted: chi-square of 3, 3 and 6 where the plate
  // hangs as surveyed.
  double shift_chi_square = 0;
  double turn_chi_square = 0;
  double chi_square = 0;
};

// The mean shift of the corners P of a group of plates from their surveyed places, world axes,
// metres, from everything but the surveyed places of these plates.
struct GroupShift {
  std::vector<std::size_t> plates;  // the group, by index
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

struct Adjustment {
  std::vector<Pose> world_from_plate;
  std::vector<double> size;                          // of each frame, as a share of the template's
  std::vector<double> size_sigma;                    // 0 for a size that is that of the template
  double chi_square = 0;                             // of everything
  std::vector<double> station_chi_square;            // of the corners, by station
  std::vector<std::optional<PlateOffset>> offsets;   // by plate; none of plates in no station
  std::vector<GroupShift> groups{};                  // the problem's
  std::vector<std::optional<VehiclePose>> vehicles;  // by station; none for one without information
  // Errors of the uncertain calibration parameters in the order of the layout's sigmas, then of the
  // frames' common size where that is not exact.
  Eigen::VectorXd calibration;
  // The covariance of these and of the mean heading, pitch and roll of all vehicles; empty unless
  // the problem names what is uncertain (AdjustmentProblem::calibration).
  Eigen::MatrixXd calibration_covariance;
};

// Gauss-Newton over all plates, the calibration and one vehicle pose a station; the poses are
// eliminated station by station (Triggs et al. 2000, "Bundle Adjustment - A Modern Synthesis", 6.1)
// and the rest is solved sparse. `freed`, one a plate. Plates that are not free to hang anywhere
// must hang within half a frame of their place. A station that shows only plates of unknown places
// contains no information: its chi-square is 0. Nothing when the fit does not converge.
std::optional<Adjustment> adjust_plates(const AdjustmentProblem& problem,
                                        const std::vector<PlateFreedom>& freed);

// The vehicle's pose by one sighting, if the plate is at its stated place.
struct SinglePose {
  VehiclePose vehicle;
  Eigen::Matrix3d turn_covariance = Eigen::Matrix3d::Zero();  // in vehicle axes, radians^2
  double chi_square = 0;                                      // of the corners, two degrees
};

// The one or two poses that a plane's picture allows (plate_pose.hpp), the better first; none when
// no pose explains the corners.
std::vector<SinglePose> single_poses(const AdjustmentProblem& problem, const Sighting& sighting);

// Raises a sighting's covariance until a rectangle explains its corners (two degrees of freedom).
// False when none does even at a hundred times the covariance: it must not be used.
bool make_consistent(const AdjustmentProblem& problem, Sighting& sighting);

}  // namespace tagsmith::detail
