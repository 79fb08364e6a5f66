// SPDX-License-Identifier: Apache-2.0
// The space of a drive: its center line and what stands beside and above it.
#pragma once

#include <string>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/chainage_profile.hpp"

namespace tagsmith::detail {

enum class Side { left, right };  // of the drive

std::string to_string(Side side);

// World frame, metres. For walls use the functions below: only they know how `left`, `right` and
// `stand_off` are combined.
struct Tunnel {
  Centerline centerline;
  // Offsets of the plates' planes from the center line, positive to the right of the drive: `left`
  // is negative everywhere, `right` positive.
  ChainageProfile left;
  ChainageProfile right;
  ChainageProfile height;  // of the roof above the floor
  double stand_off = 0;    // from the plates' planes back to the rock
};

// One width between the plates' planes (W_T), the center line in the middle, and one height.
Tunnel plain_tunnel(double width, double height, Centerline centerline);

// True when walls and roof run at one distance from the center line.
bool is_plain(const Tunnel& tunnel);

// Offset of the plates' plane of a wall, negative on the left.
const ChainageProfile& wall_of(const Tunnel& tunnel, Side side);

// The same from the center line to the rock behind the plates.
ChainageProfile rock_of(const Tunnel& tunnel, Side side);

// Distance from the center line to the plates' plane, positive on either side.
double wall_distance(const Tunnel& tunnel, Side side, double chainage);

// W_T, between the planes of the left and the right plates.
double width_at(const Tunnel& tunnel, double chainage);
double least_width(const Tunnel& tunnel);
double greatest_width(const Tunnel& tunnel);

// For the wall that comes nearest to the center line.
double least_distance(const Tunnel& tunnel);

// How far a point lies behind the plates' plane of a wall, at the point's chainage; negative inside
// the tunnel.
double behind_wall(const Tunnel& tunnel, Side side, const CenterlineAddress& address);

// Fails, saying where the point lies, when it is not between the plates' planes, floor and roof.
Result<void> check_in_tunnel(const Tunnel& tunnel, const Eigen::Vector3d& position_in_world);

// Direction of a wall along the drive where a plate of this length hangs, radians from +y to +x.
double wall_heading(const Tunnel& tunnel, Side side, double chainage, double plate_length);

// "1.9", or "3.8 to 4.2" where it changes.
std::string width_text(const Tunnel& tunnel);
std::string height_text(const Tunnel& tunnel);

}  // namespace tagsmith::detail
