// SPDX-License-Identifier: Apache-2.0
// The camera of mass_picture.hpp: where it sees the plate, and what its sensor makes of a scene.
#pragma once

#include <optional>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/simulate/sensor.hpp"
#include "tests/bench/lots.hpp"
#include "tests/bench/mass_scene.hpp"

namespace tagsmith::detail::mass {

// The frame's inner corners in the picture, for a module of `module_px` in its middle, and the
// picture's size.
struct Placing {
  Quad corners{};
  int width = 0;
  int height = 0;
};

// Seen at `tilt` radians from its normal, turned anyhow.
Placing place(double module_px, double tilt, Random& random);

struct Sensor {
  double exposure = 1;  // of white by light 1
  bool linear = false;  // or with the sRGB tone curve
  double noise = 0;     // grey levels
  PixelPoint motion;    // pixels while exposed
  // What a phone makes of the light; the tone is then its own, and every picture is compressed.
  std::optional<CameraChain> chain{};
};

// A share of the pictures is saved as JPEG and loaded.
struct Compression {
  double share = 0;
  int least_quality = 100;  // 1 to 100; at most 95
};

// Takes the picture of a scene and notes how it was taken.
void take(Picture& picture, const Scene& scene, const Placing& placing, const Sensor& sensor,
          const Compression& compression, Random& random);

}  // namespace tagsmith::detail::mass
