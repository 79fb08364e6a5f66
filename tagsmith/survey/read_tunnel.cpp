// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_tunnel.hpp"

#include <string>
#include <vector>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_room.hpp"

namespace tagsmith::detail {
namespace {

struct Elements {
  std::vector<CenterlineElement> elements;
  bool complete = true;  // false: some were faulty
};

const char* kElementHint = "{ line: LENGTH } or { arc: RADIUS, turn: left|right, angle: DEGREES }";

std::optional<CenterlineElement> read_line(const MapReader& map) {
  const auto length = map.number("line", above_zero(kLongest, "m"));
  if (!length) return std::nullopt;
  return CenterlineElement{*length, 0, 0};
}

// False, with a finding, when the wall on the inner side of the arc has no radius left.
bool leaves_room(const MapReader& map, double radius, bool turns_right, double start, double length,
                 const Room& room) {
  const std::optional<ChainageProfile>& inner = turns_right ? room.right : room.left;
  if (!inner) return true;
  const double inner_wall =
      turns_right ? inner->greatest(start, start + length) : -inner->least(start, start + length);
  if (radius > inner_wall) return true;
  map.log().error(map.find("arc")->place, "tight-arc",
                  map.name_of("arc") + " has a radius of " + format_number(radius) +
                      " m, expected more than the distance of its inner wall, " +
                      format_number(inner_wall) + " m",
                  "the radius is that of the center line");
  return false;
}

// `start`: chainage at which it begins.
std::optional<CenterlineElement> read_arc(const MapReader& map, double start, const Room& room) {
  const auto radius = map.number("arc", above_zero(kLongest, "m"));
  const auto turn = map.choice("turn", {"left", "right"}, "turn: left or turn: right");
  const auto angle = map.number("angle", above_zero(360, "degrees"));
  if (!radius || !turn || !angle) return std::nullopt;
  const bool turns_right = *turn == "right";
  const double length = *radius * radians(*angle);
  if (!leaves_room(map, *radius, turns_right, start, length, room)) return std::nullopt;
  return CenterlineElement{length, (turns_right ? 1.0 : -1.0) / *radius, 0};
}

std::optional<CenterlineElement> read_element(const YamlNode& node, const std::string& name,
                                              double start, const Room& room, FindingLog& log) {
  const MapReader map(&node, name, {"line", "arc", "turn", "angle", "grade"}, log);
  if (!map.is_map()) return std::nullopt;
  const double grade = map.number_or("grade", 0, between(-100, 100, "percent")) / 100;
  std::optional<CenterlineElement> element;
  if (map.has("arc") == map.has("line")) {
    log.error(map.place(), "bad-element",
              name + " has " + (map.has("arc") ? "both" : "neither") +
                  " `line` and `arc`, expected one of them",
              kElementHint);
  } else if (map.has("arc")) {
    element = read_arc(map, start, room);
  } else {
    for (const char* key : {"turn", "angle"}) {
      if (!map.has(key)) continue;
      log.error(map.find(key)->place, "conflicting-keys",
                "`" + map.name_of(key) + "` of a line, expected it with `arc` only", kElementHint);
    }
    element = read_line(map);
  }
  if (element) element->grade = grade;
  return element;
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
    const auto element =
        read_element((*list)[i], name + "[" + std::to_string(i) + "]", start, room, log);
    result.complete = result.complete && element.has_value();
    if (!element) continue;
    start += element->length;
    result.elements.push_back(*element);
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
