// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/point_list.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/read_tunnel.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kCodes = "TL, TR, WL, WR, CL, FL, RF or the name of a tag, as 000L";

std::string upper(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return result;
}

std::optional<PointKind> kind_of(const std::string& code) {
  static const std::map<std::string, PointKind> kinds{
      {"TL", PointKind::left_tag},   {"TR", PointKind::right_tag},  {"WL", PointKind::left_wall},
      {"WR", PointKind::right_wall}, {"CL", PointKind::centerline}, {"FL", PointKind::floor},
      {"RF", PointKind::roof}};
  const auto found = kinds.find(code);
  if (found == kinds.end()) return std::nullopt;
  return found->second;
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
  for (const char letter : upper(order)) {
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

// One line with its columns by name.
class ListRow {
 public:
  ListRow(const std::vector<std::string>& columns, std::vector<std::string> fields, int line,
          FindingLog& log)
      : columns_(columns), fields_(std::move(fields)), line_(line), log_(log) {}

  int line() const { return line_; }

  const std::string& text(const std::string& column) const {
    static const std::string kNone;
    const auto index = index_of(column);
    return index < fields_.size() ? fields_[index] : kNone;
  }

  std::optional<double> number(const std::string& column) const {
    const std::string& field = text(column);
    const std::optional<double> value = parse_number(field);
    if (value && std::abs(*value) <= kFarthest) return value;
    const bool comma = field.find(',') != std::string::npos;
    error(
        column, "bad-number",
        column + " is `" + field.substr(0, 60) + "`, expected a number of metres",
        comma ? "decimal signs are points" : "does the first line name the columns? then --header");
    return std::nullopt;
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

  void error(const std::string& column, const std::string& code, const std::string& message,
             const std::string& hint = {}) const {
    log_.error({line_, static_cast<int>(index_of(column)) + 1}, code, message, hint);
  }

 private:
  std::size_t index_of(const std::string& column) const {
    return static_cast<std::size_t>(std::ranges::find(columns_, column) - columns_.begin());
  }

  const std::vector<std::string>& columns_;
  std::vector<std::string> fields_;
  int line_;
  FindingLog& log_;
};

std::optional<SurveyedPoint> read_point(const ListRow& row,
                                        const std::vector<std::string>& ignore) {
  const std::string& description = row.text("code");
  const std::string code = upper(description.substr(0, description.find_first_of(" \t")));
  if (std::ranges::any_of(ignore, [&](const auto& word) { return upper(word) == code; })) {
    return std::nullopt;
  }
  SurveyedPoint point;
  point.line = row.line();
  point.name = row.text("name");
  point.tag = parse_tag_name(code);
  const std::optional<PointKind> kind = point.tag ? kind_of(point.tag->side) : kind_of(code);
  const auto in_grid = row.point();
  if (!kind) {
    row.error("code", "unknown-code",
              "point " + point.name.substr(0, 60) + " has the description `" +
                  description.substr(0, 60) + "`, expected " + kCodes,
              "or leave such points out: --ignore " + (code.empty() ? "CODE" : code.substr(0, 20)));
  }
  if (!kind || !in_grid) return std::nullopt;
  point.kind = *kind;
  point.in_grid = *in_grid;
  return point;
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

std::optional<SurveyedPoint> read_own_point(const ListRow& row) {
  SurveyedPoint point;
  point.line = row.line();
  point.name = row.text("tag");
  point.tag = parse_tag_name(point.name);
  if (!point.tag) {
    row.error("tag", "bad-tag-name", "tag is `" + point.name.substr(0, 60) + "`, expected 000L");
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
  if (!row.text("design_x").empty()) point.design_in_grid = row.point("design_");
  if (!point.tag || !in_grid) return std::nullopt;
  point.kind = kind_of(point.tag->side);
  point.in_grid = *in_grid;
  return point;
}

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
  if (!complete) return std::nullopt;
  survey.code.check = *check;
  survey.grid.x_axis_left = axis == "left";
  return survey;
}

// The columns that an own list has: of older versions without the plates' attitudes.
constexpr std::size_t kOldColumns = 27;

void check_own_header(const std::vector<std::string>& fields, int line,
                      std::vector<std::string>& columns, FindingLog& log) {
  if (fields.size() == kOldColumns) columns.resize(kOldColumns);
  if (fields == columns) return;
  log.error({line, 0}, "missing-column",
            "the columns are not those of `tagsmith export`, expected " + csv_row(own_columns()),
            "give the order of the columns: --order PENZD");
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

struct Line {
  int number = 0;
  std::vector<std::string> fields;
};

std::vector<Line> lines_of(const std::string& text, FindingLog& log) {
  std::vector<Line> lines;
  int number = 0;
  for (const std::string& line : split(text, '\n')) {
    ++number;
    if (trim(line).empty()) continue;
    auto fields = split_csv(line);
    if (!fields) {
      log.error({number, 0}, "bad-quotes", "a quoted field is not closed");
    } else {
      lines.push_back({number, std::move(*fields)});
    }
  }
  return lines;
}

}  // namespace

std::string to_string(PointKind kind) {
  switch (kind) {
    case PointKind::left_tag:
      return "left tag";
    case PointKind::right_tag:
      return "right tag";
    case PointKind::left_wall:
      return "left wall";
    case PointKind::right_wall:
      return "right wall";
    case PointKind::centerline:
      return "center line";
    case PointKind::floor:
      return "floor";
    default:
      return "roof";
  }
}

std::vector<std::string> own_columns() {
  return split(
      "tag,side,digits,x,y,z,chainage,offset,height,sigma,date,design_x,design_y,design_z,template,"
      "check_digit,digits_x,digits_y,digits_z,resolution_x,resolution_y,resolution_z,origin_x,"
      "origin_y,origin_z,x_axis,tunnel_height,facing,tilt,roll",
      ',');
}

Result<PointListReading> read_point_list(const std::filesystem::path& path,
                                         const PointListOptions& options) {
  const bool own = options.order == "own";
  Result<std::vector<std::string>> columns = own ? own_columns() : columns_of_order(options.order);
  if (!columns) return tl::unexpected(columns.error());
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  FindingLog log(path.string());
  PointList list;
  std::vector<Line> lines = lines_of(*text, log);
  if (own && !lines.empty()) {
    check_own_header(lines.front().fields, lines.front().number, *columns, log);
  }
  if (log.has_errors()) lines.clear();
  if ((own || options.header) && !lines.empty()) lines.erase(lines.begin());
  if (lines.empty() && !log.has_errors()) log.error({}, "no-points", "the file has no points");
  for (Line& line : lines) {
    if (line.fields.size() < columns->size()) {
      log.error({line.number, 0}, "wrong-length",
                "the line has " + std::to_string(line.fields.size()) + " fields, expected " +
                    std::to_string(columns->size()) + " separated by commas");
      continue;
    }
    const ListRow row(*columns, std::move(line.fields), line.number, log);
    if (own && !list.survey) list.survey = read_listed_survey(row);
    auto point = own ? read_own_point(row) : read_point(row, options.ignore);
    if (point) list.points.push_back(std::move(*point));
  }
  check_names(list.points, log);
  PointListReading reading;
  reading.diagnostics = log.sorted();
  if (!log.has_errors()) reading.list = std::move(list);
  return reading;
}

}  // namespace tagsmith::detail
