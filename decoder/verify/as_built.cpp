// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/as_built.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "decoder/plates/drive_fit.hpp"
#include "decoder/plates/plate_adjustment.hpp"
#include "decoder/plates/plate_consensus.hpp"
#include "decoder/plates/plate_search.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix3d;

// How far tags that are not control tags may hang from the survey. It is divided out of the result,
// and keeps the adjustment regular.
constexpr double kLooseSigma = 0.5;  // metres
constexpr double kLooseAngle = radians(10);

// Normal deviations of a control tag that hangs as surveyed.
constexpr double kFarthestControl = 4;

// --- what was seen ---

struct Site {
  Drive drive;
  std::vector<bool> is_control;       // by plate
  std::vector<bool> is_elsewhere;     // by plate: so far off that the search starts from its photos
  std::vector<std::string> excluded;  // by plate: why nothing of it is used; empty = it is used
  std::vector<LeftOutSighting> left_out;
  std::vector<std::string> cut_off;  // plates that only left-out photos connected
};

// Control tags hang as surveyed, all others about there.
void set_freedom(const Survey& survey, bool is_control, SightedPlate& plate) {
  if (is_control) {
    const double sigma = find_tag(survey, plate.name)->sigma;
    set_survey_sigma(plate, std::max(sigma, kLeastSurveySigma),
                     std::max(survey.angle_sigma, kLeastAngleSigma));
  } else {
    set_survey_sigma(plate, kLooseSigma, kLooseAngle);
  }
}

Site site_of(const Survey& survey, const Rig& rig, std::span<const SightedTag> sighted,
             std::span<const std::string> control) {
  AdjustmentProblem problem = problem_for(survey, rig, sighted);
  Site site;
  for (SightedPlate& plate : problem.plates) {
    site.is_control.push_back(std::ranges::find(control, plate.name) != control.end());
    set_freedom(survey, site.is_control.back(), plate);
  }
  site.drive.rows.resize(problem.stations.size());
  site.drive.plates = std::move(problem.plates);
  site.drive.stations = std::move(problem.stations);
  site.is_elsewhere.resize(site.drive.plates.size());
  site.excluded.resize(site.drive.plates.size());
  return site;
}

// --- which stations are used ---

// Leaves out sightings, and stations that show nothing any more. `is_out`: for a station and the
// number of a sighting in it.
template <class IsOut>
void leave_out(Drive& drive, const IsOut& is_out) {
  for (std::size_t s = 0; s < drive.stations.size(); ++s) {
    std::vector<Sighting> kept;
    for (std::size_t i = 0; i < drive.stations[s].sightings.size(); ++i) {
      if (!is_out(s, i)) kept.push_back(drive.stations[s].sightings[i]);
    }
    drive.stations[s].sightings = std::move(kept);
  }
  std::erase_if(drive.stations, [](const Station& station) { return station.sightings.empty(); });
  drive.rows.resize(drive.stations.size());
}

// Leaves out stations that show one plate alone and those that no chain connects with a control
// plate, and gives this as the reason for the plates that are then no longer seen.
void keep_tied(Site& site) {
  Drive& drive = site.drive;
  leave_out(drive,
            [&](std::size_t s, std::size_t) { return plates_of(drive.stations[s]).size() < 2; });
  const std::vector<std::size_t> chain =
      tied_groups(drive.stations, std::vector<bool>(drive.plates.size(), true));
  std::set<std::size_t> held;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (site.is_control[i]) held.insert(chain[i]);
  }
  std::vector<bool> is_seen(chain.size());
  for (const Station& station : drive.stations) {
    for (const Sighting& sighting : station.sightings) is_seen[sighting.plate] = true;
  }
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (!site.excluded[i].empty()) continue;
    const std::string& name = drive.plates[i].name;
    const auto own = std::ranges::find(site.left_out, name, &LeftOutSighting::tag);
    if (!is_seen[i] && own != site.left_out.end()) {
      site.excluded[i] = "its photos contradict those of the other tags";
    } else if (!is_seen[i] || !held.contains(chain[i])) {
      const bool is_cut_off = !site.left_out.empty();
      if (is_cut_off) site.cut_off.push_back(name);
      site.excluded[i] = is_cut_off   ? "photos that were left out alone tied it to a control tag"
                         : is_seen[i] ? "no chain of photos ties it to a control tag"
                                      : "it was never seen together with another tag";
    }
  }
  leave_out(drive, [&](std::size_t s, std::size_t i) {
    return !held.contains(chain[drive.stations[s].sightings[i].plate]);
  });
}

// --- gross errors, before anything is adjusted ---

// Summed up: with how many others something agrees, minus those with which it does not.
int vote(const SightedPair& pair) { return pair.agrees ? 1 : -1; }

// Marks the plates that disagree with more than half of those that they were seen with, the worst
// first.
void mark_elsewhere(const std::vector<SightedPair>& pairs, std::vector<bool>& is_elsewhere) {
  while (true) {
    std::vector<int> votes(is_elsewhere.size());
    for (const SightedPair& pair : pairs) {
      if (is_elsewhere[pair.plates[0]] || is_elsewhere[pair.plates[1]]) continue;
      for (const std::size_t plate : pair.plates) votes[plate] += vote(pair);
    }
    const auto worst = std::ranges::min_element(votes);
    if (worst == votes.end() || *worst >= 0) return;
    is_elsewhere[static_cast<std::size_t>(worst - votes.begin())] = true;
  }
}

// The survey's places serve as a start, except for plates that hang elsewhere; sightings that
// disagree with most others of their station are left out. A control plate that hangs elsewhere is
// no longer one.
void find_gross_errors(const Rig& rig, Site& site) {
  const AdjustmentProblem problem{&rig, site.drive.plates, site.drive.stations};
  const std::vector<SightedPair> pairs = compare_pairs(problem);
  mark_elsewhere(pairs, site.is_elsewhere);
  for (std::size_t i = 0; i < site.is_control.size(); ++i) {
    if (!site.is_control[i] || !site.is_elsewhere[i]) continue;
    site.is_control[i] = false;
    set_survey_sigma(site.drive.plates[i], kLooseSigma, kLooseAngle);
  }
  std::map<std::pair<std::size_t, std::size_t>, int> votes;  // by station and sighting
  for (const SightedPair& pair : pairs) {
    if (site.is_elsewhere[pair.plates[0]] || site.is_elsewhere[pair.plates[1]]) continue;
    for (const std::size_t sighting : pair.sightings) {
      votes[{pair.station, sighting}] += vote(pair);
    }
  }
  leave_out(site.drive, [&](std::size_t s, std::size_t i) {
    const auto found = votes.find({s, i});
    if (found == votes.end() || found->second >= 0) return false;
    const Station& station = problem.stations[s];
    site.left_out.push_back({station.name, problem.plates[station.sightings[i].plate].name});
    return true;
  });
}

// --- the adjustment ---

// The control plates, grouped by stations that show several of them.
std::vector<std::vector<std::size_t>> control_groups(const Site& site) {
  const std::vector<std::size_t> group = tied_groups(site.drive.stations, site.is_control);
  std::map<std::size_t, std::vector<std::size_t>> plates;
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (site.is_control[i]) plates[group[i]].push_back(i);
  }
  std::vector<std::vector<std::size_t>> groups;
  for (const auto& [number, of] : plates) groups.push_back(of);
  return groups;
}

// The plates adjusted, grouped as stations show them.
std::set<std::vector<std::size_t>> adjusted_groups(const Site& site) {
  std::set<std::vector<std::size_t>> groups;
  for (const Station& station : site.drive.stations) {
    std::vector<std::size_t> group;
    for (const std::size_t plate : plates_of(station)) {
      if (!site.is_control[plate]) group.push_back(plate);
    }
    if (group.size() > 1) groups.insert(std::move(group));
  }
  return groups;
}

std::optional<Adjustment> adjust(const Rig& rig, const Site& site) {
  std::vector<PlateFreedom> freed;
  for (const bool is_elsewhere : site.is_elsewhere) {
    freed.push_back(is_elsewhere ? PlateFreedom::place : PlateFreedom::none);
  }
  AdjustmentProblem problem{&rig, site.drive.plates, site.drive.stations};
  problem.groups = control_groups(site);
  std::ranges::copy(adjusted_groups(site), std::back_inserter(problem.groups));
  return adjust_plates(problem, freed);
}

// The next adjustment starts from here.
void take_places(const Adjustment& adjustment, Site& site) {
  for (std::size_t i = 0; i < site.drive.plates.size(); ++i) {
    if (site.is_control[i] || !adjustment.offsets[i]) continue;
    site.drive.plates[i].world_from_plate = adjustment.world_from_plate[i];
    site.is_elsewhere[i] = false;
  }
}

// Leaves out what the adjustment contradicts. False when there is nothing to leave out.
bool leave_out_wrong(const Rig& rig, const Adjustment& adjustment, Site& site) {
  const CalibrationLayout layout = calibration_layout(rig);
  const DriveFit fit{fitted_rig(rig, layout, adjustment.calibration), layout, adjustment};
  std::vector<LeftOut> wrong = leave_out_worst(fit, site.drive, usual_excess(fit, site.drive));
  std::ranges::stable_sort(
      wrong, {}, [](const LeftOut& one) { return std::pair(one.station, one.sighting.plate); });
  for (const auto& [station, sighting] : wrong) {
    site.left_out.push_back({station, site.drive.plates[sighting.plate].name});
  }
  if (wrong.empty()) return false;
  keep_tied(site);
  return true;
}

// When no place is found for the plates that hang elsewhere.
void give_up_elsewhere(Site& site) {
  for (std::size_t i = 0; i < site.is_elsewhere.size(); ++i) {
    if (site.is_elsewhere[i]) site.excluded[i] = "its photos contradict those of the other tags";
  }
  leave_out(site.drive, [&](std::size_t s, std::size_t i) {
    return site.is_elsewhere[site.drive.stations[s].sightings[i].plate];
  });
  keep_tied(site);
}

std::optional<Adjustment> adjust_robustly(const Rig& rig, Site& site) {
  constexpr int kMostRounds = 6;
  std::optional<Adjustment> adjustment = adjust(rig, site);
  if (!adjustment) {
    give_up_elsewhere(site);
    adjustment = adjust(rig, site);
  }
  for (int round = 0; adjustment && round < kMostRounds; ++round) {
    if (!leave_out_wrong(rig, *adjustment, site)) break;
    take_places(*adjustment, site);
    adjustment = adjust(rig, site);
  }
  return adjustment;
}

// --- the results ---

// Eight coordinates of a sighting, minus six of each vehicle and of each plate that is no control
// tag.
int degrees_of_freedom(const Site& site) {
  std::set<std::size_t> loose;
  int degrees = 0;
  for (const Station& station : site.drive.stations) {
    degrees += static_cast<int>(8 * station.sightings.size()) - 6;
    for (const Sighting& sighting : station.sightings) {
      if (!site.is_control[sighting.plate]) loose.insert(sighting.plate);
    }
  }
  return degrees - 6 * static_cast<int>(loose.size());
}

void raise_sigmas(double factor, Drive& drive) {
  for (Station& station : drive.stations) {
    for (Sighting& sighting : station.sightings) {
      sighting.covariance *= factor * factor;
      sighting.by_edges *= factor;
      sighting.by_drift *= factor;
    }
  }
}

std::string contradiction(const AsBuiltTag& tag, const Pose& surveyed) {
  const double turned = angle_between(tag.world_from_plate.rotation, surveyed.rotation);
  return fmt::format(
      "is a control tag, but hangs {:.0f} mm, and turned by {:.1f} degrees, from where the survey "
      "has it",
      1e3 * tag.shift.norm(), degrees(turned));
}

// In the mean of the three coordinates.
double sigma_of_place(const Eigen::Matrix<double, 6, 6>& covariance) {
  return std::sqrt(std::max(0.0, covariance.topLeftCorner<3, 3>().trace()) / 3);
}

void fill(const SightedPlate& plate, const PlateOffset& offset, const Pose& surveyed,
          AsBuiltTag& tag) {
  tag.world_from_plate = plate.world_from_plate;
  tag.world_from_plate.translation += offset.shift;
  tag.world_from_plate.rotation *= rotation_of(offset.turn);
  tag.covariance = offset.covariance;
  tag.shift = tag.world_from_plate.translation - surveyed.translation;
  tag.survey_sigma = sigma_of_place(tag.covariance);
}

// For a control tag whose place the photos alone do not determine.
void take_survey(const SightedPlate& plate, AsBuiltTag& tag) {
  tag.world_from_plate = plate.world_from_plate;
  tag.covariance = plate.survey_variance.asDiagonal();
  tag.survey_sigma = sigma_of_place(tag.covariance);
  tag.shift.setZero();
}

AsBuiltTag as_built_tag(const Site& site, const Adjustment& adjustment, std::size_t plate,
                        const PlacedTag& surveyed, bool was_control) {
  constexpr double kMostSigma = 0.05;  // metres: beyond, a place counts as undetermined
  AsBuiltTag tag;
  tag.tag = surveyed.name;
  tag.reason = site.excluded[plate];
  if (!tag.reason.empty() || !adjustment.offsets[plate]) return tag;
  const PlateOffset& offset = *adjustment.offsets[plate];
  fill(site.drive.plates[plate], offset, surveyed.world_from_plate, tag);
  const double sigma = worst_sigma(Matrix3d(offset.covariance.topLeftCorner<3, 3>()));
  const bool fits = offset.chi_square < chi_square_limit(6, kFarthestControl);
  if (was_control && site.is_control[plate] && fits) {
    tag.status = AsBuiltStatus::control;
    if (sigma > kMostSigma) take_survey(site.drive.plates[plate], tag);
  } else if (was_control) {
    tag.status = AsBuiltStatus::contradicted;
    tag.reason = contradiction(tag, surveyed.world_from_plate);
  } else if (sigma > kMostSigma) {
    tag.reason = fmt::format("the photos tell its place to {:.2f} m only", sigma);
  } else {
    tag.status = AsBuiltStatus::adjusted;
  }
  return tag;
}

ControlGroup control_group(const Site& site, const GroupShift& measured) {
  constexpr double kNothing = 10;  // metres
  ControlGroup group;
  Matrix3d covariance = measured.covariance;
  for (const std::size_t plate : measured.plates) {
    const SightedPlate& own = site.drive.plates[plate];
    group.tags.push_back(own.name);
    // A mistake of the station is common to all of its tags.
    covariance += Matrix3d(own.survey_variance.head<3>().asDiagonal()) / measured.plates.size();
  }
  group.shift = measured.shift.norm();
  group.chi_square = squared_mahalanobis(measured.shift, covariance);
  group.unnoticed = kFarthestControl * worst_sigma(covariance);
  if (group.unnoticed > kNothing) group.unnoticed = std::numeric_limits<double>::infinity();
  return group;
}

AsBuiltSurvey as_built_survey(const Survey& survey, const Site& site, const Adjustment& adjustment,
                              std::span<const std::string> control) {
  AsBuiltSurvey result;
  for (std::size_t i = 0; i < site.drive.plates.size(); ++i) {
    const PlacedTag& tag = *find_tag(survey, site.drive.plates[i].name);
    const bool was_control = std::ranges::find(control, tag.name) != control.end();
    result.tags.push_back(as_built_tag(site, adjustment, i, tag, was_control));
  }
  for (const GroupShift& group : adjustment.groups) {
    if (site.is_control[group.plates.front()]) {
      result.groups.push_back(control_group(site, group));
      continue;
    }
    const auto count = static_cast<double>(group.plates.size());
    const double together = std::sqrt(count * group.covariance.trace() / 3);
    for (const std::size_t plate : group.plates) {
      result.tags[plate].survey_sigma = std::max(result.tags[plate].survey_sigma, together);
    }
  }
  result.cut_off = site.cut_off;
  for (const Station& station : site.drive.stations) {
    result.sightings += station.sightings.size();
    for (const std::size_t plate : plates_of(station)) ++result.tags[plate].stations;
  }
  result.stations = site.drive.stations.size();
  result.left_out = site.left_out;
  result.chi_square = adjustment.chi_square;
  result.degrees_of_freedom = degrees_of_freedom(site);
  return result;
}

double shift_chi_square(const AsBuiltTag& tag, double sigma) {
  sigma = std::max(sigma, kLeastSurveySigma);
  const Matrix3d covariance =
      tag.covariance.topLeftCorner<3, 3>() + sigma * sigma * Matrix3d::Identity();
  return squared_mahalanobis(tag.shift, covariance);
}

// Whether two thirds of the other tags, and three at least, hang as surveyed as often as normal
// errors of the survey's sigma would have it.
bool agree(const Survey& survey, const AsBuiltSurvey& found, const std::string& besides) {
  constexpr double kTwoThirds = 3.4;  // quantile of chi-square with three degrees of freedom
  std::size_t placed = 0, fitting = 0;
  for (const AsBuiltTag& tag : found.tags) {
    if (!tag.has_place() || tag.tag == besides) continue;
    ++placed;
    const double sigma = find_tag(survey, tag.tag)->sigma;
    if (shift_chi_square(tag, sigma) < kTwoThirds) ++fitting;
  }
  return fitting >= 3 && 3 * fitting >= 2 * placed;
}

// --- control tags that are wrong together ---

// One tag that may hang wrong, or a group of tags in which each supports the others.
struct ControlSuspect {
  std::vector<std::string> tags;
  double chi_square = 0;
};

// The message on a tag that is one of `accused`.
std::string accusation(const AsBuiltTag& tag, std::span<const ControlGroup> groups,
                       std::size_t accused) {
  const auto group = std::ranges::find_if(groups, [&](const ControlGroup& each) {
    return std::ranges::find(each.tags, tag.tag) != each.tags.end();
  });
  std::string words = fmt::format("is a control tag, but hangs {:.0f} mm", 1e3 * tag.shift.norm());
  if (group != groups.end() && group->tags.size() > 1) {
    words += fmt::format(", or together with those seen with it {:.0f} mm,", 1e3 * group->shift);
  }
  words += " from where the survey has it by all others";
  return accused > 1 ? words + "; it or another of the contradicted ones is wrong" : words;
}

}  // namespace

std::string to_string(AsBuiltStatus status) {
  constexpr std::array<const char*, 4> kNames{"control", "contradicted", "adjusted",
                                              "undetermined"};
  return kNames[static_cast<std::size_t>(status)];
}

// Why: docs/decisions/0010-where-plates-hang.md.
Result<AsBuiltSurvey> adjust_as_built(const Survey& survey, const Rig& rig,
                                      std::span<const SightedTag> sighted,
                                      std::span<const std::string> control) {
  constexpr double kLeastExcess = 1.05;  // of chi-square: less makes no difference
  constexpr const char* kNoFit =
      "the photos, the survey and the rig do not fit together: is it the right rig, and is the "
      "survey right to half a metre?";
  Site site = site_of(survey, rig, sighted, control);
  keep_tied(site);
  if (site.drive.stations.empty()) {
    return fail(
        "no control tag was seen together with another tag: name control tags that the photos "
        "show");
  }
  find_gross_errors(rig, site);
  keep_tied(site);
  std::optional<Adjustment> adjustment = adjust_robustly(rig, site);
  if (!adjustment || site.drive.stations.empty()) {
    return fail(kNoFit);
  }
  const double excess = adjustment->chi_square / std::max(1, degrees_of_freedom(site));
  const double factor = excess > kLeastExcess ? std::sqrt(excess) : 1;
  if (factor > 1) {
    raise_sigmas(factor, site.drive);
    adjustment = adjust(rig, site);
    if (!adjustment) return fail(kNoFit);
  }
  AsBuiltSurvey result = as_built_survey(survey, site, *adjustment, control);
  result.sigma_factor = factor;
  return result;
}

void judge_control(const Survey& survey, AsBuiltSurvey& found) {
  constexpr double kClearly = 13.8;  // of chi-square: odds of 1000
  std::vector<ControlSuspect> suspects;
  for (const ControlGroup& group : found.groups) suspects.push_back({group.tags, group.chi_square});
  for (const AsBuiltTag& tag : found.tags) {
    if (tag.status != AsBuiltStatus::control && tag.status != AsBuiltStatus::contradicted) continue;
    const double sigma = find_tag(survey, tag.tag)->sigma;
    suspects.push_back({{tag.tag}, shift_chi_square(tag, sigma)});
  }
  double most = chi_square_limit(3, kFarthestControl);
  if (std::ranges::none_of(suspects, [&](auto& each) { return each.chi_square > most; })) return;
  for (const ControlSuspect& suspect : suspects) most = std::max(most, suspect.chi_square);
  const double least = std::max(most - kClearly, chi_square_limit(3, kFarthestControl));
  std::set<std::string> accused;
  for (const ControlSuspect& suspect : suspects) {
    if (suspect.chi_square >= least) accused.insert(suspect.tags.begin(), suspect.tags.end());
  }
  for (AsBuiltTag& tag : found.tags) {
    if (accused.contains(tag.tag)) {
      tag.status = AsBuiltStatus::contradicted;
      tag.reason = accusation(tag, found.groups, accused.size());
    } else if (tag.status == AsBuiltStatus::contradicted) {
      tag.status = AsBuiltStatus::control;
      tag.reason.clear();
    }
  }
}

std::optional<AsBuiltTag> contradicted_by_others(const Survey& survey, const Rig& rig,
                                                 std::span<const SightedTag> sighted,
                                                 const std::string& control) {
  constexpr double kMostSpread = 0.1;  // metres
  std::vector<std::string> others;
  for (const PlacedTag& tag : survey.tags) {
    const bool is_seen = std::ranges::find(sighted, tag.name, &SightedTag::tag) != sighted.end();
    if (is_seen && tag.name != control) others.push_back(tag.name);
  }
  Survey spread = survey;
  for (int doubled = 0; std::ldexp(kLeastSurveySigma, doubled) < kMostSpread; ++doubled) {
    const double sigma = std::ldexp(kLeastSurveySigma, doubled);
    for (PlacedTag& tag : spread.tags) tag.sigma = std::max(tag.sigma, sigma);
    spread.angle_sigma = std::max(spread.angle_sigma, sigma / kMostSpread * kLooseAngle);
    const auto found = adjust_as_built(spread, rig, sighted, others);
    if (!found || !agree(spread, *found, control)) continue;
    const auto tag = std::ranges::find(found->tags, control, &AsBuiltTag::tag);
    if (tag == found->tags.end() || tag->status != AsBuiltStatus::adjusted) return std::nullopt;
    const bool hangs_there = shift_chi_square(*tag, find_tag(survey, control)->sigma) <
                             chi_square_limit(3, kFarthestControl);
    return hangs_there ? std::nullopt : std::optional(*tag);
  }
  return std::nullopt;
}

}  // namespace tagsmith::detail
