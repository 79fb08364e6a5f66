// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/set_aside.hpp"

#include <algorithm>

#include "decoder/verify/hanging_check.hpp"
#include "decoder/verify/hung_tags.hpp"

namespace tagsmith::detail {
namespace {

// The tags of one survey that a row shows; its station is the row's number.
std::vector<SightedTag> sighted_in(const Observation& row, std::size_t number, std::size_t survey,
                                   const Rig& rig) {
  std::vector<SightedTag> sighted;
  for (const SeenTag& seen : row.tags) {
    const auto camera = camera_index(rig, seen.camera);
    const bool tells = seen.survey == survey && seen.seen_corners && !seen.at_coded_place;
    if (!tells || !camera) continue;
    sighted.push_back({std::to_string(number), *camera, seen.tag.name, *seen.seen_corners});
  }
  return sighted;
}

HungTags check_rows(const std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                    std::size_t survey, const Rig& rig) {
  SightingPick pick;
  for (std::size_t i = 0; i < rows.size(); ++i) pick.count(sighted_in(rows[i], i, survey, rig));
  pick.choose();
  for (std::size_t i = 0; i < rows.size(); ++i) pick.take(sighted_in(rows[i], i, survey, rig));
  return check_hung_tags(surveys[survey], rig, pick.taken());
}

// Out of the rows that show it; of a second copy, out of those that show the copy.
void take_out(std::vector<Observation>& rows, std::span<const std::size_t> of, SetAside& aside) {
  for (const std::size_t i : of) {
    const auto taken = std::erase_if(rows[i].tags, [&](const SeenTag& seen) {
      return seen.survey == aside.survey && seen.tag.name == aside.tag;
    });
    std::erase_if(rows[i].parts, [&](const SeenPart& part) {
      return std::ranges::any_of(part.candidates, [&](const SurveyedTag& candidate) {
        return candidate.survey == aside.survey && candidate.tag->name == aside.tag;
      });
    });
    if (taken == 0) continue;
    rows[i].faults.push_back("set aside in the whole run: " + aside.message);
    aside.rows.push_back(i);
  }
}

}  // namespace

RunCheck set_aside_misplaced(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                             const Rig& rig) {
  std::vector<std::size_t> all(rows.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  RunCheck result;
  for (std::size_t survey = 0; survey < surveys.size(); ++survey) {
    const HungTags hung = check_rows(rows, surveys, survey, rig);
    if (hung.nothing_fits) continue;
    const auto add = [&](const HungTag& tag, std::span<const std::size_t> of) {
      if (tag.verdict != HangVerdict::off) return;
      SetAside aside{survey, tag.tag, tag.rule, tag.message, {}};
      take_out(rows, of, aside);
      if (!aside.rows.empty()) result.aside.push_back(std::move(aside));
    };
    for (MixedStations mixed : hung.mixed) {
      for (std::string* name : {&mixed.one, &mixed.other}) {
        *name = "row " + rows[std::stoul(*name)].id;
      }
      result.mixed.push_back(in_words(mixed, rig));
    }
    for (const UnplacedTags& station : hung.unplaced) {
      const std::size_t row = std::stoul(station.station);
      for (const HungTag& tag : station.tags) add(tag, {&row, 1});
    }
    for (const HungTag& tag : hung.tags) add(tag, all);
  }
  return result;
}

}  // namespace tagsmith::detail
