// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/joint_fix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tl/expected.hpp>

#include "decoder/localize/pose_search.hpp"
#include "decoder/localize/unchecked.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {

std::string name_of(const PlacedTag& tag, std::size_t survey, std::size_t home,
                    const std::vector<Survey>& surveys) {
  return survey == home ? tag.name : tag_of_survey(surveys[survey].name, tag.name);
}

// ---- The fit once the measurements that it uses are known.

namespace {

// A pose, and its covariance with everything that survey and rig call uncertain.
struct SettledFit {
  JointState state;
  VehicleCovariance covariance = VehicleCovariance::Zero();  // world axes, as of JointFit
  VehicleBudget budget;                                      // adds up to the covariance
  double chi_square = 0;
  int degrees_of_freedom = 0;
};

// A fit that may change the calibration spreads noise over it and gives ranges more weight; one
// that weighs corners by an error common to all edges no longer distinguishes the better corner.
// Where the same measurements agree with calibration and edges as stated (they would disagree more
// once in a thousand), the pose is the one from these; otherwise it is the fit's own. The
// covariance is that of the error about the pose: the fit's own, plus the square of the difference
// between the two poses, which is added to the calibration's part.
// Why: docs/decisions/0013-unstated-is-not-exact.md.
SettledFit settled(const JointProblem& problem, const JointFit& fit) {
  constexpr double kBorneOut = 3.1;  // of a normal value: once in a thousand
  SettledFit result{fit.state, fit.vehicle_covariance(), budget_of(problem, fit), fit.chi_square,
                    fit.degrees_of_freedom};
  const auto is_exact = [](const Sighting& sighting) { return sighting.by_edges.isZero(); };
  if (fit.state.calibration.size() == 0 && std::ranges::all_of(problem.sightings, is_exact)) {
    return result;
  }
  Rig as_stated = *problem.rig;
  for (RigCamera& camera : as_stated.cameras) camera.calibration_sigma = {};
  JointProblem exact = problem;
  exact.rig = &as_stated;
  exact.edges_weigh = false;
  const auto stated = fit_jointly(exact, fit.selection, fit.state.vehicle);
  if (!stated || stated->chi_square > chi_square_limit(stated->degrees_of_freedom, kBorneOut)) {
    return result;
  }
  const Eigen::Matrix<double, 6, 1> apart =
      pose_difference(fit.state.vehicle, stated->state.vehicle);
  const VehicleCovariance square = apart * apart.transpose();
  result.covariance += square;
  result.budget.calibration += square;
  result.state = stated->state;
  result.chi_square = stated->chi_square;
  result.degrees_of_freedom = stated->degrees_of_freedom;
  return result;
}

// ---- The method.

using Eigen::Vector3d;

// Why: docs/decisions/0009-position-consensus.md.
// The likelihoods of two poses of the same tags must differ by this much of -2 log: odds of 20 000.
constexpr double kClearlyBetterPose = 20;
// Standard deviations may be understated by a factor of two. A larger factor means a mistake, whose
// effect is no noise: positions by `bench wrong_world` were up to nine raised standard deviations
// off where a factor of three was allowed.
constexpr double kMostVarianceFactor = 4;
// Chi-square raises the covariance where right measurements exceed it once in a hundred (a normal
// value exceeds 2.33).
constexpr double kUnlikely = 2.33;

// --- the problem ---

struct NamedProblem {
  JointProblem problem;
  std::vector<const SeenTag*> seen;  // of each sighting
  const std::vector<Survey>* surveys = nullptr;

  const std::string& tag_name(std::size_t sighting) const {
    return problem.plates[problem.sightings[sighting].plate].name;
  }
};

SightedPlate plate_of(const SeenTag& seen, const Survey& survey) {
  SightedPlate plate = sighted_plate(seen.tag, survey);
  for (Eigen::Index axis = 0; seen.at_coded_place && axis < 3; ++axis) {
    const double resolution = survey.code.resolution[static_cast<std::size_t>(axis)];
    plate.coding_variance[axis] = resolution * resolution / 12;  // rounding is uniform
  }
  return plate;
}

// The tags of all surveys, for they are in one grid (check_one_grid). The tunnel is that of the
// survey `home`.
NamedProblem problem_for(const Observation& observation, const std::vector<Survey>& surveys,
                         std::size_t home, const Rig& rig) {
  NamedProblem named;
  named.surveys = &surveys;
  JointProblem& problem = named.problem;
  problem.rig = &rig;
  problem.tunnel = &surveys[home].tunnel;
  for (const SeenTag& seen : observation.tags) {
    const auto camera = camera_index(rig, seen.camera);
    if (!camera || !seen.seen_corners) continue;
    SightedPlate seen_plate = plate_of(seen, surveys[seen.survey]);
    seen_plate.name = name_of(seen.tag, seen.survey, home, surveys);
    const std::size_t plate = plate_index(problem.plates, std::move(seen_plate));
    problem.sightings.push_back(sighting_of(*seen.seen_corners, rig, *camera, plate));
    named.seen.push_back(&seen);
  }
  for (const RigRange& range : rig.ranges) {
    const auto measured = observation.ranges.find(range.name);
    if (measured == observation.ranges.end()) continue;
    problem.ranges.push_back({range.name, range.wall, measured->second, range.sigma});
  }
  return named;
}

// --- poses and votes ---

// Grid coordinates in metres and the heading in degrees.
std::string pose_text(const Grid& grid, const VehiclePose& vehicle) {
  const Vector3d position = grid_from_world(grid, vehicle.position);
  const double heading = wrapped_angle(grid_heading_from_world(grid, vehicle.heading));
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) heading {:.0f} degrees", position.x(), position.y(),
                     position.z(), degrees(heading));
}

std::string tags_text(const JointProblem& problem, const JointFit& fit) {
  std::vector<std::string> names;
  for (const auto& group : fit.rows.plates) names.push_back(problem.plates[group.plate].name);
  return fmt::format("{}", fmt::join(names, " "));
}

// How many of all tags and ranges that were measured agree with a fit and how many do not; those
// that fit no pose at all count as not agreeing.
struct Votes {
  std::size_t tags_for = 0;
  std::size_t tags_against = 0;
  std::size_t ranges_for = 0;
  std::size_t ranges_against = 0;

  bool is_majority() const {
    return tags_for > tags_against && tags_for + ranges_for > tags_against + ranges_against;
  }
};

Votes votes_on(const JointProblem& problem, const JointFit& fit) {
  std::set<std::size_t> seen;
  for (const Sighting& sighting : problem.sightings) seen.insert(sighting.plate);
  const std::size_t tags_for = plate_count(fit);
  const std::size_t ranges_for = fit.selection.ranges.size();
  return {tags_for, seen.size() - tags_for, ranges_for, problem.ranges.size() - ranges_for};
}

// Why the best candidate is not believed.
struct Doubt {
  std::string reason;
  bool contradiction = false;  // between tags: understated standard deviations may explain it
};

std::optional<Doubt> doubt_by_rivals(const JointProblem& problem, const PoseSearch& search,
                                     const Grid& grid) {
  const Candidate& best = search.candidates.front();
  const auto place = [&](const Candidate& candidate) {
    return pose_text(grid, candidate.fit.state.vehicle);
  };
  for (std::size_t i = 1; i < search.candidates.size(); ++i) {
    const Candidate& rival = search.candidates[i];
    if (plate_count(rival.fit) < plate_count(best.fit)) continue;
    if (plates_of(best.fit) == plates_of(rival.fit)) {
      if (rival.chi_square - best.chi_square > kClearlyBetterPose) continue;
      return Doubt{
          fmt::format("ambiguous: {} seen nearly from the front or from afar allows two "
                      "positions, {} and {}",
                      tags_text(problem, best.fit), place(best), place(rival))};
    }
    return Doubt{fmt::format("the tags contradict each other: {} put the vehicle at {}, {} at {}",
                             tags_text(problem, best.fit), place(best),
                             tags_text(problem, rival.fit), place(rival)),
                 true};
  }
  return std::nullopt;
}

// What speaks against a single tag: with a second one, stance and range would be outvoted.
std::optional<Doubt> doubt_of_only_tag(const JointProblem& problem, const JointFit& fit) {
  const std::string stance = unlikely_stance(problem, fit, kLoneStanceGate);
  if (stance.empty()) return std::nullopt;
  return Doubt{fmt::format("by the only tag, {}, {}", tags_text(problem, fit), stance)};
}

std::optional<Doubt> doubt_by_votes(const JointProblem& problem, const JointFit& fit,
                                    const Grid& grid) {
  const Votes votes = votes_on(problem, fit);
  if (votes.is_majority()) return std::nullopt;
  const std::string place = pose_text(grid, fit.state.vehicle);
  const std::string tags = tags_text(problem, fit);
  if (votes.tags_against == 0) {
    return Doubt{
        fmt::format("range and tag contradict each other, and nothing tells which is "
                    "wrong: {} puts the vehicle at {}",
                    tags, place)};
  }
  return Doubt{fmt::format("the tags contradict each other: {} put the vehicle at {}, and as much "
                           "that was measured does not fit there",
                           tags, place),
               true};
}

// Each photo counts once for where the vehicle was when it was taken, however many tags it shows: a
// camera may have repeated an older photo, or the run's list may name another row's.
std::optional<Doubt> doubt_by_photos(const NamedProblem& named, const JointFit& fit,
                                     const Grid& grid) {
  std::set<std::string> agreeing;
  for (const std::size_t i : fit.selection.sightings) agreeing.insert(named.seen[i]->camera);
  std::set<std::string> others, others_tags;
  for (std::size_t i = 0; i < named.seen.size(); ++i) {
    const SeenTag& seen = *named.seen[i];
    if (seen.is_part || agreeing.contains(seen.camera)) continue;
    others.insert(seen.camera);
    others_tags.insert(named.tag_name(i));
  }
  if (agreeing.size() > others.size()) return std::nullopt;
  return Doubt{
      fmt::format(
          "the photos contradict each other: {} of {} put the vehicle at {}, where {} of {} "
          "does not fit; the photos were not taken together, a camera is mounted otherwise "
          "than the rig says, or a tag hangs elsewhere",
          tags_text(named.problem, fit), fmt::join(agreeing, " and "),
          pose_text(grid, fit.state.vehicle), fmt::join(others_tags, " "),
          fmt::join(others, " and ")),
      true};
}

// How the tags of one survey together are displaced against those of the others, by the survey of
// which that is least likely; nothing where a fit uses tags of one.
struct SurveyShift {
  std::size_t survey = 0;
  CommonShift shift;
};

std::optional<SurveyShift> shift_between_surveys(const NamedProblem& named, const JointFit& fit) {
  std::map<std::size_t, std::vector<std::size_t>> plates;  // of each survey
  for (std::size_t i = 0; i < fit.rows.plates.size(); ++i) {
    plates[named.seen[fit.rows.plates[i].sightings.front()]->survey].push_back(i);
  }
  std::optional<SurveyShift> greatest;
  if (plates.size() < 2) return greatest;
  for (const auto& [survey, of_survey] : plates) {
    const CommonShift shift = common_shift(named.problem, fit, of_survey);
    if (!greatest || shift.chi_square > greatest->shift.chi_square) greatest = {survey, shift};
  }
  return greatest;
}

// A survey that is displaced as a whole is outvoted by no number of tags of another one: the tags
// of each agree with each other wherever it is.
std::optional<Doubt> doubt_by_surveys(const NamedProblem& named, const JointFit& fit,
                                      const Grid& grid) {
  std::set<std::size_t> agreeing;
  for (const std::size_t i : fit.selection.sightings) agreeing.insert(named.seen[i]->survey);
  for (std::size_t i = 0; i < named.seen.size(); ++i) {
    const SeenTag& seen = *named.seen[i];
    if (seen.is_part || agreeing.contains(seen.survey)) continue;
    return Doubt{
        fmt::format("the surveys contradict each other: {} put the vehicle at {}, where {} of "
                    "survey {} does not fit; are they in one grid, and do all plates hang where "
                    "they say?",
                    tags_text(named.problem, fit), pose_text(grid, fit.state.vehicle),
                    seen.tag.name, (*named.surveys)[seen.survey].name),
        true};
  }
  const auto apart = shift_between_surveys(named, fit);
  if (!apart || apart->shift.chi_square < kMostVarianceFactor * chi_square_limit(3, kUnlikely)) {
    return std::nullopt;
  }
  return Doubt{
      fmt::format("the surveys contradict each other: the tags of survey {} stand {:.3f} m "
                  "from where the others have them; are they in one grid?",
                  (*named.surveys)[apart->survey].name, apart->shift.shift.norm())};
}

std::optional<Doubt> doubt(const NamedProblem& named, const PoseSearch& search, const Grid& grid) {
  const JointProblem& problem = named.problem;
  const JointFit& best = search.candidates.front().fit;
  if (auto rival = doubt_by_rivals(problem, search, grid)) return rival;
  if (auto displaced = doubt_by_surveys(named, best, grid)) return displaced;
  if (auto outvoted = doubt_by_votes(problem, best, grid)) return outvoted;
  if (auto outvoted = doubt_by_photos(named, best, grid)) return outvoted;
  return plate_count(best) == 1 ? doubt_of_only_tag(problem, best) : std::nullopt;
}

// "the place of camera left".
std::string calibration_name(const Rig& rig, std::size_t parameter) {
  constexpr std::array kNames{"place",           "place",     "place",        "direction",
                              "direction",       "direction", "focal length", "principal point",
                              "principal point", "distortion"};
  static_assert(std::ssize(kNames) == kMotion);
  const CalibrationLayout layout = calibration_layout_of_moment(rig);
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const auto& places = layout.places[camera];
    const auto found = std::ranges::find(places, static_cast<int>(parameter));
    if (found == places.end()) continue;
    const auto place = static_cast<std::size_t>(found - places.begin());
    return fmt::format("the {} of camera {}",
                       place < kNames.size()                       ? kNames[place]
                       : static_cast<Eigen::Index>(place) < kDelay ? "rolling shutter"
                                                                   : "moment",
                       rig.cameras[camera].name);
  }
  return "the calibration";
}

// A camera that stands or looks elsewhere than the rig says, or has another lens, as far as all
// tags together show it: the fit absorbed part of this error, so the position is wrong, too.
std::optional<Doubt> doubt_by_calibration(const JointProblem& problem, const JointFit& fit,
                                          const Grid& grid) {
  constexpr double kGate = 4;  // one of twenty parameters is farther off once in 800 measurements
  const ParameterDifference greatest = greatest_calibration_difference(fit);
  if (greatest.sigmas < kGate) return std::nullopt;
  return Doubt{fmt::format(
      "{} put the vehicle at {}, but only where {} is {:.1f} standard deviations from what the rig "
      "says: does the rig's file differ from what is?",
      tags_text(problem, fit), pose_text(grid, fit.state.vehicle),
      calibration_name(*problem.rig, greatest.parameter), greatest.sigmas)};
}

// --- understated standard deviations ---

// A fit, and the factor of its covariance that explains its chi-square.
struct Believed {
  JointFit fit;
  double variance_factor = 1;
};

double variance_factor(const JointFit& fit) {
  const double limit = chi_square_limit(fit.degrees_of_freedom, kUnlikely);
  return fit.chi_square < limit ? 1 : fit.chi_square / fit.degrees_of_freedom;
}

// The factor with which the position without any one plate is within three standard deviations of
// the position with all plates.
double factor_for_any_plate(const JointFit& fit) {
  constexpr double kWithin = 3;
  const Vector3d variances = fit.covariance.diagonal().head<3>();
  double factor = 1;
  for (std::size_t i = 0; i < fit.rows.plates.size(); ++i) {
    const Vector3d shift = position_shift_without(fit, i);
    factor = std::max(factor,
                      shift.cwiseAbs2().cwiseQuotient(variances).maxCoeff() / (kWithin * kWithin));
  }
  return factor;
}

// All tags together, where they contradict each other by so little that standard deviations
// understated by one factor explain it.
std::optional<Believed> reconciled(const JointProblem& problem, const PoseSearch& search) {
  Selection all;
  all.sightings.resize(problem.sightings.size());
  std::iota(all.sightings.begin(), all.sightings.end(), std::size_t{0});
  auto tags = fit_jointly(problem, all, search.candidates.front().fit.state.vehicle);
  if (!tags) return std::nullopt;
  const double among_tags = factor_for_any_plate(*tags);
  auto candidate = with_ranges(problem, std::move(*tags));
  if (!candidate) return std::nullopt;
  const double factor = std::max(among_tags, variance_factor(candidate->fit));
  if (factor > kMostVarianceFactor || !votes_on(problem, candidate->fit).is_majority()) {
    return std::nullopt;
  }
  return Believed{std::move(candidate->fit), factor};
}

// The result of the search that is believed, or why none is.
tl::expected<Believed, std::string> judge(const NamedProblem& named, PoseSearch& search,
                                          const Grid& grid) {
  const JointProblem& problem = named.problem;
  if (const auto doubtful = doubt(named, search, grid)) {
    auto together = doubtful->contradiction ? reconciled(problem, search) : std::nullopt;
    const bool is_sound = together && !doubt_by_calibration(problem, together->fit, grid) &&
                          !doubt_by_surveys(named, together->fit, grid);
    if (is_sound) return std::move(*together);
    return tl::unexpected(doubtful->reason);
  }
  JointFit& fit = search.candidates.front().fit;
  if (const auto doubtful = doubt_by_calibration(problem, fit, grid)) {
    return tl::unexpected(doubtful->reason);
  }
  const double factor = variance_factor(fit);
  if (factor > kMostVarianceFactor) {
    return tl::unexpected(
        fmt::format("{} put the vehicle at {}, but what was measured fits no place: chi-square is "
                    "{:.0f}, expected {}; does the rig's or the survey's file differ from what is?",
                    tags_text(problem, fit), pose_text(grid, fit.state.vehicle), fit.chi_square,
                    fit.degrees_of_freedom));
  }
  return Believed{std::move(fit), factor};
}

// --- the fix ---

// Why a sighting does not agree: the plate stands elsewhere, or its corners do not fit a plate
// there.
std::string describe(const Disagreement& difference) {
  if (difference.shift_chi_square < chi_square_limit(3, kPoseShiftGate)) {
    return fmt::format(
        "its corners do not fit a plate at its place, by the other tags (chi-square {:.0f}, "
        "expected {})",
        difference.chi_square, difference.degrees_of_freedom);
  }
  return fmt::format("stands {:.3f} m from where the survey has it, by the other tags",
                     difference.shift.norm());
}

// Whether another sighting of the tag by the same camera, in the same place, is used.
bool is_used_twice(const NamedProblem& named, const JointFit& fit, std::size_t sighting) {
  constexpr double kSame = 0.5;  // pixels, at the corner P
  const SeenTag& seen = *named.seen[sighting];
  return std::ranges::any_of(fit.selection.sightings, [&](std::size_t used) {
    const SeenTag& other = *named.seen[used];
    return other.camera == seen.camera && named.tag_name(used) == named.tag_name(sighting) &&
           distance(other.seen_corners->corners[0], seen.seen_corners->corners[0]) < kSame;
  });
}

void list_dropped(Fix& fix, const NamedProblem& named, const PoseSearch& search,
                  const JointFit& fit) {
  const JointProblem& problem = named.problem;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (std::ranges::find(fit.selection.sightings, i) != fit.selection.sightings.end()) continue;
    const auto difference = disagreement(problem, fit, i);
    std::string reason = search.reasons[i];
    if (difference) reason = describe(*difference);
    if (reason.empty()) reason = "it cannot be seen from there";
    if (named.seen[i]->is_part) reason.insert(0, "a part of a tag, perhaps of another one: ");
    if (is_used_twice(named, fit, i)) reason = "was given twice, and counts once";
    fix.dropped.push_back({named.tag_name(i), named.seen[i]->camera, reason});
  }
  for (std::size_t i = 0; i < problem.ranges.size(); ++i) {
    if (std::ranges::find(fit.selection.ranges, i) != fit.selection.ranges.end()) continue;
    const WallRange& range = problem.ranges[i];
    const ObservedWall wall =
        observe_wall(problem.tunnel->centerline, wall_of(*problem.tunnel, range.wall),
                     fit.state.vehicle.position);
    fix.dropped.push_back(
        {range.name, "",
         fmt::format("{:.3f} m measured, {:.3f} m by the tags", range.distance, wall.distance)});
  }
}

void list_corners(Fix& fix, const NamedProblem& named, const JointState& state,
                  const Selection& selection) {
  const JointProblem& problem = named.problem;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    const auto predicted = predicted_pixels(problem, state, i);
    if (!predicted) continue;
    FittedCorners corners{named.seen[i]->camera, named.tag_name(i), {}, {}, true};
    corners.seen = named.seen[i]->seen_corners->corners;
    corners.is_part = named.seen[i]->is_part;
    for (std::size_t c = 0; c < 4; ++c) {
      const auto row = static_cast<Eigen::Index>(2 * c);
      corners.fitted[c] = {(*predicted)[row], (*predicted)[row + 1]};
    }
    const std::vector<std::size_t>& used = selection.sightings;
    corners.used = std::ranges::find(used, i) != used.end();
    fix.corners.push_back(std::move(corners));
  }
}

// Mirrors a world covariance into the grid: x and headings change their sign with the grid's hand.
PoseCovariance grid_covariance(const Grid& grid, const VehicleCovariance& in_world) {
  Eigen::Matrix<double, 6, 1> signs = Eigen::Matrix<double, 6, 1>::Ones();
  signs.head<3>() = grid_from_world(grid, Vector3d::Ones());
  signs[vehicle_parameter::kHeading] = grid_heading_from_world(grid, 1);
  return signs.asDiagonal() * in_world * signs.asDiagonal();
}

ErrorBudget grid_budget(const Grid& grid, const VehicleBudget& budget, double factor) {
  const auto part = [&](const VehicleCovariance& covariance) -> Eigen::Matrix3d {
    return factor * grid_covariance(grid, covariance).topLeftCorner<3, 3>();
  };
  return {part(budget.pixels), part(budget.edges),       part(budget.survey), part(budget.coding),
          part(budget.ranges), part(budget.calibration), part(budget.vehicle)};
}

// The note about mistakes that would not be noticed although they move the position by a decimetre
// or more; empty where there are none.
std::string unchecked_text(const std::vector<Unchecked>& unchecked) {
  constexpr double kWorthANote = 0.1;  // metres
  std::vector<std::string> parts;
  for (const Unchecked& one : unchecked) {
    if (one.metres >= kWorthANote) parts.push_back(to_string(one));
  }
  return parts.empty() ? std::string()
                       : fmt::format("nothing measured here would reveal that {} is not as stated",
                                     fmt::join(parts, ", or "));
}

// Fix::unconfirmed. All tags of a photo of another moment agree with each other, and so do those of
// all photos where all are of another moment, or mirrored top to bottom. A motion may rest on the
// same camera.
std::string objection_to_confirming(const Fix& fix, const JointProblem& problem,
                                    const JointFit& fit) {
  // What stands before a sensor makes its range shorter, and nothing makes it longer.
  for (const CheckedRange& range : fix.checked_ranges) {
    const bool is_used = std::ranges::find(fix.ranges, range.name) != fix.ranges.end();
    if (is_used || range.metres <= 0) continue;
    return fmt::format(
        "range {} reaches beyond the wall that the tags show: photos of another moment would go "
        "unnoticed",
        range.name);
  }
  std::set<std::string> cameras;
  for (const FittedCorners& seen : fix.corners) {
    if (seen.used) cameras.insert(seen.camera);
  }
  if (cameras.size() == 1 && fix.ranges.size() < fix.checked_ranges.size()) {
    return "one photo only, and a range contradicts it: a photo of another moment would go "
           "unnoticed";
  }
  return unlikely_stance(problem, fit, kLoneStanceGate);
}

void add_notes(Fix& fix) {
  if (fix.tags.size() == 1) fix.notes.emplace_back(kOneTagOnly);
  if (!fix.unconfirmed.empty()) fix.notes.push_back(fix.unconfirmed);
  for (const FittedCorners& seen : fix.corners) {
    if (!seen.used || !seen.is_part) continue;
    fix.notes.push_back(
        fmt::format("only a part of {} was read in camera {}", seen.tag, seen.camera));
  }
  if (fix.variance_factor > 1) {
    fix.notes.push_back(
        fmt::format("the measurements agree only to {:.1f} times their standard deviations, by "
                    "which the position's were raised",
                    std::sqrt(fix.variance_factor)));
  }
  for (const Dropped& dropped : fix.dropped) {
    const std::string by = dropped.camera.empty() ? "" : " in camera " + dropped.camera;
    fix.notes.push_back(fmt::format("{}{} not used: {}", dropped.name, by, dropped.reason));
  }
  const std::string unchecked = unchecked_text(fix.unchecked);
  if (!unchecked.empty()) fix.notes.push_back(unchecked);
}

// Of two surveys that are displaced against each other it is unknown which is right, so the
// position may be off by as much as one moves it: of its square, the share that the tags' standard
// deviations do not explain, for which chi-square is expected to be 3.
void add_shift_between_surveys(const NamedProblem& named, const JointFit& fit,
                               SettledFit& settled_fit) {
  const auto apart = shift_between_surveys(named, fit);
  if (!apart || apart->shift.chi_square < 3) return;
  VehicleCovariance moved = VehicleCovariance::Zero();
  moved.topLeftCorner<3, 3>() =
      (1 - 3 / apart->shift.chi_square) * apart->shift.moved * apart->shift.moved.transpose();
  settled_fit.covariance += moved;
  settled_fit.budget.survey += moved;
}

void fill(Fix& fix, const NamedProblem& named, const PoseSearch& search, const Believed& believed,
          const Survey& survey) {
  const JointFit& fit = believed.fit;
  SettledFit settled_fit = settled(named.problem, fit);
  add_shift_between_surveys(named, fit, settled_fit);
  const Grid& grid = survey.grid;
  const VehiclePose& vehicle = settled_fit.state.vehicle;
  fix.tags.clear();
  for (const auto& group : fit.rows.plates) {
    fix.tags.push_back(named.problem.plates[group.plate].name);
  }
  for (const std::size_t i : fit.selection.ranges) {
    fix.ranges.push_back(named.problem.ranges[i].name);
  }
  for (std::size_t i = 0; i < named.problem.ranges.size(); ++i) {
    const RangeDifference difference = range_difference(named.problem, fit, i);
    fix.checked_ranges.push_back({named.problem.ranges[i].name, difference.metres,
                                  difference.sigmas / std::sqrt(believed.variance_factor)});
  }
  fix.position_in_grid = grid_from_world(grid, vehicle.position);
  fix.attitude = Attitude{wrapped_angle(grid_heading_from_world(grid, vehicle.heading)),
                          vehicle.pitch, vehicle.roll};
  fix.variance_factor = believed.variance_factor;
  fix.pose_covariance_in_grid = fix.variance_factor * grid_covariance(grid, settled_fit.covariance);
  fix.covariance_in_grid = fix.pose_covariance_in_grid->topLeftCorner<3, 3>();
  fix.budget = grid_budget(grid, settled_fit.budget, fix.variance_factor);
  fix.chi_square = settled_fit.chi_square;
  fix.degrees_of_freedom = settled_fit.degrees_of_freedom;
  fix.unchecked = unchecked_by(named.problem, fit, fix.variance_factor);
  list_dropped(fix, named, search, fit);
  list_corners(fix, named, settled_fit.state, fit.selection);
  fix.confirmations = static_cast<int>(fix.tags.size()) - 1;
  fix.unconfirmed = objection_to_confirming(fix, named.problem, fit);
  if (!fix.unconfirmed.empty()) fix.confirmations = 0;
  add_notes(fix);
}

// Why no tag allows a pose; a reason that several tags share is stated once.
std::string no_pose(const NamedProblem& named, const PoseSearch& search) {
  std::vector<std::string> reasons;
  std::vector<std::string> tags;
  for (std::size_t i = 0; i < named.seen.size(); ++i) {
    if (search.reasons[i].empty()) continue;
    const auto known = std::ranges::find(reasons, search.reasons[i]) - reasons.begin();
    const std::string& name = named.tag_name(i);
    if (const auto place = static_cast<std::size_t>(known); place < reasons.size()) {
      tags[place] += ", " + name;
    } else {
      reasons.push_back(search.reasons[i]);
      tags.push_back(name);
    }
  }
  if (reasons.empty()) return "no pose agrees with the tags";
  for (std::size_t i = 0; i < reasons.size(); ++i) reasons[i] = tags[i] + ": " + reasons[i];
  return fmt::format("{}", fmt::join(reasons, "; "));
}

// A range outside its sensor's limits is no measurement.
void drop_ranges_out_of_limits(const Rig& rig, JointProblem& problem, Fix& fix) {
  for (const RigRange& range : rig.ranges) {
    std::erase_if(problem.ranges, [&](const WallRange& measured) {
      if (measured.name != range.name) return false;
      if (measured.distance >= range.min && measured.distance <= range.max) return false;
      fix.dropped.push_back(
          {range.name, "",
           fmt::format("{} m, expected {} to {} m", measured.distance, range.min, range.max)});
      return true;
    });
  }
}

}  // namespace

Fix localize_by_tags(const Observation& observation, const std::vector<Survey>& surveys,
                     std::size_t home, const Rig& rig) {
  const Survey& survey = surveys[home];
  Fix fix;
  fix.survey = survey.name;
  NamedProblem named = problem_for(observation, surveys, home, rig);
  drop_ranges_out_of_limits(rig, named.problem, fix);
  for (const SightedPlate& plate : named.problem.plates) fix.tags.push_back(plate.name);
  PoseSearch search = search_poses(named.problem);
  if (search.candidates.empty()) {
    fix.reason = no_pose(named, search);
    return fix;
  }
  const auto believed = judge(named, search, survey.grid);
  if (believed) {
    fill(fix, named, search, *believed, survey);
  } else {
    fix.reason = believed.error();
  }
  return fix;
}

}  // namespace tagsmith::detail
