// SPDX-License-Identifier: Apache-2.0
#include "decoder/ledger/plate_history.hpp"

#include <random>

#include <doctest/doctest.h>

#include "tagsmith/base/date.hpp"

namespace tagsmith::detail {
namespace {

Day day(const char* text) { return parse_day(text).value(); }

constexpr std::array kDays{"2026-01-01", "2026-02-01", "2026-03-01", "2026-04-01",
                           "2026-05-01", "2026-06-01", "2026-07-01"};

// A photo in order on this day, of good print apart from what is given.
PlateSighting good(const std::string& on, double modulation = 0.8, double decodability = 0.75) {
  PlateSighting seen;
  seen.tag = "000L";
  seen.taken = on + "T10:00:00";
  seen.module_px = 6;
  seen.values = {std::nullopt, modulation, decodability, 0.05};
  seen.grade = modulation >= 0.7 && decodability >= 0.62 ? 4 : modulation < 0.5 ? 1.5 : 3;
  return seen;
}

PlateSighting bad(const std::string& on, TagStatus status, const std::string& rule) {
  PlateSighting seen;
  seen.tag = "000L";
  seen.taken = on + "T10:00:00";
  seen.finding = {status, rule, "because of " + rule};
  return seen;
}

PlateState judge(const std::vector<PlateSighting>& seen, const char* newest = "2026-07-01",
                 bool is_between_read = false) {
  PlateHistory history;
  for (const PlateSighting& one : seen) add(one, day("2026-12-31"), is_between_read, history);
  const PlateState plate = describe_plate("000L", history);
  return judge_quality(plate, {day(newest), distance_effects({plate})});
}

}  // namespace

TEST_CASE("light that is lost is cleaned, edges that are worn are printed anew") {
  std::vector<PlateSighting> dirty, worn, both;
  for (std::size_t i = 0; i < 4; ++i) {
    const double lost = 0.1 * static_cast<double>(i);
    dirty.push_back(good(kDays[i], 0.65 - lost));
    worn.push_back(good(kDays[i], 0.8, 0.5 - lost));
    both.push_back(good(kDays[i], 0.65 - lost, 0.5 - lost / 2));
  }
  CHECK(judge(dirty).action == PlateAction::clean);
  CHECK(judge(worn).action == PlateAction::reprint);
  CHECK(judge(both).action == PlateAction::reprint);
  CHECK(judge(dirty).due->is_past);
  CHECK(judge(dirty).due->parameter == GradeParameter::modulation);
}

TEST_CASE("a trend states when it is at the limit, and not more than it can tell") {
  std::vector<PlateSighting> seen;
  for (std::size_t i = 0; i < 4; ++i) {
    const double days = static_cast<double>((day(kDays[i]) - day(kDays[0])).count());
    seen.push_back(good(kDays[i], 0.7 - 0.0015 * days));
    if (i < 2) {
      CHECK_FALSE(judge(seen).due);
      CHECK(judge(seen).action == PlateAction::none);
    }
  }
  const PlateState state = judge(seen, kDays[3]);
  CHECK(state.action == PlateAction::plan);
  CHECK(state.cure == PlateAction::clean);
  REQUIRE(state.due);
  CHECK(state.due->limit == 0.40);
  // 0.3 above the limit, at 0.0015 a day.
  CHECK(std::abs((*state.due->expected - day(kDays[0])).count() - 200) <= 1);
  // Seen on 90 days: nothing is said of what is 180 days beyond the last one.
  for (PlateSighting& one : seen) one.values[1] = *one.values[1] / 2 + 0.35;
  const PlateState slow = judge(seen, kDays[3]);
  CHECK(slow.action == PlateAction::none);
  CHECK_FALSE(slow.due->expected);
  CHECK(slow.due->not_before == day("2026-09-28"));
  CHECK(slow.due->parameter == GradeParameter::modulation);  // the first of those due alike
}

TEST_CASE("a plate that suddenly fails is to be looked at, and one that goes on failing is known") {
  std::vector<PlateSighting> seen;
  for (std::size_t i = 0; i < 5; ++i) seen.push_back(good(kDays[i]));
  seen.push_back(good(kDays[5], 0.2));
  const PlateState once = judge(seen, kDays[5]);
  CHECK(once.action == PlateAction::look);
  CHECK_FALSE(once.cure);
  seen.push_back(good(kDays[6], 0.25));
  CHECK(judge(seen).action == PlateAction::clean);
  // One day alone may be a camera that was out of focus.
  CHECK(judge({good(kDays[5], 0.8, 0.1)}).action == PlateAction::look);
  CHECK(judge({good(kDays[4]), good(kDays[5], 0.8, 0.1)}).action == PlateAction::look);
  CHECK(judge({good(kDays[4], 0.8, 0.1), good(kDays[5], 0.8, 0.1)}).action == PlateAction::reprint);
}

TEST_CASE("defects rise to their limit") {
  std::vector<PlateSighting> seen;
  for (std::size_t i = 0; i < 4; ++i) {
    seen.push_back(good(kDays[i]));
    seen.back().values[3] = 0.1 + 0.05 * static_cast<double>(i);
  }
  const PlateState state = judge(seen, kDays[3]);
  CHECK(state.action == PlateAction::plan);
  CHECK(state.cure == PlateAction::reprint);
  CHECK(state.due->parameter == GradeParameter::defects);
  CHECK(state.due->limit == 0.30);
  CHECK(state.due->trend.slope > 0);
}

TEST_CASE("a plate that was mended begins anew, and a single bad day is no such thing") {
  std::vector<PlateSighting> seen;
  for (std::size_t i = 0; i < 7; ++i) seen.push_back(good(kDays[i], i < 3 ? 0.45 : 0.8));
  const PlateState state = judge(seen);
  REQUIRE(state.mended.size() == 1);
  CHECK(state.mended[0].rule.empty());
  CHECK(state.mended[0].last_found == day(kDays[2]));
  CHECK(state.mended[0].in_order == day(kDays[3]));
  CHECK(state.series.size() == 4);
  CHECK(state.action == PlateAction::none);
  for (const std::size_t dim : {0U, 3U}) {
    std::vector<PlateSighting> one_bad;
    for (std::size_t i = 0; i < 7; ++i) one_bad.push_back(good(kDays[i], i == dim ? 0.45 : 0.8));
    CHECK(judge(one_bad).mended.empty());
    CHECK(judge(one_bad).series.size() == 7);
  }
  std::vector<PlateSighting> one_good;
  for (std::size_t i = 0; i < 7; ++i) one_good.push_back(good(kDays[i], i == 3 ? 0.8 : 0.45));
  CHECK(judge(one_good).mended.empty());
}

TEST_CASE("a last day that is better at once is to be confirmed by another") {
  std::vector<PlateSighting> seen;
  for (std::size_t i = 0; i < 3; ++i) seen.push_back(good(kDays[i], 0.35));
  CHECK(judge(seen, kDays[2]).action == PlateAction::clean);
  seen.push_back(good(kDays[3]));
  const PlateState once = judge(seen, kDays[3]);
  CHECK(once.action == PlateAction::look);
  CHECK(once.reason.find("better on 2026-04-01 alone") != std::string::npos);
  CHECK(once.mended.empty());
  CHECK(once.series.size() == 4);
  seen.push_back(good(kDays[4]));
  CHECK(judge(seen, kDays[4]).action == PlateAction::none);
  CHECK(judge(seen, kDays[4]).mended.size() == 1);
  // What a trend had planned stays planned.
  std::vector<PlateSighting> worn;
  for (std::size_t i = 0; i < 3; ++i) {
    worn.push_back(good(kDays[i], 0.8, 0.5 - 0.05 * static_cast<double>(i)));
  }
  worn.push_back(good(kDays[3]));
  CHECK(judge(worn, kDays[3]).action == judge({worn[0], worn[1], worn[2]}, kDays[3]).action);
}

TEST_CASE("a fault is open until a later day tells that it is gone") {
  const auto moved = bad(kDays[0], TagStatus::misplaced, "moved");
  CHECK(judge({moved}).action == PlateAction::rehang);
  CHECK(judge({moved}).reason == "because of moved");
  // In order, but nothing told where it hangs.
  CHECK(judge({moved, good(kDays[1])}).action == PlateAction::rehang);
  PlateSighting placed = good(kDays[1]);
  placed.hanging = "fits";
  const PlateState mended = judge({moved, placed});
  CHECK(mended.action == PlateAction::none);
  REQUIRE(mended.mended.size() == 1);
  CHECK(mended.mended[0].rule == "moved");
  CHECK(mended.mended[0].in_order == day(kDays[1]));
  // And again.
  const auto again = bad(kDays[2], TagStatus::misplaced, "moved");
  CHECK(judge({moved, placed, again}).action == PlateAction::rehang);
  CHECK(judge({moved, placed, again}).mended.empty());
  const auto turned = bad(kDays[0], TagStatus::misprinted, "upside-down");
  CHECK(judge({turned, moved}).reason == "because of moved");  // of equal actions the first rule
  CHECK(judge({turned, good(kDays[1])}).action == PlateAction::rehang);
  PlateSighting upright = good(kDays[1]);
  upright.up_known = true;
  CHECK(judge({turned, upright}).action == PlateAction::none);
}

TEST_CASE("a drive that measures less exactly than a plate is off does not mend it") {
  PlateSighting moved = bad(kDays[0], TagStatus::misplaced, "moved");
  moved.offset_mm = {40, 0, 0};
  moved.offset_sigma_mm = {4, 4, 10};
  PlateSighting placed = good(kDays[1]);
  placed.hanging = "fits";
  placed.offset_mm = {22, 0, 0};
  placed.offset_sigma_mm = {18, 5, 30};
  CHECK(judge({moved, placed}).action == PlateAction::rehang);
  CHECK(judge({moved, placed}).mended.empty());
  // The first drive's offset counts, though a weak one found the plate off since.
  PlateSighting weak = moved;
  weak.taken = placed.taken;
  weak.offset_mm = {41, 0, 0};
  weak.offset_sigma_mm = {18, 5, 30};
  placed.taken = good(kDays[2]).taken;
  CHECK(judge({moved, weak, placed}).action == PlateAction::rehang);
  placed.offset_sigma_mm = {13, 5, 30};
  CHECK(judge({moved, weak, placed}).action == PlateAction::none);
  CHECK(judge({moved, placed}).mended.size() == 1);
}

TEST_CASE("of two plates that do not fit together nobody is told to rehang both") {
  const auto doubtful = bad(kDays[0], TagStatus::doubtful, "swapped");
  CHECK(judge({doubtful}).action == PlateAction::look);
  CHECK(judge({doubtful}).reason == "because of swapped");
  const auto misplaced = bad(kDays[1], TagStatus::misplaced, "swapped");
  CHECK(judge({doubtful, misplaced}).action == PlateAction::rehang);
}

TEST_CASE(
    "a misprint is not mended by a photo that shows the plate smaller, a copy not by any photo") {
  PlateSighting mirrored = bad(kDays[0], TagStatus::misprinted, "mirrored");
  mirrored.module_px = 6;
  PlateSighting far = good(kDays[1]);
  far.module_px = 2.6;
  CHECK(judge({mirrored, far}).action == PlateAction::reprint);
  CHECK(judge({mirrored, far}).mended.empty());
  CHECK(judge({mirrored, far, good(kDays[2])}).action == PlateAction::none);
  // Found at both sizes.
  PlateSighting smaller = bad(kDays[0], TagStatus::misprinted, "mirrored");
  smaller.module_px = 2.8;
  CHECK(judge({mirrored, smaller, far}).action == PlateAction::none);
  const PlateSighting copy = bad(kDays[0], TagStatus::duplicate, "duplicate");
  CHECK(judge({copy, good(kDays[1])}).action == PlateAction::rehang);
  PlateSighting placed = good(kDays[1]);
  placed.hanging = "fits";
  CHECK(judge({copy, placed}).action == PlateAction::none);
}

TEST_CASE(
    "a clock that was reset dates nothing, and its photos mend nothing that was entered later") {
  PlateSighting moved = bad("2000-01-01", TagStatus::misplaced, "moved");
  PlateSighting placed = good(kDays[0]);
  placed.hanging = "fits";
  placed.entry = 1;
  moved.entry = 2;
  CHECK(judge({placed, moved}).action == PlateAction::rehang);
  CHECK(judge({placed, moved}).undated == 1);
  moved.entry = 1;
  placed.entry = 2;
  CHECK(judge({moved, placed}).action == PlateAction::none);
}

TEST_CASE("what was entered before a fault does not mend it by its date alone") {
  PlateSighting torn = bad("2020-01-01", TagStatus::unreadable, "undecodable");
  std::vector<PlateSighting> seen{good(kDays[0]), good(kDays[1]), torn};
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i].entry = static_cast<long>(i) + 1;
  const PlateState doubted = judge(seen);
  CHECK(doubted.action == PlateAction::look);
  CHECK(doubted.mended.empty());
  CHECK(doubted.reason ==
        "because of undecodable: found on 2020-01-01 in a photo that was entered after those that "
        "show it in order on 2026-02-01: is its date right?");
  // An earlier fault that was entered first does not take its place.
  seen.push_back(bad("2025-01-01", TagStatus::unreadable, "undecodable"));
  CHECK(judge(seen).action == PlateAction::look);
  // Nor do photos whose clock was ahead, and whose day has come.
  seen = {good(kDays[3]), bad(kDays[2], TagStatus::unreadable, "undecodable")};
  seen.back().entry = 1;
  CHECK(judge(seen).action == PlateAction::look);
  // The next drive tells.
  seen.push_back(good(kDays[4]));
  seen.back().entry = 2;
  CHECK(judge(seen).action == PlateAction::none);
  CHECK(judge(seen).mended.size() == 1);
}

TEST_CASE("what lies with a photo is not the plate's") {
  CHECK(judge({bad(kDays[0], TagStatus::unreadable, "glare")}).action == PlateAction::none);
  const auto covered = bad(kDays[0], TagStatus::unreadable, "covered");
  CHECK(judge({covered}).action == PlateAction::clean);
  // Another photo of the day shows it.
  CHECK(judge({covered, good(kDays[0])}).action == PlateAction::none);
  CHECK(judge({covered, good(kDays[0])}).mended.empty());
  CHECK(judge({covered, good(kDays[1])}).mended.size() == 1);
  auto cut_off = bad(kDays[0], TagStatus::cut_off, "cut-off");
  CHECK(judge({cut_off}).photos == 0);
}

TEST_CASE("a plate that most photos of two days do not read is to be looked at") {
  std::vector<PlateSighting> seen;
  const auto add_day = [&](std::size_t i, int unread, const std::string& rule) {
    seen.push_back(good(kDays[i]));
    for (int photo = 0; photo < unread; ++photo) {
      seen.push_back(bad(kDays[i], TagStatus::unreadable, rule));
    }
  };
  const auto action = [&](bool is_between_read) {
    return judge(seen, kDays[6], is_between_read).action;
  };
  add_day(0, 9, "undecodable");
  CHECK(action(true) == PlateAction::none);  // may be the day's
  add_day(1, 8, "covered");
  CHECK(action(true) == PlateAction::look);
  CHECK(judge(seen, kDays[6], true).reason ==
        "unread in 17 of 19 photos since 2026-01-01, while plates on both sides were read");
  // What is far away is unread, too.
  CHECK(action(false) == PlateAction::none);
  add_day(2, 1, "covered");  // as often read as not
  CHECK(action(true) == PlateAction::none);
  add_day(3, 5, "glare");
  add_day(4, 5, "glare");
  CHECK(action(true) == PlateAction::none);
}

TEST_CASE("photos are compared where they show the plate about equally large") {
  std::vector<PlateSighting> seen;
  for (std::size_t i = 0; i < 4; ++i) seen.push_back(good(kDays[i]));
  PlateSighting far = good(kDays[4], 0.42);
  far.module_px = 3.9;  // of the others 6
  seen.push_back(far);
  CHECK(judge(seen).series.size() == 4);
  far.module_px = 4.1;
  seen.back() = far;
  CHECK(judge(seen).series.size() == 5);
  // Of a day the best photo counts.
  seen.push_back(good(kDays[4], 0.79));
  CHECK(*judge(seen).series.back().values[1] == 0.79);
}

TEST_CASE("distance is not taken for wear") {
  // One plate, alone, that is new and photographed from further away each time.
  std::vector<PlateSighting> alone;
  constexpr std::array kSizes{6.4, 6.0, 5.4, 4.9, 4.4};
  constexpr std::array kDecodability{0.72, 0.64, 0.53, 0.38, 0.22};
  for (std::size_t i = 0; i < kSizes.size(); ++i) {
    alone.push_back(good(kDays[i], 0.8, kDecodability[i]));
    alone.back().module_px = kSizes[i];
  }
  const PlateState far = judge(alone, kDays[4]);
  CHECK(far.action == PlateAction::look);
  CHECK(far.reason == "decodability 0.22 on 2026-05-01, limit 0.25");
  CHECK_FALSE(far.due->expected);
  // Of three days nobody can tell what was distance.
  CHECK_FALSE(judge({alone[0], alone[1], alone[2]}).due);
  for (PlateSighting& seen : alone) seen.module_px = 5;
  CHECK(judge(alone, kDays[4]).action == PlateAction::reprint);
}

TEST_CASE("what plates lose with the distance is told by all of them together") {
  // Values with an effect of -4 of 1 / module_px. The first plate is new, the second one wears and
  // is photographed from nearer each time, the others are new, and their distances vary.
  constexpr std::array<std::array<double, 4>, 4> kSizes{
      {{6.0, 5.6, 5.2, 4.8}, {4.8, 5.2, 5.6, 6.0}, {5.0, 5.5, 5.1, 5.3}, {5.4, 5.0, 5.6, 5.2}}};
  std::vector<PlateState> plates;
  for (std::size_t plate = 0; plate < kSizes.size(); ++plate) {
    PlateHistory history;
    for (std::size_t i = 0; i < 4; ++i) {
      const double worn = plate == 1 ? 0.06 * static_cast<double>(i) : 0;
      const double size = kSizes[plate][i];
      PlateSighting seen = good(kDays[i], 0.8, 0.55 - worn - 4 * (1 / size - 1 / 5.4));
      seen.module_px = size;
      add(seen, day(kDays[6]), false, history);
    }
    plates.push_back(describe_plate("000L", history));
  }
  const AllPlates all{day(kDays[3]), distance_effects(plates)};
  CHECK(all.distance[2].slope == doctest::Approx(-4).epsilon(0.02));
  CHECK(all.distance[2].half_width < 0.4);
  CHECK(judge_quality(plates[0], all).action == PlateAction::none);
  const PlateState worn = judge_quality(plates[1], all);
  CHECK(worn.action == PlateAction::plan);
  REQUIRE(worn.due);
  CHECK(worn.due->parameter == GradeParameter::decodability);
  CHECK(worn.due->trend.slope * 30 == doctest::Approx(-0.06).epsilon(0.05));
}

TEST_CASE("the stated interval holds the true day where distances vary") {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  std::normal_distribution<double> noise(0, 0.015);
  std::uniform_real_distribution<double> size(4.6, 6.4);
  int held = 0, stated = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<PlateState> plates(4);
    for (PlateState& plate : plates) {
      for (const char* text : kDays) {
        PlateQuality& quality = plate.series.emplace_back(PlateQuality{day(text), 3, size(random)});
        quality.lack = 1 / quality.module_px - 0.18;
        const double days = static_cast<double>((quality.day - day(kDays[0])).count());
        quality.values[2] = 0.75 - 0.001 * days - 5 * quality.lack + noise(random);
      }
    }
    const DistanceEffects distance = distance_effects(plates);
    for (const PlateState& plate : plates) {
      const PlateState judged = judge_quality(plate, {day(kDays[6]), distance});
      if (!judged.due) continue;
      ++stated;
      const Day truth = day(kDays[0]) + std::chrono::days(500);
      held += judged.due->not_before <= truth &&
                      (!judged.due->not_after || *judged.due->not_after >= truth)
                  ? 1
                  : 0;
    }
  }
  CHECK(stated == 2000);
  // 2000 plates: a standard deviation of 0.009.
  CHECK(static_cast<double>(held) / stated == doctest::Approx(kTrendConfidence).epsilon(0.04));
}

TEST_CASE("a photo without a date is counted and in no trend") {
  std::vector<PlateSighting> seen{good(kDays[0]), good(kDays[1])};
  for (PlateSighting& later : seen) later.entry = 1;
  PlateSighting undated = bad(kDays[2], TagStatus::misprinted, "mirrored");
  undated.taken.clear();
  seen.push_back(undated);
  const PlateState state = judge(seen);
  CHECK(state.photos == 3);
  CHECK(state.undated == 1);
  CHECK(state.action == PlateAction::none);
  // Its fault is told until a photo with a date shows the plate in order.
  CHECK(judge({undated}).action == PlateAction::reprint);
  REQUIRE(state.mended.size() == 1);
  CHECK_FALSE(state.mended[0].last_found);
  const auto undated_moved = [&] {
    PlateSighting moved = bad(kDays[0], TagStatus::misplaced, "moved");
    moved.taken.clear();
    return moved;
  }();
  CHECK(judge({undated_moved, good(kDays[0])}).action == PlateAction::rehang);
  auto hidden = undated;
  hidden.finding = {TagStatus::unreadable, "covered", ""};
  auto shown = good(kDays[0]);
  shown.taken.clear();
  CHECK(judge({hidden}).action == PlateAction::clean);
  CHECK(judge({hidden, shown}).action == PlateAction::unseen);
  CHECK(judge({}).action == PlateAction::unseen);
  // Nor what a ledger was made to say.
  undated.taken = "2026-99-99 nonsense";
  CHECK(judge({undated}).undated == 1);
}

}  // namespace tagsmith::detail
