// SPDX-License-Identifier: Apache-2.0
// The sections `grid` and `tunnel` of a survey file. Internal to tagsmith/survey.
#pragma once

#include <cstddef>
#include <optional>

#include "tagsmith/survey/survey.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith {

// Metres: national grids reach 1e7; of tunnel, radius, spacing; of a coordinate's standard
// deviation.
inline constexpr double kFarthest = 1e8;
inline constexpr double kLongest = 1e5;
inline constexpr double kWorstSigma = 10;
inline constexpr std::size_t kMostElements = 1'000;

// The grid; right-handed when the node is null.
Grid read_grid(const YamlNode* node, FindingLog& log);

// Nothing when it has a fault, which is logged.
std::optional<Tunnel> read_tunnel(const YamlNode* node, const Grid& grid, FindingLog& log);

}  // namespace tagsmith
