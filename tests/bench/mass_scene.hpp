// SPDX-License-Identifier: Apache-2.0
// What the pictures of mass_picture.hpp show: a plate, in modules from the frame's upper left inner
// corner, with what lies on it and in front of it. Light from 0 to 1.
#pragma once

#include <optional>
#include <vector>

#include "tests/bench/lots.hpp"
#include "tests/bench/mass_picture.hpp"

namespace tagsmith::detail::mass {

// The plate of Xu et al. (2017), tag-400x300, in modules.
inline constexpr double kFrameWidth = 113;
inline constexpr double kFrameHeight = 55.35;
inline constexpr double kStroke = 3.95;
inline constexpr double kPlateMargin = 9.4;  // beyond the inner edge, left and right
inline constexpr double kPlateMarginAcross = 21.7;
inline constexpr double kBarsMargin = 9;

struct Blotch {
  double u = 0, v = 0, radius = 0, light = 0;
};

// A straight cable or board in front.
struct Strip {
  double a = 0, b = 0, c = 0;  // a u + b v + c = distance from its axis, modules
  double half_width = 0;
  double light = 0;
};

// What a cable or a rock leaves of the light behind it, a share; the lamp is no point, so the edge
// is soft.
struct Shadow : Strip {
  double penumbra = 0;  // standard deviation of its edge, modules
};

struct Glare {
  double u = 0, v = 0, radius = 0, strength = 0;
};

struct Scene {
  bool odd_margins = false;
  std::vector<double> edges;  // of the bars, ascending, even ones begin a bar
  double stroke_growth = 0;   // modules
  double white = 0, ink = 0, background = 0;
  double shade_u = 0, shade_v = 0;
  std::vector<Blotch> dirt;
  std::vector<Strip> strips;
  std::vector<Shadow> shadows;
  std::optional<Glare> glare;
};

// A plate with the picture's symbol, in every way at once as it may be.
Scene make_scene(const Picture& picture, Random& random);

}  // namespace tagsmith::detail::mass
