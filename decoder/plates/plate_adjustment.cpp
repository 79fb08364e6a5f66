// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "decoder/plates/plate_normals.hpp"
#include "decoder/plates/plate_start.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr Index kPoseCount = 6;                    // parameters of a vehicle's pose
constexpr Index kLensDrifts = 3;                   // of a picture: focal length, principal point
constexpr Index kDrifts = kLensDrifts + kMotions;  // and the vehicle's motions
constexpr double kFreeSigma = 10;    // metres and radians, of a plate that hangs anywhere
constexpr double kFreeSize = 0.3;    // relative, of a frame of any size
constexpr double kExactSize = 1e-6;  // small enough to have no effect, and large enough to invert

bool has_any_size(PlateFreedom freedom) {
  return freedom == PlateFreedom::size || freedom == PlateFreedom::any;
}

// The rig's parameters, and last the frames' common size when it is not exact.
CalibrationLayout layout_of(const AdjustmentProblem& problem) {
  CalibrationLayout layout = problem.calibration.value_or(calibration_layout(*problem.rig));
  if (problem.frame_sigma > 0) layout.sigmas.push_back(problem.frame_sigma);
  return layout;
}

struct AdjustmentState {
  std::vector<Pose> world_from_plate;
  VectorXd size_error;  // of each frame on its own, relative
  std::vector<VehiclePose> vehicles;
  VectorXd calibration;
};

AdjustmentState start_state(const AdjustmentProblem& problem, const AdjustmentStart& start) {
  AdjustmentState state;
  state.world_from_plate = start.world_from_plate;
  for (const auto& vehicle : start.vehicles) {
    state.vehicles.push_back(vehicle.value_or(VehiclePose{}));
  }
  state.size_error = VectorXd::Zero(static_cast<Index>(problem.plates.size()));
  state.calibration = VectorXd::Zero(static_cast<Index>(layout_of(problem).sigmas.size()));
  return state;
}

// The stations that cannot be placed; they contain no information.
std::vector<bool> idle_stations(const AdjustmentStart& start) {
  std::vector<bool> idle;
  for (const auto& vehicle : start.vehicles) idle.push_back(!vehicle);
  return idle;
}

// From P of the frame as drawn to P of one that is larger by this, about the same middle.
Vector3d corner_of_larger(const SightedPlate& plate, double size_error) {
  return -size_error / 2 * Vector3d(plate.length, plate.height, 0);
}

VehiclePose stepped(VehiclePose vehicle, const Vector6& step) {
  vehicle.position += step.head<3>();
  vehicle.heading += step[vehicle_parameter::kHeading];
  vehicle.pitch += step[vehicle_parameter::kPitch];
  vehicle.roll += step[vehicle_parameter::kRoll];
  return vehicle;
}

Vector3d turn_of(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

// --- one linearisation ---

// A station's normal equations with its vehicle's pose eliminated. Columns: those of each plate
// it sees, then the calibration's.
struct ReducedStation {
  std::vector<std::size_t> plates;
  MatrixXd information;
  VectorXd gradient;
  Matrix6 pose_covariance = Matrix6::Zero();
  MatrixXd pose_by_rest;                // the best pose's change with the rest
  Vector6 pose_step = Vector6::Zero();  // and its change when the rest stays
  double chi_square = 0;
};

class Network {
 public:
  Network(const AdjustmentProblem& problem, const std::vector<PlateFreedom>& freed,
          std::vector<bool> idle)
      : problem_(problem), layout_(layout_of(problem)), idle_(std::move(idle)) {
    for (std::size_t i = 0; i < problem.plates.size(); ++i) {
      PlateVector variance;
      variance << problem.plates[i].survey_variance, kExactSize * kExactSize;
      if (hangs_anywhere(freed[i])) variance.head<6>().setConstant(kFreeSigma * kFreeSigma);
      if (has_any_size(freed[i])) variance[6] = kFreeSize * kFreeSize;
      variances_.push_back(variance);
    }
    const auto moves = [](const RigCamera& camera) {
      return camera.calibration_sigma.shutter > 0 || camera.calibration_sigma.delay > 0;
    };
    const auto drifts = [](const Sighting& sighting) { return !sighting.by_drift.isZero(); };
    drifts_ = std::ranges::any_of(problem.rig->cameras, moves);
    for (const Station& station : problem.stations) {
      drifts_ = drifts_ || std::ranges::any_of(station.sightings, drifts);
    }
  }

  // Of all corners and priors; infinite when a corner cannot be seen.
  double chi_square(const AdjustmentState& state) const {
    double sum = prior_chi_square(state);
    for (std::size_t s = 0; s < problem_.stations.size(); ++s) {
      const auto station = reduced(state, s, false);
      if (!station) return std::numeric_limits<double>::infinity();
      sum += station->chi_square;
    }
    return sum;
  }

  bool linearise(const AdjustmentState& state) {
    stations_.clear();
    normals_.emplace(problem_.plates.size(), state.calibration.size());
    for (std::size_t s = 0; s < problem_.stations.size(); ++s) {
      auto station = reduced(state, s, true);
      if (!station) return false;
      normals_->add(station->plates, station->information, station->gradient);
      station->information.resize(0, 0);  // of many stations these are most of the memory
      stations_.push_back(std::move(*station));
    }
    add_priors(state);
    return normals_->factorise();
  }

  // The state after `share` of the full step.
  AdjustmentState stepped_by(const AdjustmentState& state, const VectorXd& step,
                             double share) const {
    AdjustmentState next = state;
    for (std::size_t i = 0; i < next.world_from_plate.size(); ++i) {
      const PlateVector own = share * step.segment<kPlateCount>(PlateNormals::column_of(i));
      next.world_from_plate[i].translation += own.head<3>();
      next.world_from_plate[i].rotation *= rotation_of(own.segment<3>(3));
      next.size_error[static_cast<Index>(i)] += own[6];
    }
    next.calibration += share * step.tail(next.calibration.size());
    for (std::size_t s = 0; s < stations_.size(); ++s) {
      const ReducedStation& station = stations_[s];
      if (idle_[s]) continue;
      const VectorXd own = step(normals_->columns_of(station.plates));
      const Vector6 pose = station.pose_step + station.pose_by_rest * own;
      next.vehicles[s] = stepped(next.vehicles[s], share * pose);
    }
    return next;
  }

  // The covariance of the calibration's errors and of the mean heading, pitch and roll of all
  // vehicles.
  MatrixXd calibration_covariance() const {
    const Index uncertain = normals_->size() - normals_->of_plates();
    MatrixXd by_rest = MatrixXd::Zero(uncertain + 3, normals_->size());
    by_rest.topRightCorner(uncertain, uncertain).setIdentity();
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
    const auto placed = static_cast<double>(std::ranges::count(idle_, false));
    for (std::size_t s = 0; s < stations_.size(); ++s) {
      if (idle_[s]) continue;
      const ReducedStation& station = stations_[s];
      const std::vector<Index> columns = normals_->columns_of(station.plates);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        by_rest.col(columns[i]).tail<3>() +=
            station.pose_by_rest.col(static_cast<Index>(i)).tail<3>() / placed;
      }
      own += station.pose_covariance.bottomRightCorner<3, 3>() / (placed * placed);
    }
    MatrixXd covariance = by_rest * normals_->solve(by_rest.transpose());
    covariance.bottomRightCorner<3, 3>() += own;
    return covariance;
  }

  PlateNormals& normals() { return *normals_; }
  const PlateVector& variance_of(std::size_t plate) const { return variances_[plate]; }
  const std::vector<ReducedStation>& stations() const { return stations_; }
  bool is_idle(std::size_t station) const { return idle_[station]; }

  // Shift and turn of a plate from its surveyed place, and its size from the template's.
  PlateVector moved_by(const AdjustmentState& state, std::size_t plate) const {
    const Pose& surveyed = problem_.plates[plate].world_from_plate;
    const Pose& pose = state.world_from_plate[plate];
    PlateVector moved;
    moved << pose.translation - surveyed.translation,
        turn_of(surveyed.rotation.transpose() * pose.rotation),
        state.size_error[static_cast<Index>(plate)];
    return moved;
  }

 private:
  double prior_chi_square(const AdjustmentState& state) const {
    double sum = 0;
    for (std::size_t i = 0; i < problem_.plates.size(); ++i) {
      sum += moved_by(state, i).cwiseAbs2().cwiseQuotient(variances_[i]).sum();
    }
    for (Index i = 0; i < state.calibration.size(); ++i) {
      sum += std::pow(state.calibration[i] / layout_.sigmas[static_cast<std::size_t>(i)], 2);
    }
    return sum;
  }

  void add_priors(const AdjustmentState& state) {
    for (std::size_t plate = 0; plate < problem_.plates.size(); ++plate) {
      const PlateVector moved = moved_by(state, plate);
      const Index first = PlateNormals::column_of(plate);
      for (Index i = 0; i < kPlateCount; ++i) {
        normals_->add_prior(first + i, moved[i], variances_[plate][i]);
      }
    }
    for (Index i = 0; i < state.calibration.size(); ++i) {
      const double sigma = layout_.sigmas[static_cast<std::size_t>(i)];
      normals_->add_prior(normals_->of_plates() + i, state.calibration[i], sigma * sigma);
    }
  }

  struct SizedRows : SightingRows {
    Eigen::Matrix<double, kSightingRows, 1> by_size;
  };

  // For a frame of the size that it has in this state: by the plate's pose and by that size.
  std::optional<SizedRows> rows_of(const AdjustmentState& state, const VehicleFrame& frame,
                                   const Sighting& sighting) const {
    const SightedPlate& drawn = problem_.plates[sighting.plate];
    double size_error = state.size_error[static_cast<Index>(sighting.plate)];
    if (problem_.frame_sigma > 0) size_error += state.calibration[state.calibration.size() - 1];
    SightedPlate plate = drawn;
    plate.world_from_plate = state.world_from_plate[sighting.plate];
    const Eigen::Matrix3d& rotation = plate.world_from_plate.rotation;
    const Vector3d corner = corner_of_larger(drawn, size_error);
    plate.world_from_plate.translation += rotation * corner;
    plate.length *= 1 + size_error;
    plate.height *= 1 + size_error;
    const auto rows =
        sighting_rows(*problem_.rig, layout_, state.calibration, frame, plate, sighting.camera);
    if (!rows) return std::nullopt;
    SizedRows sized{*rows, {}};
    // A turn about P of the frame as drawn moves the P that is seen.
    Eigen::Matrix3d across;
    across << 0, -corner.z(), corner.y(), corner.z(), 0, -corner.x(), -corner.y(), corner.x(), 0;
    sized.by_plate.rightCols<3>() -= rows->by_plate.leftCols<3>() * rotation * across;
    for (Index i = 0; i < 4; ++i) {
      const Vector3d from_middle((i == 1 || i == 2 ? 0.5 : -0.5) * drawn.length,
                                 (i >= 2 ? 0.5 : -0.5) * drawn.height, 0);
      sized.by_size.segment<2>(2 * i) =
          rows->by_plate.block<2, 3>(2 * i, 0) * rotation * from_middle;
    }
    return sized;
  }

  // How far a vehicle is from what is known of it, in standard deviations.
  static Vector6 whitened(const VehiclePrior& prior, const VehiclePose& vehicle) {
    return pose_difference(prior.mean, vehicle).cwiseQuotient(prior.sigma);
  }

  // What a station's corners say, whitened. Columns: the vehicle's pose, each plate it sees, the
  // calibration, and last the residual. Nothing when a corner cannot be seen.
  std::optional<MatrixXd> whitened_rows(const AdjustmentState& state, std::size_t index,
                                        const std::vector<std::size_t>& plates) const {
    const Station& station = problem_.stations[index];
    const VehicleFrame frame = vehicle_frame(state.vehicles[index]);
    const Index calibration = kPoseCount + PlateNormals::column_of(plates.size());
    const Index residual = calibration + state.calibration.size();
    const Index drifts = drifts_ ? kDrifts * static_cast<Index>(layout_.places.size()) : 0;
    const auto count = kSightingRows * static_cast<Index>(station.sightings.size());
    MatrixXd all = MatrixXd::Zero(count, residual + 1 + drifts);
    for (Index i = 0; const Sighting& sighting : station.sightings) {
      const auto rows = rows_of(state, frame, sighting);
      if (!rows) return std::nullopt;
      auto own = all.middleRows<kSightingRows>(kSightingRows * i++);
      const auto place = std::ranges::find(plates, sighting.plate) - plates.begin();
      const Index plate = kPoseCount + PlateNormals::column_of(static_cast<std::size_t>(place));
      own.leftCols<kPoseCount>() = rows->by_vehicle;
      own.middleCols<6>(plate) = rows->by_plate;
      own.col(plate + 6) = rows->by_size;
      if (problem_.frame_sigma > 0) own.col(residual - 1) = rows->by_size;
      for (std::size_t k = 0; k < kCalibrationCount; ++k) {
        const int column = layout_.places[sighting.camera][k];
        if (column >= 0) {
          own.col(calibration + column) = rows->by_calibration.col(static_cast<Index>(k));
        }
      }
      own.col(residual) = rows->predicted - sighting.pixels;
      if (drifts_) {
        const Index drift = residual + 1 + kDrifts * static_cast<Index>(sighting.camera);
        own.middleCols<kLensDrifts>(drift) = sighting.by_drift;
        own.middleCols<kDrifts - kLensDrifts>(drift + kLensDrifts) =
            by_motion_sigmas(*rows, problem_.rig->cameras[sighting.camera]);
      }
      if (!whiten(own, sighting.covariance_with_edges())) return std::nullopt;
    }
    if (drifts_) {
      const MatrixXd covariance =
          MatrixXd::Identity(count, count) +
          propagated(all.rightCols(drifts), MatrixXd::Identity(drifts, drifts));
      whiten(all, covariance);
    }
    return all.leftCols(residual + 1);
  }

  static std::vector<std::size_t> plates_in(const Station& station) {
    std::vector<std::size_t> plates;
    for (const Sighting& sighting : station.sightings) {
      if (std::ranges::find(plates, sighting.plate) == plates.end()) {
        plates.push_back(sighting.plate);
      }
    }
    return plates;
  }

  // Without derivatives only chi_square is filled.
  std::optional<ReducedStation> reduced(const AdjustmentState& state, std::size_t index,
                                        bool derivatives) const {
    if (idle_[index]) return idle_station();
    const Station& station = problem_.stations[index];
    ReducedStation result;
    result.plates = plates_in(station);
    const auto rows = whitened_rows(state, index, result.plates);
    if (!rows) return std::nullopt;
    const Index rest = rows->cols() - kPoseCount;  // the last of them is the residual
    result.chi_square = rows->rightCols<1>().squaredNorm();
    Vector6 by_prior = Vector6::Zero();
    Vector6 prior_information = Vector6::Zero();
    if (station.prior) {
      const Vector6 off = whitened(*station.prior, state.vehicles[index]);
      by_prior = off.cwiseQuotient(station.prior->sigma);
      prior_information = station.prior->sigma.cwiseAbs2().cwiseInverse();
      result.chi_square += off.squaredNorm();
    }
    if (!derivatives) return result;
    MatrixXd normal = gram(*rows);
    normal.diagonal().head<kPoseCount>() += prior_information;
    normal.col(normal.cols() - 1).head<kPoseCount>() += by_prior;
    MatrixXd right(kPoseCount, rest + kPoseCount);
    right << normal.topRightCorner(kPoseCount, rest), Matrix6::Identity();
    const MatrixXd solved = solve_symmetric(normal.topLeftCorner<kPoseCount, kPoseCount>(), right);
    if (!solved.allFinite()) return std::nullopt;
    const MatrixXd remaining =
        normal.bottomRightCorner(rest, rest) -
        normal.topRightCorner(kPoseCount, rest).transpose() * solved.leftCols(rest);
    result.pose_covariance = solved.rightCols<kPoseCount>();
    result.pose_by_rest = -solved.leftCols(rest - 1);
    result.pose_step = -solved.col(rest - 1);
    result.information = remaining.topLeftCorner(rest - 1, rest - 1);
    result.gradient = remaining.col(rest - 1).head(rest - 1);
    return result;
  }

  // The normal equations of a station without information.
  ReducedStation idle_station() const {
    ReducedStation station;
    const Index columns = static_cast<Index>(layout_.sigmas.size());
    station.information = MatrixXd::Zero(columns, columns);
    station.gradient = VectorXd::Zero(columns);
    return station;
  }

  const AdjustmentProblem& problem_;
  CalibrationLayout layout_;
  std::vector<bool> idle_;
  std::vector<PlateVector> variances_;
  bool drifts_ = false;  // does a camera's focal length or centre differ from photo to photo
  std::vector<ReducedStation> stations_;
  std::optional<PlateNormals> normals_;
};

// --- the results ---

struct WithoutPrior {
  VectorXd mean;
  MatrixXd covariance;
};

// What everything but their own prior says of parameters, from the posterior mean `moved` and
// covariance: dividing the prior (variance S, mean 0) out of the posterior. In units of the prior,
// with P the posterior covariance and Q = I - P: mean Q^-1 d, covariance Q^-1 P.
WithoutPrior without_prior(const VectorXd& moved, const MatrixXd& posterior,
                           const VectorXd& prior) {
  constexpr double kLeast = 1e-9;  // least share of a direction's information that pictures give
  const VectorXd sigmas = prior.cwiseSqrt();
  const VectorXd inverse_sigmas = sigmas.cwiseInverse();
  const MatrixXd scaled = inverse_sigmas.asDiagonal() * posterior * inverse_sigmas.asDiagonal();
  const PrincipalAxes axes =
      principal_axes(MatrixXd::Identity(prior.size(), prior.size()) - scaled);
  const VectorXd share = axes.values.cwiseMax(kLeast);
  const VectorXd along = axes.vectors.transpose() * inverse_sigmas.cwiseProduct(moved);
  const MatrixXd back = sigmas.asDiagonal() * axes.vectors;
  const VectorXd variance = (VectorXd::Ones(prior.size()) - share).cwiseMax(0).cwiseQuotient(share);
  return {back * along.cwiseQuotient(share), propagated_variances(back, variance)};
}

PlateOffset offset_of(const Vector6& moved, const Matrix6& posterior, const Vector6& prior,
                      const Vector6& surveyed) {
  const WithoutPrior measured = without_prior(moved, posterior, prior);
  PlateOffset offset;
  offset.shift = measured.mean.head<3>();
  offset.turn = measured.mean.tail<3>();
  offset.covariance = measured.covariance;
  Matrix6 expected = offset.covariance;
  expected.diagonal() += surveyed;
  offset.chi_square = squared_mahalanobis(Vector6(measured.mean), expected);
  offset.shift_chi_square = squared_mahalanobis(offset.shift, expected.topLeftCorner<3, 3>());
  offset.turn_chi_square = squared_mahalanobis(offset.turn, expected.bottomRightCorner<3, 3>());
  return offset;
}

GroupShift shift_of(Network& network, const AdjustmentState& state,
                    const std::vector<std::size_t>& plates) {
  const auto count = static_cast<Index>(plates.size());
  const MatrixXd of_plates = network.normals().covariance_of(plates);
  MatrixXd posterior(6 * count, 6 * count);  // without the plates' sizes
  VectorXd moved(6 * count);
  VectorXd prior(6 * count);
  for (Index i = 0; i < count; ++i) {
    const std::size_t plate = plates[static_cast<std::size_t>(i)];
    moved.segment<6>(6 * i) = network.moved_by(state, plate).head<6>();
    prior.segment<6>(6 * i) = network.variance_of(plate).head<6>();
    for (Index j = 0; j < count; ++j) {
      posterior.block<6, 6>(6 * i, 6 * j) = of_plates.block<6, 6>(kPlateCount * i, kPlateCount * j);
    }
  }
  const WithoutPrior measured = without_prior(moved, posterior, prior);
  GroupShift shift{plates};
  for (Index i = 0; i < count; ++i) {
    shift.shift += measured.mean.segment<3>(6 * i) / static_cast<double>(count);
    for (Index j = 0; j < count; ++j) {
      shift.covariance +=
          measured.covariance.block<3, 3>(6 * i, 6 * j) / static_cast<double>(count * count);
    }
  }
  return shift;
}

// Minimises from the start. False when it does not converge.
bool converge(Network& network, AdjustmentState& state) {
  constexpr int kMostSteps = 30;
  constexpr int kMostHalvings = 8;
  constexpr double kEnough = 1e-3;  // of chi-square
  double cost = network.chi_square(state);
  for (int i = 0; i < kMostSteps; ++i) {
    if (!std::isfinite(cost) || !network.linearise(state)) return false;
    const VectorXd step = network.normals().step();
    double share = 1;
    AdjustmentState next = network.stepped_by(state, step, share);
    double next_cost = network.chi_square(next);
    for (int halved = 0; halved < kMostHalvings && !(next_cost <= cost); ++halved) {
      share /= 2;
      next = network.stepped_by(state, step, share);
      next_cost = network.chi_square(next);
    }
    if (!(next_cost <= cost)) return true;  // as low as rounding lets it
    const bool settled = cost - next_cost < kEnough;
    state = std::move(next);
    cost = next_cost;
    if (settled) break;
  }
  return network.linearise(state);
}

}  // namespace

std::vector<SinglePose> single_poses(const AdjustmentProblem& problem, const Sighting& sighting) {
  AdjustmentProblem alone{problem.rig, {problem.plates[sighting.plate]}, {{"", {sighting}}}};
  alone.stations[0].sightings[0].plate = 0;
  alone.plates[0].survey_variance.setConstant(1e-12);
  std::vector<SinglePose> poses;
  const auto starts = vehicle_poses_from(*problem.rig, alone.plates[0], sighting);
  if (!starts) return poses;
  const auto uncertain = static_cast<Index>(calibration_layout(*problem.rig).sigmas.size());
  for (const VehiclePose& start : *starts) {
    AdjustmentState state{
        {alone.plates[0].world_from_plate}, VectorXd::Zero(1), {start}, VectorXd::Zero(uncertain)};
    Network network(alone, {PlateFreedom::none}, {false});
    if (!converge(network, state)) continue;
    const ReducedStation& station = network.stations()[0];
    const Eigen::Matrix3d axes = vehicle_frame(state.vehicles[0]).turn_axes;
    const Eigen::Matrix3d of_turn = station.pose_covariance.bottomRightCorner<3, 3>();
    poses.push_back({state.vehicles[0], axes * of_turn * axes.transpose(), station.chi_square});
  }
  std::ranges::sort(poses, {}, &SinglePose::chi_square);
  return poses;
}

std::optional<Adjustment> adjust_plates(const AdjustmentProblem& problem,
                                        const std::vector<PlateFreedom>& freed) {
  const AdjustmentStart start = start_of(problem, freed);
  AdjustmentState state = start_state(problem, start);
  Network network(problem, freed, idle_stations(start));
  if (!converge(network, state)) return std::nullopt;
  network.normals().invert();
  Adjustment result;
  result.world_from_plate = state.world_from_plate;
  result.chi_square = network.chi_square(state);
  result.offsets.resize(problem.plates.size());
  result.size.resize(problem.plates.size(), 1);
  result.size_sigma.resize(problem.plates.size(), 0);
  result.calibration = state.calibration;
  for (const auto& group : problem.groups) {
    result.groups.push_back(shift_of(network, state, group));
  }
  if (problem.calibration) result.calibration_covariance = network.calibration_covariance();
  for (std::size_t s = 0; s < problem.stations.size(); ++s) {
    const ReducedStation& station = network.stations()[s];
    result.station_chi_square.push_back(station.chi_square);
    result.vehicles.emplace_back();
    if (!network.is_idle(s)) result.vehicles.back() = state.vehicles[s];
    for (const std::size_t plate : station.plates) {
      if (result.offsets[plate]) continue;
      const MatrixXd covariance = network.normals().covariance_of({plate});
      const PlateVector moved = network.moved_by(state, plate);
      result.offsets[plate] =
          offset_of(moved.head<6>(), covariance.topLeftCorner<6, 6>(),
                    network.variance_of(plate).head<6>(), problem.plates[plate].survey_variance);
      result.size[plate] += moved[6];
      if (has_any_size(freed[plate])) result.size_sigma[plate] = std::sqrt(covariance(6, 6));
    }
  }
  return result;
}

bool make_consistent(const AdjustmentProblem& problem, Sighting& sighting) {
  const std::vector<SinglePose> poses = single_poses(problem, sighting);
  const auto factor = poses.empty() ? std::nullopt : factor_to_explain(poses[0].chi_square);
  if (factor) sighting.covariance *= *factor;
  return factor.has_value();
}

}  // namespace tagsmith::detail
