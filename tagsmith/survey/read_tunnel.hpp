// SPDX-License-Identifier: Apache-2.0
// The sections `grid` and `tunnel` of a survey file. Internal to tagsmith/survey.
#pragma once

#include <cstddef>
#include <optional>

#include "tagsmith/survey/survey.hpp"
#include "tagsmith/survey/tunnel.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {

// Metres: of width, height and a wall's distance.
inline constexpr double kLargestRoom = 1e3;

// The grid; right-handed when it is absent.
Grid read_grid(const YamlValue& value);

// Nothing when it has a fault, which is logged.
std::optional<Tunnel> read_tunnel(const YamlValue& value, const Grid& grid);

}  // namespace tagsmith::detail
