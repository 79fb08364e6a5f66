// SPDX-License-Identifier: Apache-2.0
// The sections `grid` and `tunnel` of a survey file. Internal to tagsmith/survey.
#pragma once

#include <optional>

#include "tagsmith/survey/survey.hpp"
#include "tagsmith/survey/tunnel_limits.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {

// The grid; right-handed when the node is null.
Grid read_grid(const YamlNode* node, FindingLog& log);

// Nothing when it has a fault, which is logged.
std::optional<Tunnel> read_tunnel(const YamlNode* node, const Grid& grid, FindingLog& log);

}  // namespace tagsmith::detail
