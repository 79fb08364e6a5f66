// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_tunnel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/limits.hpp"
#include "tagsmith/survey/passes_over.hpp"

namespace tagsmith::detail {

// ---- Walls and roof.

namespace {

const char* kWallHint = "a list of [chainage, distance]: [[0, 1.9], [12.5, 2.1]]";
const char* kSectionHint = "{ at: CHAINAGE, width: W, height: H }";

NumberRange chainage_range() { return between(-kLongest, kLongest * kMostElements, "m"); }

// Stations of a profile that is being read; `complete` = none of them had a fault.
struct Stations {
  std::vector<ProfileStation> list;
  bool complete = true;

  std::optional<ChainageProfile> profile() const {
    if (!complete || list.empty()) return std::nullopt;
    return ChainageProfile(list);
  }
};

// Adds the station unless it stands before the last one or is a third at its chainage.
void add_station(Stations& stations, const ProfileStation& station, Place place,
                 const std::string& name, FindingLog& log) {
  const std::size_t count = stations.list.size();
  const bool falls = count > 0 && station.chainage < stations.list.back().chainage;
  const bool third = count > 1 && station.chainage == stations.list[count - 2].chainage;
  if (!falls && !third) {
    stations.list.push_back(station);
    return;
  }
  stations.complete = false;
  log.error(place, "bad-station",
            name + " is at chainage " + format_number(station.chainage) + " m, " +
                (falls ? "the one before it at " + format_number(stations.list.back().chainage) +
                             " m, expected them along the drive"
                       : "the third there, expected one, or two for a step"),
            "a step is two stations at one chainage: before it, beyond it");
}

bool has_fair_length(const std::vector<YamlNode>& list, Place place, const std::string& name,
                     FindingLog& log) {
  if (!list.empty() && list.size() <= kMostStations) return true;
  log.error(place, "wrong-length",
            name + " has " + std::to_string(list.size()) + " stations, expected 1 to " +
                std::to_string(kMostStations));
  return false;
}

// --- sections ---

struct Sections {
  Stations widths;
  Stations heights;
};

void read_section(const YamlNode& node, const std::string& name, Sections& sections,
                  FindingLog& log) {
  const MapReader map(&node, name, {"at", "width", "height"}, log);
  if (!map.is_map()) {
    sections.widths.complete = sections.heights.complete = false;
    return;
  }
  const auto at = map.number("at", chainage_range(), kSectionHint);
  if (!map.has("width") && !map.has("height")) {
    log.error(map.place(), "missing-key",
              name + " has neither `width` nor `height`, expected one of them or both",
              kSectionHint);
  }
  for (const auto& [key, stations] :
       {std::pair("width", &sections.widths), std::pair("height", &sections.heights)}) {
    const YamlNode* value_node = map.find(key);
    if (value_node == nullptr) continue;
    const auto value =
        read_number(value_node, map.name_of(key), above_zero(kLargestRoom, "m"), log);
    if (at && value) {
      add_station(*stations, {*at, *value}, map.find("at")->place, map.name_of(key), log);
    } else {
      stations->complete = false;
    }
  }
}

Sections read_sections(const MapReader& tunnel) {
  Sections sections;
  const YamlNode* node = tunnel.find("sections");
  if (node == nullptr) return sections;
  FindingLog& log = tunnel.log();
  const std::string name = tunnel.name_of("sections");
  const std::vector<YamlNode>* list = read_list(node, name, log);
  if (list == nullptr || !has_fair_length(*list, node->place, name, log)) {
    sections.widths.complete = sections.heights.complete = false;
    return sections;
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    read_section((*list)[i], name + "[" + std::to_string(i) + "]", sections, log);
  }
  return sections;
}

// The values of the map's own key or of the sections, one of which must have them.
std::optional<ChainageProfile> read_everywhere(const MapReader& tunnel, const char* key,
                                               const Stations& sections) {
  FindingLog& log = tunnel.log();
  const bool in_sections = !sections.list.empty() || !sections.complete;
  if (tunnel.has(key) && in_sections) {
    log.error(tunnel.find(key)->place, "conflicting-keys",
              "`" + tunnel.name_of(key) + "` beside `sections` that say it, expected one of them",
              "the section at the lowest chainage holds before it, that at the highest beyond it");
    return std::nullopt;
  }
  if (in_sections) return sections.profile();
  const auto value = tunnel.number(key, above_zero(kLargestRoom, "m"),
                                   std::string("also in `sections`: ") + kSectionHint);
  if (!value) return std::nullopt;
  return ChainageProfile(*value);
}

// --- walls ---

// Distances from the center line to the rock, minus the stand-off: to the plates' plane.
std::optional<ChainageProfile> read_wall(const MapReader& walls, const char* side,
                                         double stand_off) {
  FindingLog& log = walls.log();
  const std::string name = walls.name_of(side);
  const YamlNode* node = walls.find(side);
  const std::vector<YamlNode>* list = read_list(node, name, log);
  if (list == nullptr || !has_fair_length(*list, node->place, name, log)) return std::nullopt;
  Stations stations;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const YamlNode& item = (*list)[i];
    const std::string item_name = name + "[" + std::to_string(i) + "]";
    const std::vector<YamlNode>* pair = read_list(&item, item_name, log);
    if (pair != nullptr && pair->size() != 2) {
      log.error(item.place, "wrong-length",
                item_name + " has " + std::to_string(pair->size()) +
                    " numbers, expected two: chainage and distance",
                kWallHint);
    }
    const bool is_pair = pair != nullptr && pair->size() == 2;
    const auto chainage =
        is_pair ? read_number(&(*pair)[0], item_name + "[0]", chainage_range(), log) : std::nullopt;
    NumberRange room = between(stand_off, kLargestRoom, "m");
    room.low_excluded = true;  // in front of the rock there must be space for the plates
    const auto distance =
        is_pair ? read_number(&(*pair)[1], item_name + "[1]", room, log) : std::nullopt;
    if (chainage && distance) {
      add_station(stations, {*chainage, *distance - stand_off}, item.place, item_name, log);
    } else {
      stations.complete = false;
    }
  }
  return stations.profile();
}

}  // namespace

Room read_room(const MapReader& tunnel) {
  Room room;
  room.stand_off = tunnel.number_or("stand_off", 0, between(0, kLargestStandOff, "m"));
  const Sections sections = read_sections(tunnel);
  room.height = read_everywhere(tunnel, "height", sections.heights);

  const MapReader walls(tunnel.find("walls"), tunnel.name_of("walls"), {"left", "right"},
                        tunnel.log());
  const bool both = walls.has("left") && walls.has("right");
  if (both && (tunnel.has("width") || !sections.widths.list.empty())) {
    tunnel.log().error(walls.place(), "conflicting-keys",
                       "`" + walls.name() + "` has both walls, and the width is given besides",
                       "keep the width without walls, or the walls without width");
  }
  std::optional<ChainageProfile> width;
  if (!both && tunnel.is_map()) width = read_everywhere(tunnel, "width", sections.widths);
  if (walls.has("left")) {
    const auto wall = read_wall(walls, "left", room.stand_off);
    if (wall) room.left = wall->scaled(-1);
  } else if (width) {
    room.left = width->scaled(-0.5);
  }
  if (walls.has("right")) {
    room.right = read_wall(walls, "right", room.stand_off);
  } else if (width) {
    room.right = width->scaled(0.5);
  }
  return room;
}

// ---- Grid and tunnel.

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

// From the center line to the wall that faces the point; 0 where the point lies farther ahead or
// behind than `beside`.
double distance_towards(const Tunnel& tunnel, double chainage, const Eigen::Vector3d& point,
                        double beside) {
  const CenterlinePoint at = tunnel.centerline.at(chainage);
  const Eigen::Vector3d apart = point - at.position;
  if (std::abs(direction_of(at.heading).dot(apart)) > beside) return 0;
  const bool is_right = right_of(at.heading).dot(apart) > 0;
  return wall_distance(tunnel, is_right ? Side::right : Side::left, chainage);
}

// Places are found by their plan (Centerline::locate). False, and logged, where it has two of one.
bool check_passing(const Tunnel& tunnel, Place place, FindingLog& log) {
  constexpr double kMostSteps = 1e5;
  const Centerline& line = tunnel.centerline;
  const double apart = std::max(least_width(tunnel) / 2, line.length() / kMostSteps);
  const double step = apart / 2;
  std::vector<Eigen::Vector3d> way;
  const auto steps = static_cast<int>(line.length() / step);
  for (int i = 0; i <= steps; ++i) way.push_back(line.at(i * step).position);
  const auto reach_between = [&](std::size_t earlier, std::size_t later) {
    return distance_towards(tunnel, static_cast<double>(earlier) * step, way[later], apart) +
           distance_towards(tunnel, static_cast<double>(later) * step, way[earlier], apart);
  };
  const std::optional<Passing> passing =
      passing_of(way, apart, tunnel.height.greatest(), 2 * greatest_width(tunnel), reach_between);
  if (!passing) return true;
  const double later = static_cast<double>(passing->later) * step;
  log.error(
      place, "passes-over",
      fmt::format("the drive passes {} itself: at chainage {:.1f} m it lies {:.1f} m {} where "
                  "it is at chainage {:.1f} m",
                  passing->above > 0 ? "over" : "under", later, std::abs(passing->above),
                  passing->above > 0 ? "above" : "below",
                  static_cast<double>(passing->earlier) * step),
      fmt::format("a survey for each turn: end this one before chainage {:.0f} m and begin "
                  "another there",
                  std::floor(later)));
  return false;
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
  const Tunnel tunnel{*centerline, *room.left, *room.right, *room.height, room.stand_off};
  if (!check_passing(tunnel, map.find("centerline")->place, log)) return std::nullopt;
  return tunnel;
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
