// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_survey.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "tagsmith/base/date.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/check_tags.hpp"
#include "tagsmith/survey/check_together.hpp"
#include "tagsmith/survey/limits.hpp"
#include "tagsmith/survey/lint_tags.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tagsmith/survey/read_tunnel.hpp"
#include "tagsmith/survey/yaml_file.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {

// ---- The section `placed`.

namespace {

// An entry of `placed` as written.
struct PlacedEntry {
  TagName name;
  Eigen::Vector3d p_in_grid = Eigen::Vector3d::Zero();
  std::optional<Digits> digits;
  std::optional<double> sigma;
  std::string date;
  std::optional<Eigen::Vector3d> design_in_grid;
  bool control = false;
  std::optional<PlateAttitude> attitude;
  Place place;
};

using TagKey = std::pair<int, Side>;

// Eleven digits (the check digit is added) or twelve (it must be right, where its scheme is known).
std::optional<Digits> read_digits(const YamlValue& value, const std::optional<CheckDigit>& check) {
  if (!value || value.is(YamlNode::Kind::broken)) return std::nullopt;
  const bool scalar = value.is(YamlNode::Kind::scalar);
  const std::string text = scalar ? value.node->text : "";
  std::optional<Digits> digits = parse_digits(text.size() == kPayloadDigits ? text + "0" : text);
  if (!digits) {
    return value.error("bad-digits",
                       value.name + " is " + (scalar ? "`" + text.substr(0, 60) + "`" : "no text") +
                           ", expected 11 digits, or 12 with the check digit, in quotes");
  }
  if (!value.node->quoted) {
    return value.error("bad-digits", value.name + " is the number `" + text + "`, expected text",
                       "put it in quotes: \"" + text + "\"; as a number it loses its leading zeros",
                       TextEdit{text, "\"" + text + "\""});
  }
  if (!check) return digits;
  const std::uint8_t right = check_digit(*check, std::span(*digits).first<11>());
  if (text.size() == kPayloadDigits) digits->back() = right;
  if (digits->back() == right) return digits;
  return value.error("wrong-check-digit",
                     value.name + " ends in " + std::to_string(digits->back()) +
                         ", the check digit (" + to_string(*check) + ") of the other eleven is " +
                         std::to_string(right),
                     "check the digits against the plate, and code.check_digit");
}

std::optional<TagName> read_tag_name(const MapReader& map) {
  const YamlValue tag = map.need("tag", "tag: 000L");
  const auto side = map.choice("side", {"left", "right"}, "side: left or side: right");
  if (!tag || tag.is(YamlNode::Kind::broken)) return std::nullopt;
  const std::string& text = tag.node->text;
  const auto name = tag.is(YamlNode::Kind::scalar) ? parse_tag_name(text) : std::nullopt;
  if (!name) {
    return tag.error("bad-tag-name",
                     tag.name + " is `" + text.substr(0, 60) +
                         "`, expected the pair in at least three digits and L or R, as 000L");
  }
  if (!side) return std::nullopt;
  if (*side == to_string(name->side)) return name;
  return map.at("side").error(
      "side-mismatch",
      "tag " + text + " with side " + *side + ", expected " + to_string(name->side),
      "names end in L on the left wall of the drive and in R on the right one");
}

// A day as ISO 8601 writes it, 2026-03-31; empty when absent or faulty.
std::string read_date(const YamlValue& value) {
  const std::optional<std::string> text = read_text(value);
  if (!text || parse_day(*text)) return text.value_or("");
  value.error("bad-date",
              value.name + " is `" + text->substr(0, 60) + "`, expected a day as 2026-03-31");
  return {};
}

// Nothing when no key states it. What is not stated is as `usual`.
std::optional<PlateAttitude> read_attitude(const MapReader& map, const PlateAttitude& usual) {
  if (!map.has("facing") && !map.has("tilt") && !map.has("roll")) return std::nullopt;
  PlateAttitude attitude = usual;
  const auto facing = map.number_if_there("facing", between(-360, 360, "degrees"));
  const auto tilt = map.number_if_there("tilt", between(-90, 90, "degrees"));
  const auto roll = map.number_if_there("roll", between(-180, 180, "degrees"));
  if (facing) attitude.facing = radians(*facing);
  if (tilt) attitude.tilt = radians(*tilt);
  if (roll) attitude.roll = radians(*roll);
  return attitude;
}

// Angles of all plates that state none, radians, left and right: one number, or one a side.
std::array<double, 2> read_usual_angle(const YamlValue& value) {
  const NumberRange range = between(-45, 45, "degrees");
  if (!value.is(YamlNode::Kind::map)) {
    const double angle = value ? radians(read_number(value, range).value_or(0)) : 0;
    return {angle, angle};
  }
  const MapReader sides(value, {"left", "right"});
  return {radians(sides.number_or("left", 0, range)), radians(sides.number_or("right", 0, range))};
}

std::array<std::optional<PlateAttitude>, 2> read_usual_attitudes(const MapReader& tags) {
  const auto tilts = read_usual_angle(tags.at("tilt"));
  const auto rolls = read_usual_angle(tags.at("roll"));
  std::array<std::optional<PlateAttitude>, 2> attitudes;
  for (std::size_t side = 0; side < attitudes.size(); ++side) {
    if (tilts[side] == 0 && rolls[side] == 0) continue;
    attitudes[side] = PlateAttitude{std::nullopt, tilts[side], rolls[side]};
  }
  return attitudes;
}

// A standard deviation that says less of a plate's place than validate asks of it.
std::optional<double> read_sigma(const MapReader& map) {
  const std::optional<double> sigma = map.number_if_there("sigma", between(0, kWorstSigma, "m"));
  if (sigma && *sigma > kOffWall) {
    map.at("sigma").warning(
        "large-sigma",
        fmt::format("{} is {} m: no position will be better, and a plate is told to be off its "
                    "wall from {} m on",
                    map.at("sigma").name, format_number(*sigma), kOffWall),
        "a standard deviation in metres: a tape has 0.005, a total station 0.002");
  }
  return sigma;
}

std::optional<PlacedEntry> read_placed_entry(const YamlValue& value, const Survey& survey,
                                             const std::optional<CheckDigit>& check) {
  const MapReader map(value, {"tag", "side", "p", "digits", "sigma", "date", "design", "control",
                              "facing", "tilt", "roll"});
  if (!map.is_map()) return std::nullopt;
  const auto name = read_tag_name(map);
  const auto p = read_point(map.need("p", "p: [x, y, z] of corner P"), kFarthest);
  PlacedEntry entry;
  entry.digits = read_digits(map.at("digits"), check);
  entry.sigma = read_sigma(map);
  entry.date = read_date(map.at("date"));
  entry.design_in_grid = read_point(map.at("design"), kFarthest);
  entry.control = read_bool(map.at("control")).value_or(false);
  const bool digits_fit = !map.has("digits") || entry.digits.has_value();
  if (!name || !p || !digits_fit) return std::nullopt;
  entry.name = *name;
  entry.attitude = read_attitude(map, usual_attitude(survey, name->side).value_or(PlateAttitude{}));
  entry.p_in_grid = *p;
  entry.place = value.place();
  return entry;
}

// The entries without a fault; faults are logged. `check` is the scheme of printed digits, nothing
// when it is not known; `survey` has the plates' usual attitudes.
std::map<TagKey, PlacedEntry> read_placed(const YamlValue& value, const Survey& survey,
                                          const std::optional<CheckDigit>& check) {
  std::map<TagKey, PlacedEntry> placed;
  for (const YamlValue& item : read_list(value).value_or(std::vector<YamlValue>{})) {
    const auto entry = read_placed_entry(item, survey, check);
    if (!entry) continue;
    const TagKey key{entry->name.pair, entry->name.side};
    const auto [first, is_new] = placed.emplace(key, *entry);
    if (is_new) continue;
    item.error("duplicate-tag",
               "tag " + tag_name(key.first, key.second) +
                   " a second time in placed, the first is " + "on line " +
                   std::to_string(first->second.place.line),
               "remove one of the two");
  }
  return placed;
}

// ---- The file.

namespace fs = std::filesystem;

std::optional<TagTemplate> read_named_template(const MapReader& tags,
                                               const fs::path& survey_folder) {
  const YamlValue value = tags.need("template", "template: tag-400x300");
  const auto name = read_text(value);
  if (!name) return std::nullopt;
  const auto path = find_template(*name, survey_folder);
  if (!path) {
    return value.error("no-template",
                       "no template `" + *name + "`, expected a path, or a file " + *name +
                           ".yaml beside the survey or among the tool's own templates",
                       "own templates: " + own_templates());
  }
  const Result<Diagnosed<TagTemplate>> reading = read_template(*path);
  if (!reading) return value.error("no-template", reading.error().message);
  value.log->append(reading->diagnostics);
  return reading->value;
}

// The number of pairs from `pairs` or `to`; a pitch of 0 is one that was faulty.
std::optional<int> read_pair_count(const MapReader& tags, double first, double pitch) {
  constexpr int kMostPairs = kMostTags / 2;
  tags.exclude_each_other({"pairs", "to"});
  if (tags.has("pairs")) return read_integer(tags.at("pairs"), 1, kMostPairs);
  const auto to = tags.number_if_there("to", between(first, kLongest * kMostElements, "m"));
  if (!to || pitch <= 0) return std::nullopt;
  constexpr double kNudge = 1e-9;  // so that 5.6 = 7 * 0.8 includes the eighth pair
  const double count = std::floor((*to - first) / pitch + kNudge) + 1;
  if (count <= kMostPairs) return static_cast<int>(count);
  return tags.at("to").error("too-many-tags",
                             tags.at("to").name + " asks for " + format_number(count, 0) +
                                 " pairs, expected at most " + std::to_string(kMostPairs),
                             "split the survey into several files");
}

// The regular pairs. Without `pairs` and `to` there are none, and only values that apply to
// surveyed tags too (height, theta) are kept.
std::optional<TagSeries> read_series(const MapReader& tags, bool has_placed,
                                     const std::optional<TagTemplate>& tag_template) {
  const bool regular = tags.has("pairs") || tags.has("to");
  if (!regular && !has_placed && tags.is_map()) {
    tags.need("pairs", "pairs: 8, or to: CHAINAGE, or a list `placed` of surveyed tags");
  }
  TagSeries series;
  const NumberRange height = between(0, kLargestRoom, "m");
  const NumberRange spacing = above_zero(kLongest, "m");
  const NumberRange first = between(-kLongest, kLongest * kMostElements, "m");
  const auto required = [&](const char* key, const NumberRange& range) {
    return regular ? tags.number(key, range) : tags.number_if_there(key, range);
  };
  const auto mount_height = required("height", height);
  const auto gap = required("spacing", spacing);
  const auto start = required("first", first);
  const auto theta = tags.number_if_there("theta", above_zero(80, "degrees"));
  if (theta) series.pair_angle = radians(*theta);
  std::optional<int> pairs;
  if (regular && start) {
    const double pitch = gap && tag_template ? tag_template->plate_length + *gap : 0.0;
    pairs = read_pair_count(tags, *start, pitch);
  }
  if (!regular && !mount_height && !series.pair_angle) return std::nullopt;
  series.mount_height = mount_height.value_or(0);
  series.spacing = gap.value_or(0);
  series.first = start.value_or(0);
  // With a faulty dimension the regular tags would only get findings that are wrong.
  series.pairs = mount_height && gap ? pairs.value_or(0) : 0;
  return series;
}

GridPoint as_grid_point(const auto& values) { return {values[0], values[1], values[2]}; }

std::optional<GridPoint> read_resolution(const YamlValue& value, const GridPoint& fallback) {
  constexpr double kCoarsest = 1000;
  if (!value) return fallback;
  const NumberRange range = above_zero(kCoarsest, "m");
  if (value.is(YamlNode::Kind::sequence)) {
    const auto values = read_numbers(value, 3, range);
    return values ? std::optional(as_grid_point(*values)) : std::nullopt;
  }
  const auto one = read_number(value, range);
  return one ? std::optional(GridPoint{*one, *one, *one}) : std::nullopt;
}

std::optional<std::array<int, 3>> read_digit_counts(const YamlValue& value,
                                                    const std::array<int, 3>& fallback) {
  if (!value) return fallback;
  const auto values = read_numbers(value, 3, between(1, 9, ""));
  if (!values) return std::nullopt;
  const double sum = std::accumulate(values->begin(), values->end(), 0.0);
  const bool whole = std::ranges::all_of(*values, [](double v) { return v == std::floor(v); });
  if (!whole || sum != static_cast<double>(kPayloadDigits)) {
    return value.error("bad-digit-counts",
                       value.name +
                           (whole ? " sum to " + format_number(sum) : " are no whole numbers") +
                           ", expected three whole numbers that sum to 11",
                       "for example [4, 4, 3]");
  }
  return std::array{static_cast<int>((*values)[0]), static_cast<int>((*values)[1]),
                    static_cast<int>((*values)[2])};
}

std::optional<GridPoint> read_origin(const YamlValue& value, const GridPoint& fallback) {
  if (!value) return fallback;
  const auto origin = read_point(value, kFarthest);
  return origin ? std::optional(as_grid_point(*origin)) : std::nullopt;
}

std::optional<CheckDigit> read_check_digit(const MapReader& map) {
  const auto check = map.choice("check_digit", {"sum10", "gs1"},
                                "sum10 (the plain sum of Xu et al. 2017) or gs1 (standard UPC-A)");
  return check ? parse_check_digit(*check) : std::nullopt;
}

std::optional<PositionCode> read_code(const MapReader& map,
                                      const std::optional<CheckDigit>& check) {
  const PositionCode fallback;
  const auto resolution = read_resolution(map.at("resolution"), fallback.resolution);
  const auto digit_counts = read_digit_counts(map.at("digits"), fallback.digit_counts);
  const auto origin = read_origin(map.at("origin"), fallback.origin);
  if (!check || !resolution || !digit_counts || !origin) return std::nullopt;
  return PositionCode{*check, *digit_counts, *resolution, *origin};
}

SourcedTag coded(const PlacedTag& tag, const std::optional<Digits>& printed, Place place,
                 const PositionCode& code) {
  SourcedTag entry;
  entry.place = place;
  entry.printed_digits = printed.has_value();
  const auto with_code = printed ? with_digits(tag, code, *printed) : with_own_digits(tag, code);
  entry.coded = with_code.has_value();
  entry.tag = with_code ? *with_code : tag;
  entry.tag.line = place.line;
  entry.tag.column = place.column;
  return entry;
}

// The tag where it was measured, with the design that the measurement replaces.
PlacedTag as_built(const Survey& survey, const PlacedEntry& entry) {
  PlacedTag tag = place_surveyed(survey, entry.name, entry.p_in_grid, entry.attitude);
  tag.sigma = entry.sigma.value_or(survey.sigma);
  tag.date = entry.date;
  tag.design_in_grid = entry.design_in_grid;
  tag.control = entry.control;
  const bool regular = survey.series && tag.pair < survey.series->pairs;
  if (!tag.design_in_grid && regular) {
    tag.design_in_grid = place_in_series(survey, tag.pair, tag.side).p_in_grid;
  }
  return tag;
}

// The regular tags and the surveyed ones, which replace regular ones of their name; by pair, left
// before right.
std::vector<SourcedTag> place_tags(const Survey& survey,
                                   const std::map<TagKey, PlacedEntry>& placed,
                                   Place series_place) {
  std::vector<SourcedTag> tags;
  const int pairs = survey.series ? survey.series->pairs : 0;
  auto next = placed.begin();
  const auto add_placed = [&] {
    const PlacedEntry& entry = next->second;
    tags.push_back(coded(as_built(survey, entry), entry.digits, entry.place, survey.code));
    ++next;
  };
  for (int pair = 0; pair < pairs; ++pair) {
    for (const Side side : {Side::left, Side::right}) {
      if (next != placed.end() && next->first == TagKey{pair, side}) {
        add_placed();
      } else {
        tags.push_back(
            coded(place_in_series(survey, pair, side), std::nullopt, series_place, survey.code));
      }
    }
  }
  while (next != placed.end()) add_placed();
  return tags;
}

SeriesPlaces series_places(const MapReader& tags) {
  const auto place_of = [&](const char* key) {
    return (tags.has(key) ? tags.at(key) : tags.value()).place();
  };
  return {place_of("height"), place_of("spacing"), place_of("first"),
          place_of(tags.has("pairs") ? "pairs" : "to")};
}

// A theta that cannot be meant (in radians, a typing error), and one that moves the right plates.
void check_pair_angle(const Survey& survey, const YamlValue& theta) {
  if (!theta || !survey.series || !survey.series->pair_angle) return;
  constexpr double kNoticeable = 0.005;  // metres
  const double first = left_middle(survey, 0);
  const double shift = right_plate_shift(survey, first);
  const double asked = width_at(survey.tunnel, first) * std::tan(*survey.series->pair_angle);
  const std::string facing = format_number(degrees(facing_pair_angle(survey, first)), 2);
  const std::string subject =
      "tags.theta is " + format_number(degrees(*survey.series->pair_angle), 3) +
      " degrees, plates that face each other have atan(L_CI / W_T) = " + facing;
  const std::string hint = "leave theta out for plates that face each other";
  if (std::abs(shift) > asked) {
    theta.error("theta",
                subject + ": it puts the two P " + format_number(asked, 3) +
                    " m apart along the drive, facing plates " + format_number(asked - shift, 3) +
                    " m",
                hint + "; theta is in degrees");
  } else if (std::abs(shift) > kNoticeable) {
    theta.warning("theta",
                  subject + ": it moves the right plates by " + format_number(shift, 3) +
                      " m along the drive",
                  hint);
  }
}

std::optional<Survey> read_survey_tree(const YamlValue& root, const fs::path& path) {
  FindingLog& log = *root.log;
  const MapReader file(root, {"survey", "grid", "tunnel", "tags", "code", "placed"});
  Survey survey;
  survey.file = path;
  survey.name = read_name(file.need("survey", "survey: NAME")).value_or("");
  survey.grid = read_grid(file.at("grid"));
  const auto tunnel = read_tunnel(
      file.need("tunnel", "tunnel: { width: 1.9, height: 3.0, centerline: ... }"), survey.grid);
  const MapReader tags(file.need("tags", "tags: { template: tag-400x300, ... }"),
                       {"template", "height", "spacing", "first", "pairs", "to", "theta", "tilt",
                        "roll", "sigma", "angle_sigma"});
  const auto tag_template = read_named_template(tags, path.parent_path());
  survey.series = read_series(tags, file.has("placed"), tag_template);
  survey.usual_attitudes = read_usual_attitudes(tags);
  survey.states_sigma = tags.has("sigma");
  survey.sigma = read_sigma(tags).value_or(kUsualSigma);
  // A survey whose coordinates are stated to be exact is one of computed pictures: nobody hung its
  // plates by eye.
  const bool is_exact = survey.states_sigma && survey.sigma == 0;
  survey.states_angle_sigma = is_exact || tags.has("angle_sigma");
  survey.angle_sigma = radians(tags.number_or("angle_sigma", 0, between(0, 45, "degrees")));

  const MapReader code(file.need("code", "code: { check_digit: sum10, resolution: 0.01 }"),
                       {"check_digit", "resolution", "digits", "origin"});
  const auto check = read_check_digit(code);
  const auto position_code = read_code(code, check);
  survey.code = position_code.value_or(PositionCode{});
  const auto placed = read_placed(file.at("placed"), survey, check);
  if (!tunnel || !tag_template) return std::nullopt;
  survey.tunnel = *tunnel;
  survey.tag_template = *tag_template;

  check_pair_angle(survey, tags.at("theta"));
  const Place tags_place = tags.value().place();
  const Place code_place = code.value().place();
  const std::vector<SourcedTag> placed_tags = place_tags(survey, placed, tags_place);
  if (!check_grid(survey, placed_tags, file.at("placed").place(), log)) {
    if (position_code) {
      check_code_range(survey, placed_tags, code_place, log);
      check_codes(survey, placed_tags, code_place, log);
      lint_codes(survey, placed_tags, code_place, log);
    }
    check_walls(survey, placed_tags, series_places(tags), log);
    lint_places(survey, placed_tags, log);
  }
  lint_series(survey, tags_place, log);
  survey.tags.reserve(placed_tags.size());
  for (const SourcedTag& entry : placed_tags) survey.tags.push_back(entry.tag);
  if (!survey.states_angle_sigma) survey.angle_sigma = usual_angle_sigma(survey);
  lint_walls(survey, tags_place, log);
  if (!log.has_errors()) lint_exchanged_codes(survey, {&survey, 1}, log);
  return survey;
}

}  // namespace

Diagnosed<Survey> read_survey_text(const fs::path& path, std::string_view text) {
  return read_yaml_text<Survey>(
      path, text, "survey", [&](const YamlValue& root) { return read_survey_tree(root, path); });
}

Result<Diagnosed<Survey>> read_survey(const fs::path& path) {
  return read_file(path).map([&](const std::string& text) { return read_survey_text(path, text); });
}

Result<Survey> load_survey(const fs::path& path) { return value_without_errors(read_survey(path)); }

Result<std::vector<Survey>> load_surveys(const std::vector<fs::path>& paths) {
  std::vector<Survey> surveys;
  std::string faults;
  for (const fs::path& path : paths) {
    Result<Survey> survey = load_survey(path);
    if (survey) {
      surveys.push_back(std::move(*survey));
    } else {
      faults += (faults.empty() ? "" : "\n") + survey.error().message;
    }
  }
  if (!faults.empty()) return fail(faults);
  const std::vector<Diagnostic> together = check_together(surveys);
  if (has_errors(together)) return fail(to_string(together, true));
  return surveys;
}

}  // namespace tagsmith::detail
