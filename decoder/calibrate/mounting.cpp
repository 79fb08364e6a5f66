// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/mounting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "decoder/localize/plate_adjustment.hpp"
#include "tagsmith/base/chi_square.hpp"
#include "tagsmith/base/quantile.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kMounting = 6;  // parameters of a camera: shift and turn
constexpr Index kCorners = kSightingRows;

// What is assumed of a mounting before anything is seen: next to nothing.
constexpr double kFreePosition = 1;  // metres
constexpr double kFreeAngle = 0.5;   // radians

// How far a vehicle's heading strays from the drive's where the rig's envelope does not say.
constexpr double kUsualYaw = radians(5);

// --- what was seen ---

// The rows as stations, with the plates that they show.
struct Drive {
  std::vector<SightedPlate> plates;
  std::vector<Station> stations;
  std::vector<const Observation*> rows;  // by station
};

// Rigid to a nanometre where the survey calls a place exact: it is divided by.
SightedPlate plate_for(const PlacedTag& tag, const Survey& survey) {
  constexpr double kExact = 1e-9;
  SightedPlate plate = sighted_plate(tag, survey);
  plate.survey_variance = plate.survey_variance.cwiseMax(kExact * kExact);
  return plate;
}

std::size_t plate_index(Drive& drive, const PlacedTag& tag, const Survey& survey) {
  const auto found = std::ranges::find(drive.plates, tag.name, &SightedPlate::name);
  if (found != drive.plates.end()) return static_cast<std::size_t>(found - drive.plates.begin());
  drive.plates.push_back(plate_for(tag, survey));
  return drive.plates.size() - 1;
}

Drive drive_of(std::span<const Observation> rows, const Survey& survey, const Rig& rig) {
  Drive drive;
  for (const Observation& row : rows) {
    Station station{row.id, {}, {}};
    for (const SeenTag& seen : row.tags) {
      const auto camera = std::ranges::find(rig.cameras, seen.camera, &RigCamera::name);
      if (!seen.seen_corners || camera == rig.cameras.end()) continue;
      station.sightings.push_back(sighting_of(
          *seen.seen_corners, rig, static_cast<std::size_t>(camera - rig.cameras.begin()),
          plate_index(drive, seen.tag, survey)));
    }
    if (station.sightings.empty()) continue;
    drive.stations.push_back(std::move(station));
    drive.rows.push_back(&row);
  }
  return drive;
}

// --- the vehicle's own axes ---

// A vehicle of the rig's height that follows the drive, abreast of a place.
VehiclePose following(const Survey& survey, const Rig& rig, const Vector3d& place) {
  const Centerline& line = survey.tunnel.centerline;
  FloorStance stance;
  stance.height = rig.vehicle_height;
  return vehicle_on_floor(line.at(line.locate(place.head<2>()).chainage), stance);
}

VehiclePrior prior_at(const Survey& survey, const Rig& rig, const Vector3d& place) {
  VehiclePrior prior{following(survey, rig, place)};
  prior.sigma[vehicle_parameter::kZ] = rig.height_sigma;
  prior.sigma[vehicle_parameter::kHeading] =
      rig.envelope && rig.envelope->yaw > 0 ? rig.envelope->yaw : kUsualYaw;
  prior.sigma[vehicle_parameter::kPitch] = rig.pitch_sigma;
  prior.sigma[vehicle_parameter::kRoll] = rig.roll_sigma;
  return prior;
}

// --- where the search starts ---

double angle_between(const Matrix3d& a, const Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

// The attitudes on the vehicle that a sighting allows its camera, were the vehicle level and along
// the drive.
std::vector<Matrix3d> attitudes(const Survey& survey, const Rig& rig, const SightedPlate& plate,
                                const Sighting& sighting) {
  std::vector<Matrix3d> result;
  const auto poses = camera_poses_from(rig.cameras[sighting.camera].camera, plate, sighting);
  if (!poses) return result;
  for (const Pose& world_from_camera : *poses) {
    const Pose vehicle = world_from_vehicle(following(survey, rig, world_from_camera.translation));
    result.push_back(vehicle.rotation.transpose() * world_from_camera.rotation);
  }
  return result;
}

// Within which single tags and vehicles that are not quite level agree on an attitude.
constexpr double kAlike = radians(15);

std::size_t supporters(const std::vector<std::vector<Matrix3d>>& seen, const Matrix3d& attitude) {
  return static_cast<std::size_t>(std::ranges::count_if(seen, [&](const auto& allowed) {
    return std::ranges::any_of(
        allowed, [&](const Matrix3d& own) { return angle_between(own, attitude) < kAlike; });
  }));
}

bool sees_anything(const Drive& drive, std::size_t camera) {
  return std::ranges::any_of(drive.stations, [&](const Station& station) {
    return std::ranges::find(station.sightings, camera, &Sighting::camera) !=
           station.sightings.end();
  });
}

// The camera's attitude that most of its tags support: the rig's, unless another has more.
Matrix3d start_attitude(const Survey& survey, const Rig& rig, const Drive& drive,
                        std::size_t camera) {
  constexpr std::size_t kEnough = 100;  // tags; the comparison grows with their square
  std::vector<std::vector<Matrix3d>> seen;
  for (const Station& station : drive.stations) {
    for (const Sighting& sighting : station.sightings) {
      if (sighting.camera != camera || seen.size() == kEnough) continue;
      seen.push_back(attitudes(survey, rig, drive.plates[sighting.plate], sighting));
    }
  }
  Matrix3d best = rig.cameras[camera].vehicle_from_camera.rotation;
  std::size_t most = supporters(seen, best);
  for (const auto& allowed : seen) {
    for (const Matrix3d& attitude : allowed) {
      const std::size_t support = supporters(seen, attitude);
      if (support <= most) continue;
      most = support;
      best = attitude;
    }
  }
  return best;
}

// --- the fit ---

using Held = std::vector<std::array<bool, kMounting>>;  // by camera

// The columns of the mounting's parameters that are not held, and beyond them what the rig calls
// uncertain of the lens.
CalibrationLayout layout_for(const Rig& rig, const Held& held) {
  CalibrationLayout layout = calibration_layout(rig);
  CalibrationLayout result;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    std::array<int, kCalibrationCount> places{};
    for (std::size_t i = 0; i < kCalibrationCount; ++i) {
      const int stated = layout.places[camera][i];
      double sigma = stated < 0 ? 0 : layout.sigmas[static_cast<std::size_t>(stated)];
      if (i < kMounting) sigma = held[camera][i] ? 0 : i < 3 ? kFreePosition : kFreeAngle;
      places[i] = -1;
      if (sigma == 0) continue;
      places[i] = static_cast<int>(result.sigmas.size());
      result.sigmas.push_back(sigma);
    }
    result.places.push_back(places);
  }
  return result;
}

struct Fitted {
  Rig rig;
  CalibrationLayout layout;
  Adjustment adjustment;
};

Matrix3d turned_by(const Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

// Moves the cameras as the adjustment says; by how many standard deviations at most.
double take_over(Fitted& fitted) {
  double most = 0;
  for (std::size_t camera = 0; camera < fitted.rig.cameras.size(); ++camera) {
    Vector6 change = Vector6::Zero();
    for (std::size_t i = 0; i < kMounting; ++i) {
      const int place = fitted.layout.places[camera][i];
      if (place < 0) continue;
      const double moved = fitted.adjustment.calibration[place];
      const double variance = fitted.adjustment.calibration_covariance(place, place);
      change[static_cast<Index>(i)] = moved;
      most = std::max(most, std::abs(moved) / std::sqrt(variance));
    }
    Pose& pose = fitted.rig.cameras[camera].vehicle_from_camera;
    pose.translation += change.head<3>();
    pose.rotation *= turned_by(change.tail<3>());
  }
  return most;
}

// The adjustment, repeated about its own result until that stays.
std::optional<Fitted> converged(const Survey& survey, const Drive& drive, Rig rig,
                                const Held& held) {
  constexpr int kMostRounds = 20;
  constexpr double kSettled = 0.01;  // standard deviations
  Fitted fitted{std::move(rig), {}, {}};
  fitted.layout = layout_for(fitted.rig, held);
  AdjustmentProblem problem{&fitted.rig, drive.plates, drive.stations, 0, fitted.layout};
  const std::vector<PlateFreedom> none(drive.plates.size(), PlateFreedom::none);
  for (Station& station : problem.stations) {
    const SightedPlate& plate = problem.plates[station.sightings.front().plate];
    station.prior = prior_at(survey, fitted.rig, plate.world_from_plate.translation);
  }
  for (int round = 0; round < kMostRounds; ++round) {
    std::optional<Adjustment> adjustment = adjust_plates(problem, none);
    if (!adjustment) return std::nullopt;
    fitted.adjustment = std::move(*adjustment);
    for (std::size_t s = 0; s < problem.stations.size(); ++s) {
      const auto& vehicle = fitted.adjustment.vehicles[s];
      if (vehicle) problem.stations[s].prior = prior_at(survey, fitted.rig, vehicle->position);
    }
    if (take_over(fitted) < kSettled) return fitted;
  }
  return std::nullopt;
}

// --- what contradicts the rest ---

// Chi-square of a sighting's corners; infinite where the fit cannot see it or tells nothing of it.
double chi_square_of(const Fitted& fitted, const Drive& drive, std::size_t station,
                     const Sighting& sighting) {
  const auto& vehicle = fitted.adjustment.vehicles[station];
  SightedPlate plate = drive.plates[sighting.plate];
  plate.world_from_plate = fitted.adjustment.world_from_plate[sighting.plate];
  const auto rows = vehicle ? sighting_rows(fitted.rig, fitted.layout, {}, vehicle_frame(*vehicle),
                                            plate, sighting.camera)
                            : std::nullopt;
  if (!rows) return std::numeric_limits<double>::infinity();
  return squared_mahalanobis(rows->predicted - sighting.pixels, sighting.covariance_with_edges());
}

// Takes the worst sightings out: those that fit worse than one in some thousands would, measured by
// what is usual of this drive, and not far better than the worst of all, for that spoils the
// others' fit. How many.
std::size_t leave_out(const Fitted& fitted, Drive& drive, std::vector<std::size_t>& left_out) {
  constexpr double kMedian = 7.344;  // of chi-square of eight
  constexpr double kNearWorst = 4;
  std::vector<double> all;
  for (std::size_t s = 0; s < drive.stations.size(); ++s) {
    for (const Sighting& sighting : drive.stations[s].sightings) {
      all.push_back(chi_square_of(fitted, drive, s, sighting));
    }
  }
  std::vector<double> sorted = all;
  const double usual = std::max(1.0, quantile(sorted, 0.5) / kMedian);
  const double limit = std::max(usual * chi_square_limit(static_cast<int>(kCorners), 3.5),
                                std::ranges::max(all) / kNearWorst);
  const std::size_t before = all.size();
  std::size_t kept = 0;
  std::size_t next = 0;
  for (std::size_t s = 0; s < drive.stations.size(); ++s) {
    std::erase_if(drive.stations[s].sightings, [&](const Sighting& sighting) {
      const bool out = !(all[next++] <= limit);
      if (out) ++left_out[sighting.camera];
      return out;
    });
    kept += drive.stations[s].sightings.size();
  }
  for (std::size_t s = drive.stations.size(); s-- > 0;) {
    if (!drive.stations[s].sightings.empty()) continue;
    drive.stations.erase(drive.stations.begin() + static_cast<std::ptrdiff_t>(s));
    drive.rows.erase(drive.rows.begin() + static_cast<std::ptrdiff_t>(s));
  }
  return before - kept;
}

// --- how well it is known ---

// Of a camera's six parameters in the vehicle's own axes: an error that all vehicles' attitudes
// have in common is one of these axes, which the drive defines, not of the camera.
Eigen::Matrix<double, 6, 6> covariance_of(const Fitted& fitted, std::size_t camera) {
  const MatrixXd& all = fitted.adjustment.calibration_covariance;
  const Index mean_attitude = all.rows() - 3;
  const Pose& pose = fitted.rig.cameras[camera].vehicle_from_camera;
  const Matrix3d axes = vehicle_frame(VehiclePose{}).turn_axes;
  MatrixXd by_all = MatrixXd::Zero(6, all.rows());
  for (std::size_t i = 0; i < kMounting; ++i) {
    const int place = fitted.layout.places[camera][i];
    const auto row = static_cast<Index>(i);
    if (place < 0) continue;
    by_all(row, place) = 1;
    for (Index a = 0; a < 3; ++a) {
      const Vector3d axis = axes.col(a);
      const Vector3d shift = axis.cross(pose.translation);
      const Vector3d turn = pose.rotation.transpose() * axis;
      by_all(row, mean_attitude + a) = i < 3 ? shift[row] : turn[row - 3];
    }
  }
  return by_all * all * by_all.transpose();
}

// Angles by a small turn in camera axes.
Matrix3d angles_by_turn(const Pose& vehicle_from_camera) {
  constexpr double kStep = 1e-6;
  const MountingAngles at = mounting_angles(vehicle_from_camera);
  Matrix3d result;
  for (Index i = 0; i < 3; ++i) {
    Pose moved = vehicle_from_camera;
    moved.rotation *= turned_by(kStep * Vector3d::Unit(i));
    const MountingAngles angles = mounting_angles(moved);
    const auto change = [](double to, double from) {
      return std::remainder(to - from, 2 * std::numbers::pi) / kStep;
    };
    result.col(i) << change(angles.yaw, at.yaw), change(angles.pitch, at.pitch),
        change(angles.roll, at.roll);
  }
  return result;
}

// Holds the parameter that the drive tells least of, if it tells less than a third of what is
// assumed of it.
bool hold_worst(const Fitted& fitted, Held& held) {
  constexpr double kTold = 1.0 / 3;
  double worst = kTold;
  bool* to_hold = nullptr;
  for (std::size_t camera = 0; camera < held.size(); ++camera) {
    const Vector6 sigma = covariance_of(fitted, camera).diagonal().cwiseMax(0).cwiseSqrt();
    for (std::size_t i = 0; i < kMounting; ++i) {
      const double share = sigma[static_cast<Index>(i)] / (i < 3 ? kFreePosition : kFreeAngle);
      if (held[camera][i] || share <= worst) continue;
      worst = share;
      to_hold = &held[camera][i];
    }
  }
  if (to_hold != nullptr) *to_hold = true;
  return to_hold != nullptr;
}

// --- ranges ---

std::vector<FittedRange> fit_ranges(const Fitted& fitted, const Drive& drive,
                                    const Survey& survey) {
  constexpr double kSpread = 1.4826;    // standard deviations a median absolute deviation
  constexpr double kOfMedian = 1.2533;  // standard deviation of a median over that of a mean
  std::vector<FittedRange> result;
  for (const RigRange& range : fitted.rig.ranges) {
    std::vector<double> offsets;
    for (std::size_t s = 0; s < drive.rows.size(); ++s) {
      const auto measured = drive.rows[s]->ranges.find(range.name);
      const auto& vehicle = fitted.adjustment.vehicles[s];
      if (measured == drive.rows[s]->ranges.end() || !vehicle) continue;
      offsets.push_back(measured->second - observe_wall(survey.tunnel.centerline,
                                                        wall_of(survey.tunnel, range.wall),
                                                        vehicle->position)
                                               .distance);
    }
    if (offsets.empty()) continue;
    FittedRange fit{range.name, quantile(offsets, 0.5), 0, offsets.size()};
    for (double& offset : offsets) offset = std::abs(offset - fit.offset);
    const double spread = std::max(kSpread * quantile(offsets, 0.5), range.sigma);
    fit.sigma = kOfMedian * spread / std::sqrt(static_cast<double>(fit.rows));
    result.push_back(std::move(fit));
  }
  return result;
}

// --- all together ---

MountingFit result_of(const Fitted& fitted, const Drive& drive, const Survey& survey,
                      const Held& held, const std::vector<std::size_t>& left_out) {
  MountingFit fit;
  fit.rows = drive.stations.size();
  std::vector<std::size_t> tags(fitted.rig.cameras.size());
  std::size_t sightings = 0;
  for (std::size_t s = 0; s < drive.stations.size(); ++s) {
    for (const Sighting& sighting : drive.stations[s].sightings) {
      fit.chi_square += chi_square_of(fitted, drive, s, sighting);
      ++tags[sighting.camera];
      ++sightings;
    }
  }
  // Priors add as many equations as they add unknowns of the vehicle: four a row.
  fit.degrees_of_freedom = static_cast<int>(8 * sightings + 4 * fit.rows) -
                           static_cast<int>(6 * fit.rows + fitted.layout.sigmas.size());
  fit.sigma_factor = std::sqrt(std::max(1.0, fit.chi_square / std::max(1, fit.degrees_of_freedom)));
  for (std::size_t c = 0; c < fitted.rig.cameras.size(); ++c) {
    const RigCamera& camera = fitted.rig.cameras[c];
    FittedMounting mounting{camera.name, camera.vehicle_from_camera};
    const auto covariance = covariance_of(fitted, c);
    const Matrix3d by_turn = angles_by_turn(camera.vehicle_from_camera);
    const Matrix3d of_turn = covariance.bottomRightCorner<3, 3>();
    mounting.sigma << covariance.diagonal().head<3>(),
        (by_turn * of_turn * by_turn.transpose()).diagonal();
    mounting.sigma = fit.sigma_factor * mounting.sigma.cwiseMax(0).cwiseSqrt();
    mounting.held = held[c];
    mounting.tags = tags[c];
    mounting.left_out = left_out[c];
    fit.cameras.push_back(std::move(mounting));
  }
  fit.ranges = fit_ranges(fitted, drive, survey);
  return fit;
}

}  // namespace

Result<MountingFit> fit_mounting(std::span<const Observation> rows, const Survey& survey,
                                 const Rig& rig) {
  constexpr std::size_t kLeastRows = 3;
  Drive drive = drive_of(rows, survey, rig);
  if (drive.stations.size() < kLeastRows) {
    return fail(fmt::format("{} of {} rows show tags of the survey, expected {} or more",
                            drive.stations.size(), rows.size(), kLeastRows));
  }
  Rig start = rig;
  Held held(rig.cameras.size());
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (!sees_anything(drive, camera)) held[camera].fill(true);
    start.cameras[camera].vehicle_from_camera.rotation = start_attitude(survey, rig, drive, camera);
  }
  std::vector<std::size_t> left_out(rig.cameras.size());
  while (drive.stations.size() >= kLeastRows) {
    const auto fitted = converged(survey, drive, start, held);
    if (!fitted) return fail("the mounting that fits the tags best was not found");
    if (leave_out(*fitted, drive, left_out) > 0) continue;
    if (!hold_worst(*fitted, held)) return result_of(*fitted, drive, survey, held, left_out);
  }
  return fail("the tags contradict each other in too many rows");
}

Rig with_mountings(Rig rig, const MountingFit& fit) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const FittedMounting& mounting = fit.cameras[c];
    rig.cameras[c].vehicle_from_camera = mounting.vehicle_from_camera;
    CalibrationSigma& sigma = rig.cameras[c].calibration_sigma;
    const double position = mounting.sigma.head<3>().maxCoeff();
    const double angle = mounting.sigma.tail<3>().maxCoeff();
    if (position > 0) sigma.position = position;
    if (angle > 0) sigma.angle = angle;
  }
  return rig;
}

}  // namespace tagsmith::detail
