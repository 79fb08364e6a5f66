// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/point_formats.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/length_units.hpp"
#include "tagsmith/survey/listed_survey.hpp"

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

// The twelve digits of a tag, which zeros pad; else the text as it is.
std::string gsi_digits(std::string_view data) {
  constexpr std::size_t kDigits = 12;
  const std::size_t zeros = data.size() - std::min(data.size(), kDigits);
  const bool padded = data.substr(0, zeros).find_first_not_of('0') == std::string_view::npos;
  return std::string(padded ? data.substr(zeros) : data);
}

// What one block says.
struct GsiBlock {
  std::string name;
  std::optional<std::string> remark;  // word 71
  std::optional<std::string> code;    // word 41
  std::string digits;                 // word 72
  // Words 42 to 49, each without what precedes its sign of equality.
  std::string key;    // word 42
  std::string value;  // the others
  std::array<std::optional<double>, 3> coordinates;
  std::optional<bool> in_feet;  // what the coordinates' words say, the last one
  bool in_two_units = false;    // they differ
};

bool is_feet(char unit) { return unit == '1' || unit == '7'; }

// The word as one of a block's coordinates. False, with a finding, where it is none.
bool put_gsi_length(const GsiWord& word, int number, GsiBlock& block, FindingLog& log) {
  const auto unit = last_digit(word.unit);
  const auto value = parse_number(without_zeros(word.data).empty() ? "0" : word.data);
  if (!unit || !value) {
    log.error({number, 0}, "bad-number",
              fmt::format("word {} is `{}` in unit {}, expected a length", word.index, word.data,
                          word.unit));
    return false;
  }
  const bool in_feet = is_feet(word.unit);
  block.in_two_units = block.in_two_units || block.in_feet.value_or(in_feet) != in_feet;
  block.in_feet = in_feet;
  block.coordinates[static_cast<std::size_t>(word.index[1] - '1')] =
      (word.negative ? -1 : 1) * *value * *unit;
  return true;
}

// What export writes of all tags, into the block's key and value.
void put_listed(const GsiWord& word, GsiBlock& block) {
  const std::size_t sign = word.data.find('=');
  if (word.index[0] != '4' || word.index[1] < '2' || sign == std::string_view::npos) return;
  (word.index == "42" ? block.key : block.value) += word.data.substr(sign + 1);
}

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
    if (word->index == "72") block.digits = gsi_digits(word->data);
    put_listed(*word, block);
    const bool is_length = word->index[0] == '8' && word->index[1] >= '1' && word->index[1] <= '3';
    if (is_length && !put_gsi_length(*word, number, block, log)) return std::nullopt;
    line.remove_prefix(7 + size);
  }
  return block;
}

// "CIRCLE (2), HATCH (1)".
std::string listed(const std::map<std::string, int>& counts) {
  constexpr std::size_t kMost = 10;
  std::string text;
  std::size_t shown = 0;
  for (const auto& [name, count] : counts) {
    if (shown++ == kMost) return text + " ...";
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name.substr(0, 60), count);
  }
  return text;
}

// ---- DXF.

struct DxfVertex {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  int line = 0;
  // Of the arc to the next vertex: the tangent of a quarter of its angle, positive to the left.
  double bulge = 0;
};

struct DxfEntity {
  std::string type;
  int line = 0;
  std::string layer;
  std::vector<DxfVertex> vertices;  // by group 10, and 11 of a LINE
  double elevation = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // the extrusion direction
  int flags = 0;                                      // group 70
  std::string tag;                                    // of an ATTRIB
  std::string value;

  bool has(int flag) const { return (flags & flag) != 0; }
};

// Bits of group 70.
constexpr int kClosed = 1;        // of polylines
constexpr int kInSpace = 8;       // of a POLYLINE
constexpr int kMesh = 16 | 64;    // of a POLYLINE
constexpr int kSplineFrame = 16;  // of a VERTEX

// Axes of the entity's own coordinates, by the arbitrary axis algorithm of the DXF reference.
Eigen::Matrix3d world_from_entity(const DxfEntity& entity) {
  constexpr double kNearZ = 1.0 / 64;
  const Eigen::Vector3d z = entity.normal.normalized();
  const bool near_z = std::abs(z.x()) < kNearZ && std::abs(z.y()) < kNearZ;
  const Eigen::Vector3d beside =
      near_z ? Eigen::Vector3d(Eigen::Vector3d::UnitY()) : Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d axes;
  axes.col(0) = beside.cross(z).normalized();
  axes.col(1) = z.cross(axes.col(0));
  axes.col(2) = z;
  return axes;
}

// Of a polyline that is drawn with arcs, metres.
constexpr double kSagitta = 0.002;  // of chords between its points, at most
constexpr double kStep = 1;         // between points of its straight parts, at most

// Points between two vertices, without these: on their arc, or straight. `metre`: in the drawing's
// unit.
std::vector<DxfVertex> points_between(const DxfVertex& from, const DxfVertex& to, double metre) {
  constexpr double kMost = 1e5;       // bounds the work
  constexpr double kStraight = 1e-3;  // of the sagitta
  const double bulge = from.bulge;
  const Eigen::Vector2d start = from.p.head<2>();
  const Eigen::Vector2d chord = to.p.head<2>() - start;
  const double angle = 4 * std::atan(bulge);
  const bool bends = std::abs(bulge) * chord.norm() > kStraight * kSagitta * metre;
  Eigen::Vector2d centre(0, 0);
  double count = chord.norm() / (kStep * metre);
  if (bends) {
    const Eigen::Vector2d left(-chord.y(), chord.x());
    centre = start + chord / 2 + (1 - bulge * bulge) / (4 * bulge) * left;
    const double radius = (start - centre).norm();
    count = std::max(2.0, std::abs(angle) / std::sqrt(8 * kSagitta * metre / radius));
  }
  const int parts = static_cast<int>(std::ceil(std::clamp(count, 1.0, kMost)));
  std::vector<DxfVertex> points;
  for (int i = 1; i < parts; ++i) {
    const double share = static_cast<double>(i) / parts;
    DxfVertex point{from.p + share * (to.p - from.p), from.line};
    if (bends) point.p.head<2>() = centre + Eigen::Rotation2Dd(share * angle) * (start - centre);
    points.push_back(point);
  }
  return points;
}

// The points that an entity says, in the world. A polyline that is drawn with arcs has points
// between its vertices too, since the fit would else follow its vertices alone.
std::vector<DxfVertex> points_of(const DxfEntity& entity, double metre) {
  const bool is_2d = entity.type == "POLYLINE" && !entity.has(kInSpace);
  const bool has_arcs =
      (is_2d || entity.type == "LWPOLYLINE") &&
      std::ranges::any_of(entity.vertices, [](const DxfVertex& each) { return each.bulge != 0; });
  std::vector<DxfVertex> points;
  for (std::size_t i = 0; i < entity.vertices.size(); ++i) {
    points.push_back(entity.vertices[i]);
    const bool is_last = i + 1 == entity.vertices.size();
    if (!has_arcs || (is_last && !entity.has(kClosed))) continue;
    const DxfVertex& next = entity.vertices[is_last ? 0 : i + 1];
    std::ranges::copy(points_between(points.back(), next, metre), std::back_inserter(points));
  }
  const bool in_own_axes = is_2d || entity.type == "LWPOLYLINE" || entity.type == "INSERT";
  for (DxfVertex& point : points) {
    point.p.z() += entity.elevation;
    if (in_own_axes) point.p = world_from_entity(entity) * point.p;
  }
  return points;
}

// Takes the entities of a drawing one by one.
class DxfPoints {
 public:
  DxfPoints(RawPoints& result, const IsDescription& is_description,
            const std::optional<double>& metres_per_unit, FindingLog& log)
      : result_(result),
        is_description_(is_description),
        metres_per_unit_(metres_per_unit),
        log_(log) {}

  // False when there are too many points.
  bool take(const DxfEntity& entity) {
    if (entity.type == "ATTRIB") return keep_attribute(entity);
    if (entity.type == "VERTEX") return keep_vertex(entity);
    const bool done = finish();
    if (entity.type == "SEQEND" || entity.type.empty()) return done;
    if (entity.type == "POLYLINE" && entity.has(kMesh)) {
      leave_out(entity.layer, "POLYLINE of a mesh");
    } else if (entity.type == "POLYLINE" || entity.type == "INSERT") {
      open_ = entity;
      if (entity.type == "POLYLINE") open_polyline();
    } else if (entity.type == "POINT" || entity.type == "LINE" || entity.type == "LWPOLYLINE") {
      return done && add_all(entity, {}, {});
    } else {
      leave_out(entity.layer, entity.type);
    }
    return done;
  }

  void warn_of_rest() const {
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
    const bool is_flat = std::ranges::all_of(
        result_.points, [](const RawPoint& point) { return point.in_grid.z() == 0; });
    if (is_flat && !result_.points.empty()) {
      log_.warning({}, "flat-drawing",
                   "all points have the height 0: heights in texts and attributes are not read",
                   "give points and polylines of the drawing their heights");
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

  void leave_out(const std::string& layer, const std::string& what) {
    if (is_description_(layer)) ++other_entities_[what];
  }

  // Of its own place it has the elevation alone, which holds for vertices that have none.
  void open_polyline() {
    elevation_ = open_.vertices.empty() || open_.has(kInSpace) ? 0 : open_.vertices[0].p.z();
    open_.vertices.clear();
  }

  bool keep_vertex(const DxfEntity& vertex) {
    if (open_.type != "POLYLINE" || vertex.vertices.empty()) return true;
    if (vertex.has(kSplineFrame)) {
      leave_out(open_.layer, "VERTEX of a spline's frame");
    } else if (open_.vertices.size() < kMostPoints) {
      open_.vertices.push_back(vertex.vertices.front());
      open_.vertices.back().line = vertex.line;
      double& z = open_.vertices.back().p.z();
      if (z == 0) z = elevation_;
    }
    return true;
  }

  // Adds the block or polyline whose parts were read.
  bool finish() {
    const DxfEntity entity = std::exchange(open_, {});
    if (entity.type.empty()) return true;
    return add_all(entity, std::exchange(name_, {}), std::exchange(description_, {}));
  }

  bool add_all(const DxfEntity& entity, const std::string& name, const std::string& description) {
    const std::string& layer = entity.layer;
    const bool by_layer =
        description.empty() || (!is_description_(description) && is_description_(layer));
    if (by_layer && !is_description_(layer)) {
      ++other_layers_[layer];
      return true;
    }
    if (entity.normal.isZero()) {
      log_.error({entity.line, 0}, "bad-number",
                 "the extrusion direction of a " + entity.type + " is 0, 0, 0");
      return true;
    }
    const double unit = metres_per_unit_.value_or(result_.metres_per_unit.value_or(1));
    for (const DxfVertex& place : points_of(entity, 1 / unit)) {
      RawPoint point{place.line, name.empty() ? entity.type : name, by_layer ? layer : description,
                     place.p};
      if (!add_point(result_, std::move(point), log_)) return false;
    }
    return true;
  }

  RawPoints& result_;
  const IsDescription& is_description_;
  const std::optional<double>& metres_per_unit_;
  FindingLog& log_;
  DxfEntity open_;        // a block whose attributes follow, or a polyline whose vertices do
  double elevation_ = 0;  // of that polyline
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
  if (axis == 0) entity.vertices.push_back({Eigen::Vector3d::Zero(), entity.line});
  if (!entity.vertices.empty()) entity.vertices.back().p[axis] = value;
}

// What is kept of an entity's groups.
void put_group(DxfEntity& entity, int code, std::string_view text, int line, FindingLog& log) {
  constexpr int kBulge = 42;  // of vertices; of blocks a scale
  const bool is_coordinate = code >= 10 && code <= 31 && code % 10 <= 1;
  const bool is_normal = code == 210 || code == 220 || code == 230;
  const bool is_bulge = code == kBulge && (entity.type == "VERTEX" || entity.type == "LWPOLYLINE");
  if (code == 8) entity.layer = text;
  if (code == 1) entity.value = text;
  if (code == 2) entity.tag = text;
  if (code == 70) entity.flags = parse_integer(text).value_or(0);
  if (!is_coordinate && !is_normal && !is_bulge && code != 38) return;
  const std::optional<double> value = parse_number(text);
  if (!value) {
    log.error({line, 0}, "bad-number",
              fmt::format("`{}` of a {} is no number", text.substr(0, 20), entity.type));
  } else if (code == 38) {
    entity.elevation = *value;
  } else if (is_normal) {
    entity.normal[code / 10 - 21] = *value;
  } else if (is_bulge) {
    if (!entity.vertices.empty()) entity.vertices.back().bulge = *value;
  } else {
    put_coordinate(entity, code, *value);
  }
}

// Calls `use(line, code, value)` for each group, a code and a value on a line each, until it
// returns false or the file says its end. Blank values are values.
template <class Use>
void for_each_group(std::string_view text, FindingLog& log, Use use) {
  text = without_mark(text);
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

// Metres of the header's $INSUNITS, by the DXF reference; 0 says nothing.
std::optional<double> unit_of_drawing(int insunits) {
  static const std::map<int, double> kUnits{{1, 0.0254},
                                            {2, kFoot},
                                            {3, 5280 * kFoot},
                                            {4, 1e-3},
                                            {5, 1e-2},
                                            {6, 1.0},
                                            {7, 1e3},
                                            {8, 2.54e-8},
                                            {9, 2.54e-5},
                                            {10, 3 * kFoot},
                                            {11, 1e-10},
                                            {12, 1e-9},
                                            {13, 1e-6},
                                            {14, 0.1},
                                            {15, 10.0},
                                            {16, 100.0},
                                            {17, 1e9},
                                            {18, 149'597'870'700.0},
                                            {19, 9.4607304725808e15},
                                            {20, 3.0856775814913673e16},
                                            {21, kSurveyFoot},
                                            {22, kSurveyFoot / 12},
                                            {23, 3 * kSurveyFoot},
                                            {24, 5280 * kSurveyFoot}};
  const auto found = kUnits.find(insunits);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

void read_drawing_unit(std::string_view text, RawPoints& result) {
  const int number = parse_integer(text).value_or(-1);
  result.metres_per_unit = unit_of_drawing(number);
  const bool is_known = number == 0 || result.metres_per_unit;
  result.unknown_unit = is_known ? "" : "$INSUNITS " + std::string(text.substr(0, 20));
}

// ---- RW5.

// Of a record: what is behind the head of one of its fields.
std::optional<std::string> rw5_field(const std::vector<std::string>& fields,
                                     std::string_view head) {
  for (const std::string& each : fields) {
    const bool elevation = each.starts_with("EL");
    if (each.starts_with(head) && (elevation == (head == "EL"))) {
      return std::string(trim(std::string_view(each).substr(head.size())));
    }
  }
  return std::nullopt;
}

// Takes the records of a raw file one by one.
class Rw5Points {
 public:
  Rw5Points(RawPoints& result, const IsDescription& is_description, FindingLog& log)
      : result_(result), is_description_(is_description), log_(log) {}

  // False when there are too many points.
  bool take(int number, std::string_view line) {
    const std::size_t note = std::min(line.find(",--"), line.size());
    const std::vector<std::string> fields = split(line.substr(0, note), ',');
    const std::string words(note < line.size() ? trim(line.substr(note + 3)) : "");
    if (fields[0] == "MO") take_unit(number, fields);
    if (fields[0] == "SP") return take_point(number, fields, words);
    if (!is_description_(words)) return true;
    std::optional<std::string> name;
    for (const char* head : {"PN", "FP", "OP"}) {
      if (!name) name = rw5_field(fields, head);
    }
    others_.emplace(name.value_or(""), fields[0]);
    return true;
  }

  void warn_of_rest() const {
    std::map<std::string, int> counts;
    for (const auto& [name, record] : others_) {
      if (!points_.contains(name)) ++counts[record];
    }
    if (counts.empty()) return;
    log_.warning({}, "left-out", "points that no record SP has are left out: " + listed(counts),
                 "let the field book compute them, so that they are stored as SP");
  }

 private:
  void take_unit(int number, const std::vector<std::string>& fields) {
    const auto unit = rw5_field(fields, "UN");
    if (!unit) return;
    if (unit_ && *unit_ != *unit) {
      log_.error({number, 0}, "no-units",
                 "the record MO says UN" + unit->substr(0, 20) + ", one before it UN" +
                     unit_->substr(0, 20),
                 "divide the file where its unit changes");
      return;
    }
    unit_ = *unit;
    result_.in_some_feet = *unit == "0";
    if (*unit == "1") result_.metres_per_unit = 1;
    if (*unit == "2") result_.metres_per_unit = kSurveyFoot;
    if (!result_.in_some_feet && !result_.metres_per_unit) result_.unknown_unit = "UN" + *unit;
  }

  bool take_point(int number, const std::vector<std::string>& fields, const std::string& words) {
    const auto number_of = [&](const char* head) {
      return parse_number(rw5_field(fields, head).value_or(""));
    };
    const auto north = number_of("N");
    const auto east = number_of("E");
    const auto height = number_of("EL");
    const std::string name = rw5_field(fields, "PN").value_or("");
    points_.insert(name);
    if (north && east && height) {
      return add_point(result_, {number, name, words, {*east, *north, *height}}, log_);
    }
    log_.error(
        {number, 0}, "bad-number",
        "point " + name.substr(0, 60) + " lacks N, E or EL, expected SP,PN1,N 1,E 1,EL1,--WL");
    return true;
  }

  RawPoints& result_;
  const IsDescription& is_description_;
  FindingLog& log_;
  std::optional<std::string> unit_;                       // as the first record MO says it
  std::set<std::string> points_;                          // names of those that have a record SP
  std::set<std::pair<std::string, std::string>> others_;  // names and kinds of other records
};

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
    if (block->code == kListedSurvey) {
      result.listed_line = number;
      result.listed[block->key] = trim(block->value);
      return true;
    }
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
    if (block->in_two_units) {
      log.error({number, 0}, "no-units",
                "words 81, 82, 83 of point " + block->name + " are in feet and in metres",
                "write the file again with east, north and height in one unit");
      return false;
    }
    result.in_some_feet = result.in_some_feet || *block->in_feet;
    if (!*block->in_feet) result.metres_per_unit = 1;
    RawPoint point{number, block->name, *codes_first ? code : "", {*x, *y, *z}};
    if (block->remark && !block->remark->empty()) point.description = *block->remark;
    point.digits = block->digits;
    return add_point(result, std::move(point), log);
  });
  if (result.in_some_feet && result.metres_per_unit) {
    log.error({}, "no-units", "some points are in feet and others in metres");
  }
  return result;
}

RawPoints rw5_points(std::string_view text, const IsDescription& is_description, FindingLog& log) {
  RawPoints result;
  Rw5Points points(result, is_description, log);
  for_each_line(text,
                [&](int number, std::string_view line) { return points.take(number, trim(line)); });
  points.warn_of_rest();
  return result;
}

RawPoints dxf_points(std::string_view text, const IsDescription& is_description,
                     const std::optional<double>& metres_per_unit, FindingLog& log) {
  RawPoints result;
  result.unit_is_advice = true;
  DxfPoints points(result, is_description, metres_per_unit, log);
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
      read_drawing_unit(value, result);
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
