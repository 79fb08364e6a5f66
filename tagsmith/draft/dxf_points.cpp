// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/draft/length_units.hpp"
#include "tagsmith/draft/point_formats.hpp"

namespace tagsmith::detail {
namespace {

struct DxfVertex {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  int line = 0;
  // The bulge of the arc to the next vertex: the tangent of a quarter of its angle, positive to the
  // left.
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

// For a polyline that is drawn with arcs, metres.
constexpr double kSagitta = 0.002;   // of chords between its points, at most
constexpr double kStraightStep = 1;  // between points of its straight parts, at most

// Points between two vertices, without these: on their arc, or straight. `metre`: in the drawing's
// unit.
std::vector<DxfVertex> points_between(const DxfVertex& from, const DxfVertex& to, double metre) {
  constexpr double kMost = 1e5;       // limits the work
  constexpr double kStraight = 1e-3;  // of the sagitta
  const double bulge = from.bulge;
  const Eigen::Vector2d start = from.p.head<2>();
  const Eigen::Vector2d chord = to.p.head<2>() - start;
  const double angle = 4 * std::atan(bulge);
  const bool bends = std::abs(bulge) * chord.norm() > kStraight * kSagitta * metre;
  Eigen::Vector2d centre(0, 0);
  double count = chord.norm() / (kStraightStep * metre);
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

// The points of an entity, in the world. A polyline that is drawn with arcs has points between its
// vertices too, since the fit would otherwise follow its vertices alone.
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
  const Eigen::Matrix3d axes = world_from_entity(entity);
  for (DxfVertex& point : points) {
    point.p.z() += entity.elevation;
    if (in_own_axes) point.p = axes * point.p;
  }
  return points;
}

// Takes the entities of a drawing one by one.
class DxfPoints {
 public:
  DxfPoints(RawPoints& result, const std::optional<double>& metres_per_unit, FindingLog& log)
      : result_(result), metres_per_unit_(metres_per_unit), log_(log) {}

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
                   "layers that are no descriptions are left out: " + counted_text(other_layers_),
                   "rename layers with points to TL, TR, WL, WR, CL, FL or RF");
    }
    if (!other_entities_.empty()) {
      log_.warning(
          {}, "left-out",
          "entities that are no points or lines are left out: " + counted_text(other_entities_),
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

  void leave_out(const std::string& layer, const std::string& what) {
    if (is_point_description(layer)) ++other_entities_[what];
  }

  // Of its own place only the elevation is used, for vertices that have none.
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
        description.empty() || (!is_point_description(description) && is_point_description(layer));
    if (by_layer && !is_point_description(layer)) {
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
// returns false or the file ends. Blank values are values.
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

}  // namespace

RawPoints dxf_points(std::string_view text, const std::optional<double>& metres_per_unit,
                     FindingLog& log) {
  RawPoints result;
  result.unit_is_advice = true;
  DxfPoints points(result, metres_per_unit, log);
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
