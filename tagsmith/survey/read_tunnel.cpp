// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_tunnel.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/read_room.hpp"

namespace tagsmith::detail {
namespace {

struct Elements {
  std::vector<CenterlineElement> elements;
  bool complete = true;  // false: some were faulty
};

const char* kElementHint =
    "{ line: LENGTH }, { arc: RADIUS, turn: left|right, angle: DEGREES } or { clothoid: LENGTH, "
    "turn: left|right, from_radius: RADIUS, to_radius: RADIUS }";

std::optional<CenterlineElement> read_line(const MapReader& map) {
  const auto length = map.number("line", above_zero(kLongest, "m"));
  if (!length) return std::nullopt;
  return CenterlineElement{*length, 0, 0};
}

// False, with a finding, when the wall on the inner side of the bend has no radius left. `key`: of
// the radius.
bool leaves_room(const MapReader& map, const char* key, double radius, bool turns_right,
                 double start, double length, const Room& room) {
  const std::optional<ChainageProfile>& inner = turns_right ? room.right : room.left;
  if (!inner) return true;
  const double inner_wall =
      turns_right ? inner->greatest(start, start + length) : -inner->least(start, start + length);
  if (radius > inner_wall) return true;
  map.log().error(map.find(key)->place, "tight-arc",
                  map.name_of(key) + " has a radius of " + format_number(radius) +
                      " m, expected more than the distance of its inner wall, " +
                      format_number(inner_wall) + " m",
                  "the radius is that of the center line");
  return false;
}

// `start`: chainage at which it begins.
std::optional<CenterlineElement> read_arc(const MapReader& map, double start, const Room& room) {
  const auto radius = map.number("arc", above_zero(kWidestRadius, "m"));
  const auto turn = map.choice("turn", {"left", "right"}, "turn: left or turn: right");
  const auto angle = map.number("angle", above_zero(360, "degrees"));
  if (!radius || !turn || !angle) return std::nullopt;
  const bool turns_right = *turn == "right";
  const double length = *radius * radians(*angle);
  if (!leaves_room(map, "arc", *radius, turns_right, start, length, room)) return std::nullopt;
  return CenterlineElement{length, (turns_right ? 1.0 : -1.0) / *radius, 0};
}

// A clothoid between these radii, of which one that is not given is that of a straight line.
std::vector<CenterlineElement> read_clothoid(const MapReader& map, double start, const Room& room,
                                             int number) {
  const auto length = map.number("clothoid", above_zero(kLongest, "m"));
  const auto turn = map.choice("turn", {"left", "right"}, "turn: left or turn: right");
  if (!length || !turn) return {};
  const double sign = *turn == "right" ? 1 : -1;
  std::array<double, 2> curvatures{};
  for (std::size_t i = 0; i < 2; ++i) {
    const char* key = i == 0 ? "from_radius" : "to_radius";
    if (!map.has(key)) continue;
    const auto radius = map.number(key, above_zero(kWidestRadius, "m"));
    if (!radius || !leaves_room(map, key, *radius, sign > 0, start, *length, room)) return {};
    curvatures[i] = sign / *radius;
  }
  const double turned = *length * std::abs(curvatures[0] + curvatures[1]) / 2;
  if (curvatures[0] == curvatures[1] || turned > 2 * std::numbers::pi) {
    map.log().error(map.place(), "bad-element",
                    curvatures[0] == curvatures[1]
                        ? "the clothoid has the same radius at both ends, expected two, or one "
                          "where its other end is straight"
                        : "the clothoid turns by " + format_number(degrees(turned), 0) +
                              " degrees, expected at most 360",
                    kElementHint);
    return {};
  }
  return arcs_of_clothoid(*length, curvatures[0], curvatures[1], number);
}

// Keys that belong to other kinds of elements than this one.
void check_keys(const MapReader& map, const std::string& kind) {
  const std::pair<const char*, std::string> owners[] = {{"turn", "arc clothoid"},
                                                        {"angle", "arc"},
                                                        {"from_radius", "clothoid"},
                                                        {"to_radius", "clothoid"}};
  for (const auto& [key, kinds] : owners) {
    if (!map.has(key) || kinds.find(kind) != std::string::npos) continue;
    map.log().error(map.find(key)->place, "conflicting-keys",
                    "`" + map.name_of(key) + "` beside `" + kind + "`, expected it with `" +
                        (kinds == "arc clothoid" ? "arc` or `clothoid" : kinds) + "` only",
                    kElementHint);
  }
}

// One, or the arcs of a clothoid; none where it is faulty. `number`: from 1.
std::vector<CenterlineElement> read_element(const YamlNode& node, const std::string& name,
                                            double start, int number, const Room& room,
                                            FindingLog& log) {
  const MapReader map(
      &node, name,
      {"line", "arc", "clothoid", "turn", "angle", "from_radius", "to_radius", "grade"}, log);
  if (!map.is_map()) return {};
  const double grade = map.number_or("grade", 0, between(-100, 100, "percent")) / 100;
  std::vector<std::string> kinds;
  for (const char* kind : {"line", "arc", "clothoid"}) {
    if (map.has(kind)) kinds.emplace_back(kind);
  }
  if (kinds.size() != 1) {
    log.error(map.place(), "bad-element",
              name + " has " + (kinds.empty() ? "none" : "several") +
                  " of `line`, `arc` and `clothoid`, expected one of them",
              kElementHint);
    return {};
  }
  check_keys(map, kinds.front());
  std::vector<CenterlineElement> elements;
  if (kinds.front() == "clothoid") {
    elements = read_clothoid(map, start, room, number);
  } else if (auto one = kinds.front() == "arc" ? read_arc(map, start, room) : read_line(map)) {
    elements.push_back(*one);
  }
  for (CenterlineElement& element : elements) element.grade = grade;
  return elements;
}

Elements read_elements(const MapReader& centerline, const Room& room) {
  const std::string name = centerline.name_of("elements");
  FindingLog& log = centerline.log();
  const YamlNode* node = centerline.need("elements", "elements: [ { line: 10.0 } ]");
  const std::vector<YamlNode>* list = read_list(node, name, log);
  Elements result;
  result.complete = list != nullptr;
  if (list == nullptr) return result;
  if (list->empty() || list->size() > kMostElements) {
    log.error(node->place, "wrong-length",
              name + " has " + std::to_string(list->size()) + " elements, expected 1 to " +
                  std::to_string(kMostElements));
    result.complete = false;
    return result;
  }
  double start = 0;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const auto elements = read_element((*list)[i], name + "[" + std::to_string(i) + "]", start,
                                       static_cast<int>(i) + 1, room, log);
    result.complete = result.complete && !elements.empty();
    for (const CenterlineElement& element : elements) start += element.length;
    result.elements.insert(result.elements.end(), elements.begin(), elements.end());
  }
  return result;
}

std::optional<Centerline> read_centerline(const YamlNode* node, const Grid& grid, const Room& room,
                                          FindingLog& log) {
  const MapReader map(node, "tunnel.centerline", {"start", "heading", "elements"}, log);
  const auto start = read_point(map.need("start", "start: [x, y, z] on the floor"),
                                map.name_of("start"), kFarthest, log);
  const auto heading =
      map.number("heading", between(-360, 360, "degrees"), "heading: degrees from +y towards +x");
  const Elements elements = read_elements(map, room);
  if (!start || !heading || !elements.complete) return std::nullopt;
  return Centerline(world_from_grid(grid, *start), world_heading_from_grid(grid, radians(*heading)),
                    elements.elements);
}

}  // namespace

std::optional<Tunnel> read_tunnel(const YamlNode* node, const Grid& grid, FindingLog& log) {
  const MapReader map(node, "tunnel",
                      {"width", "height", "sections", "walls", "stand_off", "centerline"}, log);
  const Room room = read_room(map);
  const auto centerline = read_centerline(
      map.need("centerline",
               "centerline: { start: [0, 0, 0], heading: 0, elements: [ { line: 10.0 } ] }"),
      grid, room, log);
  if (!room.left || !room.right || !room.height || !centerline) return std::nullopt;
  return Tunnel{*centerline, *room.left, *room.right, *room.height, room.stand_off};
}

Grid read_grid(const YamlNode* node, FindingLog& log) {
  const MapReader map(node, "grid", {"x_axis", "crs"}, log);
  Grid grid{map.choice("x_axis", {"right", "left"}) == "left"};
  const auto crs = read_text(map.find("crs"), map.name_of("crs"), log);
  if (!crs) return grid;
  const std::optional<int> epsg = parse_crs(*crs);
  if (!epsg) {
    log.error(map.find("crs")->place, "bad-crs",
              map.name_of("crs") + " is `" + *crs +
                  "`, expected a grid in metres by its number in the EPSG register",
              "for example crs: EPSG:25832, ETRS89 / UTM zone 32N");
  } else if (grid.x_axis_left) {
    log.error(map.find("crs")->place, "bad-crs",
              map.name_of("crs") + " is east and north, but grid.x_axis is left",
              "leave crs out, or give the grid with x to the east");
  }
  grid.epsg = epsg.value_or(0);
  return grid;
}

}  // namespace tagsmith::detail
