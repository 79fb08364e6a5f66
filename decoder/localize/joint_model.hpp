// SPDX-License-Identifier: Apache-2.0
// The joint fit: the vehicle's pose that best explains the corners of chosen tags in all cameras,
// chosen ranges, and what is known beforehand, each weighted by its covariance.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/localize/sighting_model.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A range as measured: the least horizontal distance from O to a wall's plates, metres.
struct WallRange {
  std::string name;
  Side wall = Side::left;
  double distance = 0;
  double sigma = 0;  // of the distance
};

// Rig and tunnel must outlive the problem.
struct JointProblem {
  const Rig* rig = nullptr;
  const Tunnel* tunnel = nullptr;
  std::vector<SightedPlate> plates;
  std::vector<Sighting> sightings;
  std::vector<WallRange> ranges;
  bool edges_weigh = true;  // pictures are weighed with the sightings' errors of edges
};

// What a fit uses, by index.
struct Selection {
  std::vector<std::size_t> sightings;
  std::vector<std::size_t> ranges;
};

// Parameters: the vehicle's six, then nine for each camera whose calibration is uncertain: its
// mounting (6), relative focal length, principal point (2).
struct JointState {
  VehiclePose vehicle;
  Eigen::VectorXd calibration;
};

// The measurements that the fit uses, each group scaled by its covariance: the plates in the order
// of `plates`, the ranges, the vehicle's three (height, pitch, roll), the calibration's.
struct WhitenedRows {
  struct Plate {
    std::size_t plate = 0;
    std::vector<std::size_t> sightings;
    Eigen::Index begin = 0;
    Eigen::MatrixXd root;  // lower triangle L of its covariance L L^T
  };
  std::vector<Plate> plates;
  Eigen::Index ranges_begin = 0;
  Eigen::Index vehicle_begin = 0;
  Eigen::Index calibration_begin = 0;
  Eigen::VectorXd residual;  // predicted minus measured
  Eigen::MatrixXd jacobian;
};

// A fit and the measurements that it uses.
struct JointFit {
  JointState state;
  Selection selection;
  WhitenedRows rows;
  Eigen::MatrixXd covariance;  // of all parameters, world axes; metres and radians, squared
  double chi_square = 0;
  int degrees_of_freedom = 0;

  VehicleCovariance vehicle_covariance() const { return covariance.topLeftCorner<6, 6>(); }
};

// Least squares from `start` (Levenberg-Marquardt, Ceres' TinySolver). Nothing when it does not
// converge to a pose from which every chosen corner can be seen.
std::optional<JointFit> fit_jointly(const JointProblem& problem, const Selection& selection,
                                    const VehiclePose& start);

// The difference between a measurement and its prediction by a fit without it.
struct Disagreement {
  double chi_square = 0;        // of all corners' coordinates
  int degrees_of_freedom = 0;   // of chi_square
  double shift_chi_square = 0;  // of the shift of the plate that explains them best, 3 degrees
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // of the plate, world frame, metres
};

// Of a sighting that the fit does not use. Nothing when the plate cannot be seen from there.
std::optional<Disagreement> disagreement(const JointProblem& problem, const JointFit& fit,
                                         std::size_t sighting);

// Of a plate (index in fit.rows.plates) that the fit uses, against the rest.
Disagreement disagreement_within(const JointProblem& problem, const JointFit& fit,
                                 std::size_t index);

// How some plates together stand elsewhere than surveyed, by the rest of a fit that uses them all.
struct CommonShift {
  double chi_square = 0;                            // of the shift, three degrees
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // of the plates, world frame, metres
  // How far the vehicle's position moves when they may be shifted, world frame, metres.
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
};

// `plates`: indices in fit.rows.plates.
CommonShift common_shift(const JointProblem& problem, const JointFit& fit,
                         std::span<const std::size_t> plates);

// How far the vehicle's position moves when a plate (index in fit.rows.plates) is taken out of the
// fit, world frame, metres; linearly (Cook and Weisberg 1982, "Residuals and Influence in
// Regression", 2.2).
Eigen::Vector3d position_shift_without(const JointFit& fit, std::size_t index);

// A parameter of the calibration (index of the layout), and how far all measurements put it from
// its stated value, standard deviations of the difference.
struct ParameterDifference {
  std::size_t parameter = 0;
  double sigmas = 0;
};

// The greatest. Chi-square of the whole spreads one wrong parameter over all rows; this test looks
// in its direction (Baarda 1968, "A testing procedure for use in geodetic networks").
ParameterDifference greatest_calibration_difference(const JointFit& fit);

// A range as measured minus the value that the fit predicts without it.
struct RangeDifference {
  double metres = 0;
  double sigmas = 0;  // standard deviations of the difference
};

// Whether or not the fit uses it.
RangeDifference range_difference(const JointProblem& problem, const JointFit& fit,
                                 std::size_t range);

// The pixels where the fit predicts a sighting's corners; nothing when it cannot.
std::optional<Eigen::Matrix<double, 8, 1>> predicted_pixels(const JointProblem& problem,
                                                            const JointState& state,
                                                            std::size_t sighting);

// The parts of the vehicle's covariance by their source.
struct VehicleBudget {
  VehicleCovariance pixels = VehicleCovariance::Zero();
  VehicleCovariance edges = VehicleCovariance::Zero();
  VehicleCovariance survey = VehicleCovariance::Zero();
  VehicleCovariance coding = VehicleCovariance::Zero();
  VehicleCovariance ranges = VehicleCovariance::Zero();
  VehicleCovariance calibration = VehicleCovariance::Zero();
  VehicleCovariance vehicle = VehicleCovariance::Zero();
};

// Through the gain of the fit's rows, each group of measurements with its own covariance.
VehicleBudget budget_of(const JointProblem& problem, const JointFit& fit);

}  // namespace tagsmith::detail
