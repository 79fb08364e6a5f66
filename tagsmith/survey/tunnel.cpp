// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/tunnel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/side_line.hpp"

namespace tagsmith::detail {
namespace {

std::string range_text(const ChainageProfile& profile) {
  const std::string least = format_number(profile.least(), 3);
  const std::string greatest = format_number(profile.greatest(), 3);
  return least == greatest ? least : least + " to " + greatest;
}

std::string metres(double value) { return format_number(value, 3) + " m"; }

ChainageProfile widths_of(const Tunnel& tunnel) {
  return sum(tunnel.right, tunnel.left.scaled(-1));
}

}  // namespace

std::string to_string(Side side) { return side == Side::left ? "left" : "right"; }

Tunnel plain_tunnel(double width, double height, Centerline centerline) {
  return {std::move(centerline), -width / 2, width / 2, height, 0};
}

bool is_plain(const Tunnel& tunnel) {
  return tunnel.left.is_constant() && tunnel.right.is_constant() && tunnel.height.is_constant();
}

const ChainageProfile& wall_of(const Tunnel& tunnel, Side side) {
  return side == Side::left ? tunnel.left : tunnel.right;
}

ChainageProfile rock_of(const Tunnel& tunnel, Side side) {
  return wall_of(tunnel, side).scaled(1, side == Side::left ? -tunnel.stand_off : tunnel.stand_off);
}

double wall_distance(const Tunnel& tunnel, Side side, double chainage) {
  const double offset = wall_of(tunnel, side).at(chainage);
  return side == Side::left ? -offset : offset;
}

double width_at(const Tunnel& tunnel, double chainage) {
  return tunnel.right.at(chainage) - tunnel.left.at(chainage);
}

double least_width(const Tunnel& tunnel) { return widths_of(tunnel).least(); }

double greatest_width(const Tunnel& tunnel) { return widths_of(tunnel).greatest(); }

double least_distance(const Tunnel& tunnel) {
  return std::min(tunnel.right.least(), -tunnel.left.greatest());
}

double behind_wall(const Tunnel& tunnel, Side side, const CenterlineAddress& address) {
  const double towards_wall = side == Side::left ? -address.offset : address.offset;
  return towards_wall - wall_distance(tunnel, side, address.chainage);
}

Result<void> check_in_tunnel(const Tunnel& tunnel, const Eigen::Vector3d& position_in_world) {
  const CenterlineAddress address = tunnel.centerline.locate(position_in_world.head<2>());
  const Side side = address.offset < 0 ? Side::left : Side::right;
  if (behind_wall(tunnel, side, address) >= 0) {
    return fail(metres(std::abs(address.offset)) + " " + to_string(side) +
                " of the center line, expected less than the distance of that wall's plates, " +
                metres(wall_distance(tunnel, side, address.chainage)));
  }
  const double above_floor =
      position_in_world.z() - tunnel.centerline.at(address.chainage).position.z();
  const double height = tunnel.height.at(address.chainage);
  if (above_floor <= 0 || above_floor >= height) {
    return fail(metres(above_floor) +
                " above the floor, expected between 0 and the tunnel's height, " + metres(height));
  }
  return {};
}

double wall_heading(const Tunnel& tunnel, Side side, double chainage, double plate_length) {
  return side_heading(tunnel.centerline, wall_of(tunnel, side), chainage, plate_length);
}

std::string width_text(const Tunnel& tunnel) { return range_text(widths_of(tunnel)); }

std::string height_text(const Tunnel& tunnel) { return range_text(tunnel.height); }

}  // namespace tagsmith::detail
