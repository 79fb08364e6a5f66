// SPDX-License-Identifier: Apache-2.0
#include "decoder/ledger/plate_history.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "decoder/verify/verify_json.hpp"
#include "decoder/verify/verify_merge.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {

// ---- Trends.

namespace {

// Student's t that is exceeded with a probability of 0.1, so that 0.8 lie within it on both sides.
// Beyond the table by Cornish and Fisher's expansion (Abramowitz and Stegun 26.7.5).
double student_t(std::size_t degrees_of_freedom) {
  constexpr std::array kTable{3.0777, 1.8856, 1.6377, 1.5332, 1.4759,
                              1.4398, 1.4149, 1.3968, 1.3830, 1.3722};
  if (degrees_of_freedom <= kTable.size()) return kTable[degrees_of_freedom - 1];
  constexpr double kNormal = 1.28155;
  const auto n = static_cast<double>(degrees_of_freedom);
  const double cube = kNormal * kNormal * kNormal;
  return kNormal + (cube + kNormal) / (4 * n) +
         (5 * cube * kNormal * kNormal + 16 * cube + 3 * kNormal) / (96 * n * n);
}

// Where a x^2 + b x + c is 0, the lesser one first; infinite where there is no such place.
std::pair<double, double> roots(double a, double b, double c) {
  const double inside = b * b - 4 * a * c;
  if (!(inside >= 0) || a == 0) return {-INFINITY, INFINITY};
  const double q = -(b + std::copysign(std::sqrt(inside), b)) / 2;
  const double other = q == 0 ? 0 : c / q;
  return std::minmax({q / a, other});
}

}  // namespace

std::optional<Trend> fit_trend(const std::vector<TrendPoint>& points) {
  if (points.size() < kLeastTrendDays) return std::nullopt;
  Trend trend{points.size(), points.front().day, points.back().day};
  const auto count = static_cast<double>(points.size());
  for (const TrendPoint& point : points) {
    trend.middle += point.day / count;
    trend.level += point.value / count;
  }
  double product = 0;
  for (const TrendPoint& point : points) {
    trend.spread += (point.day - trend.middle) * (point.day - trend.middle);
    product += (point.day - trend.middle) * (point.value - trend.level);
  }
  if (!(trend.spread > 0)) return std::nullopt;
  trend.slope = product / trend.spread;
  double squares = 0;
  for (const TrendPoint& point : points) squares += std::pow(point.value - trend.at(point.day), 2);
  trend.scatter = std::sqrt(squares / (count - 2));
  return trend;
}

Crossing crossing_of(const Trend& trend, double limit) {
  // At x from the middle, the edges of the line's confidence band are above and below it by the
  // root of k^2 (1 / n + x^2 / spread) + (distance_level + distance_slope x)^2; they are at the
  // limit where the square of the line's height is that of this half width.
  const double k = student_t(trend.days - 2) * trend.scatter;
  const double height = trend.level - limit;
  const double a = trend.slope * trend.slope - k * k / trend.spread -
                   trend.distance_slope * trend.distance_slope;
  const double b = 2 * (trend.slope * height - trend.distance_level * trend.distance_slope);
  const double c = height * height - k * k / static_cast<double>(trend.days) -
                   trend.distance_level * trend.distance_level;
  const auto [lesser, greater] = roots(a, b, c);
  const bool surely_falls = a > 0 && trend.slope < 0;
  const bool surely_above = c > 0;  // in the middle
  Crossing crossing;
  const auto set = [&](std::optional<double>& day, double from_middle) {
    if (std::isfinite(from_middle)) day = std::max(trend.last, trend.middle + from_middle);
  };
  if (trend.slope < 0) set(crossing.expected, -height / trend.slope);
  if (surely_falls) set(crossing.latest, greater);
  if (!surely_above) {
    crossing.earliest = trend.last;
  } else if (surely_falls) {
    set(crossing.earliest, lesser);
  } else if (a < 0) {
    set(crossing.earliest, greater);
  }
  return crossing;
}

// ---- One plate.

namespace {

// What repairs the plate that this rule was reported of; nothing where the photo is at fault.
std::optional<PlateAction> cure_of(std::string_view rule) {
  const Rule* reported = find_verify_rule(rule);
  if (reported == nullptr) return std::nullopt;
  return value_named<PlateAction>(reported->action, kPlateActions);
}

// Whether an offset is more than its standard deviations explain by chance.
bool is_significant(const std::array<double, 3>& offset, const std::array<double, 3>& sigma) {
  constexpr double kSurely = 3;  // standard deviations
  double squares = 0;
  for (std::size_t i = 0; i < offset.size(); ++i) {
    if (offset[i] != 0) squares += std::pow(offset[i] / sigma[i], 2);
  }
  return squares >= kSurely * kSurely;
}

// A drive that measures less exactly than the plate is off fits it wherever it hangs.
bool shows_place_of(const PlateDay& day, const SeenFault& fault) {
  if (!fault.offset_mm) return day.placed;
  return std::ranges::any_of(day.placed_sigma_mm, [&](const std::array<double, 3>& sigma) {
    return is_significant(*fault.offset_mm, sigma);
  });
}

// Whether the fault would have been found on this day, on which the plate was in order. A photo
// that shows a plate smaller than the fault was found at may not show the fault.
bool tells(const PlateDay& day, const SeenFault& fault) {
  constexpr double kAsLarge = 0.8;
  switch (fault.finding.status) {
    case TagStatus::misplaced:
    case TagStatus::doubtful:
    case TagStatus::duplicate:
      return shows_place_of(day, fault);
    case TagStatus::misprinted:
      return day.module_px >= kAsLarge * fault.module_px &&
             (!fault.finding.is_upside_down() || day.up_known);
    default:
      return true;
  }
}

// Better is greater.
double goodness(std::size_t parameter, double value) {
  return kWearParameters[parameter] == GradeParameter::defects ? -value : value;
}

double failing(std::size_t parameter) {
  return goodness(parameter, grade_limits(kWearParameters[parameter])[3]);
}

struct FaultHistory {
  std::optional<MendedFault> mended;
  std::optional<SeenFault> open;
  std::optional<Day> found;     // the open fault, last
  std::optional<Day> in_order;  // later by its date, in photos that had been entered before
};

// What was entered before a fault mends it by its date alone, and clocks are reset.
FaultHistory trace_fault(const std::string& tag, const PlateHistory& history,
                         const std::string& rule) {
  FaultHistory traced;
  const auto undated = history.without_day.faults.find(rule);
  if (undated != history.without_day.faults.end()) traced.open = undated->second;
  for (const auto& [day, seen] : history.days) {
    const auto fault = seen.faults.find(rule);
    if (fault != seen.faults.end()) {
      const SeenFault before = traced.open.value_or(fault->second);
      traced = {std::nullopt, fault->second, day, std::nullopt};
      traced.open->module_px = std::min(before.module_px, traced.open->module_px);
      traced.open->entry = std::max(before.entry, traced.open->entry);
      if (!traced.open->offset_mm) traced.open->offset_mm = before.offset_mm;
    } else if (traced.open && seen.in_order && tells(seen, *traced.open)) {
      if (seen.entry >= traced.open->entry) {
        traced = {MendedFault{tag, rule, traced.found, day}, {}, {}, {}};
      } else {
        traced.in_order = day;
      }
    }
  }
  return traced;
}

// What separates a grade from the one below, near the limit.
double grade_step(std::size_t parameter) {
  const auto limits = grade_limits(kWearParameters[parameter]);
  return std::abs(limits[2] - limits[3]);
}

// Photos of one plate are compared where they show it about equally large: the fewer pixels a
// module has, the more the lens takes from modulation and decodability (DistanceEffect).
std::vector<PlateQuality> qualities_of(const PlateHistory& history) {
  constexpr double kLikeScale = 1.5;
  std::vector<double> sizes;
  for (const auto& [day, seen] : history.days) {
    double largest = 0;
    for (const WearSample& sample : seen.samples) largest = std::max(largest, sample.module_px);
    if (largest > 0) sizes.push_back(largest);
  }
  if (sizes.empty()) return {};
  const double usual = quantile(sizes, 0.5);
  std::vector<PlateQuality> qualities;
  for (const auto& [day, seen] : history.days) {
    PlateQuality best{day};
    for (const WearSample& sample : seen.samples) {
      if (sample.module_px > usual * kLikeScale || sample.module_px < usual / kLikeScale) continue;
      best.module_px = std::max(best.module_px, sample.module_px);
      best.grade = std::max(best.grade, sample.grade);
      for (std::size_t i = 0; i < best.values.size(); ++i) {
        const auto& value = sample.values[i];
        if (!value || (best.values[i] && goodness(i, *value) <= goodness(i, *best.values[i]))) {
          continue;
        }
        best.values[i] = value;
      }
    }
    if (best.module_px > 0) qualities.push_back(best);
  }
  return qualities;
}

// Whether `grade` is by a whole grade above the better one of the two days before day i.
bool rises_to(double grade, std::span<const PlateQuality> days, std::size_t i) {
  constexpr double kRise = 1.0;
  return i >= 2 && grade - std::max(days[i - 1].grade, days[i - 2].grade) >= kRise;
}

// Where the last series begins: the plate was cleaned or replaced when its grade rises by a whole
// grade above the better one of the two days before, and is as high on the next day. A single bad
// day, or a single good one before others, is no such rise.
std::size_t find_rise(std::span<const PlateQuality> days) {
  for (std::size_t i = days.size(); i-- > 3;) {
    if (rises_to(std::min(days[i - 1].grade, days[i].grade), days, i - 1)) return i - 1;
  }
  return 0;
}

Day day_of(double days) { return Day(std::chrono::days(static_cast<int>(std::floor(days)))); }

// When the trend of one quality is at its limit. Nothing is said beyond twice the days observed.
PlateDue due_of(Trend trend, std::size_t parameter) {
  const double limit = failing(parameter);
  const double horizon = trend.last + 2 * (trend.last - trend.first);
  Crossing crossing{trend.last, trend.last, trend.last};
  const bool is_past = trend.at(trend.last) <= limit;
  if (!is_past) crossing = crossing_of(trend, limit);
  const auto within = [&](std::optional<double> day) {
    return day && *day <= horizon ? std::optional(day_of(*day)) : std::nullopt;
  };
  trend.level = goodness(parameter, trend.level);
  trend.slope = goodness(parameter, trend.slope);
  PlateDue due{kWearParameters[parameter], trend, goodness(parameter, limit), is_past};
  due.not_before = within(crossing.earliest).value_or(day_of(horizon));
  due.expected = within(crossing.expected);
  due.not_after = within(crossing.latest);
  return due;
}

// One quality over the days that have it.
struct QualityPoints {
  std::vector<TrendPoint> goodness;
  std::vector<TrendPoint> lack;  // PlateQuality::lack
};

QualityPoints points_of(std::span<const PlateQuality> series, std::size_t parameter) {
  QualityPoints points;
  for (const PlateQuality& quality : series) {
    if (!quality.values[parameter]) continue;
    const auto day = static_cast<double>(quality.day.time_since_epoch().count());
    points.goodness.push_back({day, goodness(parameter, *quality.values[parameter])});
    points.lack.push_back({day, quality.lack});
  }
  return points;
}

// The series as photos from the usual distance would show it.
std::vector<PlateQuality> at_usual_distance(std::span<const PlateQuality> series,
                                            const DistanceEffects& effects) {
  std::vector<PlateQuality> usual(series.begin(), series.end());
  for (PlateQuality& day : usual) {
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (day.values[i]) *day.values[i] -= goodness(i, effects[i].slope * day.lack);
    }
  }
  return usual;
}

// The first to reach its limit, of a series at the usual distance. Nothing where the distance may
// have made a whole grade.
std::optional<PlateDue> first_due(std::span<const PlateQuality> series,
                                  const DistanceEffects& effects) {
  std::optional<PlateDue> first;
  const auto is_earlier = [](const PlateDue& a, const PlateDue& b) {
    if (a.expected.has_value() != b.expected.has_value()) return a.expected.has_value();
    return a.expected && *a.expected != *b.expected ? *a.expected < *b.expected
                                                    : a.not_before < b.not_before;
  };
  for (std::size_t i = 0; i < kWearParameters.size(); ++i) {
    const QualityPoints points = points_of(series, i);
    std::optional<Trend> trend = fit_trend(points.goodness);
    if (!trend) continue;
    const Trend lack = *fit_trend(points.lack);
    if (effects[i].half_width * std::abs(lack.at(lack.last)) > grade_step(i)) return std::nullopt;
    trend->distance_level = effects[i].half_width * lack.level;
    trend->distance_slope = effects[i].half_width * lack.slope;
    const PlateDue due = due_of(*trend, i);
    if (!first || is_earlier(due, *first)) first = due;
  }
  return first;
}

// Dirt takes light; wear and damage move edges and tear elements. So lost contrast or modulation
// is cleaned while the edges are where they belong, all else is printed anew. Where most plates
// fall the camera may be what moved.
PlateAction cure_of(GradeParameter parameter, const WearValues& values, const AllPlates& all) {
  const auto is_sound = [&](std::size_t i) {
    const auto limits = grade_limits(kWearParameters[i]);
    return !values[i] || goodness(i, *values[i]) >= goodness(i, limits[2]);  // grade 2
  };
  const bool edges_are_sound = is_sound(2) && is_sound(3);
  const bool is_light =
      parameter == GradeParameter::symbol_contrast || parameter == GradeParameter::modulation;
  if (all.most_fall) return PlateAction::look;
  return is_light && edges_are_sound ? PlateAction::clean : PlateAction::reprint;
}

std::string in_words(const PlateDue& due) {
  const std::string name = to_string(due.parameter);
  const double now = due.trend.at(due.trend.last);
  return fmt::format("{} {:.2f}, limit {:.2f}", name, now, due.limit);
}

// The quality of a day that is beyond its limit; what wears before what light does.
std::optional<std::size_t> failed_parameter(const PlateQuality& day) {
  for (std::size_t i = kWearParameters.size(); i-- > 0;) {
    if (day.values[i] && goodness(i, *day.values[i]) < failing(i)) return i;
  }
  return std::nullopt;
}

void act(PlateAction action, const std::string& reason, PlateState& state) {
  if (action >= state.action) return;
  state.action = action;
  state.reason = reason;
}

// A trend does not know what happened at once. What one day shows may be the day's, or the
// camera's, so somebody is to look; two days are believed, where it is not the distance.
void judge_last_days(std::span<const PlateQuality> series, std::span<const PlateQuality> at_usual,
                     const AllPlates& all, PlateState& state) {
  const PlateQuality& last = series.back();
  const auto parameter = failed_parameter(last);
  if (!parameter) return;
  const bool is_alone = series.size() == 1 || !failed_parameter(at_usual.back()) ||
                        !failed_parameter(at_usual[at_usual.size() - 2]);
  act(is_alone ? PlateAction::look : cure_of(kWearParameters[*parameter], last.values, all),
      fmt::format("{} {:.2f} on {}, limit {:.2f}", to_string(kWearParameters[*parameter]),
                  *last.values[*parameter], to_text(last.day),
                  grade_limits(kWearParameters[*parameter])[3]),
      state);
}

void judge_days(std::span<const PlateQuality> series, const AllPlates& all, PlateState& state) {
  if (series.empty()) return;
  const std::vector<PlateQuality> at_usual = at_usual_distance(series, all.distance);
  state.due = first_due(at_usual, all.distance);
  if (!state.due || !state.due->is_past) judge_last_days(series, at_usual, all, state);
  if (!state.due || !state.due->expected) return;
  const PlateAction cure = cure_of(state.due->parameter, at_usual.back().values, all);
  const bool is_now = *state.due->expected <= all.newest;
  if (!is_now && state.action > PlateAction::plan) state.cure = cure;
  act(is_now ? cure : PlateAction::plan, in_words(*state.due), state);
}

void judge_faults(const PlateHistory& history, PlateState& state) {
  std::map<std::string, SeenFault> rules = history.without_day.faults;
  for (const auto& [day, seen] : history.days) rules.insert(seen.faults.begin(), seen.faults.end());
  for (const auto& [rule, fault] : rules) {
    const FaultHistory traced = trace_fault(state.tag, history, rule);
    if (traced.mended) state.mended.push_back(*traced.mended);
    if (!traced.open) continue;
    const std::string& message = traced.open->finding.message;
    if (traced.found && traced.in_order) {
      act(PlateAction::look,
          fmt::format("{}: found on {} in a photo that was entered after those that show it in "
                      "order on {}: is its date right?",
                      message, to_text(*traced.found), to_text(*traced.in_order)),
          state);
    } else {
      const bool is_doubtful = traced.open->finding.status == TagStatus::doubtful;
      act(is_doubtful ? PlateAction::look : cure_of(rule).value_or(PlateAction::none), message,
          state);
    }
  }
}

// Distance and light explain a plate that is unread in a photo, and not where the plates on both
// sides of it are read. That most photos of a day say so may be the day's; two days are believed.
void judge_unread(const PlateHistory& history, PlateState& state) {
  std::size_t days = 0, photos = 0, unread = 0;
  Day since{};
  for (const auto& [day, seen] : history.days) {
    if (seen.read + seen.unread == 0) continue;
    if (seen.unread <= seen.read) {
      days = photos = unread = 0;
      continue;
    }
    if (days++ == 0) since = day;
    photos += seen.read + seen.unread;
    unread += seen.unread;
  }
  if (days < 2) return;
  act(PlateAction::look,
      fmt::format("unread in {} of {} photos since {}, while plates on both sides were read",
                  unread, photos, to_text(since)),
      state);
}

// The days since the plate was last cleaned or replaced.
void find_series(const PlateHistory& history, PlateState& state) {
  state.series = qualities_of(history);
  const std::size_t rise = find_rise(state.series);
  Day begin = state.series.empty() ? Day{} : state.series[rise].day;
  if (rise > 0) state.mended.push_back({state.tag, "", state.series[rise - 1].day, begin});
  for (const MendedFault& fault : state.mended) {
    const auto cure = cure_of(fault.rule);
    if (cure && *cure <= PlateAction::clean) begin = std::max(begin, fault.in_order);
  }
  std::erase_if(state.series, [&](const PlateQuality& day) { return day.day < begin; });
  std::vector<double> sizes;
  for (const PlateQuality& day : state.series) sizes.push_back(day.module_px);
  const double usual = sizes.empty() ? 0 : quantile(sizes, 0.5);
  for (PlateQuality& day : state.series) day.lack = 1 / day.module_px - 1 / usual;
}

}  // namespace

std::string to_string(PlateAction action) {
  constexpr std::array kNames{"reprint", "clean", "rehang", "look", "plan", "none", "unseen"};
  return kNames[static_cast<std::size_t>(action)];
}

void add(const PlateSighting& seen, Day last, bool is_between_read, PlateHistory& history) {
  if (seen.finding.status == TagStatus::cut_off) return;
  ++history.photos;
  const auto day = parse_day(std::string_view(seen.taken).substr(0, 10));
  const bool has_day = day && *day <= last && seen.taken >= kFirstPhotos;
  if (!has_day) ++history.undated;
  PlateDay& of_day = has_day ? history.days[*day] : history.without_day;
  if (seen.offset_mm) of_day.offset_mm = seen.offset_mm;
  if (seen.finding.status != TagStatus::unreadable) {
    ++of_day.read;
  } else if (is_between_read && cure_of(seen.finding.rule)) {
    ++of_day.unread;
  }
  if (seen.finding.is_fault()) {
    if (!cure_of(seen.finding.rule)) return;
    const auto [found, ignored] = of_day.faults.try_emplace(
        seen.finding.rule, SeenFault{seen.finding, seen.module_px, seen.entry});
    SeenFault& fault = found->second;
    fault.module_px = std::min(fault.module_px, seen.module_px);
    fault.entry = std::max(fault.entry, seen.entry);
    if (seen.offset_mm && seen.offset_sigma_mm &&
        is_significant(*seen.offset_mm, *seen.offset_sigma_mm)) {
      fault.offset_mm = seen.offset_mm;
    }
    return;
  }
  of_day.in_order = true;
  of_day.entry = std::max(of_day.entry, seen.entry);
  if (seen.hanging == "fits") {
    of_day.placed = true;
    of_day.placed_sigma_mm.push_back(seen.offset_sigma_mm.value_or(std::array<double, 3>{}));
  }
  of_day.up_known = of_day.up_known || seen.up_known;
  of_day.module_px = std::max(of_day.module_px, seen.module_px);
  if (seen.grade) of_day.samples.push_back({seen.module_px, *seen.grade, seen.values});
}

PlateState describe_plate(const std::string& tag, const PlateHistory& history) {
  // What hid the plate in one photo and not in another of the day is not on the plate.
  const auto forgive = [](PlateDay& seen) {
    if (!seen.in_order) return;
    std::erase_if(seen.faults, [](const auto& fault) {
      return fault.second.finding.status == TagStatus::unreadable;
    });
  };
  PlateHistory dated = history;
  forgive(dated.without_day);
  for (auto& [day, seen] : dated.days) forgive(seen);
  PlateState state;
  state.tag = tag;
  state.photos = history.photos;
  state.undated = history.undated;
  for (const auto& [day, seen] : dated.days) {
    if (seen.in_order) state.last_seen = day;
    if (seen.offset_mm) state.offset_mm = seen.offset_mm;
  }
  judge_faults(dated, state);
  judge_unread(history, state);
  find_series(dated, state);
  if (dated.days.empty() && state.action == PlateAction::none) {
    state.action = PlateAction::unseen;
  }
  return state;
}

namespace {

// What the days of all plates sum to, the plates' own levels and trends taken away.
struct DistanceSums {
  double squares = 0;   // of the lacks
  double product = 0;   // of lacks and goodness
  double goodness = 0;  // squares of it
  std::ptrdiff_t freedom = -1;
  std::map<double, std::pair<double, double>> days;  // squares, product
};

DistanceSums sums_of(const std::vector<PlateState>& plates, std::size_t parameter) {
  DistanceSums sums;
  for (const PlateState& plate : plates) {
    const QualityPoints points = points_of(plate.series, parameter);
    const std::optional<Trend> trend = fit_trend(points.goodness);
    if (!trend) continue;
    const Trend lack_trend = *fit_trend(points.lack);
    for (std::size_t i = 0; i < points.lack.size(); ++i) {
      const auto [day, lack] = points.lack[i];
      const double unusual = lack - lack_trend.at(day);
      const double better = points.goodness[i].value - trend->at(day);
      sums.squares += unusual * unusual;
      sums.product += unusual * better;
      sums.goodness += better * better;
      sums.days[day].first += unusual * unusual;
      sums.days[day].second += unusual * better;
    }
    sums.freedom += static_cast<std::ptrdiff_t>(points.lack.size()) - 2;
  }
  return sums;
}

// Plates of one day share its lamps and its fog: the deviation is the greater one of that by single
// days of plates and that by whole days (Liang and Zeger, Biometrika 73, 1986: 13).
DistanceEffect effect_of(const DistanceSums& sums) {
  constexpr double kOneDistance = 1e-12;  // sizes are rounded to far more
  if (sums.squares < kOneDistance || sums.freedom < 1) return {};
  DistanceEffect effect{sums.product / sums.squares};
  const auto freedom = static_cast<double>(sums.freedom);
  const double left = std::max(0.0, sums.goodness - effect.slope * sums.product) / freedom;
  double by_days = 0;
  for (const auto& [day, sum] : sums.days) {
    by_days += std::pow(sum.second - effect.slope * sum.first, 2);
  }
  const std::size_t days = sums.days.size();
  by_days *= static_cast<double>(days) / static_cast<double>(days - 1);
  const double deviation = std::sqrt(std::max(left * sums.squares, by_days)) / sums.squares;
  const std::size_t fewest = std::min(static_cast<std::size_t>(sums.freedom), days - 1);
  effect.half_width = student_t(fewest) * deviation;
  return effect;
}

}  // namespace

DistanceEffects distance_effects(const std::vector<PlateState>& plates) {
  DistanceEffects effects;
  for (std::size_t i = 0; i < effects.size(); ++i) effects[i] = effect_of(sums_of(plates, i));
  return effects;
}

// A last day that is better at once may be a plate that was cleaned, or a camera that sharpens:
// until another day tells, the days before it are judged, and somebody is to look.
PlateState judge_quality(PlateState state, const AllPlates& all) {
  const std::span<const PlateQuality> series = state.series;
  if (series.empty() || !rises_to(series.back().grade, series, series.size() - 1)) {
    judge_days(series, all, state);
    return state;
  }
  PlateState before = state;
  judge_days(series.first(series.size() - 1), all, before);
  state.due = before.due;
  if (before.action >= std::min(state.action, PlateAction::look)) {
    state.cure = before.cure;
    act(before.action, before.reason, state);
    return state;
  }
  act(PlateAction::look,
      fmt::format("{}; better on {} alone: photograph it on another day", before.reason,
                  to_text(series.back().day)),
      state);
  return state;
}

// ---- All plates.

namespace {

using Histories = std::map<std::string, PlateHistory>;

// The survey's plates that photos show, by what they were called in each state of the survey.
class PlateNames {
 public:
  explicit PlateNames(const Survey& survey) : revision_(survey_revision(survey)) {
    for (const PlacedTag& tag : survey.tags) {
      of_digits_[tag.digits] = &tag;
      named_[tag.name] = &tag;
    }
  }

  // The plate that a photo shows by its digits, whatever it was called then; nothing where it was
  // not read, or was misprinted: such a plate is known by its name alone.
  const PlacedTag* by_digits(const PlateSighting& seen) {
    const auto digits = parse_digits(seen.digits);
    const PlacedTag* tag = digits ? found(of_digits_, *digits) : nullptr;
    if (tag != nullptr && !seen.finding.is_fault()) {
      meant_[{seen.revision, seen.tag}] = tag;
      if (tag->name != seen.tag) renamed_.insert(seen.revision);
    }
    return tag;
  }

  // The plate that had this name in the state of the survey that the photo was verified against:
  // the one that other photos then showed under it, else the one that has the name now; nothing
  // where plates had other names then. Only after by_digits() of all sightings.
  const PlacedTag* by_name(const PlateSighting& seen) const {
    if (!seen.digits.empty() && !seen.finding.is_fault()) return nullptr;
    if (seen.revision == revision_) return found(named_, std::string_view(seen.tag));
    const auto meant = meant_.find({seen.revision, seen.tag});
    if (meant != meant_.end()) return meant->second;
    return renamed_.contains(seen.revision) ? nullptr : found(named_, std::string_view(seen.tag));
  }

 private:
  template <class Map>
  static const PlacedTag* found(const Map& tags, const typename Map::key_type& key) {
    const auto tag = tags.find(key);
    return tag == tags.end() ? nullptr : tag->second;
  }

  std::string revision_;
  std::map<Digits, const PlacedTag*> of_digits_;
  std::map<std::string_view, const PlacedTag*> named_;
  std::map<std::pair<std::string, std::string>, const PlacedTag*> meant_;  // by revision and name
  std::set<std::string> renamed_;  // states in which plates had other names
};

// Of the walls of a photo, from where to where plates were read, along the center line.
class ReadStretches {
 public:
  void add(const PlateSighting& seen, const PlacedTag& tag) {
    if (seen.finding.status == TagStatus::unreadable) return;
    const auto [stretch, is_first] =
        stretches_.try_emplace({seen.entry, tag.side}, tag.chainage, tag.chainage);
    auto& [least, most] = stretch->second;
    least = std::min(least, tag.chainage);
    most = std::max(most, tag.chainage);
  }

  bool contains(const PlateSighting& seen, const PlacedTag& tag) const {
    const auto stretch = stretches_.find({seen.entry, tag.side});
    return stretch != stretches_.end() && stretch->second.first < tag.chainage &&
           tag.chainage < stretch->second.second;
  }

 private:
  std::map<std::pair<long, Side>, std::pair<double, double>> stretches_;
};

// `nameless`: faults of plates that no longer have a name.
Result<Histories> read_histories(const Survey& survey, const Ledger& ledger, Day last,
                                 std::size_t& nameless) {
  Histories histories;
  PlateNames names(survey);
  ReadStretches read_stretches;
  std::vector<PlateSighting> unread;
  const auto take = [&](const PlateSighting& seen) {
    if (const PlacedTag* tag = names.by_digits(seen)) {
      read_stretches.add(seen, *tag);
      add(seen, last, false, histories[tag->name]);
    } else {
      unread.push_back(seen);
    }
  };
  if (auto read = ledger.for_each_sighting(survey.name, take); !read) {
    return fail(read);
  }
  for (const PlateSighting& seen : unread) {
    if (const PlacedTag* tag = names.by_name(seen)) {
      add(seen, last, read_stretches.contains(seen, *tag), histories[tag->name]);
    } else if (seen.finding.is_fault()) {
      ++nameless;
    }
  }
  return histories;
}

// Of each plate of a wall the days on which photos show plates on both sides of it, and not itself.
// A plate that fell down, or that is covered, is in no photo, and neither are the plates beside it
// where rock fell on all of them.
std::vector<std::vector<Day>> days_without(const Histories& histories,
                                           const std::vector<const PlacedTag*>& wall) {
  // In a row, about what a fall of rock or a parked machine takes. Of a longer stretch nobody may
  // have taken photos on that day, as beyond the last plate that was seen.
  constexpr std::size_t kMostMissing = 10;
  std::vector<std::vector<Day>> missed(wall.size());
  std::map<Day, std::size_t> seen_before;
  for (std::size_t i = 0; i < wall.size(); ++i) {
    const auto history = histories.find(wall[i]->name);
    if (history == histories.end()) continue;
    for (const auto& [day, seen] : history->second.days) {
      if (!seen.in_order) continue;
      const auto [before, is_first] = seen_before.try_emplace(day, i);
      if (!is_first && i - before->second <= kMostMissing + 1) {
        for (std::size_t between = before->second + 1; between < i; ++between) {
          missed[between].push_back(day);
        }
      }
      before->second = i;
    }
  }
  return missed;
}

// `missed`: of days_without.
void find_lost(const std::vector<Day>& missed, PlateState& state) {
  constexpr std::ptrdiff_t kEnough = 2;  // days; on a single one somebody may have stood before it
  const std::ptrdiff_t after = std::ranges::count_if(
      missed, [&](Day day) { return !state.last_seen || day > *state.last_seen; });
  if (after < kEnough || state.action <= PlateAction::look) return;
  state.action = PlateAction::look;
  state.cure.reset();
  state.reason = fmt::format(
      "{}; plates on both sides were, on {} days",
      state.last_seen ? "not seen since " + to_text(*state.last_seen) : std::string("never seen"),
      after);
}

void count_trend(const PlateState& plate, LedgerReport& report) {
  if (!plate.due) return;
  ++report.trends;
  if (!plate.due->expected) return;
  ++report.falling;
  const bool is_light = plate.due->parameter == GradeParameter::symbol_contrast ||
                        plate.due->parameter == GradeParameter::modulation;
  if (is_light) ++report.losing_light;
}

// The medians of the plates' last days.
WearValues usual_values(const std::vector<PlateState>& plates) {
  WearValues usual;
  for (std::size_t i = 0; i < usual.size(); ++i) {
    std::vector<double> values;
    for (const PlateState& plate : plates) {
      if (plate.due && plate.series.back().values[i]) {
        values.push_back(*plate.series.back().values[i]);
      }
    }
    if (!values.empty()) usual[i] = quantile(values, 0.5);
  }
  return usual;
}

// Whether a plate is worse than most by a whole grade, which the camera does to none alone.
bool stands_out(const PlateState& plate, const WearValues& usual) {
  for (std::size_t i = 0; i < usual.size() && !plate.series.empty(); ++i) {
    const auto& value = plate.series.back().values[i];
    if (value && usual[i] && goodness(i, *usual[i]) - goodness(i, *value) >= grade_step(i)) {
      return true;
    }
  }
  return false;
}

// Plates as they are described, judged by their series.
void judge_all(const std::vector<PlateState>& described, LedgerReport& report) {
  AllPlates all{report.newest.value_or(Day{}), distance_effects(described)};
  for (const PlateState& plate : described) {
    report.plates.push_back(judge_quality(plate, all));
    count_trend(report.plates.back(), report);
  }
  if (!report.blames_camera()) return;
  all.most_fall = true;
  const WearValues usual = usual_values(report.plates);
  for (std::size_t i = 0; i < described.size(); ++i) {
    PlateState& plate = report.plates[i];
    if (!stands_out(plate, usual)) plate = judge_quality(described[i], all);
  }
}

auto urgency(const PlateState& plate) {
  const bool is_dated = plate.due && plate.due->expected;
  return std::make_tuple(plate.action, !is_dated, is_dated ? *plate.due->expected : Day{});
}

}  // namespace

Result<LedgerReport> make_ledger_report(const Survey& survey, const Ledger& ledger, Day last) {
  const Result<LedgerCounts> photos =
      ledger.count_photos(survey.name, to_text(last), survey_revision(survey));
  if (!photos) return fail(photos);
  LedgerReport report;
  const Result<Histories> histories = read_histories(survey, ledger, last, report.nameless);
  if (!histories) return fail(histories);
  report.photos = *photos;
  for (const auto& [tag, history] : *histories) {
    if (history.days.empty()) continue;
    report.oldest = std::min(report.oldest.value_or(Day::max()), history.days.begin()->first);
    report.newest = std::max(report.newest.value_or(Day{}), history.days.rbegin()->first);
  }
  std::vector<PlateState> described;
  std::vector<std::vector<Day>> missed;
  for (const Side side : {Side::left, Side::right}) {
    const std::vector<const PlacedTag*> wall = tags_along(survey, side);
    for (const PlacedTag* tag : wall) {
      const auto history = histories->find(tag->name);
      described.push_back(describe_plate(
          tag->name, history == histories->end() ? PlateHistory{} : history->second));
    }
    std::ranges::move(days_without(*histories, wall), std::back_inserter(missed));
  }
  judge_all(described, report);
  for (std::size_t i = 0; i < report.plates.size(); ++i) {
    PlateState& state = report.plates[i];
    find_lost(missed[i], state);
    report.mended.insert(report.mended.end(), state.mended.begin(), state.mended.end());
  }
  std::ranges::stable_sort(report.plates, {}, urgency);
  std::ranges::stable_sort(report.mended, std::ranges::greater{}, &MendedFault::in_order);
  return report;
}

std::string camera_in_words(const LedgerReport& report) {
  return fmt::format(
      "{} of {} plates lose quality at once: clean the cameras' lenses first, and check focus, "
      "lamps "
      "and exposure; look at some plates before any is printed anew",
      report.falling, report.trends);
}

std::vector<std::string> plates_to(PlateAction action, const Survey& survey,
                                   const LedgerReport& report) {
  std::set<std::string_view> have_it;
  for (const PlateState& state : report.plates) {
    if (state.action == action) have_it.insert(state.tag);
  }
  std::vector<std::string> names;
  for (const PlacedTag& tag : survey.tags) {
    if (have_it.contains(tag.name)) names.push_back(tag.name);
  }
  return names;
}

}  // namespace tagsmith::detail
