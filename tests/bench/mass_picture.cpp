// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/mass_picture.hpp"

#include <array>
#include <optional>

#include "tagsmith/geometry/angle.hpp"
#include "tests/bench/drawn_chain.hpp"
#include "tests/bench/lots.hpp"
#include "tests/bench/mass_camera.hpp"
#include "tests/bench/mass_scene.hpp"
#include "tests/bench/mass_symbols.hpp"

namespace tagsmith::detail::mass {

namespace {

// Of any kind, or of one.
Picture draw_through(const std::optional<CameraChain>& chain, std::uint64_t seed,
                     std::optional<Kind> kind = {}) {
  Random random(seed);
  Picture picture;
  picture.kind = random_kind(random);
  if (kind) picture.kind = *kind;
  picture.code = random_code_of(picture.kind, random);
  picture.module_px =
      chance(random, 0.85) ? log_uniform(random, 0.3, 1.3) : log_uniform(random, 1.3, 3.0);
  picture.blur_px = log_uniform(random, 0.25, 2.0);
  if (picture.blur_px > 1.5 * picture.module_px && chance(random, 0.7)) picture.blur_px /= 2;
  picture.growth = chance(random, 0.4) ? uniform(random, -0.8, 0.8) : 0;
  Sensor sensor;
  sensor.chain = chain;
  sensor.noise = chance(random, 0.3) ? uniform(random, 4, 30) : uniform(random, 0.5, 4);
  sensor.exposure = uniform(random, 0.1, 1.3);
  sensor.linear = chance(random, 0.25);
  if (chance(random, 0.2)) sensor.motion = {uniform(random, -4, 4), uniform(random, -4, 4)};
  const Scene scene = make_scene(picture, random);
  const double tilt =
      radians(chance(random, 0.7) ? uniform(random, 0, 45) : uniform(random, 45, 72));
  const Placing placing = place(picture.module_px, tilt, random);
  take(picture, scene, placing, sensor, {0.15, 60}, random);
  return picture;
}

}  // namespace

Picture draw(std::uint64_t seed) { return draw_through({}, seed); }

Picture draw_misprinted(std::uint64_t seed) { return draw_through({}, seed, Kind::misshapen); }

Picture draw_chained(std::uint64_t seed) {
  Random random(seed ^ 0x2545f4914f6cdd1dULL);
  const char* name = std::array{"mild", "strong", "night"}[random() % 3];
  return draw_through(bench::drawn_chain(name, random), seed);
}

}  // namespace tagsmith::detail::mass
