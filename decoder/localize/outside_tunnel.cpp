// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/outside_tunnel.hpp"

#include <cmath>

#include <fmt/core.h>

#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {

std::string outside_tunnel(const Tunnel& tunnel, const Eigen::Vector3d& position_in_world) {
  const CenterlineAddress address = tunnel.centerline.locate(position_in_world.head<2>());
  const double above_floor =
      position_in_world.z() - tunnel.centerline.at(address.chainage).position.z();
  if (above_floor < 0) {
    return fmt::format("the solution lies {:.3f} m below the floor", -above_floor);
  }
  const double roof = tunnel.height.at(address.chainage);
  if (above_floor > roof) {
    return fmt::format("the solution lies {:.3f} m above the roof", above_floor - roof);
  }
  const Side side = address.offset < 0 ? Side::left : Side::right;
  const double beyond_wall = behind_wall(tunnel, side, address);
  if (beyond_wall > 0) {
    return fmt::format("the solution lies {:.3f} m behind the {} wall's plates", beyond_wall,
                       to_string(side));
  }
  return {};
}

}  // namespace tagsmith::detail
