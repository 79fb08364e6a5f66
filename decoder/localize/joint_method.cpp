// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/joint_method.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "decoder/localize/outside_tunnel.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith {
namespace {

using Eigen::Vector3d;

// A tag or range is believed while it disagrees less than right ones do once in 10 000 (a normal
// value exceeds 3.7) or, for all corners of a tag, whose noise has heavier tails, in a million.
constexpr double kShiftGate = 3.7;
constexpr double kCornersGate = 4.75;
constexpr double kRangeGate = 4.0;
// How far the vehicle may stand from what the rig says, standard deviations. With one tag alone the
// stance is nearly all there is to tell a wrong plate by.
constexpr double kStanceGate = 6.0;
constexpr double kLoneStanceGate = 4.0;

// The likelihoods of two poses of the same tags must differ by this much of -2 log: odds of 20 000.
constexpr double kClearlyBetter = 20;
// Solutions closer than this, in standard deviations, are one.
constexpr double kSame = 1.0;

// --- the problem ---

struct NamedProblem {
  JointProblem problem;
  std::vector<const SeenTag*> seen;  // of each sighting
};

SightedPlate plate_of(const SeenTag& seen, const Survey& survey) {
  SightedPlate plate = sighted_plate(seen.tag, survey);
  for (Eigen::Index axis = 0; seen.at_coded_place && axis < 3; ++axis) {
    const double resolution = survey.code.resolution[static_cast<std::size_t>(axis)];
    plate.coding_variance[axis] = resolution * resolution / 12;  // rounding is uniform
  }
  return plate;
}

std::size_t plate_index(JointProblem& problem, const SeenTag& seen, const Survey& survey) {
  const auto found = std::ranges::find(problem.plates, seen.tag.name, &SightedPlate::name);
  if (found != problem.plates.end()) {
    return static_cast<std::size_t>(found - problem.plates.begin());
  }
  problem.plates.push_back(plate_of(seen, survey));
  return problem.plates.size() - 1;
}

NamedProblem problem_for(const Observation& observation, std::size_t survey_index,
                         const Survey& survey, const Rig& rig) {
  NamedProblem named;
  JointProblem& problem = named.problem;
  problem.rig = &rig;
  problem.tunnel = &survey.tunnel;
  for (const SeenTag& seen : observation.tags) {
    if (seen.survey != survey_index || !seen.seen_corners) continue;
    const auto camera = std::ranges::find(rig.cameras, seen.camera, &RigCamera::name);
    if (camera == rig.cameras.end()) continue;
    const auto index = static_cast<std::size_t>(camera - rig.cameras.begin());
    problem.sightings.push_back(
        sighting_of(*seen.seen_corners, index, plate_index(problem, seen, survey)));
    named.seen.push_back(&seen);
  }
  for (const RigRange& range : rig.ranges) {
    const auto measured = observation.ranges.find(range.name);
    if (measured == observation.ranges.end()) continue;
    problem.ranges.push_back({range.name, range.wall, measured->second, range.sigma});
  }
  return named;
}

// --- single tags ---

// Whether the vehicle can stand like that, to `gate` standard deviations: empty, or why not.
std::string unlikely_stance(const JointProblem& problem, const JointFit& fit, double gate) {
  const auto row = fit.rows.vehicle_begin;
  const VehiclePose& vehicle = fit.state.vehicle;
  if (std::abs(fit.rows.residual[row]) > gate) {
    return fmt::format("the vehicle would be {:.2f} m from the height that the rig says",
                       std::abs(fit.rows.residual[row]) * problem.rig->height_sigma);
  }
  for (const Eigen::Index i : {1, 2}) {
    if (std::abs(fit.rows.residual[row + i]) > gate) {
      return fmt::format("the vehicle would have a pitch of {:.1f} and a roll of {:.1f} degrees",
                         degrees(vehicle.pitch), degrees(vehicle.roll));
    }
  }
  return {};
}

std::string impossible(const JointProblem& problem, const JointFit& fit) {
  const std::string outside = outside_tunnel(*problem.tunnel, fit.state.vehicle.position);
  return outside.empty() ? unlikely_stance(problem, fit, kStanceGate) : outside;
}

// What one sighting by itself allows.
struct SingleFits {
  std::vector<JointFit> fits;  // possible ones
  std::string reason;          // why there is none
};

double squared_distance(const JointFit& a, const JointFit& b) {
  VehicleCovariance spread = a.vehicle_covariance() + b.vehicle_covariance();
  Eigen::Matrix<double, 6, 1> difference;
  const VehiclePose& from = a.state.vehicle;
  const VehiclePose& to = b.state.vehicle;
  difference << to.position - from.position,
      std::remainder(to.heading - from.heading, 2 * std::numbers::pi), to.pitch - from.pitch,
      to.roll - from.roll;
  return difference.dot(spread.ldlt().solve(difference)) / 2;
}

bool is_same(const JointFit& a, const JointFit& b) {
  return squared_distance(a, b) < kSame * kSame;
}

// Fits each pose that the sighting allows. Raises its corners' covariance until the better one
// explains them.
SingleFits fit_single(JointProblem& problem, std::size_t index) {
  constexpr int kFree = 2;            // eight coordinates less six of the pose
  constexpr double kAsStated = 13.8;  // once in a thousand
  constexpr double kMostRaised = 100;
  SingleFits result;
  Sighting& sighting = problem.sightings[index];
  const auto starts = vehicle_poses_from(*problem.rig, problem.plates[sighting.plate], sighting);
  if (!starts) {
    result.reason = "its corners are no picture of a rectangle";
    return result;
  }
  const auto fit_all = [&] {
    std::vector<JointFit> fits;
    for (const VehiclePose& start : *starts) {
      auto fit = fit_jointly(problem, {{index}, {}}, start);
      if (!fit) continue;
      const auto same = [&](const JointFit& other) { return is_same(other, *fit); };
      if (std::ranges::none_of(fits, same)) fits.push_back(std::move(*fit));
    }
    std::ranges::sort(fits, {}, &JointFit::chi_square);
    return fits;
  };
  std::vector<JointFit> fits = fit_all();
  const auto corners_of = [&](const JointFit& fit) {
    return fit.rows.residual.head(fit.rows.ranges_begin).squaredNorm();
  };
  if (!fits.empty() && corners_of(fits.front()) > kAsStated) {
    const double raised = corners_of(fits.front()) / kFree;
    if (raised > kMostRaised) {
      result.reason = "its corners do not fit a plate of its template on its wall";
      return result;
    }
    sighting.covariance *= raised;
    fits = fit_all();
  }
  for (JointFit& fit : fits) {
    const std::string reason = impossible(problem, fit);
    if (reason.empty()) {
      result.fits.push_back(std::move(fit));
    } else if (result.reason.empty()) {
      result.reason = reason;
    }
  }
  if (fits.empty()) result.reason = "no pose explains its corners";
  if (!result.fits.empty()) result.reason.clear();
  return result;
}

// --- consensus ---

bool agrees(const Disagreement& difference) {
  return difference.shift_chi_square < chi_square_limit(3, kShiftGate) &&
         difference.chi_square < chi_square_limit(difference.degrees_of_freedom, kCornersGate);
}

std::size_t plate_count(const JointFit& fit) { return fit.rows.plates.size(); }

std::string shift_text(const Disagreement& difference) {
  return fmt::format("stands {:.3f} m from where the survey has it, by the other tags",
                     difference.shift.norm());
}

// The sightings that agree with the fit, those it rests on included. Of two of one plate in one
// image (a copy, a reflection) the one that agrees better.
std::vector<std::size_t> supporters(const JointProblem& problem, const JointFit& fit) {
  std::vector<std::size_t> chosen = fit.selection.sightings;
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (std::ranges::find(chosen, i) != chosen.end()) continue;
    const auto difference = disagreement(problem, fit, i);
    if (difference && agrees(*difference)) others.emplace_back(difference->chi_square, i);
  }
  std::ranges::sort(others);
  for (const auto& [chi_square, i] : others) {
    const auto& other = problem.sightings[i];
    const auto twin = [&](std::size_t j) {
      return problem.sightings[j].plate == other.plate &&
             problem.sightings[j].camera == other.camera;
    };
    if (std::ranges::none_of(chosen, twin)) chosen.push_back(i);
  }
  std::ranges::sort(chosen);
  return chosen;
}

std::size_t count_plates(const JointProblem& problem, const std::vector<std::size_t>& sightings) {
  std::set<std::size_t> plates;
  for (const std::size_t i : sightings) plates.insert(problem.sightings[i].plate);
  return plates.size();
}

// The plate of the fit that disagrees most with the rest; nothing when all agree.
std::optional<std::size_t> worst_plate(const JointProblem& problem, const JointFit& fit) {
  std::optional<std::size_t> worst;
  double most = 1;
  for (std::size_t i = 0; i < fit.rows.plates.size(); ++i) {
    const Disagreement difference = disagreement_within(problem, fit, i);
    const double excess = std::max(
        difference.shift_chi_square / chi_square_limit(3, kShiftGate),
        difference.chi_square / chi_square_limit(difference.degrees_of_freedom, kCornersGate));
    if (excess <= most) continue;
    most = excess;
    worst = i;
  }
  return worst;
}

// A pose and all that agrees with it.
struct Candidate {
  JointFit fit;
  double chi_square = 0;       // of the same measurements for all candidates: ranges capped
  bool contradictory = false;  // two plates, and they do not agree after all
};

// Fits the tags together, dropping the worst of those that disagree until all agree.
std::optional<Candidate> fit_agreeing(const JointProblem& problem,
                                      std::vector<std::size_t> sightings,
                                      const VehiclePose& start) {
  Candidate candidate;
  for (;;) {
    auto fit = fit_jointly(problem, {sightings, {}}, start);
    if (!fit) return std::nullopt;
    candidate.fit = std::move(*fit);
    if (plate_count(candidate.fit) < 2) return candidate;
    const auto worst = worst_plate(problem, candidate.fit);
    if (!worst) return candidate;
    if (plate_count(candidate.fit) == 2) {
      candidate.contradictory = true;
      return candidate;
    }
    const std::size_t plate = candidate.fit.rows.plates[*worst].plate;
    std::erase_if(sightings, [&](std::size_t i) { return problem.sightings[i].plate == plate; });
  }
}

// Takes in what agrees: tags that the first look missed, then ranges.
std::optional<Candidate> completed(const JointProblem& problem, Candidate candidate) {
  const std::vector<std::size_t> all = supporters(problem, candidate.fit);
  if (all.size() > candidate.fit.selection.sightings.size()) {
    auto larger = fit_agreeing(problem, all, candidate.fit.state.vehicle);
    if (larger && !larger->contradictory &&
        plate_count(larger->fit) >= plate_count(candidate.fit)) {
      candidate = std::move(*larger);
    }
  }
  Selection selection = candidate.fit.selection;
  double ranges_beyond = 0;
  for (std::size_t i = 0; i < problem.ranges.size(); ++i) {
    if (range_disagreement(problem, candidate.fit, i) < kRangeGate) {
      selection.ranges.push_back(i);
    } else {
      ranges_beyond += kRangeGate * kRangeGate;
    }
  }
  if (!selection.ranges.empty()) {
    auto fit = fit_jointly(problem, selection, candidate.fit.state.vehicle);
    if (!fit) return std::nullopt;
    candidate.fit = std::move(*fit);
  }
  candidate.chi_square = candidate.fit.chi_square + ranges_beyond;
  if (!impossible(problem, candidate.fit).empty()) return std::nullopt;
  return candidate;
}

// More tags first, then the better explanation.
bool is_better(const Candidate& a, const Candidate& b) {
  if (plate_count(a.fit) != plate_count(b.fit)) return plate_count(a.fit) > plate_count(b.fit);
  return a.chi_square < b.chi_square;
}

struct Search {
  std::vector<Candidate> candidates;  // distinct, the best first
  std::vector<std::string> reasons;   // of each sighting: why it allows no pose by itself
  bool contradictory = false;         // two tags that agree with neither's own pose
};

void add_candidate(Search& search, Candidate candidate) {
  for (Candidate& other : search.candidates) {
    if (!is_same(other.fit, candidate.fit)) continue;
    if (is_better(candidate, other)) other = std::move(candidate);
    return;
  }
  search.candidates.push_back(std::move(candidate));
}

// Largest pictures first: their poses are the surest.
std::vector<std::size_t> by_size(const JointProblem& problem) {
  std::vector<std::size_t> order(problem.sightings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto size = [&](std::size_t i) {
    const auto& pixels = problem.sightings[i].pixels;
    return -(pixels.segment<2>(4) - pixels.segment<2>(0)).norm();
  };
  std::ranges::stable_sort(order, {}, size);
  return order;
}

// Every pose that a sighting allows, with all that agrees with it. Ends early when all tags agree
// with the poses of one sighting: what else the others allow has fewer tags for it.
Search search_poses(JointProblem& problem) {
  Search search;
  search.reasons.resize(problem.sightings.size());
  for (const std::size_t index : by_size(problem)) {
    SingleFits single = fit_single(problem, index);
    search.reasons[index] = single.reason;
    bool all_agree = false;
    for (const JointFit& fit : single.fits) {
      const std::vector<std::size_t> agreeing = supporters(problem, fit);
      all_agree = all_agree || agreeing.size() == problem.sightings.size();
      const std::size_t most =
          search.candidates.empty() ? 0 : plate_count(search.candidates.front().fit);
      if (count_plates(problem, agreeing) < most) continue;
      auto candidate = fit_agreeing(problem, agreeing, fit.state.vehicle);
      if (candidate && candidate->contradictory) {
        search.contradictory = true;
        candidate = Candidate{fit};
      }
      if (candidate) candidate = completed(problem, std::move(*candidate));
      if (candidate) add_candidate(search, std::move(*candidate));
      std::ranges::stable_sort(search.candidates, is_better);
    }
    const bool settled =
        !search.candidates.empty() && all_agree &&
        search.candidates.front().fit.selection.sightings.size() == problem.sightings.size();
    if (settled) break;
  }
  return search;
}

// --- the fix ---

// Grid coordinates in metres and the heading in degrees.
std::string pose_text(const Grid& grid, const VehiclePose& vehicle) {
  const Vector3d position = grid_from_world(grid, vehicle.position);
  const double heading =
      std::remainder(grid_heading_from_world(grid, vehicle.heading), 2 * std::numbers::pi);
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) heading {:.0f} degrees", position.x(), position.y(),
                     position.z(), degrees(heading));
}

bool same_tags(const JointProblem& problem, const JointFit& a, const JointFit& b) {
  const auto plates = [&](const JointFit& fit) {
    std::set<std::size_t> result;
    for (const std::size_t i : fit.selection.sightings) result.insert(problem.sightings[i].plate);
    return result;
  };
  return plates(a) == plates(b);
}

std::string tags_text(const JointProblem& problem, const JointFit& fit) {
  std::vector<std::string> names;
  for (const auto& group : fit.rows.plates) names.push_back(problem.plates[group.plate].name);
  return fmt::format("{}", fmt::join(names, " "));
}

// Plates that by themselves allow a pose, and contradict this one.
std::size_t count_dissenters(const JointProblem& problem, const Search& search,
                             const JointFit& fit) {
  std::set<std::size_t> plates;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (search.reasons[i].empty()) plates.insert(problem.sightings[i].plate);
  }
  for (const auto& group : fit.rows.plates) plates.erase(group.plate);
  return plates.size();
}

// Why the best candidate is not to be believed; empty when it is.
std::string doubt(const JointProblem& problem, const Search& search, const Grid& grid) {
  const Candidate& best = search.candidates.front();
  const auto place = [&](const Candidate& candidate) {
    return pose_text(grid, candidate.fit.state.vehicle);
  };
  for (std::size_t i = 1; i < search.candidates.size(); ++i) {
    const Candidate& rival = search.candidates[i];
    if (plate_count(rival.fit) < plate_count(best.fit)) continue;
    if (same_tags(problem, best.fit, rival.fit)) {
      if (rival.chi_square - best.chi_square > kClearlyBetter) continue;
      return fmt::format(
          "ambiguous: {} seen nearly from the front or from afar allows two positions, {} and {}",
          tags_text(problem, best.fit), place(best), place(rival));
    }
    return fmt::format("the tags contradict each other: {} put the vehicle at {}, {} at {}",
                       tags_text(problem, best.fit), place(best), tags_text(problem, rival.fit),
                       place(rival));
  }
  const std::size_t against = count_dissenters(problem, search, best.fit);
  if (against >= plate_count(best.fit)) {
    return fmt::format(
        "the tags contradict each other: {} put the vehicle at {}, as many others elsewhere",
        tags_text(problem, best.fit), place(best));
  }
  if (search.contradictory && plate_count(best.fit) < 2) {
    return "the tags contradict each other, each by itself allows a position: " + place(best) +
           " by " + tags_text(problem, best.fit);
  }
  const bool alone = plate_count(best.fit) == 1;
  const std::string stance =
      alone ? unlikely_stance(problem, best.fit, kLoneStanceGate) : std::string();
  if (!stance.empty()) {
    return fmt::format("by the only tag, {}, {}", tags_text(problem, best.fit), stance);
  }
  if (alone && problem.ranges.size() > 1 && best.fit.selection.ranges.empty()) {
    return fmt::format("every range contradicts the only tag, {}, which puts the vehicle at {}",
                       tags_text(problem, best.fit), place(best));
  }
  return {};
}

void list_dropped(Fix& fix, const NamedProblem& named, const Search& search, const JointFit& fit) {
  const JointProblem& problem = named.problem;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    if (std::ranges::find(fit.selection.sightings, i) != fit.selection.sightings.end()) continue;
    const auto difference = disagreement(problem, fit, i);
    std::string reason = search.reasons[i];
    if (difference) reason = shift_text(*difference);
    if (reason.empty()) reason = "it cannot be seen from there";
    fix.dropped.push_back({named.seen[i]->tag.name, named.seen[i]->camera, reason});
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

void list_corners(Fix& fix, const NamedProblem& named, const JointFit& fit) {
  const JointProblem& problem = named.problem;
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    const auto predicted = predicted_pixels(problem, fit.state, i);
    if (!predicted) continue;
    FittedCorners corners{named.seen[i]->camera, named.seen[i]->tag.name, {}, {}, true};
    corners.seen = named.seen[i]->seen_corners->corners;
    for (std::size_t c = 0; c < 4; ++c) {
      const auto row = static_cast<Eigen::Index>(2 * c);
      corners.fitted[c] = {(*predicted)[row], (*predicted)[row + 1]};
    }
    const std::vector<std::size_t>& used = fit.selection.sightings;
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

ErrorBudget grid_budget(const Grid& grid, const VehicleBudget& budget) {
  const auto part = [&](const VehicleCovariance& covariance) -> Eigen::Matrix3d {
    return grid_covariance(grid, covariance).topLeftCorner<3, 3>();
  };
  return {part(budget.pixels), part(budget.survey),      part(budget.coding),
          part(budget.ranges), part(budget.calibration), part(budget.vehicle)};
}

void fill(Fix& fix, const NamedProblem& named, const Search& search, const Survey& survey) {
  const JointFit& fit = search.candidates.front().fit;
  const Grid& grid = survey.grid;
  const VehiclePose& vehicle = fit.state.vehicle;
  fix.tags.clear();
  for (const auto& group : fit.rows.plates) {
    fix.tags.push_back(named.problem.plates[group.plate].name);
  }
  for (const std::size_t i : fit.selection.ranges) {
    fix.ranges.push_back(named.problem.ranges[i].name);
  }
  fix.position_in_grid = grid_from_world(grid, vehicle.position);
  fix.attitude =
      Attitude{std::remainder(grid_heading_from_world(grid, vehicle.heading), 2 * std::numbers::pi),
               vehicle.pitch, vehicle.roll};
  fix.pose_covariance_in_grid = grid_covariance(grid, fit.vehicle_covariance());
  fix.covariance_in_grid = fix.pose_covariance_in_grid->topLeftCorner<3, 3>();
  fix.budget = grid_budget(grid, budget_of(named.problem, fit));
  fix.chi_square = fit.chi_square;
  fix.degrees_of_freedom = fit.degrees_of_freedom;
  list_dropped(fix, named, search, fit);
  list_corners(fix, named, fit);
  fix.confirmations = static_cast<int>(fix.tags.size()) - 1;
  if (fix.tags.size() == 1) fix.notes.emplace_back(kOneTagOnly);
  for (const Dropped& dropped : fix.dropped) {
    const std::string by = dropped.camera.empty() ? "" : " in camera " + dropped.camera;
    fix.notes.push_back(fmt::format("{}{} not used: {}", dropped.name, by, dropped.reason));
  }
}

// Why no tag allows a pose.
std::string no_pose(const NamedProblem& named, const Search& search) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < named.seen.size(); ++i) {
    if (search.reasons[i].empty()) continue;
    parts.push_back(named.seen[i]->tag.name + ": " + search.reasons[i]);
  }
  return parts.empty() ? "no pose agrees with the tags" : fmt::format("{}", fmt::join(parts, "; "));
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

Fix localize_in(const Observation& observation, const std::vector<Survey>& surveys,
                std::size_t survey_index, const Rig& rig) {
  const Survey& survey = surveys[survey_index];
  Fix fix;
  fix.survey = survey.name;
  NamedProblem named = problem_for(observation, survey_index, survey, rig);
  drop_ranges_out_of_limits(rig, named.problem, fix);
  for (const SeenTag* seen : named.seen) {
    if (std::ranges::find(fix.tags, seen->tag.name) == fix.tags.end()) {
      fix.tags.push_back(seen->tag.name);
    }
  }
  const Search search = search_poses(named.problem);
  if (search.candidates.empty()) {
    fix.reason = no_pose(named, search);
    return fix;
  }
  fix.reason = doubt(named.problem, search, survey.grid);
  if (fix.reason.empty()) fill(fix, named, search, survey);
  return fix;
}

// The surveys that have a tag with corners in the observation.
std::vector<std::size_t> surveys_seen(const Observation& observation) {
  std::set<std::size_t> seen;
  for (const SeenTag& tag : observation.tags) {
    if (tag.seen_corners) seen.insert(tag.survey);
  }
  return {seen.begin(), seen.end()};
}

Fix without_tags(const Observation& observation) {
  Fix fix;
  for (const SeenTag& seen : observation.tags) fix.tags.push_back(seen.tag.name);
  fix.reason = observation.tags.empty()
                   ? "no tag was seen"
                   : "only distances to tags were measured, which --method paper can use";
  return fix;
}

// Of fixes by the tags of different surveys, the one that rests on most tags.
Fix choose(std::vector<Fix> fixes) {
  const auto rank = [](const Fix& fix) {
    return fix.position_in_grid ? static_cast<int>(fix.tags.size()) : 0;
  };
  std::ranges::stable_sort(fixes, std::ranges::greater{}, rank);
  Fix best = std::move(fixes.front());
  if (fixes.size() < 2) return best;
  if (rank(fixes[1]) > 0 && rank(fixes[1]) == rank(best)) {
    Fix none;
    none.reason = fmt::format("as many tags of survey {} as of survey {} were seen", best.survey,
                              fixes[1].survey);
    return none;
  }
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    best.notes.push_back(fmt::format("tags of survey {} not used: {}", fixes[i].survey,
                                     fmt::join(fixes[i].tags, " ")));
  }
  return best;
}

}  // namespace

Fix localize_jointly(const Observation& observation, const std::vector<Survey>& surveys,
                     const Rig& rig) {
  std::vector<Fix> fixes;
  for (const std::size_t survey : surveys_seen(observation)) {
    fixes.push_back(localize_in(observation, surveys, survey, rig));
  }
  Fix fix = fixes.empty() ? without_tags(observation) : choose(std::move(fixes));
  fix.id = observation.id;
  fix.method = "joint";
  std::vector<std::string>& told = fix.notes;
  if (fix.position_in_grid) {
    told.insert(told.begin(), observation.faults.begin(), observation.faults.end());
  } else {
    std::vector<std::string> reasons = observation.faults;
    reasons.push_back(fix.reason);
    fix.reason = fmt::format("{}", fmt::join(reasons, "; "));
  }
  return fix;
}

}  // namespace tagsmith
