// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tagsmith/geometry/angle.hpp"
#include "tests/bench/lots.hpp"
#include "tests/bench/mass_camera.hpp"
#include "tests/bench/mass_picture.hpp"
#include "tests/bench/mass_scene.hpp"
#include "tests/bench/mass_symbols.hpp"

namespace tagsmith::detail::mass {
namespace {

Strip strip_at(double angle, double u, double v, double half_width, double light) {
  const double a = std::cos(angle), b = std::sin(angle);
  return {a, b, -a * u - b * v, half_width, light};
}

double any_place(double length, Random& random) { return uniform(random, 0.1, 0.9) * length; }

Strip hidden_side(Random& random) {
  const double light = uniform(random, 0.02, 0.3);
  const double half = uniform(random, 3, 5);
  const bool ends = chance(random, 0.5);  // left or right, else above or below
  const bool far = chance(random, 0.5);
  const double lean = uniform(random, -0.05, 0.05);
  if (ends) return strip_at(lean, far ? kFrameWidth : 0, kFrameHeight / 2, half, light);
  return strip_at(std::numbers::pi / 2 + lean, kFrameWidth / 2, far ? kFrameHeight : 0, half,
                  light);
}

// A board or a pipe along one of the frame's sides, whose edge is up to two modules within the
// frame's inner edge and nearly as straight.
Strip edge_along_side(Random& random) {
  const double light = uniform(random, 0.02, 0.3);
  const double half = uniform(random, 2, 12);
  const double middle = uniform(random, 0.1, 2) - half;
  const bool ends = chance(random, 0.5), far = chance(random, 0.5);
  const double lean = uniform(random, -0.01, 0.01);
  if (ends) {
    return strip_at(lean, far ? kFrameWidth - middle : middle, kFrameHeight / 2, half, light);
  }
  return strip_at(std::numbers::pi / 2 + lean, kFrameWidth / 2,
                  far ? kFrameHeight - middle : middle, half, light);
}

// One side of a straight edge, or a band.
Shadow shadow_at(double u, double v, Random& random) {
  const double half = chance(random, 0.5) ? 1000 : uniform(random, 2, 20);
  Strip strip = strip_at(uniform(random, 0, 2 * std::numbers::pi), u, v, half,
                         log_uniform(random, 0.05, 0.5));
  if (half > kFrameWidth) strip.c -= half;  // its edge goes through the place
  return {strip, log_uniform(random, 0.1, 3)};
}

void add_trouble(Trouble trouble, Scene& scene, Sensor& sensor, Random& random) {
  const double u = any_place(kFrameWidth, random);
  const double v = any_place(kFrameHeight, random);
  const double ink = uniform(random, 0.02, 0.12);
  switch (trouble) {
    case Trouble::steep_cable:
      scene.strips.push_back(
          strip_at(uniform(random, -0.35, 0.35), u, v, uniform(random, 1.5, 5), ink));
      break;
    case Trouble::diagonal_cable:
      scene.strips.push_back(strip_at(uniform(random, 0.6, 2.5), u, v, uniform(random, 2, 5), ink));
      break;
    case Trouble::pale_cable:
      scene.strips.push_back(strip_at(uniform(random, -1, 1), u, v, uniform(random, 1.5, 5),
                                      scene.white * uniform(random, 0.8, 1.1)));
      break;
    case Trouble::hidden_side:
      scene.strips.push_back(hidden_side(random));
      break;
    case Trouble::edge_along_side:
      scene.strips.push_back(edge_along_side(random));
      break;
    case Trouble::dirt: {
      const int count = integer(random, 3, 10);
      for (int i = 0; i < count; ++i) {
        scene.dirt.push_back({uniform(random, 0, kFrameWidth), uniform(random, 0, kFrameHeight),
                              log_uniform(random, 3, 12), uniform(random, 0.02, 0.6)});
      }
      break;
    }
    case Trouble::glare:
      scene.glare = Glare{u, v, uniform(random, 5, 18), uniform(random, 0.3, 2)};
      break;
    case Trouble::shadow:
      scene.shadows.push_back(shadow_at(u, v, random));
      if (chance(random, 0.3)) {
        scene.shadows.push_back(
            shadow_at(any_place(kFrameWidth, random), any_place(kFrameHeight, random), random));
      }
      break;
    case Trouble::veil: {
      const double dust = uniform(random, 0.3, 0.5), cover = uniform(random, 0.6, 0.9);
      scene.white += cover * (dust - scene.white);
      scene.ink += cover * (dust - scene.ink);
      break;
    }
    case Trouble::dark:
      sensor.exposure = uniform(random, 0.05, 0.15);
      sensor.noise = uniform(random, 10, 20);
      break;
    default:  // a matter of the camera
      break;
  }
}

// The way of the image for motion along or across the bars.
PixelPoint motion_for(Trouble trouble, const Placing& placing, double module_px, Random& random) {
  const bool along = trouble == Trouble::motion_along;
  const PixelPoint side = placing.corners[along ? 3 : 1] - placing.corners[0];
  const double way = along ? uniform(random, 3, 8) : uniform(random, 0.5, 1.2) * module_px;
  return way / length(side) * side;
}

}  // namespace

const char* name_of(Trouble trouble) {
  constexpr std::array<const char*, static_cast<std::size_t>(Trouble::count)> kNames{
      "none",
      "dark cable along the bars",
      "dark cable across the bars",
      "cable of the plate's colour",
      "a side of the frame hidden",
      "dirt",
      "glare",
      "veil of dust",
      "darkness and noise",
      "motion along the bars",
      "motion across the bars",
      "steep view",
      "three of them",
      "shadow",
      "an edge along a side of the frame"};
  return kNames[static_cast<std::size_t>(trouble)];
}

Picture draw_troubled(Trouble trouble, std::uint64_t seed) {
  Random random(seed ^ 0x5bd1e995ULL * (static_cast<std::uint64_t>(trouble) + 1));
  Picture picture;
  picture.kind = chance(random, 0.67) ? Kind::tag : random_kind(random);
  picture.code = random_code_of(picture.kind, random);
  picture.module_px = log_uniform(random, 1.3, 4.0);
  picture.blur_px = log_uniform(random, 0.4, 0.9);
  Sensor sensor;
  sensor.noise = uniform(random, 1, 4);
  sensor.exposure = uniform(random, 0.3, 1);
  Scene scene = make_scene(picture, random);
  scene.dirt.clear();
  scene.strips.clear();
  scene.glare.reset();
  scene.white = uniform(random, 0.7, 0.85);
  scene.ink = uniform(random, 0.03, 0.1);
  std::vector<Trouble> troubles{trouble};
  if (trouble == Trouble::several) {
    troubles.clear();
    while (troubles.size() < 3) {
      troubles.push_back(static_cast<Trouble>(integer(random, 1, 11)));
    }
  }
  const bool steep = std::ranges::count(troubles, Trouble::steep) > 0;
  const Placing placing = place(
      picture.module_px, radians(steep ? uniform(random, 65, 75) : uniform(random, 0, 50)), random);
  for (const Trouble one : troubles) {
    add_trouble(one, scene, sensor, random);
    if (one == Trouble::motion_along || one == Trouble::motion_across) {
      sensor.motion = motion_for(one, placing, picture.module_px, random);
    }
  }
  take(picture, scene, placing, sensor, {0.5, 80}, random);
  return picture;
}

}  // namespace tagsmith::detail::mass
