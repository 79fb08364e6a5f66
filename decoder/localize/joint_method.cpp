// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/joint_method.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/localize/joint_fix.hpp"

namespace tagsmith::detail {
namespace {

// --- parts of tags. Why: docs/decisions/0005-parts-and-frameless-symbols.md. ---

Observation with_part(Observation observation, const SeenPart& part, const SurveyedTag& of) {
  observation.tags.push_back(
      {part.camera, of.survey, *of.tag, part.seen_corners, std::nullopt, false, true});
  return observation;
}

// Whether a position uses a whole tag. Parts may belong to plates of no survey whose digits in
// sight are the same, and those of a drive with the same layout agree with each other, too.
bool rests_on_a_whole_tag(const Fix& fix) {
  return std::ranges::any_of(fix.tags, [&](const std::string& tag) {
    return std::ranges::none_of(
        fix.corners, [&](const FittedCorners& seen) { return seen.is_part && seen.tag == tag; });
  });
}

bool is_used(const Fix& fix, const SeenPart& part, const std::string& tag) {
  return fix.position_in_grid && std::ranges::any_of(fix.corners, [&](const FittedCorners& seen) {
           return seen.used && seen.is_part && seen.camera == part.camera && seen.tag == tag;
         });
}

// The fix with a part that may be several tags, where the position without it agrees with exactly
// one of them.
void settle_part(const SeenPart& part, const std::vector<Survey>& surveys, std::size_t home,
                 const Rig& rig, Observation& observation, Fix& fix) {
  std::vector<std::pair<Observation, Fix>> agreeing;
  for (const SurveyedTag& candidate : part.candidates) {
    Observation with = with_part(observation, part, candidate);
    Fix together = localize_by_tags(with, surveys, home, rig);
    if (!is_used(together, part, name_of(*candidate.tag, candidate.survey, home, surveys)))
      continue;
    agreeing.emplace_back(std::move(with), std::move(together));
  }
  if (agreeing.size() != 1) return;
  observation = std::move(agreeing.front().first);
  fix = std::move(agreeing.front().second);
}

Fix localize_in(const Observation& observation, const std::vector<Survey>& surveys,
                std::size_t home, const Rig& rig) {
  Observation all = observation;
  for (const SeenPart& part : observation.parts) {
    if (part.candidates.size() == 1) all = with_part(std::move(all), part, part.candidates.front());
  }
  Fix fix = localize_by_tags(all, surveys, home, rig);
  if (fix.position_in_grid && !rests_on_a_whole_tag(fix)) {
    Fix none;
    none.survey = fix.survey;
    none.tags = fix.tags;
    none.reason = fmt::format("only a part of {} was read, and no whole tag confirms it",
                              fmt::join(fix.tags, " and of "));
    return none;
  }
  for (const SeenPart& part : observation.parts) {
    if (!fix.position_in_grid || part.candidates.size() < 2) continue;
    settle_part(part, surveys, home, rig, all, fix);
  }
  return fix;
}

// The surveys whose tags, or parts of them, are seen; those with most tags first.
std::vector<std::size_t> surveys_seen(const Observation& observation) {
  std::map<std::size_t, std::size_t> tags;
  for (const SeenTag& tag : observation.tags) {
    if (tag.seen_corners) ++tags[tag.survey];
  }
  for (const SeenPart& part : observation.parts) {
    for (const SurveyedTag& candidate : part.candidates) tags.try_emplace(candidate.survey, 0);
  }
  std::vector<std::size_t> seen;
  for (const auto& [survey, count] : tags) seen.push_back(survey);
  std::ranges::stable_sort(seen, std::ranges::greater{}, [&](std::size_t i) { return tags[i]; });
  return seen;
}

Fix without_tags(const Observation& observation) {
  Fix fix;
  for (const SeenTag& seen : observation.tags) fix.tags.push_back(seen.tag.name);
  fix.reason = observation.tags.empty()
                   ? observation.has_left_out ? "no other picture shows a tag" : "no tag was seen"
                   : "only distances to tags were measured, which --method paper can use";
  return fix;
}

// How far a position lies before the beginning or after the end of its survey's center line.
double beyond_ends(const Fix& fix, const std::vector<Survey>& surveys) {
  const Survey& survey = survey_of(fix, surveys);
  const Eigen::Vector3d place = world_from_grid(survey.grid, *fix.position_in_grid);
  const Centerline& centerline = survey.tunnel.centerline;
  const double chainage = centerline.locate(place.head<2>()).chainage;
  return std::max({-chainage, chainage - centerline.length(), 0.0});
}

// By the same tags in the tunnel of each survey of which a tag is in sight: the fix that lies in
// its tunnel. In several tunnels, as at a crossing, the ranges tell to whose walls they were
// measured.
Fix localize_at_home(const Observation& observation, const std::vector<Survey>& surveys,
                     const Rig& rig, const std::vector<std::size_t>& homes) {
  std::vector<Fix> fixes;
  for (const std::size_t home : homes) {
    fixes.push_back(localize_in(observation, surveys, home, rig));
  }
  const auto rank = [&](const Fix& fix) {
    const bool located = fix.position_in_grid.has_value();
    return std::tuple(!located, located ? beyond_ends(fix, surveys) : 0, -std::ssize(fix.ranges));
  };
  return *std::ranges::min_element(fixes, {}, rank);
}

// Where none of these has a position: in the tunnel of a survey of which no tag is in sight, as
// beside the mouth of a drive. Several tags must agree on that, for a lone one seen from the front
// allows a second pose, which may lie in any tunnel.
Fix localize_anywhere(const Observation& observation, const std::vector<Survey>& surveys,
                      const Rig& rig) {
  const std::vector<std::size_t> homes = surveys_seen(observation);
  if (homes.empty()) return without_tags(observation);
  Fix fix = localize_at_home(observation, surveys, rig, homes);
  if (fix.position_in_grid || fix.tags.size() < 2) return fix;
  for (std::size_t other = 0; other < surveys.size(); ++other) {
    if (std::ranges::find(homes, other) != homes.end()) continue;
    Fix there = localize_in(observation, surveys, other, rig);
    const bool is_there =
        there.position_in_grid && there.confirmations > 0 && beyond_ends(there, surveys) == 0;
    if (is_there) return there;
  }
  return fix;
}

}  // namespace

Fix localize_jointly(const Observation& observation, const std::vector<Survey>& surveys,
                     const Rig& rig) {
  Fix fix = localize_anywhere(observation, surveys, rig);
  fix.id = observation.id;
  fix.method = "joint";
  if (fix.position_in_grid) {
    fix.notes.insert(fix.notes.begin(), observation.faults.begin(), observation.faults.end());
  } else {
    std::vector<std::string> reasons = observation.faults;
    reasons.push_back(fix.reason);
    fix.reason = fmt::format("{}", fmt::join(reasons, "; "));
  }
  return fix;
}

}  // namespace tagsmith::detail
