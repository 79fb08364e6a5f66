// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/mass_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tagsmith/symbology/upca.hpp"
#include "tests/bench/mass_symbols.hpp"

namespace tagsmith::detail::mass {
namespace {

void dirty(Scene& scene, Random& random) {
  if (chance(random, 0.3)) {
    const int count = integer(random, 1, 8);
    for (int i = 0; i < count; ++i) {
      scene.dirt.push_back({uniform(random, 0, kFrameWidth), uniform(random, 0, kFrameHeight),
                            log_uniform(random, 1, 14), uniform(random, 0.02, 0.7)});
    }
  }
  if (chance(random, 0.3)) {
    const int count = chance(random, 0.25) ? 2 : 1;
    for (int i = 0; i < count; ++i) {
      const double angle =
          chance(random, 0.3) ? uniform(random, -0.2, 0.2) : uniform(random, 0, std::numbers::pi);
      const double a = std::cos(angle), b = std::sin(angle);
      scene.strips.push_back(
          {a, b, -a * uniform(random, 0, kFrameWidth) - b * uniform(random, 0, kFrameHeight),
           log_uniform(random, 0.5, 8), uniform(random, 0, 0.9)});
    }
  }
  if (chance(random, 0.15)) {
    scene.glare = Glare{uniform(random, 0, kFrameWidth), uniform(random, 0, kFrameHeight),
                        uniform(random, 3, 25), uniform(random, 0.2, 3)};
  }
}

}  // namespace

Scene make_scene(const Picture& picture, Random& random) {
  Scene scene;
  const Widths widths = widths_of(picture.kind, picture.code, random);
  double total = 0;
  for (const double width : widths) total += width;
  double quiet = 9;
  if (chance(random, 0.12)) quiet = uniform(random, 4, 16);
  scene.odd_margins = quiet != 9;
  double module = 1;
  // Other symbols fill the place of ours, or hold our module.
  const bool ours = picture.kind <= Kind::cut;
  if (!ours && total > 0 && chance(random, 0.7)) module = kModuleCount / total;
  module *= (kFrameWidth - 2 * quiet) / kModuleCount;
  double u = quiet + (chance(random, 0.1) ? uniform(random, -1.5, 1.5) : 0);
  scene.odd_margins = scene.odd_margins || u != quiet;
  if (!ours && chance(random, 0.3)) u = (kFrameWidth - total * module) / 2;
  if (picture.kind == Kind::cut && chance(random, 0.5)) u = kFrameWidth - 9 - total * module;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    scene.edges.push_back(u);
    u += widths[i] * module;
  }
  scene.edges.push_back(u);
  if (widths.empty()) scene.edges.clear();
  scene.stroke_growth = picture.growth;
  for (std::size_t i = 0; i < scene.edges.size(); ++i) {
    scene.edges[i] += (i % 2 == 0 ? -0.5 : 0.5) * picture.growth;
  }
  for (std::size_t i = 1; i < scene.edges.size(); ++i) {  // what has grown together
    scene.edges[i] = std::max(scene.edges[i], scene.edges[i - 1]);
  }
  const double contrast = uniform(random, 0.2, 1);
  scene.white = 0.435 + 0.385 * contrast;
  scene.ink = 0.435 - 0.385 * contrast;
  scene.background = uniform(random, 0.02, 0.7);
  if (chance(random, 0.3)) {
    scene.shade_u = uniform(random, -0.6, 0.6);
    scene.shade_v = uniform(random, -0.6, 0.6);
  }
  dirty(scene, random);
  return scene;
}

}  // namespace tagsmith::detail::mass
