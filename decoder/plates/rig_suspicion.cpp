// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/rig_suspicion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/plates/attitude_scatter.hpp"
#include "decoder/plates/drive_fit.hpp"
#include "decoder/plates/plate_search.hpp"
#include "decoder/plates/plate_trials.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

// What is tried for one camera: neighbours among its calibration parameters.
struct Trial {
  std::size_t first = 0;
  std::size_t count = 1;
};
constexpr std::size_t kFirstAngle = 3;
constexpr std::size_t kFocal = 6;
constexpr std::size_t kDistortion = 9;
constexpr std::array<Trial, 7> kTrials{
    {{3}, {4}, {5}, {kFocal}, {kDistortion}, {kFirstAngle, 3}, {0, 3}}};

double free_sigma(std::size_t parameter) {
  return parameter == kFocal        ? kFreeFocal
         : parameter == kDistortion ? kFreeDistortion
         : parameter < kFirstAngle  ? kFreePosition
                                    : kFreeAngle;
}

bool is_of_lens(std::size_t parameter) { return parameter == kFocal || parameter == kDistortion; }

RigParameter parameter_of_lens(std::size_t parameter) {
  return parameter == kFocal ? RigParameter::focal : RigParameter::distortion;
}

std::size_t count_sightings(const Drive& drive) {
  std::size_t count = 0;
  for (const Station& station : drive.stations) count += station.sightings.size();
  return count;
}

std::ptrdiff_t count_seeing(const Drive& drive, const Rig& rig) {
  std::ptrdiff_t count = 0;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (sees_anything(drive, camera)) ++count;
  }
  return count;
}

// The rows that can contradict themselves: those that show several tags, where there are enough.
// Those of a vehicle that stands still count as one. Rows of a long drive are sampled evenly,
// because the fits take long.
std::vector<Observation> compared_rows(std::span<const Observation> rows) {
  constexpr std::size_t kMost = 40;
  constexpr std::size_t kEnough = 3;
  std::vector<Observation> chosen;
  for (const std::size_t least_tags : {2U, 1U}) {
    chosen.clear();
    std::ranges::copy_if(rows, std::back_inserter(chosen),
                         [&](const Observation& row) { return row.tags.size() >= least_tags; });
    const auto repeated = std::ranges::unique(chosen, are_of_one_place);
    chosen.erase(repeated.begin(), repeated.end());
    if (chosen.size() >= kEnough) break;
  }
  return evenly_taken(std::move(chosen), kMost);
}

constexpr std::size_t kLeastRows = 3;

struct Explained {
  std::size_t rows = 0;
  std::size_t stations = 0;  // that were not left out, and their sightings
  std::size_t sightings = 0;
  double chi_square = 0;
  DriveFit fit;
};

// How many rows fit completely once all sightings that do not fit are left out.
std::optional<Explained> explained(const Survey& survey, Drive drive, const Rig& start,
                                   const std::vector<ParameterSigmas>& sigmas, double excess) {
  std::vector<std::size_t> whole;
  whole.reserve(drive.stations.size());
  for (const Station& station : drive.stations) whole.push_back(station.sightings.size());
  const std::vector<const Observation*> rows = drive.rows;
  while (!drive.stations.empty()) {
    auto fit = fit_drive(survey, drive, start, sigmas);
    if (!fit) return std::nullopt;
    const std::size_t before = count_sightings(drive);
    leave_out_worst(*fit, drive, excess);
    if (count_sightings(drive) < before) continue;
    // A vehicle that stands askew in every row is no evidence against a camera.
    Explained result{0, drive.stations.size(), before,
                     fit->adjustment.chi_square - fit->heading_chi_square, std::move(*fit)};
    for (std::size_t s = 0; s < drive.stations.size(); ++s) {
      const auto row = std::ranges::find(rows, drive.rows[s]) - rows.begin();
      const bool all = drive.stations[s].sightings.size() == whole[static_cast<std::size_t>(row)];
      if (all) ++result.rows;
    }
    return result;
  }
  return std::nullopt;
}

// Cameras that may stand and look anywhere, with any lens.
std::vector<ParameterSigmas> any_sigmas(const Rig& rig) {
  std::vector<ParameterSigmas> sigmas = stated_sigmas(rig);
  for (ParameterSigmas& camera : sigmas) {
    for (std::size_t i = 0; i <= kFocal; ++i) camera[i] = free_sigma(i);
    camera[kDistortion] = free_sigma(kDistortion);
  }
  return sigmas;
}

// The excess of the corners' chi-square when any rig is allowed.
double noise_of(const Survey& survey, const Drive& drive, const Rig& start) {
  const auto fit = fit_drive(survey, drive, start, any_sigmas(start));
  return fit ? usual_excess(*fit, drive) : 1;
}

// The drive as stated, and how much better another rig must be.
struct Stated {
  const Drive* drive = nullptr;
  double excess = 1;  // of the corners' chi-square over chance
  std::optional<Explained> explained;

  std::size_t rows() const { return explained ? explained->rows : 0; }

  // True when the other rig clearly explains differences that otherwise, row by row and always
  // alike, the plates' tolerances would have to absorb.
  bool is_beaten_by(const Explained& other) const {
    return explained && other.sightings >= explained->sightings &&
           explained->chi_square - other.chi_square > decisive_gain();
  }

  // Of chi-square: odds of 270 000.
  double decisive_gain() const { return 25 * excess; }
};

// True when chi-square is no more than noise.
bool fits_well(const Explained& with, double excess) {
  constexpr double kGate = 3;  // normal value that is exceeded once in 700
  const auto degrees_of_freedom =
      static_cast<int>(kSightingRows * with.sightings) - 2 * static_cast<int>(with.stations);
  return with.chi_square < excess * chi_square_limit(degrees_of_freedom, kGate);
}

double value_of(const MountingAngles& angles, RigParameter parameter) {
  return parameter == RigParameter::yaw     ? angles.yaw
         : parameter == RigParameter::pitch ? angles.pitch
                                            : angles.roll;
}

// The angle that a turn about one of the camera's axes changes most.
RigParameter angle_changed(const MountingAngles& from, const MountingAngles& to) {
  const auto change = [&](RigParameter parameter) {
    return std::abs(wrapped_angle(value_of(to, parameter) - value_of(from, parameter)));
  };
  return std::ranges::max({RigParameter::yaw, RigParameter::pitch, RigParameter::roll}, {}, change);
}

// By how much the camera is turned as a whole.
void take_turn(const RigCamera& stated, const RigCamera& fitted, const Eigen::Matrix3d& covariance,
               RigSuspect& suspect) {
  const Eigen::AngleAxisd turn(stated.vehicle_from_camera.rotation.transpose() *
                               fitted.vehicle_from_camera.rotation);
  suspect.parameter = RigParameter::turn;
  suspect.stated = 0;
  suspect.expected = turn.angle();
  suspect.sigma = std::sqrt(turn.axis().dot(covariance * turn.axis()));
  suspect.mounting = mounting_angles(fitted.vehicle_from_camera);
}

// Where the camera stands.
void take_shift(const RigCamera& stated, const RigCamera& fitted, const Eigen::Matrix3d& covariance,
                RigSuspect& suspect) {
  suspect.parameter = RigParameter::position;
  suspect.shift = fitted.vehicle_from_camera.translation - stated.vehicle_from_camera.translation;
  suspect.stated = 0;
  suspect.expected = suspect.shift.norm();
  suspect.sigma = std::sqrt(suspect.shift.dot(covariance * suspect.shift)) / suspect.expected;
}

// Of a lens as stated and as fitted: the focal lengths relative to the stated ones, or the first
// coefficient of the distortion.
RigSuspect suspect_lens(const RigCamera& stated, const RigCamera& fitted, std::size_t parameter) {
  RigSuspect suspect{stated.name, parameter_of_lens(parameter)};
  const bool is_focal = parameter == kFocal;
  suspect.stated = is_focal ? 1 : stated.camera.distortion[0];
  suspect.expected = is_focal ? fitted.camera.fx / stated.camera.fx : fitted.camera.distortion[0];
  return suspect;
}

RigSuspect suspect_of(const Rig& rig, std::size_t camera, const Trial& trial,
                      const Explained& with) {
  const RigCamera& stated = rig.cameras[camera];
  const RigCamera& fitted = with.fit.rig.cameras[camera];
  const auto place = static_cast<Eigen::Index>(with.fit.layout.places[camera][trial.first]);
  const Eigen::MatrixXd& covariance = with.fit.adjustment.calibration_covariance;
  RigSuspect suspect = suspect_lens(stated, fitted, trial.first);
  suspect.sigma = std::sqrt(covariance(place, place));
  if (is_of_lens(trial.first)) return suspect;
  if (trial.first < kFirstAngle) {
    take_shift(stated, fitted, covariance.block<3, 3>(place, place), suspect);
    return suspect;
  }
  if (trial.count > 1) {
    take_turn(stated, fitted, covariance.block<3, 3>(place, place), suspect);
    return suspect;
  }
  const MountingAngles from = mounting_angles(stated.vehicle_from_camera);
  const MountingAngles to = mounting_angles(fitted.vehicle_from_camera);
  suspect.parameter = angle_changed(from, to);
  suspect.stated = value_of(from, suspect.parameter);
  suspect.expected =
      suspect.stated + wrapped_angle(value_of(to, suspect.parameter) - suspect.stated);
  return suspect;
}

// The rig from which the search for a camera's angle starts: with the camera where most of its tags
// put it, if all else is as stated.
Rig start_for(const Survey& survey, const Rig& rig, const Drive& drive, std::size_t camera,
              const Trial& trial) {
  Rig start = rig;
  if (is_of_lens(trial.first) || trial.first < kFirstAngle) return start;
  Pose& pose = start.cameras[camera].vehicle_from_camera;
  const MountingAngles stated = mounting_angles(pose);
  Pose likely = pose;
  likely.rotation = likely_attitude(survey, rig, drive, camera);
  if (trial.count > 1) {
    pose = likely;
    return start;
  }
  const MountingAngles seen = mounting_angles(likely);
  MountingAngles angles = stated;
  const RigParameter changed = angle_changed(stated, seen);
  // The axis that is tried turns the camera about its own x, y or z: pitch, yaw or roll.
  constexpr std::array<RigParameter, 3> kAngle{RigParameter::pitch, RigParameter::yaw,
                                               RigParameter::roll};
  if (changed != kAngle[trial.first - kFirstAngle]) return start;
  (changed == RigParameter::yaw     ? angles.yaw
   : changed == RigParameter::pitch ? angles.pitch
                                    : angles.roll) = value_of(seen, changed);
  pose = vehicle_from_camera(angles.yaw, angles.pitch, angles.roll, pose.translation);
  return start;
}

// Whether it explains most rows, and the rig as stated does not.
bool is_better(const Explained& with, const Stated& as_stated) {
  constexpr double kLeastShare = 0.7;
  const auto rows = static_cast<double>(as_stated.drive->stations.size());
  const auto least = std::max(kLeastRows, static_cast<std::size_t>(std::ceil(kLeastShare * rows)));
  if (with.rows < least) return false;
  return with.rows >= 2 * as_stated.rows() ||
         (as_stated.is_beaten_by(with) && fits_well(with, as_stated.excess));
}

struct Candidate {
  RigSuspect suspect;
  double chi_square = 0;  // including the cost of further parameters
};

// Of chi-square: a further parameter, and its odds. One value of one camera has no such cost.
constexpr double kOfParameter = 7;

// Takes what explains the rows much better than the rig as stated, if it surely differs from that.
// `further`: cost of further parameters; `stated_sigma`: of the parameter.
void take_if_sure(const Explained& with, RigSuspect suspect, double stated_sigma, double further,
                  std::vector<Candidate>& candidates) {
  constexpr double kSurely = 4;  // standard deviations
  const double sigma = std::hypot(suspect.sigma, stated_sigma);
  if (std::abs(suspect.expected - suspect.stated) < kSurely * sigma) return;
  suspect.rows_explained = with.rows;
  candidates.push_back({std::move(suspect), with.chi_square + further});
}

void try_cameras(const Survey& survey, const Rig& rig, const Stated& as_stated,
                 std::vector<Candidate>& result) {
  constexpr double kOfTurn = 2 * kOfParameter;
  const Drive& drive = *as_stated.drive;
  const std::vector<ParameterSigmas> stated = stated_sigmas(rig);
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (!sees_anything(drive, camera)) continue;
    for (const Trial& trial : kTrials) {
      std::vector<ParameterSigmas> sigmas = stated;
      for (std::size_t i = trial.first; i < trial.first + trial.count; ++i) {
        sigmas[camera][i] = free_sigma(i);
      }
      const auto with = explained(survey, drive, start_for(survey, rig, drive, camera, trial),
                                  sigmas, as_stated.excess);
      if (!with || !is_better(*with, as_stated)) continue;
      take_if_sure(*with, suspect_of(rig, camera, trial, *with), stated[camera][trial.first],
                   trial.count > 1 ? kOfTurn : 0, result);
    }
  }
}

// All cameras' lenses, each by itself: an image size or a unit that is wrong for all, or lenses
// whose distortion is not stated. Not where one camera's alone explains as many rows.
void try_lenses(const Survey& survey, const Rig& rig, const Stated& as_stated,
                std::size_t parameter, std::vector<Candidate>& result) {
  const std::vector<ParameterSigmas> stated = stated_sigmas(rig);
  std::vector<ParameterSigmas> sigmas = stated;
  for (ParameterSigmas& camera : sigmas) camera[parameter] = free_sigma(parameter);
  const auto with = explained(survey, *as_stated.drive, rig, sigmas, as_stated.excess);
  if (!with || !is_better(*with, as_stated)) return;
  RigSuspect suspect{"", parameter_of_lens(parameter)};
  const auto is_enough = [&](const Candidate& one) {
    return one.suspect.parameter == suspect.parameter && one.suspect.rows_explained >= with->rows;
  };
  if (std::ranges::any_of(result, is_enough)) return;
  double stated_sigma = 0;
  double cameras = 0;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    if (!sees_anything(*as_stated.drive, i)) continue;
    const auto place = static_cast<Eigen::Index>(with->fit.layout.places[i][parameter]);
    const double variance = with->fit.adjustment.calibration_covariance(place, place);
    const RigSuspect one = suspect_lens(rig.cameras[i], with->fit.rig.cameras[i], parameter);
    suspect.stated += one.stated;
    suspect.expected += one.expected;
    suspect.sigma = std::max(suspect.sigma, std::sqrt(variance));
    stated_sigma = std::max(stated_sigma, stated[i][parameter]);
    ++cameras;
  }
  suspect.stated /= cameras;
  suspect.expected /= cameras;
  take_if_sure(*with, suspect, stated_sigma, kOfParameter * (cameras - 1), result);
}

// All plates larger or smaller than their template, as a print that was scaled, or another
// template; or turned alike, as on walls that lean.
void try_plates(const Survey& survey, const Rig& rig, const Stated& as_stated,
                RigParameter parameter, std::vector<Candidate>& result) {
  const std::vector<ParameterSigmas> sigmas = stated_sigmas(rig);
  std::map<double, double> known;
  const auto chi_square = [&](double value) {
    const auto [entry, is_new] = known.try_emplace(value, std::numeric_limits<double>::infinity());
    if (!is_new) return entry->second;
    if (const auto fit =
            fit_drive(survey, plates_changed(parameter, value, *as_stated.drive), rig, sigmas)) {
      entry->second = fit->adjustment.chi_square;
    }
    return entry->second;
  };
  const auto best = best_value(chi_square, as_stated.decisive_gain());
  if (!best) return;
  constexpr double kAside = 0.002;
  const Drive drive = plates_changed(parameter, *best, *as_stated.drive);
  const auto fit = fit_drive(survey, drive, rig, sigmas);
  const auto with = explained(survey, drive, rig, sigmas, as_stated.excess);
  const double rise =
      chi_square(*best - kAside) + chi_square(*best + kAside) - 2 * chi_square(*best);
  if (!fit || !with || !is_better(*with, as_stated) || !(rise > 0)) return;
  const bool is_size = parameter == RigParameter::plate_size;
  RigSuspect suspect{"", parameter, is_size ? 1.0 : 0.0, is_size ? std::exp(*best) : *best};
  suspect.sigma = std::sqrt(2 * usual_excess(*fit, drive) / rise) * kAside;
  // A turn that all plates have in common moves positions of two to four tags by more than three of
  // their standard deviations from twice the stated one on.
  const double stated_sigma = is_of_attitudes(suspect) ? survey.angle_sigma / 2 : 0;
  take_if_sure(*with, suspect, stated_sigma, kOfParameter, result);
}

// The survey's positions are not those of P but of another point of each plate.
void try_points(const Survey& survey, const Rig& rig, const Stated& as_stated,
                std::vector<Candidate>& result) {
  for (const MeasuredPoint& point : points_besides_p(survey.tag_template)) {
    Drive drive = *as_stated.drive;
    for (SightedPlate& plate : drive.plates) {
      plate.world_from_plate = plate_measured_at(point, survey, plate.side, plate.world_from_plate);
    }
    const auto with =
        explained(survey, std::move(drive), rig, stated_sigmas(rig), as_stated.excess);
    if (!with || !is_better(*with, as_stated) || !fits_well(*with, as_stated.excess)) continue;
    RigSuspect suspect{"", RigParameter::plate_point, 0, std::hypot(point.right, point.down)};
    suspect.shift.head<2>() = Eigen::Vector2d(point.right, -point.down);
    suspect.point = point;
    take_if_sure(*with, suspect, survey.sigma, kOfParameter, result);
  }
}

// Rigs, and plates of another size, attitude or point, that explain the rows much better than the
// rig as stated.
std::vector<Candidate> candidates(const Survey& survey, const Rig& rig, const Stated& as_stated) {
  std::vector<Candidate> result;
  try_cameras(survey, rig, as_stated, result);
  for (const std::size_t parameter : {kFocal, kDistortion}) {
    try_lenses(survey, rig, as_stated, parameter, result);
  }
  try_points(survey, rig, as_stated, result);
  for (const RigParameter parameter : kCommonToPlates) {
    try_plates(survey, rig, as_stated, parameter, result);
  }
  return result;
}

// A yaw as the rig file states it: for level cameras that look to a side as their alpha.
struct NamedYaw {
  std::string name;
  double sign = 1;
  double offset = 0;

  double of(double yaw) const { return offset + sign * yaw; }
};

NamedYaw named_yaw(const RigCamera& camera) {
  const MountingAngles angles = mounting_angles(camera.vehicle_from_camera);
  const bool level = std::abs(angles.pitch) < 1e-9 && std::abs(angles.roll) < 1e-9;
  if (!camera.side || !level) return {to_string(RigParameter::yaw)};
  return {"alpha", *camera.side == Side::left ? -1.0 : 1.0, std::numbers::pi / 2};
}

int decimals_of(const RigSuspect& suspect) { return degrees(suspect.sigma) < 0.01 ? 3 : 2; }

// "plates of the left wall that lean back by 2.00 +-0.02 degrees against the survey"
std::string words_for_turned_plates(const RigSuspect& suspect) {
  const bool is_slope = suspect.parameter == RigParameter::plate_slope;
  const bool is_forward = suspect.expected > 0;
  return fmt::format("plates of {} that {} by {:.{}f} +-{:.{}f} degrees against the survey",
                     suspect.parameter == RigParameter::left_plate_tilt    ? "the left wall"
                     : suspect.parameter == RigParameter::right_plate_tilt ? "the right wall"
                                                                           : "both walls",
                     is_slope ? (is_forward ? "rise along the drive" : "fall along the drive")
                              : (is_forward ? "lean forward" : "lean back"),
                     std::abs(degrees(suspect.expected)), decimals_of(suspect),
                     degrees(suspect.sigma), decimals_of(suspect));
}

// "172 mm to the left and 84 mm up": the way back.
std::string way_in_words(const Eigen::Vector3d& shift) {
  const Eigen::Vector3d mm = -1000 * shift;
  std::vector<std::string> parts;
  if (std::abs(mm.x()) >= 0.5) {
    parts.push_back(
        fmt::format("{:.0f} mm to the {}", std::abs(mm.x()), mm.x() > 0 ? "right" : "left"));
  }
  if (std::abs(mm.y()) >= 0.5) {
    parts.push_back(fmt::format("{:.0f} mm {}", std::abs(mm.y()), mm.y() > 0 ? "up" : "down"));
  }
  return fmt::format("{}", fmt::join(parts, " and "));
}

// "left: alpha 40.00 +-0.01 degrees in place of 35.00"
std::string words_for(const RigSuspect& suspect, const Rig& rig) {
  if (is_of_attitudes(suspect)) return words_for_turned_plates(suspect);
  if (suspect.parameter == RigParameter::plate_point) {
    return fmt::format("plates that were surveyed at {} in place of P", suspect.point.name);
  }
  if (suspect.parameter == RigParameter::distortion) {
    return fmt::format(
        "{}: a first coefficient of distortion of {:.3f} +-{:.3f} in place of {:.3f}",
        suspect.camera.empty() ? "the lenses of all cameras" : suspect.camera, suspect.expected,
        std::max(0.001, suspect.sigma), suspect.stated);
  }
  if (suspect.camera.empty()) {
    const bool is_size = suspect.parameter == RigParameter::plate_size;
    return fmt::format("{} {:.4f} +-{:.4f} times {}",
                       is_size ? "plates" : "focal lengths of all cameras", suspect.expected,
                       std::max(1e-4, suspect.sigma),
                       is_size ? "as large as the template says" : "the stated ones");
  }
  const RigCamera& camera = *find_camera(rig, suspect.camera);
  if (suspect.parameter == RigParameter::focal) {
    return fmt::format("{}: a focal length of {:.1f} +-{:.1f} pixels in place of {:.1f}",
                       suspect.camera, suspect.expected * camera.camera.fx,
                       suspect.sigma * camera.camera.fx, camera.camera.fx);
  }
  if (suspect.parameter == RigParameter::position) {
    const Eigen::Vector3d mm = 1000 * suspect.shift;
    const bool is_along = std::abs(mm.x()) > 5 * std::hypot(mm.y(), mm.z());
    return fmt::format(
        "{}: a place {:.0f} +-{:.0f} mm from the stated one (by {:+.0f} forward, {:+.0f} to the "
        "left, {:+.0f} up{})",
        suspect.camera, 1000 * suspect.expected, std::max(1.0, 1000 * suspect.sigma), mm.x(),
        mm.y(), mm.z(), is_along ? "; or photos that are not of one moment: `delay`" : "");
  }
  const int decimals = decimals_of(suspect);
  if (suspect.parameter == RigParameter::turn) {
    return fmt::format(
        "{}: a turn by {:.{}f} +-{:.{}f} degrees (to yaw {:.2f}, pitch {:.2f}, "
        "roll {:.2f})",
        suspect.camera, degrees(suspect.expected), decimals, degrees(suspect.sigma), decimals,
        degrees(suspect.mounting.yaw), degrees(suspect.mounting.pitch),
        degrees(suspect.mounting.roll));
  }
  NamedYaw named{to_string(suspect.parameter)};
  if (suspect.parameter == RigParameter::yaw) named = named_yaw(camera);
  return fmt::format("{}: {} {:.{}f} +-{:.{}f} degrees in place of {:.2f}", suspect.camera,
                     named.name, degrees(named.of(suspect.expected)), decimals,
                     degrees(suspect.sigma), decimals, degrees(named.of(suspect.stated)));
}

// "; if so, add -2.0 degrees to `tags.tilt`, ...": what the survey is to state.
std::string remedy_of(const RigSuspect& suspect) {
  if (suspect.parameter == RigParameter::plate_point) {
    return fmt::format(
        "; if so, move every P by {}, as seen by who faces the plate (`tagsmith new --from` does "
        "it: --point {}), or measure P, the inner top left corner of its frame",
        way_in_words(suspect.shift), suspect.point.option);
  }
  if (suspect.parameter == RigParameter::distortion) {
    return "; a lens bends straight lines, and its calibration says how (`tagsmith calibrate`)";
  }
  if (!is_of_attitudes(suspect)) return "";
  const double angle = degrees(suspect.expected);
  const char* wall = suspect.parameter == RigParameter::left_plate_tilt    ? " of the left wall"
                     : suspect.parameter == RigParameter::right_plate_tilt ? " of the right wall"
                                                                           : "";
  const std::string turn =
      suspect.parameter == RigParameter::plate_slope
          ? fmt::format(
                "{:+.1f} degrees to the left wall's `tags.roll` and {:+.1f} to the right wall's, "
                "and "
                "to each `roll`",
                -angle, angle)
          : fmt::format("{:+.1f} degrees to `tags.tilt`{}, and to each `tilt`", angle, wall);
  return fmt::format("; if so, add {} that tags of `placed` state", turn);
}

// The tilt of plates where the survey says nothing of it, or that plates hang exactly.
void take_scatter(const Survey& survey, const Rig& rig, Drive& drive) {
  if (survey.angle_sigma > 0 && survey.states_angle_sigma) return;
  const double sigma =
      attitude_scatter({&rig, drive.plates, drive.stations}, ComparedPlates::of_picture);
  for (SightedPlate& plate : drive.plates)
    plate.survey_variance.tail<3>().setConstant(sigma * sigma);
}

// The best of the candidates, and those that are as likely: they explain as many rows, with a
// chi-square that exceeds the best's by less than chance does once in a hundred.
std::vector<RigSuspect> likeliest(std::vector<Candidate> found, double excess) {
  constexpr double kAsLikely = 9.2;
  if (found.empty()) return {};
  std::ranges::sort(found, {}, &Candidate::chi_square);
  const auto rows = [](const Candidate& candidate) { return candidate.suspect.rows_explained; };
  const Candidate best = *std::ranges::max_element(found, {}, rows);
  std::vector<RigSuspect> suspects;
  for (const Candidate& candidate : found) {
    const bool as_likely = rows(candidate) == rows(best) &&
                           candidate.chi_square < best.chi_square + excess * kAsLikely;
    if (as_likely) suspects.push_back(candidate.suspect);
  }
  return suspects;
}

// True when one plate that hangs anywhere explains the rows about as well as another rig does: then
// the plate is more likely to be wrong.
bool one_plate_explains(const Survey& survey, const Rig& rig, const Stated& as_stated,
                        double chi_square) {
  constexpr std::size_t kMostTried = 6;
  constexpr double kAnywhere = 1;  // metres, radians
  if (!as_stated.explained) return false;
  const auto& offsets = as_stated.explained->fit.adjustment.offsets;
  std::vector<std::size_t> worst;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    if (offsets[i]) worst.push_back(i);
  }
  std::ranges::sort(worst, std::ranges::greater{},
                    [&](std::size_t i) { return offsets[i]->chi_square; });
  if (worst.size() > kMostTried) worst.resize(kMostTried);
  return std::ranges::any_of(worst, [&](std::size_t plate) {
    Drive drive = *as_stated.drive;
    drive.plates[plate].survey_variance.setConstant(kAnywhere);
    const auto fit = fit_drive(survey, drive, rig, stated_sigmas(rig));
    return fit && fit->adjustment.chi_square - fit->heading_chi_square <
                      chi_square + as_stated.excess * kClearlyBetter;
  });
}

}  // namespace

bool is_of_plates(const RigSuspect& suspect) {
  return suspect.parameter >= RigParameter::plate_point;
}

bool is_of_attitudes(const RigSuspect& suspect) {
  return suspect.parameter > RigParameter::plate_size;
}

bool is_of_hanging(const RigSuspect& suspect) {
  return is_of_attitudes(suspect) || suspect.parameter == RigParameter::plate_point;
}

Survey with_plates_of(const RigSuspect& suspect, Survey survey) {
  if (suspect.parameter != RigParameter::plate_point) {
    return with_turned_plates(std::move(survey), suspect.parameter, suspect.expected);
  }
  return with_plates_measured_at(std::move(survey), suspect.point);
}

std::optional<RigSuspicion> suspect_rig(std::span<const Observation> rows, const Survey& survey,
                                        const Rig& rig) {
  const std::vector<Observation> compared = compared_rows(rows);
  Drive drive = drive_of(compared, survey, rig);
  if (drive.stations.size() < kLeastRows) return std::nullopt;
  take_scatter(survey, rig, drive);
  Stated as_stated{&drive, noise_of(survey, drive, rig), {}};
  as_stated.explained = explained(survey, drive, rig, stated_sigmas(rig), as_stated.excess);
  RigSuspicion suspicion;
  suspicion.rows = drive.stations.size();
  suspicion.by_one_camera = count_seeing(drive, rig) == 1;
  suspicion.rows_as_stated = as_stated.rows();
  if (2 * suspicion.rows_as_stated > suspicion.rows &&
      fits_well(*as_stated.explained, as_stated.excess)) {
    const auto any = explained(survey, drive, rig, any_sigmas(rig), as_stated.excess);
    if (!any || !as_stated.is_beaten_by(*any)) return std::nullopt;
  }
  const std::vector<Candidate> better = candidates(survey, rig, as_stated);
  if (better.empty()) return std::nullopt;
  const double least = std::ranges::min(better, {}, &Candidate::chi_square).chi_square;
  if (one_plate_explains(survey, rig, as_stated, least)) return std::nullopt;
  suspicion.suspects = likeliest(better, as_stated.excess);
  return suspicion;
}

const char* to_string(RigParameter parameter) {
  constexpr std::array kNames{"yaw",
                              "pitch",
                              "roll",
                              "turn",
                              "focal",
                              "distortion",
                              "position",
                              "plate_point",
                              "plate_size",
                              "plate_slope",
                              "plate_tilt",
                              "left_plate_tilt",
                              "right_plate_tilt"};
  static_assert(kNames.size() == static_cast<std::size_t>(RigParameter::right_plate_tilt) + 1);
  return kNames[static_cast<std::size_t>(parameter)];
}

std::string describe(const RigSuspicion& suspicion, const Rig& rig) {
  std::vector<std::string> words;
  for (const RigSuspect& suspect : suspicion.suspects) {
    words.push_back(words_for(suspect, rig));
    if (suspect.parameter == RigParameter::focal && suspicion.by_one_camera) {
      words.back() += ", or frames of other proportions than the template's,";
    }
  }
  const bool by_rows = 2 * suspicion.rows_as_stated <= suspicion.rows;
  const RigSuspect& likeliest = suspicion.suspects.front();
  return fmt::format("{} would explain {} of {} rows {}{}", fmt::join(words, ", or "),
                     likeliest.rows_explained, suspicion.rows,
                     by_rows ? fmt::format("({} as it is)", suspicion.rows_as_stated)
                     : is_of_plates(likeliest) ? "far better than the survey"
                                               : "far better than the rig",
                     remedy_of(likeliest));
}

std::string doubt_in_words(const RigSuspicion& suspicion, const Rig& rig) {
  const bool of_plates = std::ranges::all_of(suspicion.suspects, is_of_plates);
  return (of_plates ? "the plates are in doubt: " : "the rig is in doubt: ") +
         describe(suspicion, rig);
}

}  // namespace tagsmith::detail
