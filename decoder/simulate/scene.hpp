// SPDX-License-Identifier: Apache-2.0
// The scene in front of a simulated camera.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "decoder/simulate/light.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// Blotches of dust or mud.
struct Dirt {
  double amount = 0;          // roughly the share of the plate that is covered, 0 to 1
  double blotch_size = 0.03;  // metres
  double reflectance = 0.25;
  std::uint64_t seed = 0;
};

// Something opaque in front of the plate.
struct Cover {
  Rectangle area;  // plate frame; may stick out over the plate's edge
  double reflectance = 0.15;
};

// A highlight that adds `strength` times the light of a white surface at its centre.
struct Glare {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // plate frame, metres
  double radius = 0.05;                              // of a Gaussian, metres
  double strength = 1;
};

// A plate's surface. The defaults are a clean matt print.
struct PlateFinish {
  double white_reflectance = 0.82;
  double ink_reflectance = 0.05;
  // Ink spread: every black edge moves outwards by half of this; within (-1, 1) modules.
  double bar_growth = 0;
  // Relative change of the light from one edge of the plate to the other, rightwards and downwards.
  Eigen::Vector2d shading = Eigen::Vector2d::Zero();
  Dirt dirt;
  std::optional<Cover> cover;
  std::optional<Glare> glare;
};

struct ScenePlate {
  TagDrawing drawing;
  Pose camera_from_plate;
  PlateFinish finish;
};

// The scene behind the plates, as seen by the same camera: its light, and its depth (z in the
// camera frame, metres), which hides the plates behind it.
struct Backdrop {
  LightImage light;
  LightImage depth;
};

}  // namespace tagsmith::detail
