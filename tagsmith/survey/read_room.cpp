// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_room.hpp"

#include <string>
#include <utility>
#include <vector>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/tunnel_limits.hpp"

namespace tagsmith::detail {
namespace {

const char* kWallHint = "a list of [chainage, distance]: [[0, 1.9], [12.5, 2.1]]";
const char* kSectionHint = "{ at: CHAINAGE, width: W, height: H }";

NumberRange chainage_range() { return between(-kLongest, kLongest * kMostElements, "m"); }

// Stations of a profile under way; `complete` = none of them had a fault.
struct Stations {
  std::vector<ProfileStation> list;
  bool complete = true;

  std::optional<ChainageProfile> profile() const {
    if (!complete || list.empty()) return std::nullopt;
    return ChainageProfile(list);
  }
};

// Takes the station in unless it stands before the last one or makes a third at its chainage.
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

// The values of the map's own key or of the sections, one of which must say them.
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

// Distances from the center line to the rock, less the stand-off: to the plates' plane.
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
    room.low_excluded = true;  // in front of the rock there must be room for the plates
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

}  // namespace tagsmith::detail
