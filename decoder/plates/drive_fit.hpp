// SPDX-License-Identifier: Apache-2.0
// A drive past surveyed tags, fitted as a whole: vehicles, plates and chosen parameters of the
// cameras.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "decoder/localize/observation.hpp"
#include "decoder/plates/plate_adjustment.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The rows that show tags, as stations, with the plates that they show.
struct Drive {
  std::vector<SightedPlate> plates;
  std::vector<Station> stations;
  std::vector<const Observation*> rows;  // by station
};

// The rows must outlive the drive. A row is backward where most of its tags fit the rig's mounting
// if the vehicle points backward, and are far from it if it points forward.
Drive drive_of(std::span<const Observation> rows, const Survey& survey, const Rig& rig);

bool sees_anything(const Drive& drive, std::size_t camera);

// Standard deviations of a camera's calibration parameters before the drive is fitted
// (sighting_model.hpp's order: shift, turn, focal lengths, principal point, k1); 0 = exactly the
// rig's.
using ParameterSigmas = std::array<double, kCalibrationCount>;

// As the rig states them.
std::vector<ParameterSigmas> stated_sigmas(const Rig& rig);

// The standard deviation of a parameter of which nothing is known.
inline constexpr double kFreePosition = 1;    // metres
inline constexpr double kFreeAngle = 0.5;     // radians
inline constexpr double kFreeFocal = 0.3;     // relative
inline constexpr double kFreeDistortion = 1;  // of its first coefficient

// The attitude of a camera on the vehicle that most of its tags support, each by itself and with
// the vehicle level and along the drive: the rig's, unless another has more.
Eigen::Matrix3d likely_attitude(const Survey& survey, const Rig& rig, const Drive& drive,
                                std::size_t camera);

// The rig with its cameras as an adjustment has fitted them: `calibration`, errors of the layout's
// parameters.
Rig fitted_rig(Rig rig, const CalibrationLayout& layout, const Eigen::VectorXd& calibration);

struct DriveFit {
  Rig rig;  // with the cameras as fitted
  CalibrationLayout layout;
  Adjustment adjustment;
  // The part of the adjustment's chi-square that comes from headings against the drive's.
  double heading_chi_square = 0;
  // The mean attitude of the vehicles against the drive and its floor: heading, pitch, roll; and
  // the variance of this mean by their scatter from place to place.
  Eigen::Vector3d mean_attitude = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_attitude_variance = Eigen::Vector3d::Zero();
  // Of the vehicles, 0.4 m and more from each other: closer ones stand as the first of them stood.
  std::size_t places_apart = 0;
};

// Fits the vehicles, the plates within the survey's sigmas, and the cameras of `start` within these
// sigmas (one a camera). The vehicle stands on the floor along the drive, within the rig's sigmas
// of height, pitch and roll and its envelope's yaw. Nothing when the fit does not converge.
std::optional<DriveFit> fit_drive(const Survey& survey, const Drive& drive, const Rig& start,
                                  const std::vector<ParameterSigmas>& sigmas);

// The problem's rig with the cameras as its plates determine them: fitted within the rig's sigmas
// to the pictures that remain after the simplest explanation of plates that hang elsewhere.
Rig calibrated_by_plates(AdjustmentProblem problem);

// The factor by which the corners' chi-square exceeds chance: the median over all sightings, at
// least 1. It is raised by errors that the stated covariances leave out.
double usual_excess(const DriveFit& fit, const Drive& drive);

struct LeftOut {
  std::string station;
  Sighting sighting;
};

// Removes the worst sightings from the drive: those whose chi-square, divided by this excess, is
// more than one in some thousands would have by chance; if others are far worse, only these,
// because they spoil the fit of the rest. Returns them.
std::vector<LeftOut> leave_out_worst(const DriveFit& fit, Drive& drive, double excess);

}  // namespace tagsmith::detail
