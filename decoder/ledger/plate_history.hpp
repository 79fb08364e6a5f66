// SPDX-License-Identifier: Apache-2.0
// What the ledger's photos show of one plate: its condition, and what must be done about it.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "decoder/ledger/ledger.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// ---- A straight line through the daily measurements, and when it falls to a limit.

struct TrendPoint {
  double day = 0;
  double value = 0;
};

// Fewer days show no trend: two points are always on a line.
inline constexpr std::size_t kLeastTrendDays = 3;

// For the intervals that are stated: the share of them that hold the true day.
inline constexpr double kTrendConfidence = 0.80;

// The least-squares line.
struct Trend {
  std::size_t days = 0;
  double first = 0;    // day
  double last = 0;     // day
  double middle = 0;   // mean of the days
  double spread = 0;   // sum of the squared distances from it
  double level = 0;    // at the middle
  double slope = 0;    // per day
  double scatter = 0;  // standard deviation of a day's value about the line
  // How far the line's height may be off by the distances of the photos, at the middle and per day:
  // half of an interval of kTrendConfidence.
  double distance_level = 0;
  double distance_slope = 0;

  double at(double day) const { return level + slope * (day - middle); }
};

// Nothing of fewer than kLeastTrendDays different days. The points are in the order of their days.
std::optional<Trend> fit_trend(const std::vector<TrendPoint>& points);

// When a line that falls is at the limit, not before the trend's last day; and the interval that
// holds the true day with kTrendConfidence.
struct Crossing {
  std::optional<double> expected;  // nothing for a line that does not fall
  std::optional<double> earliest;  // nothing = never
  std::optional<double> latest;    // nothing = perhaps never
};

// Of a trend that is above the limit on its last day. Exact where values scatter normally about a
// line (Fieller, J. Royal Statistical Society B 16, 1954: 175).
Crossing crossing_of(const Trend& trend, double limit);

// ---- One plate.

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

// A fault in photos of a day.
struct SeenFault {
  Finding finding;
  double module_px = 0;  // the least at which it was found
  long entry = 0;        // the last of these photos (PlateSighting::entry)
  // From its surveyed place, where that is more than the standard deviation explains.
  std::optional<std::array<double, 3>> offset_mm{};
};

// All photos of a plate of one day.
struct PlateDay {
  std::size_t read = 0;    // photos in which it was read, with a fault or without
  std::size_t unread = 0;  // that show plates on both sides read, and it not
  bool in_order = false;
  bool placed = false;  // in order in a photo that showed where it hangs
  // Standard deviations to which these photos showed it; one that does not say has zeros.
  std::vector<std::array<double, 3>> placed_sigma_mm;
  bool up_known = false;  // in order in a photo whose up is known
  double module_px = 0;   // the widest in a photo in which it was in order
  long entry = 0;         // the last of the photos in which it was in order
  std::vector<WearSample> samples;
  std::map<std::string, SeenFault> faults;  // by rule
  std::optional<std::array<double, 3>> offset_mm;
};

struct PlateHistory {
  std::size_t photos = 0;
  std::size_t undated = 0;
  // All photos without a date. Their faults are open until a photo that was entered later, and that
  // has a date, shows the plate in order.
  PlateDay without_day;
  std::map<Day, PlateDay> days;
};

// Adds a photo in which the plate is wholly in view. One that is dated after `last`, or before
// kFirstPhotos, was taken with a wrong clock and counts as undated. `is_between_read`: the photo
// shows plates of its wall on both sides of it that were read.
void add(const PlateSighting& seen, Day last, bool is_between_read, PlateHistory& history);

// The best of a day: what lowers a grade below the plate's own is caused by the photo.
struct PlateQuality {
  Day day;
  double grade = 0;
  double module_px = 0;
  double lack = 0;  // 1 / module_px more than at the plate's usual distance
  WearValues values{};
};

// The quality in which the trend reaches the limit first.
struct PlateDue {
  GradeParameter parameter = GradeParameter::modulation;
  Trend trend;  // of the value at the plate's usual distance; defects rise
  double limit = 0;
  bool is_past = false;  // on the last day it was beyond it
  Day not_before{};
  std::optional<Day> expected{};   // nothing = beyond the range of the trend
  std::optional<Day> not_after{};  // nothing = perhaps never
};

struct MendedFault {
  std::string tag;
  std::string rule;               // of docs/verify-rules.md; empty = the print's quality
  std::optional<Day> last_found;  // nothing = in photos without a date
  Day in_order;
};

struct PlateState {
  std::string tag;
  PlateAction action = PlateAction::none;
  std::string reason;                // why, in words; empty without an action
  std::optional<PlateAction> cure;   // for what must be planned
  std::vector<PlateQuality> series;  // since it was last mended
  std::optional<PlateDue> due;       // nothing = no trend yet
  std::vector<MendedFault> mended;
  std::optional<Day> last_seen;  // in order
  std::size_t photos = 0;
  std::size_t undated = 0;
  std::optional<std::array<double, 3>> offset_mm;  // from the last day that has it
};

// What a quality changes by with PlateQuality::lack: blur takes the more from it the fewer pixels a
// module has.
struct DistanceEffect {
  double slope = 0;         // better is greater
  double half_width = 1e6;  // of the interval of kTrendConfidence about it; so great: not known
};
using DistanceEffects = std::array<DistanceEffect, kWearParameters.size()>;

// The same for all plates, because their photos are of the same cameras. Tells wear from distance
// where plates have four days or more, or several have three.
DistanceEffects distance_effects(const std::vector<PlateState>& plates);

// What the photos of all plates say together.
struct AllPlates {
  Day newest;  // of the newest photo
  DistanceEffects distance{};
  bool most_fall = false;  // as LedgerReport::blames_camera
};

// By the plate's faults, and with its series; judge_quality then judges that, too.
PlateState describe_plate(const std::string& tag, const PlateHistory& history);
PlateState judge_quality(PlateState state, const AllPlates& all);

// ---- What the ledger says of all plates of a survey.

struct LedgerReport {
  LedgerCounts photos;
  std::optional<Day> oldest;        // day of the oldest photo of a plate
  std::optional<Day> newest;        // day of the newest one: now, in what follows
  std::vector<PlateState> plates;   // all of the survey, the most urgent first
  std::vector<MendedFault> mended;  // the latest first
  std::size_t trends = 0;           // plates that have one
  // Faults of plates that were not read and that the survey now calls otherwise, or not at all.
  std::size_t nameless = 0;
  std::size_t falling = 0;       // of these, on their way to the limit
  std::size_t losing_light = 0;  // of these, by contrast or modulation

  // Plates do not all get dirty or wear at the same time: then it is a lens, its focus, a lamp, or
  // dust in the air.
  bool blames_camera() const { return trends >= 5 && 2 * falling > trends; }
};

// What to do when the report blames the camera, in words.
std::string camera_in_words(const LedgerReport& report);

// No photo can have been taken after the day `last`: photos with a later date count as undated.
Result<LedgerReport> make_ledger_report(const Survey& survey, const Ledger& ledger, Day last);

// The survey's plates for which this must be done, in the survey's order.
std::vector<std::string> plates_to(PlateAction action, const Survey& survey,
                                   const LedgerReport& report);

}  // namespace tagsmith::detail
