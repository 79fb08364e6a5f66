// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/set_aside.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "decoder/localize/repeated_pictures.hpp"
#include "decoder/plates/hung_tags.hpp"
#include "decoder/plates/sightings.hpp"

namespace tagsmith::detail {
namespace {

// The tags of one survey that a row shows; its station is the row's number.
std::vector<SightedTag> sighted_in(const Observation& row, std::size_t number, std::size_t survey,
                                   const Rig& rig) {
  std::vector<SightedTag> sighted;
  for (const SeenTag& seen : row.tags) {
    const auto camera = camera_index(rig, seen.camera);
    const bool is_used = seen.survey == survey && seen.seen_corners && !seen.at_coded_place;
    if (!is_used || !camera) continue;
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
  return hung_as_surveyed(surveys[survey], rig, pick.taken());
}

// ---- Surveys together: tags of one may show what hangs wrong in another.

bool has_plates_of_one_size(const Survey& a, const Survey& b) {
  return a.tag_template.frame_inner_length == b.tag_template.frame_inner_length &&
         a.tag_template.frame_inner_height == b.tag_template.frame_inner_height;
}

// The tags of all surveys, which are in one grid, whose plates are as large as the first one's;
// each is named SURVEY/TAG.
Survey joined(const std::vector<Survey>& surveys) {
  Survey all = surveys.front();
  all.tags.clear();
  for (const Survey& survey : surveys) {
    if (!has_plates_of_one_size(survey, surveys.front())) continue;
    all.angle_sigma = std::max(all.angle_sigma, survey.angle_sigma);
    all.states_angle_sigma = all.states_angle_sigma && survey.states_angle_sigma;
    for (PlacedTag tag : survey.tags) {
      tag.name = tag_of_survey(survey.name, tag.name);
      all.tags.push_back(std::move(tag));
    }
  }
  return all;
}

// The rows with all tags as those of the joined surveys.
std::vector<Observation> joined_rows(std::vector<Observation> rows,
                                     const std::vector<Survey>& surveys) {
  for (Observation& row : rows) {
    for (SeenTag& seen : row.tags) {
      seen.tag.name = tag_of_survey(surveys[seen.survey].name, seen.tag.name);
      seen.survey = 0;
    }
  }
  return rows;
}

// Whether rows show tags of more than one survey.
bool shows_several(const std::vector<Observation>& rows) {
  std::set<std::size_t> seen;
  for (const Observation& row : rows) {
    for (const SeenTag& tag : row.tags) seen.insert(tag.survey);
  }
  return seen.size() > 1;
}

// The tags that hang elsewhere by the tags of all surveys.
std::vector<SetAside> aside_by_all(const std::vector<Observation>& rows,
                                   const std::vector<Survey>& surveys, const Rig& rig) {
  std::vector<SetAside> aside;
  if (!shows_several(rows)) return aside;
  const Survey all = joined(surveys);
  const HungTags hung = check_rows(joined_rows(rows, surveys), {all}, 0, rig);
  if (hung.nothing_fits) return aside;
  for (const HungTag& tag : hung.tags) {
    if (tag.verdict != HangVerdict::off) continue;
    const std::string survey = tag.tag.substr(0, tag.tag.find('/'));
    const auto of = std::ranges::find(surveys, survey, &Survey::name) - surveys.begin();
    const std::string name = tag.tag.substr(survey.size() + 1);
    std::string message = fmt::format(
        "{} hangs elsewhere than survey {} says, by tags of other surveys: measure it again, or "
        "hang it there",
        name, survey);
    aside.push_back({static_cast<std::size_t>(of), name, "moved", std::move(message), {}});
  }
  return aside;
}

// By the rows of the survey whose tags are seen most.
std::optional<RigSuspicion> suspicion_of(std::vector<Observation> rows,
                                         const std::vector<Survey>& surveys, const Rig& rig) {
  std::vector<std::size_t> tags(surveys.size());
  for (const Observation& row : rows) {
    for (const SeenTag& tag : row.tags) ++tags[tag.survey];
  }
  const auto survey = static_cast<std::size_t>(std::ranges::max_element(tags) - tags.begin());
  for (Observation& row : rows) {
    std::erase_if(row.tags, [&](const SeenTag& tag) { return tag.survey != survey; });
  }
  return suspect_rig(rows, surveys[survey], rig);
}

// Removes the tag from the rows that show it; a second copy from those that show the copy.
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

// Whether tags contradict each other, or the motion.
bool is_contradicted(const Fix& fix) {
  const auto is_tag = [](const Dropped& dropped) { return !dropped.camera.empty(); };
  const bool refused = !fix.position_in_grid && fix.tags.size() > 1;
  return refused || std::ranges::any_of(fix.dropped, is_tag);
}

}  // namespace

RunCheck set_aside_misplaced(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                             const Rig& rig) {
  std::vector<std::size_t> all(rows.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  RunCheck result;
  result.suspicion = suspicion_of(rows, surveys, rig);
  if (result.suspicion) return result;
  const auto keep = [&](SetAside aside, std::span<const std::size_t> of) {
    take_out(rows, of, aside);
    if (!aside.rows.empty()) result.aside.push_back(std::move(aside));
  };
  for (std::size_t survey = 0; survey < surveys.size(); ++survey) {
    const HungTags hung = check_rows(rows, surveys, survey, rig);
    if (hung.nothing_fits) {
      result.contradicted = fmt::format(
          "more than half of the tags seen contradict survey {}: are these its photos, and are rig "
          "and survey right?",
          surveys[survey].name);
      continue;
    }
    const auto add = [&](const HungTag& tag, std::span<const std::size_t> of) {
      if (tag.verdict == HangVerdict::off) keep({survey, tag.tag, tag.rule, tag.message, {}}, of);
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
  for (SetAside& aside : aside_by_all(rows, surveys, rig)) keep(std::move(aside), all);
  return result;
}

std::string doubt_in_words(const RunCheck& check, const Rig& rig) {
  return check.suspicion ? doubt_in_words(*check.suspicion, rig) : check.contradicted;
}

bool LiveSetAside::take(Observation seen, const Fix& fix) {
  constexpr std::size_t kMost = 40;
  constexpr std::size_t kParts = 4;
  const bool contradicted = is_contradicted(fix);
  if (!contradicted && !last_.empty() && are_of_one_place(last_.back().seen, seen)) return false;
  seen.parts.clear();  // these point into the surveys as they were
  last_.push_back({std::move(seen), contradicted});
  if (last_.size() > kMost) last_.pop_front();
  ++since_compared_;
  const bool is_open = !suspicion_ && std::ranges::any_of(last_, &Past::contradicted);
  return is_open || kParts * since_compared_ >= last_.size();
}

RunCheck LiveSetAside::learn(Observation seen, const Fix& fix, const Rig& rig) {
  if (!take(std::move(seen), fix)) return {{}, {}, suspicion_, contradicted_};
  since_compared_ = 0;
  std::vector<Observation> rows;
  for (const Past& past : last_) {
    rows.push_back(past.seen);
    // Two measurements are of two moments, even if they do not say when.
    if (!rows.back().time) rows.back().time = -static_cast<double>(rows.size());
  }
  leave_out_repeated(rows);
  RunCheck check = set_aside_misplaced(rows, surveys_, rig);
  std::erase_if(check.aside, [&](const SetAside& aside) {
    return std::erase_if(left_[aside.survey].tags,
                         [&](const PlacedTag& placed) { return placed.name == aside.tag; }) == 0;
  });
  for (Past& past : last_) past.contradicted = past.contradicted && check.aside.empty();
  // At the limit of certainty, a single row decides whether it is found.
  if (check.suspicion || found_none_) suspicion_ = check.suspicion;
  found_none_ = !check.suspicion;
  check.suspicion = suspicion_;
  contradicted_ = check.contradicted;
  return check;
}

}  // namespace tagsmith::detail
