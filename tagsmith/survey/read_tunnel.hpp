// SPDX-License-Identifier: Apache-2.0
// The sections `grid` and `tunnel` of a survey file. Internal to tagsmith/survey.
#pragma once

#include <cstddef>
#include <optional>

#include "tagsmith/survey/survey.hpp"
#include "tagsmith/survey/tunnel.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {

// ---- The keys of the section `tunnel` that say where walls and roof are. Internal to
// tagsmith/survey.

// Metres: of width, height and a wall's distance; of the plates from the rock.
inline constexpr double kLargestRoom = 1e3;
inline constexpr double kLargestStandOff = 1;
// Of the sections together, and of each wall.
inline constexpr std::size_t kMostStations = 100'000;

// Walls and roof along the center line; one that has a fault (logged) or depends on one is absent.
struct Room {
  std::optional<ChainageProfile> left;  // as Tunnel's
  std::optional<ChainageProfile> right;
  std::optional<ChainageProfile> height;
  double stand_off = 0;
};

// From the keys width, height, sections, walls and stand_off of the map.
Room read_room(const MapReader& tunnel);

// ---- Grid and tunnel.

// The grid; right-handed when the node is null.
Grid read_grid(const YamlNode* node, FindingLog& log);

// Nothing when it has a fault, which is logged.
std::optional<Tunnel> read_tunnel(const YamlNode* node, const Grid& grid, FindingLog& log);

}  // namespace tagsmith::detail
