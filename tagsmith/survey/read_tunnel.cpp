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
namespace {

// ---- Walls and roof.

// Metres: of the plates from the rock.
constexpr double kLargestStandOff = 1;
// Of the sections together, and of each wall.
constexpr std::size_t kMostStations = 100'000;

// Walls and roof along the center line; one that has a fault (logged) or depends on one is absent.
struct Room {
  std::optional<ChainageProfile> left;  // as Tunnel's
  std::optional<ChainageProfile> right;
  std::optional<ChainageProfile> height;
  double stand_off = 0;
};

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

// Adds the station unless it stands before the last one or is a third at its chainage. `value`
// states it.
void add_station(Stations& stations, const ProfileStation& station, const YamlValue& value,
                 const std::string& name) {
  const std::size_t count = stations.list.size();
  const bool falls = count > 0 && station.chainage < stations.list.back().chainage;
  const bool third = count > 1 && station.chainage == stations.list[count - 2].chainage;
  if (!falls && !third) {
    stations.list.push_back(station);
    return;
  }
  stations.complete = false;
  value.error("bad-station",
              name + " is at chainage " + format_number(station.chainage) + " m, " +
                  (falls ? "the one before it at " + format_number(stations.list.back().chainage) +
                               " m, expected them along the drive"
                         : "the third there, expected one, or two for a step"),
              "a step is two stations at one chainage: before it, beyond it");
}

// The items of a list that has one at least and not more than `most`; `noun`: what they are.
std::optional<std::vector<YamlValue>> read_some(const YamlValue& value, std::size_t most,
                                                const std::string& noun) {
  auto list = read_list(value);
  if (!list || (!list->empty() && list->size() <= most)) return list;
  return value.error("wrong-length", fmt::format("{} has {} {}, expected 1 to {}", value.name,
                                                 list->size(), noun, most));
}

// --- sections ---

struct Sections {
  Stations widths;
  Stations heights;
};

void read_section(const YamlValue& section, Sections& sections) {
  const MapReader map(section, {"at", "width", "height"});
  if (!map.is_map()) {
    sections.widths.complete = sections.heights.complete = false;
    return;
  }
  const auto at = map.number("at", chainage_range(), kSectionHint);
  if (!map.has("width") && !map.has("height")) {
    section.error("missing-key",
                  section.name + " has neither `width` nor `height`, expected one of them or both",
                  kSectionHint);
  }
  for (const auto& [key, stations] :
       {std::pair("width", &sections.widths), std::pair("height", &sections.heights)}) {
    if (!map.has(key)) continue;
    const auto value = map.number_if_there(key, above_zero(kLargestRoom, "m"));
    if (at && value) {
      add_station(*stations, {*at, *value}, map.at("at"), map.at(key).name);
    } else {
      stations->complete = false;
    }
  }
}

Sections read_sections(const MapReader& tunnel) {
  Sections sections;
  if (!tunnel.has("sections")) return sections;
  const auto list = read_some(tunnel.at("sections"), kMostStations, "stations");
  if (!list) sections.widths.complete = sections.heights.complete = false;
  for (const YamlValue& section : list.value_or(std::vector<YamlValue>{})) {
    read_section(section, sections);
  }
  return sections;
}

// The values of the map's own key or of the sections, one of which must have them.
std::optional<ChainageProfile> read_everywhere(const MapReader& tunnel, const char* key,
                                               const Stations& sections) {
  const bool in_sections = !sections.list.empty() || !sections.complete;
  if (tunnel.has(key) && in_sections) {
    const YamlValue value = tunnel.at(key);
    return value.error(
        "conflicting-keys",
        "`" + value.name + "` beside `sections` that say it, expected one of them",
        "the section at the lowest chainage holds before it, that at the highest beyond it");
  }
  if (in_sections) return sections.profile();
  const auto value = tunnel.number(key, above_zero(kLargestRoom, "m"),
                                   std::string("also in `sections`: ") + kSectionHint);
  if (!value) return std::nullopt;
  return ChainageProfile(*value);
}

// --- walls ---

// Distances from the center line to the rock, minus the stand-off: to the plates' plane.
std::optional<ChainageProfile> read_wall(const YamlValue& wall, double stand_off) {
  const auto list = read_some(wall, kMostStations, "stations");
  if (!list) return std::nullopt;
  NumberRange room = between(stand_off, kLargestRoom, "m");
  room.low_excluded = true;  // in front of the rock there must be space for the plates
  Stations stations;
  for (const YamlValue& item : *list) {
    const auto pair = read_list(item);
    const bool is_pair = pair && pair->size() == 2;
    if (pair && !is_pair) {
      item.error("wrong-length",
                 item.name + " has " + std::to_string(pair->size()) +
                     " numbers, expected two: chainage and distance",
                 kWallHint);
    }
    const auto chainage = is_pair ? read_number((*pair)[0], chainage_range()) : std::nullopt;
    const auto distance = is_pair ? read_number((*pair)[1], room) : std::nullopt;
    if (chainage && distance) {
      add_station(stations, {*chainage, *distance - stand_off}, item, item.name);
    } else {
      stations.complete = false;
    }
  }
  return stations.profile();
}

// From the keys width, height, sections, walls and stand_off of the map.
Room read_room(const MapReader& tunnel) {
  Room room;
  room.stand_off = tunnel.number_or("stand_off", 0, between(0, kLargestStandOff, "m"));
  const Sections sections = read_sections(tunnel);
  room.height = read_everywhere(tunnel, "height", sections.heights);

  const MapReader walls(tunnel.at("walls"), {"left", "right"});
  const bool both = walls.has("left") && walls.has("right");
  if (both && (tunnel.has("width") || !sections.widths.list.empty())) {
    walls.value().error(
        "conflicting-keys",
        "`" + walls.value().name + "` has both walls, and the width is given besides",
        "keep the width without walls, or the walls without width");
  }
  std::optional<ChainageProfile> width;
  if (!both && tunnel.is_map()) width = read_everywhere(tunnel, "width", sections.widths);
  if (walls.has("left")) {
    const auto wall = read_wall(walls.at("left"), room.stand_off);
    if (wall) room.left = wall->scaled(-1);
  } else if (width) {
    room.left = width->scaled(-0.5);
  }
  if (walls.has("right")) {
    room.right = read_wall(walls.at("right"), room.stand_off);
  } else if (width) {
    room.right = width->scaled(0.5);
  }
  return room;
}

// ---- Center line.

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
  map.at(key).error("tight-arc",
                    map.at(key).name + " has a radius of " + format_number(radius) +
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
    map.value().error("bad-element",
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
  const std::pair<const char*, std::vector<std::string>> owners[] = {{"turn", {"arc", "clothoid"}},
                                                                     {"angle", {"arc"}},
                                                                     {"from_radius", {"clothoid"}},
                                                                     {"to_radius", {"clothoid"}}};
  for (const auto& [key, kinds] : owners) {
    if (!map.has(key) || std::ranges::count(kinds, kind) > 0) continue;
    const YamlValue value = map.at(key);
    value.error("conflicting-keys",
                "`" + value.name + "` beside `" + kind + "`, expected it with " + either_of(kinds) +
                    " only",
                kElementHint);
  }
}

// One, or the arcs of a clothoid; none where it is faulty. `number`: from 1.
std::vector<CenterlineElement> read_element(const YamlValue& element, double start, int number,
                                            const Room& room) {
  const MapReader map(
      element, {"line", "arc", "clothoid", "turn", "angle", "from_radius", "to_radius", "grade"});
  if (!map.is_map()) return {};
  const double grade = map.number_or("grade", 0, between(-100, 100, "percent")) / 100;
  std::vector<std::string> kinds;
  for (const char* kind : {"line", "arc", "clothoid"}) {
    if (map.has(kind)) kinds.emplace_back(kind);
  }
  if (kinds.size() != 1) {
    element.error("bad-element",
                  element.name + " has " + (kinds.empty() ? "none" : "several") +
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
  for (CenterlineElement& each : elements) each.grade = grade;
  return elements;
}

// Nothing where one is faulty.
std::optional<std::vector<CenterlineElement>> read_elements(const MapReader& centerline,
                                                            const Room& room) {
  const auto list = read_some(centerline.need("elements", "elements: [ { line: 10.0 } ]"),
                              kMostElements, "elements");
  if (!list) return std::nullopt;
  std::vector<CenterlineElement> all;
  bool complete = true;
  double start = 0;
  int number = 0;
  for (const YamlValue& value : *list) {
    const auto elements = read_element(value, start, ++number, room);
    complete = complete && !elements.empty();
    for (const CenterlineElement& element : elements) start += element.length;
    all.insert(all.end(), elements.begin(), elements.end());
  }
  return complete ? std::optional(all) : std::nullopt;
}

std::optional<Centerline> read_centerline(const YamlValue& centerline, const Grid& grid,
                                          const Room& room) {
  const MapReader map(centerline, {"start", "heading", "elements"});
  const auto start = read_point(map.need("start", "start: [x, y, z] on the floor"), kFarthest);
  const auto heading =
      map.number("heading", between(-360, 360, "degrees"), "heading: degrees from +y towards +x");
  const auto elements = read_elements(map, room);
  if (!start || !heading || !elements) return std::nullopt;
  return Centerline(world_from_grid(grid, *start), world_heading_from_grid(grid, radians(*heading)),
                    *elements);
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
bool check_passing(const Tunnel& tunnel, const YamlValue& centerline) {
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
  centerline.error(
      "passes-over",
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

std::optional<Tunnel> read_tunnel(const YamlValue& value, const Grid& grid) {
  const MapReader map(value, {"width", "height", "sections", "walls", "stand_off", "centerline"});
  const Room room = read_room(map);
  const YamlValue line = map.need(
      "centerline", "centerline: { start: [0, 0, 0], heading: 0, elements: [ { line: 10.0 } ] }");
  const auto centerline = read_centerline(line, grid, room);
  if (!room.left || !room.right || !room.height || !centerline) return std::nullopt;
  const Tunnel tunnel{*centerline, *room.left, *room.right, *room.height, room.stand_off};
  if (!check_passing(tunnel, line)) return std::nullopt;
  return tunnel;
}

Grid read_grid(const YamlValue& value) {
  const MapReader map(value, {"x_axis", "crs"});
  Grid grid{map.choice("x_axis", {"right", "left"}) == "left"};
  const YamlValue crs = map.at("crs");
  const auto text = read_text(crs);
  if (!text) return grid;
  const std::optional<int> epsg = parse_crs(*text);
  if (!epsg) {
    crs.error("bad-crs",
              crs.name + " is `" + *text +
                  "`, expected a grid in metres by its number in the EPSG register",
              "for example crs: EPSG:25832, ETRS89 / UTM zone 32N");
  } else if (grid.x_axis_left) {
    crs.error("bad-crs", crs.name + " is east and north, but grid.x_axis is left",
              "leave crs out, or give the grid with x to the east");
  }
  grid.epsg = epsg.value_or(0);
  return grid;
}

}  // namespace tagsmith::detail
