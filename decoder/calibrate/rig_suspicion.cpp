// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/rig_suspicion.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/calibrate/drive_fit.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

// The parameters that are tried, by their place among a camera's calibration parameters.
constexpr std::array<std::size_t, 4> kTriedParameters{3, 4, 5, 6};
constexpr std::size_t kFocal = 6;

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
// Rows of a long drive are taken evenly, for the fits take long.
std::vector<Observation> compared_rows(std::span<const Observation> rows) {
  constexpr std::size_t kMost = 40;
  constexpr std::size_t kEnough = 3;
  std::vector<Observation> chosen;
  for (const std::size_t least_tags : {2U, 1U}) {
    chosen.clear();
    std::ranges::copy_if(rows, std::back_inserter(chosen),
                         [&](const Observation& row) { return row.tags.size() >= least_tags; });
    if (chosen.size() >= kEnough) break;
  }
  if (chosen.size() <= kMost) return chosen;
  std::vector<Observation> some;
  for (std::size_t i = 0; i < kMost; ++i) some.push_back(chosen[i * chosen.size() / kMost]);
  return some;
}

struct Explained {
  std::size_t rows = 0;
  double chi_square = 0;
  DriveFit fit;
};

// How many rows fit whole once all that does not fit is left out.
std::optional<Explained> explained(const Survey& survey, Drive drive, const Rig& start,
                                   const std::vector<ParameterSigmas>& sigmas, double excess) {
  std::vector<std::size_t> whole;
  for (const Station& station : drive.stations) whole.push_back(station.sightings.size());
  const std::vector<const Observation*> rows = drive.rows;
  while (!drive.stations.empty()) {
    auto fit = fit_drive(survey, drive, start, sigmas);
    if (!fit) return std::nullopt;
    const std::size_t before = count_sightings(drive);
    leave_out_worst(*fit, drive, excess);
    if (count_sightings(drive) < before) continue;
    // A vehicle that stands askew in every row is no evidence against a camera.
    Explained result{0, fit->adjustment.chi_square - fit->heading_chi_square, std::move(*fit)};
    for (std::size_t s = 0; s < drive.stations.size(); ++s) {
      const auto row = std::ranges::find(rows, drive.rows[s]) - rows.begin();
      const bool all = drive.stations[s].sightings.size() == whole[static_cast<std::size_t>(row)];
      if (all) ++result.rows;
    }
    return result;
  }
  return std::nullopt;
}

// What the corners' chi-square is where the cameras may look anywhere, with any lens.
double noise_of(const Survey& survey, const Drive& drive, const Rig& start) {
  std::vector<ParameterSigmas> sigmas = stated_sigmas(start);
  for (ParameterSigmas& camera : sigmas) {
    for (const std::size_t i : kTriedParameters) camera[i] = i == kFocal ? kFreeFocal : kFreeAngle;
  }
  const auto fit = fit_drive(survey, drive, start, sigmas);
  return fit ? usual_excess(*fit, drive) : 1;
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

RigSuspect suspect_of(const Rig& rig, std::size_t camera, std::size_t parameter,
                      const Explained& with) {
  const RigCamera& stated = rig.cameras[camera];
  const RigCamera& fitted = with.fit.rig.cameras[camera];
  const auto place = static_cast<Eigen::Index>(with.fit.layout.places[camera][parameter]);
  RigSuspect suspect{stated.name, RigParameter::focal, 1, fitted.camera.fx / stated.camera.fx};
  suspect.sigma = std::sqrt(with.fit.adjustment.calibration_covariance(place, place));
  suspect.rows_explained = with.rows;
  if (parameter == kFocal) return suspect;
  const MountingAngles from = mounting_angles(stated.vehicle_from_camera);
  const MountingAngles to = mounting_angles(fitted.vehicle_from_camera);
  suspect.parameter = angle_changed(from, to);
  suspect.stated = value_of(from, suspect.parameter);
  suspect.expected =
      suspect.stated + wrapped_angle(value_of(to, suspect.parameter) - suspect.stated);
  return suspect;
}

// The rig from which the search for a camera's angle starts: where most of its tags have it, were
// all else as stated.
Rig start_for(const Survey& survey, const Rig& rig, const Drive& drive, std::size_t camera,
              std::size_t parameter) {
  Rig start = rig;
  if (parameter == kFocal) return start;
  Pose& pose = start.cameras[camera].vehicle_from_camera;
  const MountingAngles stated = mounting_angles(pose);
  Pose likely = pose;
  likely.rotation = likely_attitude(survey, rig, drive, camera);
  const MountingAngles seen = mounting_angles(likely);
  MountingAngles angles = stated;
  const RigParameter changed = angle_changed(stated, seen);
  // The axis that is tried turns the camera about its own x, y or z: pitch, yaw or roll.
  constexpr std::array<RigParameter, 3> kAngle{RigParameter::pitch, RigParameter::yaw,
                                               RigParameter::roll};
  if (changed != kAngle[parameter - kTriedParameters[0]]) return start;
  (changed == RigParameter::yaw     ? angles.yaw
   : changed == RigParameter::pitch ? angles.pitch
                                    : angles.roll) = value_of(seen, changed);
  pose = vehicle_from_camera(angles.yaw, angles.pitch, angles.roll, pose.translation);
  return start;
}

struct Candidate {
  RigSuspect suspect;
  double chi_square = 0;
};

std::vector<Candidate> candidates(const Survey& survey, const Rig& rig, const Drive& drive,
                                  double excess) {
  constexpr double kSurely = 4;  // standard deviations
  const std::vector<ParameterSigmas> stated = stated_sigmas(rig);
  std::vector<Candidate> result;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (!sees_anything(drive, camera)) continue;
    for (const std::size_t parameter : kTriedParameters) {
      std::vector<ParameterSigmas> sigmas = stated;
      sigmas[camera][parameter] = parameter == kFocal ? kFreeFocal : kFreeAngle;
      const auto with = explained(survey, drive, start_for(survey, rig, drive, camera, parameter),
                                  sigmas, excess);
      if (!with) continue;
      const RigSuspect suspect = suspect_of(rig, camera, parameter, *with);
      const double sigma = std::hypot(suspect.sigma, stated[camera][parameter]);
      if (std::abs(suspect.expected - suspect.stated) < kSurely * sigma) continue;
      result.push_back({suspect, with->chi_square});
    }
  }
  return result;
}

// "left: alpha 40.00 +-0.01 degrees in place of 35.00"
std::string words_for(const RigSuspect& suspect, const Rig& rig) {
  const RigCamera& camera = *find_camera(rig, suspect.camera);
  if (suspect.parameter == RigParameter::focal) {
    return fmt::format("{}: a focal length of {:.1f} +-{:.1f} pixels in place of {:.1f}",
                       suspect.camera, suspect.expected * camera.camera.fx,
                       suspect.sigma * camera.camera.fx, camera.camera.fx);
  }
  const MountingAngles angles = mounting_angles(camera.vehicle_from_camera);
  const bool level = std::abs(angles.pitch) < 1e-9 && std::abs(angles.roll) < 1e-9;
  std::string name = to_string(suspect.parameter);
  double stated = suspect.stated;
  double expected = suspect.expected;
  if (suspect.parameter == RigParameter::yaw && camera.side && level) {
    const double side = *camera.side == Side::left ? 1 : -1;
    name = "alpha";
    stated = std::numbers::pi / 2 - side * stated;
    expected = std::numbers::pi / 2 - side * expected;
  }
  const int decimals = degrees(suspect.sigma) < 0.01 ? 3 : 2;
  return fmt::format("{}: {} {:.{}f} +-{:.{}f} degrees in place of {:.2f}", suspect.camera, name,
                     degrees(expected), decimals, degrees(suspect.sigma), decimals,
                     degrees(stated));
}

}  // namespace

std::optional<RigSuspicion> suspect_rig(std::span<const Observation> rows, const Survey& survey,
                                        const Rig& rig) {
  constexpr std::size_t kLeastRows = 3;
  constexpr double kLeastShare = 0.7;
  const std::vector<Observation> compared = compared_rows(rows);
  const Drive drive = drive_of(compared, survey, rig);
  if (drive.stations.size() < kLeastRows) return std::nullopt;
  const double excess = noise_of(survey, drive, rig);
  const auto as_stated = explained(survey, drive, rig, stated_sigmas(rig), excess);
  RigSuspicion suspicion;
  suspicion.rows = drive.stations.size();
  suspicion.by_one_camera = count_seeing(drive, rig) == 1;
  suspicion.rows_as_stated = as_stated ? as_stated->rows : 0;
  if (2 * suspicion.rows_as_stated > suspicion.rows) return std::nullopt;
  std::vector<Candidate> found = candidates(survey, rig, drive, excess);
  if (found.empty()) return std::nullopt;
  const auto best = std::ranges::max_element(found, {}, [](const Candidate& candidate) {
    return std::pair(candidate.suspect.rows_explained, -candidate.chi_square);
  });
  const std::size_t most = best->suspect.rows_explained;
  const auto needed =
      static_cast<std::size_t>(std::ceil(kLeastShare * static_cast<double>(suspicion.rows)));
  if (most < std::max(kLeastRows, needed) || most < 2 * suspicion.rows_as_stated) {
    return std::nullopt;
  }
  // As likely: as many rows, and a chi-square that chance tells from the best's once in a hundred.
  constexpr double kAsLikely = 9.2;
  const double least = best->chi_square;
  std::ranges::sort(found, {}, &Candidate::chi_square);
  for (const Candidate& candidate : found) {
    const bool as_likely = candidate.suspect.rows_explained == most &&
                           candidate.chi_square < least + excess * kAsLikely;
    if (as_likely) suspicion.suspects.push_back(candidate.suspect);
  }
  return suspicion;
}

const char* to_string(RigParameter parameter) {
  switch (parameter) {
    case RigParameter::yaw:
      return "yaw";
    case RigParameter::pitch:
      return "pitch";
    case RigParameter::roll:
      return "roll";
    case RigParameter::focal:
      break;
  }
  return "focal";
}

std::string describe(const RigSuspicion& suspicion, const Rig& rig) {
  std::vector<std::string> words;
  for (const RigSuspect& suspect : suspicion.suspects) {
    words.push_back(words_for(suspect, rig));
    if (suspect.parameter == RigParameter::focal && suspicion.by_one_camera) {
      words.back() += ", or frames of other proportions than the template's,";
    }
  }
  return fmt::format("{} would explain {} of {} rows ({} as it is)", fmt::join(words, ", or "),
                     suspicion.suspects.front().rows_explained, suspicion.rows,
                     suspicion.rows_as_stated);
}

}  // namespace tagsmith::detail
