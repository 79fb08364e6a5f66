// SPDX-License-Identifier: Apache-2.0
#include "decoder/ledger/ledger_report.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "tagsmith/base/date.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

using Histories = std::map<std::string, PlateHistory>;

Result<Histories> read_histories(const Survey& survey, const Ledger& ledger, Day last) {
  Histories histories;
  const auto take = [&](const PlateSighting& seen) {
    const PlacedTag* tag = find_tag(survey, std::string_view(seen.tag));
    if (tag == nullptr) return;
    // Of a tag that the survey moved since, the plate with the earlier digits is another one.
    const bool is_other =
        !seen.digits.empty() && !seen.finding.is_fault() && seen.digits != to_string(tag->digits);
    if (!is_other) add(seen, last, histories[seen.tag]);
  };
  if (auto read = ledger.for_each_sighting(survey.name, take); !read) {
    return tl::unexpected(read.error());
  }
  return histories;
}

bool is_seen(const Histories& histories, const std::string& tag, Day day) {
  const auto history = histories.find(tag);
  if (history == histories.end()) return false;
  const auto of_day = history->second.days.find(day);
  return of_day != history->second.days.end() && of_day->second.in_order;
}

// The nearest tags on either side of this one on its wall that photos with a date show.
std::vector<std::string> neighbours_of(const Histories& histories,
                                       const std::vector<const PlacedTag*>& wall, std::size_t i) {
  std::vector<std::string> names;
  const auto take = [&](std::size_t k) {
    const auto history = histories.find(wall[k]->name);
    const bool has_days = history != histories.end() && !history->second.days.empty();
    if (has_days) names.push_back(wall[k]->name);
    return has_days;
  };
  for (std::size_t k = i; k > 0 && !take(k - 1);) --k;
  for (std::size_t k = i + 1; k < wall.size() && !take(k);) ++k;
  return names;
}

// A plate that fell down, or that is covered, is in no photo: the days tell on which the plates on
// both sides were seen, and it was not. Beyond the last plate that was seen nobody may have driven.
void find_lost(const Histories& histories, const std::vector<std::string>& neighbours,
               PlateState& state) {
  constexpr std::size_t kEnough = 2;  // days; on a single one somebody may have stood before it
  if (neighbours.size() < 2 || state.action <= PlateAction::look) return;
  const auto first = histories.find(neighbours.front());
  if (first == histories.end()) return;
  std::size_t missed = 0;
  for (const auto& [day, seen] : first->second.days) {
    const auto shows = [&, at = day](const std::string& tag) {
      return is_seen(histories, tag, at);
    };
    const bool is_after = !state.last_seen || day > *state.last_seen;
    if (is_after && std::ranges::all_of(neighbours, shows)) ++missed;
  }
  if (missed < kEnough) return;
  state.action = PlateAction::look;
  state.cure.reset();
  state.reason = fmt::format(
      "{}; its neighbours were, on {} days",
      state.last_seen ? "not seen since " + to_text(*state.last_seen) : std::string("never seen"),
      missed);
}

std::vector<const PlacedTag*> wall_of(const Survey& survey, Side side) {
  std::vector<const PlacedTag*> wall;
  for (const PlacedTag& tag : survey.tags) {
    if (tag.side == side) wall.push_back(&tag);
  }
  std::ranges::stable_sort(wall, {}, &PlacedTag::chainage);
  return wall;
}

void count_trend(const PlateState& plate, LedgerReport& report) {
  if (!plate.due) return;
  ++report.trends;
  const bool is_light = plate.due->parameter == GradeParameter::symbol_contrast ||
                        plate.due->parameter == GradeParameter::modulation;
  if (is_light && plate.due->expected) ++report.losing_light;
}

auto urgency(const PlateState& plate) {
  const bool is_dated = plate.due && plate.due->expected;
  return std::make_tuple(plate.action, !is_dated, is_dated ? *plate.due->expected : Day{});
}

}  // namespace

Result<LedgerReport> make_ledger_report(const Survey& survey, const Ledger& ledger, Day last) {
  const Result<LedgerCounts> photos =
      ledger.count_photos(survey.name, to_text(last), survey_revision(survey));
  if (!photos) return tl::unexpected(photos.error());
  const Result<Histories> histories = read_histories(survey, ledger, last);
  if (!histories) return tl::unexpected(histories.error());
  LedgerReport report;
  report.photos = *photos;
  for (const auto& [tag, history] : *histories) {
    if (history.days.empty()) continue;
    report.oldest = std::min(report.oldest.value_or(Day::max()), history.days.begin()->first);
    report.newest = std::max(report.newest.value_or(Day{}), history.days.rbegin()->first);
  }
  for (const Side side : {Side::left, Side::right}) {
    const std::vector<const PlacedTag*> wall = wall_of(survey, side);
    for (std::size_t i = 0; i < wall.size(); ++i) {
      const auto history = histories->find(wall[i]->name);
      report.plates.push_back(
          judge_plate(wall[i]->name, history == histories->end() ? PlateHistory{} : history->second,
                      report.newest.value_or(Day{})));
      PlateState& state = report.plates.back();
      find_lost(*histories, neighbours_of(*histories, wall, i), state);
      count_trend(state, report);
      report.mended.insert(report.mended.end(), state.mended.begin(), state.mended.end());
    }
  }
  std::ranges::stable_sort(report.plates, {}, urgency);
  std::ranges::stable_sort(report.mended, std::ranges::greater{}, &MendedFault::in_order);
  return report;
}

std::string camera_in_words(const LedgerReport& report) {
  return fmt::format(
      "{} of {} plates lose light at once: clean the cameras' lenses first, and check focus, lamps "
      "and exposure",
      report.losing_light, report.trends);
}

std::vector<std::string> plates_to(PlateAction action, const Survey& survey,
                                   const LedgerReport& report) {
  std::vector<std::string> names;
  for (const PlacedTag& tag : survey.tags) {
    const auto state = std::ranges::find(report.plates, tag.name, &PlateState::tag);
    if (state != report.plates.end() && state->action == action) names.push_back(tag.name);
  }
  return names;
}

}  // namespace tagsmith::detail
