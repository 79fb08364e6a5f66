// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/point_formats.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/length_units.hpp"

namespace tagsmith::detail {
namespace {

// ---- GSI.

struct GsiWord {
  std::string_view index;  // two digits
  char unit = '0';
  bool negative = false;
  std::string_view data;
};

// The word that the line begins with: six characters, a sign, the data, a blank.
std::optional<GsiWord> front_word(std::string_view line, std::size_t data_size) {
  constexpr std::size_t kHead = 7;
  if (line.size() < kHead + data_size || !is_digit(line[0]) || !is_digit(line[1])) {
    return std::nullopt;
  }
  if (line[6] != '+' && line[6] != '-') return std::nullopt;
  return GsiWord{line.substr(0, 2), line[5], line[6] == '-', line.substr(kHead, data_size)};
}

std::string without_zeros(std::string_view data) {
  data = trim(data);
  data.remove_prefix(std::min(data.find_first_not_of('0'), data.size()));
  return std::string(data);
}

// Descriptions are padded with zeros on the left, which eats those of a tag's name.
std::string gsi_description(std::string_view data) {
  std::string text = without_zeros(data);
  const bool is_tag = !text.empty() && (text.back() == 'L' || text.back() == 'R') &&
                      std::all_of(text.begin(), text.end() - 1, is_digit);
  if (is_tag) text.insert(0, 4 - std::min<std::size_t>(4, text.size()), '0');
  return text;
}

// Metres or feet of the last digit; nothing for units of angles.
std::optional<double> last_digit(char unit) {
  static const std::map<char, double> kUnits{
      {'0', 1e-3}, {'1', 1e-3}, {'6', 1e-4}, {'7', 1e-4}, {'8', 1e-5}};
  const auto found = kUnits.find(unit);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

// What one block says.
struct GsiBlock {
  std::string name;
  std::optional<std::string> remark;  // word 71
  std::optional<std::string> code;    // word 41
  std::array<std::optional<double>, 3> coordinates;
  bool in_feet = false;
};

std::optional<GsiBlock> read_block(std::string_view line, int number, FindingLog& log) {
  const bool is_long = line.starts_with('*');
  const std::size_t size = is_long ? 16 : 8;
  if (is_long) line.remove_prefix(1);
  GsiBlock block;
  for (line = trim(line); !line.empty(); line = trim(line)) {
    const auto word = front_word(line, size);
    if (!word) {
      log.error(
          {number, 0}, "bad-gsi",
          fmt::format("`{}` is no GSI word of {} characters of data", line.substr(0, 24), size),
          "write the file again as GSI-8 or GSI-16");
      return std::nullopt;
    }
    if (word->index == "11") block.name = without_zeros(word->data);
    if (word->index == "71") block.remark = gsi_description(word->data);
    if (word->index == "41") block.code = gsi_description(word->data);
    if (word->index[0] == '8' && word->index[1] >= '1' && word->index[1] <= '3') {
      const auto unit = last_digit(word->unit);
      const auto value = parse_number(without_zeros(word->data).empty() ? "0" : word->data);
      if (!unit || !value) {
        log.error({number, 0}, "bad-number",
                  fmt::format("word {} is `{}` in unit {}, expected a length", word->index,
                              word->data, word->unit));
        return std::nullopt;
      }
      block.in_feet = word->unit == '1' || word->unit == '7';
      block.coordinates[static_cast<std::size_t>(word->index[1] - '1')] =
          (word->negative ? -1 : 1) * *value * *unit;
    }
    line.remove_prefix(7 + size);
  }
  return block;
}

// ---- DXF.

struct DxfEntity {
  std::string type;
  int line = 0;
  std::string layer;
  std::vector<Eigen::Vector3d> places;  // by group 10, and 11 of a LINE
  double elevation = 0;
  std::string tag;  // of an ATTRIB
  std::string value;
};

// Takes the entities of a drawing one by one.
class DxfPoints {
 public:
  DxfPoints(RawPoints& result, const IsDescription& is_description, FindingLog& log)
      : result_(result), is_description_(is_description), log_(log) {}

  // False when there are too many points.
  bool take(const DxfEntity& entity) {
    if (entity.type == "ATTRIB") return keep_attribute(entity);
    if (entity.type == "VERTEX") return add_all(entity, polyline_layer_, {}, {});
    const bool done = finish_insert();
    if (entity.type == "SEQEND" || entity.type.empty()) return done;
    if (entity.type == "POLYLINE") {
      polyline_layer_ = entity.layer;
    } else if (entity.type == "INSERT") {
      insert_ = entity;
    } else if (entity.type == "POINT" || entity.type == "LINE" || entity.type == "LWPOLYLINE") {
      return done && add_all(entity, entity.layer, {}, {});
    } else if (is_description_(entity.layer)) {
      ++other_entities_[entity.type];
    }
    return done;
  }

  void warn_of_rest() const {
    const auto listed = [](const std::map<std::string, int>& counts) {
      constexpr std::size_t kMost = 10;
      std::string text;
      std::size_t shown = 0;
      for (const auto& [name, count] : counts) {
        if (shown++ == kMost) return text + " ...";
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name.substr(0, 60), count);
      }
      return text;
    };
    if (!other_layers_.empty()) {
      log_.warning({}, "left-out",
                   "layers that are no descriptions are left out: " + listed(other_layers_),
                   "rename layers with points to TL, TR, WL, WR, CL, FL or RF");
    }
    if (!other_entities_.empty()) {
      log_.warning({}, "left-out",
                   "entities that are no points or lines are left out: " + listed(other_entities_),
                   "make points or polylines of them");
    }
  }

 private:
  bool keep_attribute(const DxfEntity& entity) {
    const std::string tag = upper_case(entity.tag);
    const auto is_one_of = [&](std::initializer_list<const char*> names) {
      return std::ranges::find(names, tag) != names.end();
    };
    if (is_one_of({"NAME", "POINT", "NUMBER", "PT", "ID", "NO"})) name_ = entity.value;
    if (is_one_of({"CODE", "DESC", "DESCRIPTION", "KIND"})) description_ = entity.value;
    return true;
  }

  bool finish_insert() {
    if (insert_.type.empty()) return true;
    const DxfEntity insert = std::exchange(insert_, {});
    return add_all(insert, insert.layer, std::exchange(name_, {}), std::exchange(description_, {}));
  }

  bool add_all(const DxfEntity& entity, const std::string& layer, const std::string& name,
               const std::string& description) {
    const bool by_layer =
        description.empty() || (!is_description_(description) && is_description_(layer));
    if (by_layer && !is_description_(layer)) {
      ++other_layers_[layer];
      return true;
    }
    for (const Eigen::Vector3d& place : entity.places) {
      const Eigen::Vector3d raised = place + entity.elevation * Eigen::Vector3d::UnitZ();
      RawPoint point{entity.line, name.empty() ? entity.type : name, by_layer ? layer : description,
                     raised};
      if (!add_point(result_, std::move(point), log_)) return false;
    }
    return true;
  }

  RawPoints& result_;
  const IsDescription& is_description_;
  FindingLog& log_;
  std::string polyline_layer_;
  DxfEntity insert_;  // whose attributes follow
  std::string name_;
  std::string description_;
  std::map<std::string, int> other_layers_;
  std::map<std::string, int> other_entities_;
};

// A coordinate group into the entity: 10, 20, 30 of a place, 11, 21, 31 of a line's end.
void put_coordinate(DxfEntity& entity, int code, double value) {
  const int axis = code / 10 - 1;
  const bool is_end = code % 10 == 1;
  if (is_end && entity.type != "LINE") return;
  if (axis == 0) entity.places.emplace_back(Eigen::Vector3d::Zero());
  if (!entity.places.empty()) entity.places.back()[axis] = value;
}

// What is kept of an entity's groups.
void put_group(DxfEntity& entity, int code, std::string_view text, int line, FindingLog& log) {
  const bool is_coordinate = (code >= 10 && code <= 31 && code % 10 <= 1) || code == 38;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double value = is_coordinate ? parse_number(text).value_or(kNone) : kNone;
  if (code == 8) entity.layer = text;
  if (code == 1) entity.value = text;
  if (code == 2) entity.tag = text;
  if (!is_coordinate) return;
  if (std::isnan(value)) {
    log.error({line, 0}, "bad-number",
              fmt::format("`{}` of a {} is no coordinate", text.substr(0, 20), entity.type));
  } else if (code == 38) {
    entity.elevation = value;
  } else {
    put_coordinate(entity, code, value);
  }
}

// Calls `use(line, code, value)` for each group, a code and a value on a line each, until it
// returns false or the file says its end. Blank values are values.
template <class Use>
void for_each_group(std::string_view text, FindingLog& log, Use use) {
  bool expects_code = true;
  int code = 0;
  for (int number = 1; !text.empty(); ++number, expects_code = !expects_code) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!expects_code) {
      if ((code == 0 && line == "EOF") || !use(number, code, line)) return;
      continue;
    }
    const std::optional<int> parsed = parse_integer(line);
    if (!parsed) {
      log.error({number, 0}, "bad-dxf", fmt::format("`{}` is no group code", line.substr(0, 20)),
                "save the drawing again as DXF, ASCII");
      return;
    }
    code = *parsed;
  }
}

// Metres of the header's $INSUNITS.
std::optional<double> unit_of_drawing(int insunits) {
  static const std::map<int, double> kUnits{
      {2, kFoot}, {4, 1e-3}, {5, 1e-2}, {6, 1.0}, {21, kSurveyFoot}};
  const auto found = kUnits.find(insunits);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

Result<PointFormat> format_of_points(std::string_view text) {
  if (text.starts_with("AutoCAD Binary DXF") || text.starts_with("AC10")) {
    return fail("a binary drawing (DWG or DXF): save it as DXF, ASCII");
  }
  if (text.substr(0, 1024).find('\0') != std::string_view::npos || text.starts_with("\xFF\xFE") ||
      text.starts_with("\xFE\xFF")) {
    return fail("no text in UTF-8: save it as text in UTF-8");
  }
  std::vector<std::string_view> lines;
  for_each_line(text, [&](int, std::string_view line) {
    lines.push_back(trim(line));
    return lines.size() < 100;
  });
  if (lines.empty()) return PointFormat::table;
  if (lines[0].starts_with('<')) {
    const bool landxml = text.substr(0, 4096).find("<LandXML") != std::string_view::npos;
    if (!landxml) return fail("XML, but not LandXML: expected a root element LandXML");
    return PointFormat::landxml;
  }
  if (lines.size() > 1 && (lines[0] == "999" || (lines[0] == "0" && lines[1] == "SECTION"))) {
    return PointFormat::dxf;
  }
  const bool is_long = lines[0].starts_with('*');
  const auto word = front_word(lines[0].substr(is_long ? 1 : 0), is_long ? 16 : 8);
  if (word && (word->index == "11" || word->index == "41")) return PointFormat::gsi;
  const bool rw5 = std::ranges::any_of(lines, [](std::string_view line) {
    return line.starts_with("JB,NM") || line.starts_with("MO,AD") || line.starts_with("SP,PN");
  });
  return rw5 ? PointFormat::rw5 : PointFormat::table;
}

bool add_point(RawPoints& points, RawPoint point, FindingLog& log) {
  if (points.points.size() < kMostPoints) {
    points.points.push_back(std::move(point));
    return true;
  }
  log.error({point.line, 0}, "too-many-points", fmt::format("more than {} points", kMostPoints),
            "divide the file");
  return false;
}

RawPoints gsi_points(std::string_view text, FindingLog& log) {
  RawPoints result;
  std::optional<bool> codes_first;  // by the first block
  std::string code;
  std::size_t uncoded = 0;  // from here on points wait for the code that follows them
  for_each_line(text, [&](int number, std::string_view line) {
    const auto block = read_block(line, number, log);
    if (!block) return true;
    if (!codes_first) codes_first = block->code.has_value();
    if (block->code) {
      code = *block->code;
      for (; !*codes_first && uncoded < result.points.size(); ++uncoded) {
        std::string& description = result.points[uncoded].description;
        if (description.empty()) description = code;
      }
    }
    const auto& [x, y, z] = block->coordinates;
    if (!x && !y && !z) return true;
    if (!x || !y || !z) {
      log.error({number, 0}, "bad-number",
                "point " + block->name + " lacks one of words 81, 82, 83",
                "write the file again with east, north and height");
      return true;
    }
    result.in_some_feet = result.in_some_feet || block->in_feet;
    if (!block->in_feet) result.metres_per_unit = 1;
    RawPoint point{number, block->name, *codes_first ? code : "", {*x, *y, *z}};
    if (block->remark) point.description = *block->remark;
    return add_point(result, std::move(point), log);
  });
  if (result.in_some_feet && result.metres_per_unit) {
    log.error({}, "no-units", "some points are in feet and others in metres");
  }
  return result;
}

RawPoints rw5_points(std::string_view text, FindingLog& log) {
  RawPoints result;
  for_each_line(text, [&](int number, std::string_view line) {
    line = trim(line);
    const std::size_t note = std::min(line.find(",--"), line.size());
    const std::vector<std::string> fields = split(line.substr(0, note), ',');
    const auto field = [&](std::string_view head) -> std::optional<std::string> {
      for (const std::string& each : fields) {
        const bool elevation = each.starts_with("EL");
        if (each.starts_with(head) && (elevation == (head == "EL"))) {
          return std::string(trim(std::string_view(each).substr(head.size())));
        }
      }
      return std::nullopt;
    };
    if (fields[0] == "MO") {
      const std::string unit = field("UN").value_or("");
      result.in_some_feet = unit == "0";
      if (unit == "1") result.metres_per_unit = 1;
      if (unit == "2") result.metres_per_unit = kSurveyFoot;
    }
    if (fields[0] != "SP") return true;
    const auto number_of = [&](const char* head) { return parse_number(field(head).value_or("")); };
    const auto north = number_of("N");
    const auto east = number_of("E");
    const auto height = number_of("EL");
    const std::string name = field("PN").value_or("");
    if (!north || !east || !height) {
      log.error(
          {number, 0}, "bad-number",
          "point " + name.substr(0, 60) + " lacks N, E or EL, expected SP,PN1,N 1,E 1,EL1,--WL");
      return true;
    }
    const std::string_view words = note < line.size() ? line.substr(note + 3) : std::string_view();
    return add_point(result, {number, name, std::string(trim(words)), {*east, *north, *height}},
                     log);
  });
  return result;
}

RawPoints dxf_points(std::string_view text, const IsDescription& is_description, FindingLog& log) {
  RawPoints result;
  result.unit_is_advice = true;
  DxfPoints points(result, is_description, log);
  DxfEntity entity;
  std::string section;
  std::string variable;
  for_each_group(text, log, [&](int line, int code, std::string_view value) {
    bool goes_on = true;
    if (code == 0) {
      if (section == "ENTITIES") goes_on = points.take(entity);
      if (value == "ENDSEC") section.clear();
      entity = {};
      entity.type = section == "ENTITIES" ? value : "";
      entity.line = line;
    } else if (code == 2 && section.empty()) {
      section = value;
    } else if (code == 9) {
      variable = value;
    } else if (code == 70 && section == "HEADER" && variable == "$INSUNITS") {
      result.metres_per_unit = unit_of_drawing(parse_integer(value).value_or(0));
    } else if (section == "ENTITIES") {
      put_group(entity, code, value, line, log);
    }
    return goes_on;
  });
  points.take({});  // a block at the end
  points.warn_of_rest();
  return result;
}

}  // namespace tagsmith::detail
