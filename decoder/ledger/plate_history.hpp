// SPDX-License-Identifier: Apache-2.0
// What the ledger's photos say of one plate: how it fares, and what is to be done about it.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "decoder/ledger/ledger.hpp"
#include "decoder/ledger/trend.hpp"

namespace tagsmith::detail {

using Day = std::chrono::sys_days;

// What to do about a plate, the most urgent first.
enum class PlateAction {
  reprint,  // its bars are worn, damaged or wrong
  clean,    // light is lost, and the bars are where they were
  rehang,   // it hangs wrong
  look,     // its neighbours are seen and it is not, or it suddenly fails
  plan,     // nothing yet: its trend falls to the limit
  none,
  unseen,  // no dated photo shows it
};
inline constexpr std::size_t kPlateActions = 7;

std::string to_string(PlateAction action);

// A graded symbol in a photo.
struct WearSample {
  double module_px = 0;
  double grade = 0;
  WearValues values{};
};

// All photos of a plate of one day.
struct PlateDay {
  std::size_t photos = 0;
  bool in_order = false;
  bool placed = false;    // in order in a photo that told where it hangs
  bool up_known = false;  // in order in a photo that told which way is up
  std::vector<WearSample> samples;
  std::map<std::string, Finding> faults;  // by rule
  std::optional<std::array<double, 3>> offset_mm;
};

struct PlateHistory {
  std::size_t photos = 0;
  std::size_t undated = 0;
  PlateDay without_day;  // all photos that say no day: their faults are taken for older than others
  std::map<Day, PlateDay> days;
};

// Adds a photo in which the plate is wholly in view. One that is dated after `last` was taken with
// a wrong clock and counts as undated.
void add(const PlateSighting& seen, Day last, PlateHistory& history);

// The best of a day: what lowers a grade beyond the plate's own is the photo's.
struct PlateQuality {
  Day day;
  double grade = 0;
  double module_px = 0;
  WearValues values{};
};

// The quality in which the trend reaches the limit first.
struct PlateDue {
  GradeParameter parameter = GradeParameter::modulation;
  Trend trend;  // of the measured value; defects rise
  double limit = 0;
  bool is_past = false;  // on the last day it was beyond it
  Day not_before{};
  std::optional<Day> expected{};   // nothing = beyond what the trend can tell
  std::optional<Day> not_after{};  // nothing = perhaps never
};

struct MendedFault {
  std::string tag;
  std::string rule;               // of docs/verify-rules.md; empty = the print's quality
  std::optional<Day> last_found;  // nothing = in photos that say no day
  Day in_order;
};

struct PlateState {
  std::string tag;
  PlateAction action = PlateAction::none;
  std::string reason;                // why, in words; empty without an action
  std::optional<PlateAction> cure;   // of what is to be planned
  std::vector<PlateQuality> series;  // since it was last mended
  std::optional<PlateDue> due;       // nothing = no trend yet
  std::vector<MendedFault> mended;
  std::optional<Day> last_seen;  // in order
  std::size_t photos = 0;
  std::size_t undated = 0;
  std::optional<std::array<double, 3>> offset_mm;  // of the last day that says it
};

// By the plate's own photos. `newest`: the day of the newest photo of all plates.
PlateState judge_plate(const std::string& tag, const PlateHistory& history, Day newest);

}  // namespace tagsmith::detail
