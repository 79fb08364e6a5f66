// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/point_list.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/draft/length_units.hpp"
#include "tagsmith/draft/point_formats.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/limits.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kCodes = "TL, TR, WL, WR, CL, FL, RF or the name of a tag, as 000L";

// Limits of numbers before their unit is known; check_reach checks the rest.
constexpr double kFarthestInMillimetres = 1000 * kFarthest;

struct PointKindWords {
  std::string_view code;
  const char* name;
};

// In the order of PointKind.
constexpr std::array kPointKinds{
    PointKindWords{"TL", "left tag"},    PointKindWords{"TR", "right tag"},
    PointKindWords{"WL", "left wall"},   PointKindWords{"WR", "right wall"},
    PointKindWords{"CL", "center line"}, PointKindWords{"FL", "floor"},
    PointKindWords{"RF", "roof"},
};
static_assert(kPointKinds.size() == static_cast<std::size_t>(PointKind::roof) + 1);

std::optional<PointKind> kind_of(const std::string& code) {
  const auto found = std::ranges::find(kPointKinds, code, &PointKindWords::code);
  if (found == kPointKinds.end()) return std::nullopt;
  return static_cast<PointKind>(found - kPointKinds.begin());
}

PointKind kind_of(Side side) {
  return side == Side::left ? PointKind::left_tag : PointKind::right_tag;
}

// Names of the columns of a surveyors' list, by its letters.
Result<std::vector<std::string>> columns_of_order(const std::string& order) {
  static const std::map<char, std::string> names{{'P', "name"}, {'E', "x"}, {'X', "x"},
                                                 {'N', "y"},    {'Y', "y"}, {'Z', "z"},
                                                 {'D', "code"}, {'-', ""}};
  std::vector<std::string> columns;
  std::set<std::string> seen;
  for (const char letter : upper_case(order)) {
    const auto name = names.find(letter);
    const bool usable =
        name != names.end() && (name->second.empty() || seen.insert(name->second).second);
    if (!usable) {
      return fail("--order " + order +
                  ": expected each of the letters P, E (or X), N (or Y), Z, D "
                  "once and - for columns to skip, as PENZD; or own");
    }
    columns.push_back(name->second);
  }
  if (seen.size() != 5) {
    return fail("--order " + order +
                ": expected all of P (point), E, N, Z and D (description), as PENZD or PNEZD");
  }
  return columns;
}

// What may be wrong with a field of this line of the file that is no number.
std::string number_hint(const std::string& field, int line) {
  const bool has_letters = field.find_first_not_of("+-0123456789., '") != std::string::npos;
  if (has_letters || field.empty()) {
    return line == 1 ? "does the first line name the columns? then --header" : "";
  }
  const auto signs = std::ranges::count_if(field, [](char c) { return c == '.' || c == ','; });
  const bool grouped = signs > 1 || field.find_first_of(" '") != std::string::npos;
  return grouped ? "write numbers without signs between the thousands" : "decimal signs are points";
}

// One line of a list.
class ListRow : public TableRow {
 public:
  // `comma`: the decimal sign may be a comma, because fields are separated by something else.
  ListRow(const std::vector<std::string>& columns, std::vector<std::string> fields, bool comma,
          int line, FindingLog& log)
      : TableRow(columns, std::move(fields), line, log), comma_(comma) {}

  std::optional<double> number(const std::string& column) const {
    std::string field = text(column);
    if (comma_ && field.find('.') == std::string::npos) std::ranges::replace(field, ',', '.');
    const std::optional<double> value = parse_number(field);
    if (value && std::abs(*value) <= kFarthestInMillimetres) return value;
    return error(column, "bad-number",
                 column + " is `" + field.substr(0, 60) + "`, expected a number",
                 number_hint(text(column), line()));
  }

  std::optional<double> optional_number(const std::string& column) const {
    if (text(column).empty()) return std::nullopt;
    return number(column);
  }

  std::optional<Eigen::Vector3d> point(const std::string& prefix = {}) const {
    const auto x = number(prefix + "x");
    const auto y = number(prefix + "y");
    const auto z = number(prefix + "z");
    if (!x || !y || !z) return std::nullopt;
    return Eigen::Vector3d(*x, *y, *z);
  }

 private:
  bool comma_;
};

std::string code_of(std::string_view description) {
  return upper_case(description.substr(0, description.find_first_of(" \t")));
}

bool is_ignored(const RawPoint& raw, const std::vector<std::string>& ignore) {
  const std::string code = code_of(raw.description);
  return std::ranges::any_of(ignore, [&](const auto& word) { return upper_case(word) == code; });
}

// The point that the description says; `column` is its place in the line, for findings.
std::optional<SurveyedPoint> described_point(const RawPoint& raw, int column, FindingLog& log) {
  const std::string code = code_of(raw.description);
  SurveyedPoint point;
  point.line = raw.line;
  point.name = raw.name;
  point.in_grid = raw.in_grid;
  point.has_height = raw.has_height;
  point.of_alignment = raw.of_alignment;
  point.tag = parse_tag_name(code);
  if (point.tag && parse_digits(raw.digits)) point.digits = raw.digits;
  const std::optional<PointKind> kind = point.tag ? kind_of(point.tag->side) : kind_of(code);
  if (kind) {
    point.kind = *kind;
    return point;
  }
  return log.error(
      {raw.line, column}, "unknown-code",
      "point " + raw.name.substr(0, 60) + " has the description `" + raw.description.substr(0, 60) +
          "`, expected " + kCodes,
      "or leave such points out: --ignore " + (code.empty() ? "CODE" : code.substr(0, 20)));
}

std::optional<SurveyedPoint> read_point(const ListRow& row, const PointListOptions& options,
                                        FindingLog& log) {
  RawPoint raw{row.line(), row.text("name"), row.text("code")};
  if (is_ignored(raw, options.ignore)) return std::nullopt;
  const auto in_grid = row.point();
  raw.in_grid = options.metres_per_unit.value_or(1) * in_grid.value_or(Eigen::Vector3d::Zero());
  std::optional<SurveyedPoint> point = described_point(raw, row.place("code").column, log);
  return in_grid ? point : std::nullopt;
}

// Lists of older versions do not have it.
std::optional<PlateAttitude> read_attitude(const ListRow& row) {
  if (row.text("facing").empty()) return std::nullopt;
  PlateAttitude attitude;
  attitude.facing = radians(row.number("facing").value_or(0));
  attitude.tilt = radians(row.optional_number("tilt").value_or(0));
  attitude.roll = radians(row.optional_number("roll").value_or(0));
  return attitude;
}

std::optional<SurveyedPoint> read_own_point(const ListRow& row, const PointListOptions& options) {
  SurveyedPoint point;
  point.line = row.line();
  point.name = row.text("tag");
  if (is_ignored({point.line, point.name, point.name}, options.ignore)) return std::nullopt;
  point.tag = parse_tag_name(point.name);
  if (!point.tag) {
    row.error("tag", "bad-tag-name", "tag is `" + point.name.substr(0, 60) + "`, expected 000L");
  }
  const std::string& side = row.text("side");
  if (point.tag && side != to_string(point.tag->side)) {
    row.error("side", "side-mismatch",
              "side is `" + side.substr(0, 60) + "`, but tag " + point.name + " hangs on the " +
                  to_string(point.tag->side));
  }
  const auto in_grid = row.point();
  point.digits = row.text("digits");
  if (!parse_digits(point.digits)) {
    row.error("digits", "bad-digits",
              "digits is `" + point.digits.substr(0, 60) + "`, expected 12 digits",
              "spreadsheets drop leading zeros: import the column as text");
  }
  point.height = row.number("height");
  point.chainage = row.number("chainage");
  point.offset = row.number("offset");
  point.tunnel_height = row.number("tunnel_height");
  point.attitude = read_attitude(row);
  point.sigma = row.optional_number("sigma");
  point.date = row.text("date");
  point.control = row.text("control") == "yes";
  if (!row.text("design_x").empty()) point.design_in_grid = row.point("design_");
  if (!point.tag || !in_grid) return std::nullopt;
  point.kind = kind_of(point.tag->side);
  point.in_grid = *in_grid;
  return point;
}

// In the order of listed_plate.
constexpr std::array kPlateColumns{"plate_length", "plate_height", "frame_length", "frame_height"};

// What every row repeats, from one row.
std::optional<ListedSurvey> read_listed_survey(const ListRow& row) {
  ListedSurvey survey;
  survey.tag_template = row.text("template");
  const auto check = parse_check_digit(row.text("check_digit"));
  const std::string& axis = row.text("x_axis");
  if (!check)
    row.error("check_digit", "bad-choice", "check_digit is no scheme, expected sum10 or gs1");
  if (axis != "left" && axis != "right") {
    row.error("x_axis", "bad-choice",
              "x_axis is `" + axis.substr(0, 60) + "`, expected left or right");
  }
  bool complete = check.has_value();
  const std::array<std::string, 3> axes{"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto count = row.number("digits_" + axes[i]);
    const auto resolution = row.number("resolution_" + axes[i]);
    const auto origin = row.number("origin_" + axes[i]);
    complete = complete && count && resolution && origin;
    survey.code.digit_counts[i] = static_cast<int>(std::clamp(count.value_or(1), 1.0, 9.0));
    survey.code.resolution[i] = resolution.value_or(1);
    survey.code.origin[i] = origin.value_or(0);
  }
  if (!row.text("plate_length").empty()) {
    std::array<double, 4> plate{};
    for (std::size_t i = 0; i < plate.size(); ++i) {
      plate[i] = row.number(kPlateColumns[i]).value_or(0);
    }
    survey.plate = plate;
  }
  if (const auto degrees = row.optional_number("angle_sigma")) {
    survey.angle_sigma = radians(std::clamp(*degrees, 0.0, 45.0));
  }
  if (!complete) return std::nullopt;
  survey.code.check = *check;
  survey.grid.x_axis_left = axis == "left";
  return survey;
}

// What every row repeats.
std::vector<std::string> repeated_columns() {
  std::vector<std::string> columns = split("template,check_digit,x_axis,angle_sigma", ',');
  for (const char* axis : {"x", "y", "z"}) {
    for (const char* of : {"digits_", "resolution_", "origin_"}) {
      columns.push_back(of + std::string(axis));
    }
  }
  columns.insert(columns.end(), kPlateColumns.begin(), kPlateColumns.end());
  return columns;
}

// Whether a row repeats what the first one says; logs it where it does not.
bool repeats(const ListRow& row, const ListRow& first, FindingLog& log) {
  for (const std::string& column : repeated_columns()) {
    if (row.text(column) == first.text(column)) continue;
    log.error(row.place(column), "conflicting-rows",
              column + " is `" + row.text(column).substr(0, 60) + "`, but line " +
                  std::to_string(first.line()) + " says `" + first.text(column).substr(0, 60) + "`",
              "a survey has one template, code and grid: make a list of each survey");
    return false;
  }
  return true;
}

// The columns that own lists of older versions have: without the plates' attitudes, without their
// sizes, and without how well attitudes are known.
constexpr std::array<std::size_t, 3> kOldColumns{27, 30, 34};

void check_own_header(const std::vector<std::string>& fields, int line,
                      std::vector<std::string>& columns, FindingLog& log) {
  const auto old = std::ranges::find(kOldColumns, fields.size());
  if (old != kOldColumns.end()) columns.resize(*old);
  if (fields == columns) return;
  log.error({line, 0}, "missing-column",
            "the columns are not those of `tagsmith export`, expected " + csv_row(own_columns()),
            "give the order of the columns: --order PENZD");
}

// Warns of tags with digits that the draft cannot know.
void check_digits(const PointList& list, FindingLog& log) {
  const auto lacks_digits = [](const SurveyedPoint& point) {
    return point.tag && point.digits.empty();
  };
  const auto has_digits = [](const SurveyedPoint& point) { return !point.digits.empty(); };
  const auto first = std::ranges::find_if(list.points, lacks_digits);
  if (first != list.points.end()) {
    log.warning({first->line, 0}, "unknown-digits",
                fmt::format("tag {} has a name, but the list does not say its digits ({} such in "
                            "all): the draft's codes need not be those of plates that hang",
                            tag_name(first->tag->pair, first->tag->side),
                            std::ranges::count_if(list.points, lacks_digits)),
                "write the digits of plates that hang into the draft, as `digits`, or draft it "
                "from the survey's own export; do not localize with it before");
  }
  if (list.survey || std::ranges::none_of(list.points, has_digits)) return;
  log.warning({}, "unknown-digits",
              "the list says the digits of tags, but not the code that they follow: the draft's "
              "code is another, and tags that get digits by it differ from those that hang",
              "write the code of the survey that the plates were printed from into the draft");
}

void check_names(const std::vector<SurveyedPoint>& points, FindingLog& log) {
  std::map<std::string, int> lines;
  for (const SurveyedPoint& point : points) {
    if (!point.tag) continue;
    const std::string name = tag_name(point.tag->pair, point.tag->side);
    const auto [first, is_new] = lines.emplace(name, point.line);
    if (is_new) continue;
    log.error(
        {point.line, 0}, "duplicate-tag",
        "tag " + name + " a second time, the first is on line " + std::to_string(first->second),
        "remove one of the two");
  }
}

// ---- Tables.

// The character that separates the columns in the first lines of a table.
struct Separator {
  char sign;
  const char* name;
  std::size_t fitting = 0;         // lines with enough columns
  std::size_t first = 0;           // columns of the first line
  std::set<std::size_t> counts{};  // of columns
};

// The one that gives enough columns in most of the first lines; of several, the one that always
// gives the same number of them. An error, once, where there is none.
std::optional<char> separator_of(std::string_view text, std::size_t least, FindingLog& log) {
  constexpr std::size_t kMostLines = 200;
  std::array<Separator, 3> tried{{{',', "commas"}, {';', "semicolons"}, {'\t', "tabs"}}};
  std::size_t lines = 0;
  int first_line = 0;
  for_each_line(text, [&](int number, std::string_view line) {
    for (Separator& each : tried) {
      const auto fields = split_csv(line, each.sign);
      const std::size_t count = fields ? fields->size() : 0;
      if (lines == 0) each.first = count;
      each.fitting += count >= least ? 1 : 0;
      each.counts.insert(count);
    }
    if (lines == 0) first_line = number;
    return ++lines < kMostLines;
  });
  if (lines == 0) return ',';
  std::vector<const Separator*> fitting;
  for (const Separator& each : tried) {
    if (2 * each.fitting > lines) fitting.push_back(&each);
  }
  if (fitting.size() > 1) {
    std::erase_if(fitting, [](const Separator* each) { return each->counts.size() > 1; });
  }
  if (fitting.size() == 1) return fitting.front()->sign;
  std::string found;
  for (const Separator& each : tried) {
    found += (found.empty() ? "" : ", ") + std::to_string(each.first) + " by " + each.name;
  }
  return log.error({first_line, 0}, "wrong-length",
                   "the line has " + found + " fields, expected " + std::to_string(least) +
                       " by one of them, and as many on the others",
                   "--order says all columns of the file, - for those to skip");
}

bool is_coordinate_column(std::string_view column) {
  return column == "x" || column == "y" || column == "z";
}

// Whether fields follow that no column is for, and that do not continue a description.
bool has_more_fields(const std::vector<std::string>& fields,
                     const std::vector<std::string>& columns) {
  if (columns.back() == "code") return false;
  return std::any_of(fields.begin() + static_cast<std::ptrdiff_t>(columns.size()), fields.end(),
                     [](const std::string& field) { return !trim(field).empty(); });
}

// Whether these are a point's numbers and description.
bool is_point(const std::vector<std::string>& fields, const std::vector<std::string>& columns) {
  if (fields.size() < columns.size()) return false;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& column = columns[i];
    if (is_coordinate_column(column) && !parse_number(fields[i])) return false;
    const std::string code = column == "code" ? code_of(fields[i]) : "";
    if (column == "code" && !kind_of(code) && !parse_tag_name(code)) return false;
  }
  return true;
}

// Whether a line by commas has decimal commas, too: each coordinate is two fields of digits.
bool has_decimal_commas(const std::vector<std::string>& fields,
                        const std::vector<std::string>& columns) {
  const auto are_digits = [](std::string_view field) {
    return !field.empty() && field.find_first_not_of("0123456789") == std::string_view::npos;
  };
  std::size_t next = 0;
  std::size_t coordinates = 0;
  for (const std::string& column : columns) {
    if (is_coordinate_column(column) &&
        (next + 1 >= fields.size() || !parse_integer(fields[next]) ||
         !are_digits(fields[next + 1]))) {
      return false;
    }
    coordinates += is_coordinate_column(column) ? 1 : 0;
    next += is_coordinate_column(column) ? 2 : 1;
  }
  return coordinates > 0 && next == fields.size();
}

void read_table(std::string_view text, const PointListOptions& options,
                std::vector<std::string> columns, PointList& list, FindingLog& log) {
  const bool own = options.order == "own";
  list.unit_is_known = own || options.metres_per_unit;
  list.metres_per_unit = options.metres_per_unit.value_or(1);
  const std::size_t least = own ? kOldColumns.front() : columns.size();
  FindingLog unheard("");  // of an own list the header's faults are reported
  auto separator = separator_of(text, least, own ? unheard : log);
  if (!separator && own) separator = ',';
  bool is_header = own || options.header;
  std::optional<ListRow> first;
  bool is_one_survey = true;
  if (!separator) return;
  for_each_line(text, [&](int number, std::string_view line) {
    auto fields = split_csv(line, *separator);
    if (!fields) {
      log.error({number, 0}, "bad-quotes", "a quoted field is not closed");
    } else if (std::exchange(is_header, false)) {
      if (own) {
        check_own_header(*fields, number, columns, log);
      } else if (is_point(*fields, columns)) {
        log.error({number, 0}, "missing-column", "the line is a point and names no columns",
                  "leave --header out");
      }
      return !log.has_errors();
    } else if (own && *fields == columns) {
      return true;  // lists put together, each with its names of the columns
    } else if (fields->size() < columns.size()) {
      log.error({number, 0}, "wrong-length",
                "the line has " + std::to_string(fields->size()) + " fields, expected " +
                    std::to_string(columns.size()),
                "take out lines that are no points");
    } else if (!own && *separator == ',' && has_decimal_commas(*fields, columns)) {
      log.error({number, 0}, "bad-number",
                "the line has commas between the columns and in its numbers",
                "with decimal commas, semicolons or tabs between the columns");
      return false;
    } else if (!own && has_more_fields(*fields, columns)) {
      log.error({number, 0}, "wrong-length",
                "the line has " + std::to_string(fields->size()) + " fields, expected " +
                    std::to_string(columns.size()),
                "--order says all columns of the file, - for those to skip; a decimal comma makes "
                "two fields of one number");
    } else if (list.points.size() == kMostPoints) {
      log.error({number, 0}, "too-many-points", "more than a million points", "divide the file");
      return false;
    } else {
      const ListRow row(columns, std::move(*fields), *separator != ',', number, log);
      if (own && first && is_one_survey) is_one_survey = repeats(row, *first, log);
      if (own && !first) list.survey = read_listed_survey(first.emplace(row));
      auto point = own ? read_own_point(row, options) : read_point(row, options, log);
      if (point) list.points.push_back(std::move(*point));
    }
    return true;
  });
}

// Logs once that points lie beyond all grids, as they do in millimetres.
void check_reach(const PointList& list, FindingLog& log) {
  const auto is_far = [](const SurveyedPoint& point) {
    return !(point.in_grid.cwiseAbs().maxCoeff() <= kFarthest);
  };
  const auto first = std::ranges::find_if(list.points, is_far);
  if (first == list.points.end()) return;
  const auto count = std::ranges::count_if(list.points, is_far);
  log.error({first->line, 0}, list.unit_is_known ? "bad-number" : "no-units",
            "point " + first->name.substr(0, 60) + " lies more than 100 000 km from zero" +
                (count > 1 ? ", and so do " + std::to_string(count - 1) + " others" : ""),
            list.unit_is_known ? "correct its coordinates"
                               : "are these millimetres? --units mm, or ft, us-ft, m");
}

// Logs once that no point has a height, as in plans.
void check_flat(const std::vector<SurveyedPoint>& points, FindingLog& log) {
  const bool is_flat =
      std::ranges::all_of(points, [](const SurveyedPoint& p) { return p.in_grid.z() == 0; });
  if (!is_flat || points.empty()) return;
  log.warning({}, "flat-list",
              "all points have the height 0: heights in texts and attributes of a drawing, or in a "
              "column that --order skips, are not read",
              "give the points their heights");
}

// ---- Files of other kinds.

// Metres of the file's unit.
double unit_of(const RawPoints& raw, const std::optional<double>& asked, FindingLog& log) {
  const bool asked_feet = asked == kFoot || asked == kSurveyFoot;
  if (raw.in_some_feet && !asked_feet) {
    log.error({}, "no-units", "the file is in feet, but does not say in which",
              "--units ft (0.3048 m) or --units us-ft (1200/3937 m)");
  } else if (!raw.unknown_unit.empty() && !asked) {
    log.error({}, "no-units",
              "the file says the unit `" + raw.unknown_unit.substr(0, 60) +
                  "`, which is none that is known",
              "--units m, ft (0.3048 m), us-ft (1200/3937 m) or mm");
  } else if (asked && raw.metres_per_unit && !raw.unit_is_advice &&
             *asked != *raw.metres_per_unit) {
    log.error({}, "no-units",
              "the file says that its unit is " + format_number(*raw.metres_per_unit, 9) + " m",
              "leave --units out");
  }
  return asked.value_or(raw.metres_per_unit.value_or(1));
}

// The number of the file's grid, where it is one of metres as the survey is; else it is reported.
int epsg_of(const std::string& code, double unit, FindingLog& log) {
  if (code.empty() || code == "0") return 0;
  const std::string name = "EPSG:" + code.substr(0, 20);
  const std::optional<int> epsg = parse_crs(name);
  if (epsg && unit == 1) return *epsg;
  log.warning({}, "bad-crs",
              "the file's grid " + name + " is left out: " +
                  (epsg ? "the file is in units of " + format_number(unit, 9) +
                              " m, so its grid is, but the survey is in metres"
                        : "it is no grid in metres"),
              "the same grid in metres has another number: write that into the draft, as "
              "grid: { crs: EPSG:25832 }");
  return 0;
}

// What the file says of all its tags, where it does.
std::optional<ListedSurvey> listed_survey_of(const RawPoints& raw, FindingLog& log) {
  if (raw.listed.empty()) return std::nullopt;
  std::vector<std::string> columns;
  std::vector<std::string> fields;
  for (const auto& [column, field] : raw.listed) {
    columns.push_back(column);
    fields.push_back(field);
  }
  return read_listed_survey(ListRow(columns, std::move(fields), false, raw.listed_line, log));
}

RawPoints raw_points(PointFormat format, std::string_view text, const PointListOptions& options,
                     FindingLog& log) {
  switch (format) {
    case PointFormat::landxml:
      return landxml_points(text, options.ignore, log);
    case PointFormat::gsi:
      return gsi_points(text, log);
    case PointFormat::rw5:
      return rw5_points(text, log);
    default:
      return dxf_points(text, options.metres_per_unit, log);
  }
}

void read_other(PointFormat format, std::string_view text, const PointListOptions& options,
                PointList& list, FindingLog& log) {
  RawPoints raw = raw_points(format, text, options, log);
  const double unit = unit_of(raw, options.metres_per_unit, log);
  list.metres_per_unit = unit;
  list.unit_is_known = options.metres_per_unit || (raw.metres_per_unit && !raw.unit_is_advice);
  list.epsg = epsg_of(raw.epsg_code, unit, log);
  list.survey = listed_survey_of(raw, log);
  if (raw.alignment) list.alignment = scaled(std::move(*raw.alignment), unit);
  const bool has_line = std::ranges::any_of(raw.points, &RawPoint::of_alignment);
  for (RawPoint& point : raw.points) {
    if (is_ignored(point, options.ignore)) continue;
    point.in_grid *= unit;
    auto described = described_point(point, 0, log);
    if (!described) continue;
    const bool is_line = described->kind == PointKind::centerline;
    if (has_line && is_line && !point.of_alignment) described->kind = PointKind::floor;
    list.points.push_back(std::move(*described));
  }
}

}  // namespace

std::string to_string(PointKind kind) { return kPointKinds[static_cast<std::size_t>(kind)].name; }

bool is_point_description(std::string_view text) {
  const std::string code = code_of(text);
  return kind_of(code).has_value() || parse_tag_name(code).has_value();
}

std::vector<std::string> own_columns() {
  return split(
      "tag,side,digits,x,y,z,chainage,offset,height,sigma,date,design_x,design_y,design_z,template,"
      "check_digit,digits_x,digits_y,digits_z,resolution_x,resolution_y,resolution_z,origin_x,"
      "origin_y,origin_z,x_axis,tunnel_height,facing,tilt,roll,plate_length,plate_height,"
      "frame_length,frame_height,angle_sigma,control",
      ',');
}

Result<Diagnosed<PointList>> read_point_list(const std::filesystem::path& path,
                                             const PointListOptions& options) {
  const Result<std::string> text = read_file(path);
  if (!text) return fail(text);
  const Result<PointFormat> format = format_of_points(*text);
  if (!format) return fail(path.string() + ": is " + format.error().message);
  FindingLog log(path.string());
  PointList list;
  if (*format != PointFormat::table) {
    if (!options.order.empty() || options.header) {
      return fail(path.string() + ": is no table of columns: leave --order and --header out");
    }
    read_other(*format, *text, options, list, log);
  } else if (options.order.empty()) {
    return fail(path.string() +
                ": a table needs --order, the order of its columns: PENZD, PNEZD or own");
  } else {
    const bool own = options.order == "own";
    Result<std::vector<std::string>> columns =
        own ? own_columns() : columns_of_order(options.order);
    if (!columns) return fail(columns);
    if (own && options.metres_per_unit) return fail("--order own is in metres: leave --units out");
    read_table(*text, options, std::move(*columns), list, log);
  }
  if (list.points.empty() && !log.has_errors()) {
    log.error({}, "no-points", "the file has no points");
  }
  check_flat(list.points, log);
  check_reach(list, log);
  check_names(list.points, log);
  check_digits(list, log);
  Diagnosed<PointList> reading;
  reading.diagnostics = log.sorted();
  if (!log.has_errors()) reading.value = std::move(list);
  return reading;
}

std::string in_words(const SurveyedPoint& point) {
  return fmt::format("line {}: point {} ({})", point.line, point.name, to_string(point.kind));
}

}  // namespace tagsmith::detail
