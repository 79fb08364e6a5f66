// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/drive_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "decoder/plates/plate_search.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// How far a vehicle's heading may differ from the drive's where the rig's envelope does not say.
constexpr double kUsualYaw = radians(5);

// --- what was seen ---

// Nanometres where the survey calls a place exact, because the variance is a divisor.
SightedPlate plate_for(const PlacedTag& tag, const Survey& survey) {
  constexpr double kExact = 1e-9;
  SightedPlate plate = sighted_plate(tag, survey);
  plate.survey_variance = plate.survey_variance.cwiseMax(kExact * kExact);
  return plate;
}

// --- the vehicle's own axes ---

// A vehicle of the rig's height that follows the drive, or points against it, abreast of a place.
VehiclePose following(const Survey& survey, const Rig& rig, const Vector3d& place,
                      bool is_backward) {
  const Centerline& line = survey.tunnel.centerline;
  FloorStance stance;
  stance.height = rig.vehicle_height;
  if (is_backward) stance.yaw = std::numbers::pi;
  return vehicle_on_floor(line.at(line.locate(place.head<2>()).chainage), stance);
}

VehiclePrior prior_at(const Survey& survey, const Rig& rig, const Vector3d& place,
                      bool is_backward) {
  VehiclePrior prior{following(survey, rig, place, is_backward)};
  prior.sigma[vehicle_parameter::kZ] = rig.height_sigma;
  prior.sigma[vehicle_parameter::kHeading] =
      rig.envelope && rig.envelope->yaw > 0 ? rig.envelope->yaw : kUsualYaw;
  prior.sigma[vehicle_parameter::kPitch] = rig.pitch_sigma;
  prior.sigma[vehicle_parameter::kRoll] = rig.roll_sigma;
  return prior;
}

// --- where the search starts ---

// The attitude of a camera on the vehicle if the vehicle is level and along the drive, or against
// it.
Matrix3d attitude_on_vehicle(const Survey& survey, const Rig& rig, const Pose& world_from_camera,
                             bool is_backward) {
  const Pose vehicle =
      world_from_vehicle(following(survey, rig, world_from_camera.translation, is_backward));
  return vehicle.rotation.transpose() * world_from_camera.rotation;
}

// The attitudes that a sighting allows its camera.
std::vector<Matrix3d> attitudes(const Survey& survey, const Rig& rig, const SightedPlate& plate,
                                const Sighting& sighting, bool is_backward) {
  std::vector<Matrix3d> result;
  const auto poses = camera_poses_from(rig.cameras[sighting.camera].camera, plate, sighting);
  if (!poses) return result;
  for (const Pose& world_from_camera : *poses) {
    result.push_back(attitude_on_vehicle(survey, rig, world_from_camera, is_backward));
  }
  return result;
}

// The angle within which single tags and vehicles that are not quite level agree on an attitude.
constexpr double kAlikeAttitudes = radians(15);

std::size_t supporters(const std::vector<std::vector<Matrix3d>>& seen, const Matrix3d& attitude) {
  return static_cast<std::size_t>(std::ranges::count_if(seen, [&](const auto& allowed) {
    return std::ranges::any_of(allowed, [&](const Matrix3d& own) {
      return angle_between(own, attitude) < kAlikeAttitudes;
    });
  }));
}

// Whether most of the station's tags have their cameras where the rig says only if the vehicle
// points against the center line's direction. A camera that looks elsewhere in both cases does not
// count.
bool points_backward(const Survey& survey, const Rig& rig, const Drive& drive,
                     const Station& station) {
  constexpr double kFits = radians(45);
  int backward = 0;
  for (const Sighting& sighting : station.sightings) {
    const RigCamera& camera = rig.cameras[sighting.camera];
    const auto poses = camera_poses_from(camera.camera, drive.plates[sighting.plate], sighting);
    if (!poses) continue;
    double ahead = std::numbers::pi, behind = std::numbers::pi;  // from the rig's attitude
    for (const Pose& pose : *poses) {
      const auto off = [&](bool is_backward) {
        return angle_between(attitude_on_vehicle(survey, rig, pose, is_backward),
                             camera.vehicle_from_camera.rotation);
      };
      ahead = std::min(ahead, off(false));
      behind = std::min(behind, off(true));
    }
    if (ahead < kFits && ahead < behind) --backward;
    if (behind < kFits && behind < ahead) ++backward;
  }
  return backward > 0;
}

// --- the fit ---

// The columns of the parameters that are not exact.
CalibrationLayout layout_for(const std::vector<ParameterSigmas>& sigmas) {
  CalibrationLayout layout;
  for (const ParameterSigmas& camera : sigmas) {
    std::array<int, kCalibrationCount> places{};
    for (std::size_t i = 0; i < kCalibrationCount; ++i) {
      places[i] = camera[i] > 0 ? static_cast<int>(layout.sigmas.size()) : -1;
      if (camera[i] > 0) layout.sigmas.push_back(camera[i]);
    }
    layout.places.push_back(places);
  }
  return layout;
}

}  // namespace

Rig fitted_rig(Rig rig, const CalibrationLayout& layout, const Eigen::VectorXd& calibration) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    RigCamera& camera = rig.cameras[c];
    const CalibratedCamera fitted = calibrated(camera, layout, c, calibration);
    camera.camera = fitted.camera;
    camera.vehicle_from_camera = fitted.vehicle_from_camera;
  }
  return rig;
}

Drive drive_of(std::span<const Observation> rows, const Survey& survey, const Rig& rig) {
  Drive drive;
  for (const Observation& row : rows) {
    Station station{row.id, {}, {}};
    for (const SeenTag& seen : row.tags) {
      const auto camera = camera_index(rig, seen.camera);
      if (!seen.seen_corners || seen.at_coded_place || !camera) continue;
      const std::size_t plate = plate_index(drive.plates, plate_for(seen.tag, survey));
      station.sightings.push_back(sighting_of(*seen.seen_corners, rig, *camera, plate));
    }
    if (station.sightings.empty()) continue;
    station.is_backward = points_backward(survey, rig, drive, station);
    drive.stations.push_back(std::move(station));
    drive.rows.push_back(&row);
  }
  return drive;
}

bool sees_anything(const Drive& drive, std::size_t camera) {
  return std::ranges::any_of(drive.stations, [&](const Station& station) {
    return std::ranges::find(station.sightings, camera, &Sighting::camera) !=
           station.sightings.end();
  });
}

std::vector<ParameterSigmas> stated_sigmas(const Rig& rig) {
  const CalibrationLayout layout = calibration_layout(rig);
  std::vector<ParameterSigmas> result(rig.cameras.size());
  for (std::size_t c = 0; c < result.size(); ++c) {
    for (std::size_t i = 0; i < kCalibrationCount; ++i) {
      const int place = layout.places[c][i];
      if (place >= 0) result[c][i] = layout.sigmas[static_cast<std::size_t>(place)];
    }
  }
  return result;
}

Matrix3d likely_attitude(const Survey& survey, const Rig& rig, const Drive& drive,
                         std::size_t camera) {
  constexpr std::size_t kEnough = 100;  // tags; the comparison grows with their square
  std::vector<std::vector<Matrix3d>> seen;
  for (const Station& station : drive.stations) {
    for (const Sighting& sighting : station.sightings) {
      if (sighting.camera != camera || seen.size() == kEnough) continue;
      seen.push_back(
          attitudes(survey, rig, drive.plates[sighting.plate], sighting, station.is_backward));
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

namespace {

// How many of these places are 0.4 m and more from each of the others taken.
std::size_t count_apart(const std::vector<Vector3d>& places) {
  constexpr double kApart = 0.4;  // metres
  std::vector<Vector3d> apart;
  for (const Vector3d& place : places) {
    const auto is_near = [&](const Vector3d& other) { return (place - other).norm() < kApart; };
    if (std::ranges::none_of(apart, is_near)) apart.push_back(place);
  }
  return apart.size();
}

// The mean attitude against the stations' priors. Its variance is that of Student's distribution,
// which the scatter of a few attitudes has, and of as many attitudes as there are places apart,
// with the priors' variances where these are smaller, or where the places are too few to show a
// scatter.
void take_attitudes(const std::vector<Station>& stations, DriveFit& fit) {
  using namespace vehicle_parameter;
  std::vector<Vector3d> attitudes, places;
  Vector3d stated = Vector3d::Zero();
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const auto& vehicle = fit.adjustment.vehicles[s];
    if (!vehicle) continue;
    const VehiclePrior& prior = *stations[s].prior;
    attitudes.emplace_back(wrapped_angle(vehicle->heading - prior.mean.heading),
                           vehicle->pitch - prior.mean.pitch, vehicle->roll - prior.mean.roll);
    places.push_back(vehicle->position);
    stated = Vector3d(prior.sigma[kHeading], prior.sigma[kPitch], prior.sigma[kRoll]).cwiseAbs2();
    fit.heading_chi_square += std::pow(attitudes.back()[0] / prior.sigma[kHeading], 2);
  }
  if (attitudes.empty()) return;
  const auto count = static_cast<double>(attitudes.size());
  for (const Vector3d& attitude : attitudes) fit.mean_attitude += attitude / count;
  fit.places_apart = count_apart(places);
  const auto apart = static_cast<double>(fit.places_apart);
  fit.mean_attitude_variance = stated / apart;
  if (apart < 4) return;
  Vector3d scatter = Vector3d::Zero();
  for (const Vector3d& attitude : attitudes) {
    scatter += (attitude - fit.mean_attitude).cwiseAbs2() / (count - 1);
  }
  scatter *= (apart - 1) / (apart - 3);
  fit.mean_attitude_variance = scatter.cwiseMin(stated) / apart;
}

}  // namespace

std::optional<DriveFit> fit_drive(const Survey& survey, const Drive& drive, const Rig& start,
                                  const std::vector<ParameterSigmas>& sigmas) {
  constexpr int kRounds = 3;  // in a bend the drive's direction depends on the vehicle's place
  const CalibrationLayout layout = layout_for(sigmas);
  AdjustmentProblem problem{&start, drive.plates, drive.stations, 0, layout};
  const std::vector<PlateFreedom> none(drive.plates.size(), PlateFreedom::none);
  std::optional<Adjustment> adjustment;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t s = 0; s < problem.stations.size(); ++s) {
      const SightedPlate& plate = problem.plates[problem.stations[s].sightings.front().plate];
      const bool placed = adjustment && adjustment->vehicles[s];
      problem.stations[s].prior =
          prior_at(survey, start,
                   placed ? adjustment->vehicles[s]->position : plate.world_from_plate.translation,
                   problem.stations[s].is_backward);
    }
    adjustment = adjust_plates(problem, none);
    if (!adjustment) return std::nullopt;
  }
  DriveFit fit{fitted_rig(start, layout, adjustment->calibration), layout, std::move(*adjustment)};
  take_attitudes(problem.stations, fit);
  return fit;
}

Rig calibrated_by_plates(AdjustmentProblem problem) {
  constexpr int kRounds = 2;  // if the rig is far off, the first explains less than it could
  const CalibrationLayout layout = calibration_layout(*problem.rig);
  Rig fitted = *problem.rig;
  keep_comparable(problem);
  for (int round = 0; round < kRounds; ++round) {
    problem.rig = &fitted;
    const PlateExplanation found = explain(problem);
    if (!found.adjustment) break;
    fitted = fitted_rig(fitted, layout, found.adjustment->calibration);
  }
  return fitted;
}

namespace {

// Of a sighting's corners; infinite where the fit cannot see it.
double chi_square_of(const DriveFit& fit, const Drive& drive, std::size_t station,
                     const Sighting& sighting) {
  const auto& vehicle = fit.adjustment.vehicles[station];
  SightedPlate plate = drive.plates[sighting.plate];
  plate.world_from_plate = fit.adjustment.world_from_plate[sighting.plate];
  const auto rows = vehicle ? sighting_rows(fit.rig, fit.layout, {}, vehicle_frame(*vehicle), plate,
                                            sighting.camera)
                            : std::nullopt;
  if (!rows) return std::numeric_limits<double>::infinity();
  const auto by_motion = by_motion_sigmas(*rows, fit.rig.cameras[sighting.camera]);
  return squared_mahalanobis(rows->predicted - sighting.pixels,
                             sighting.covariance_with_edges() + by_motion * by_motion.transpose());
}

// The chi-squares of all sightings, station by station.
std::vector<double> chi_squares(const DriveFit& fit, const Drive& drive) {
  std::vector<double> all;
  for (std::size_t s = 0; s < drive.stations.size(); ++s) {
    for (const Sighting& sighting : drive.stations[s].sightings) {
      all.push_back(chi_square_of(fit, drive, s, sighting));
    }
  }
  return all;
}

}  // namespace

double usual_excess(const DriveFit& fit, const Drive& drive) {
  constexpr double kMedian = 7.344;  // of chi-square of eight
  std::vector<double> all = chi_squares(fit, drive);
  return all.empty() ? 1 : std::max(1.0, quantile(all, 0.5) / kMedian);
}

std::vector<LeftOut> leave_out_worst(const DriveFit& fit, Drive& drive, double excess) {
  constexpr double kNearWorst = 4;
  const std::vector<double> all = chi_squares(fit, drive);
  double worst = 0;
  for (const double value : all) {
    if (std::isfinite(value)) worst = std::max(worst, value);
  }
  const double limit = std::max(excess * chi_square_limit(kSightingRows, 3.5), worst / kNearWorst);
  std::vector<LeftOut> left_out;
  auto next = all.begin();
  for (Station& station : drive.stations) {
    std::erase_if(station.sightings, [&](const Sighting& sighting) {
      const bool out = !(*next++ <= limit);
      if (out) left_out.push_back({station.name, sighting});
      return out;
    });
  }
  for (std::size_t s = drive.stations.size(); s-- > 0;) {
    if (!drive.stations[s].sightings.empty()) continue;
    drive.stations.erase(drive.stations.begin() + static_cast<std::ptrdiff_t>(s));
    drive.rows.erase(drive.rows.begin() + static_cast<std::ptrdiff_t>(s));
  }
  return left_out;
}

}  // namespace tagsmith::detail
