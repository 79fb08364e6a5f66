// SPDX-License-Identifier: Apache-2.0
// The tunnel itself as a camera sees it: walls, floor and roof, without plates.
#pragma once

#include <cstdint>

#include "decoder/simulate/light.hpp"
#include "decoder/simulate/scene.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Brick walls that stand `standoff` metres behind the plates' planes (wall_standoff), a rough floor
// and roof that follow the center line's grade; one ray a pixel, textures softened to the pixel's
// size. Sees 60 m along the tunnel; beyond is darkness.
Backdrop tunnel_backdrop(const Tunnel& tunnel, double standoff, const Camera& camera,
                         const Pose& world_from_camera, const Lighting& lighting,
                         std::uint64_t seed);

}  // namespace tagsmith::detail
