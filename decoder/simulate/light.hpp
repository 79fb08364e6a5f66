// SPDX-License-Identifier: Apache-2.0
// Linear light, before a sensor turns it into grey levels.
#pragma once

#include <cstddef>
#include <vector>

namespace tagsmith::detail {

// Samples row by row, in units of the light that a perfectly white surface returns under an
// irradiance of 1.
struct LightImage {
  int width = 0;
  int height = 0;
  std::vector<float> samples;

  LightImage() = default;
  LightImage(int w, int h, float value = 0)
      : width(w),
        height(h),
        samples(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}

  float* row(int y) {
    return samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
  const float* row(int y) const {
    return samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
};

// An even light everywhere and one lamp at the camera.
struct Lighting {
  double ambient = 1;      // irradiance from all around
  double lamp = 0;         // irradiance of the lamp at 1 m, at normal incidence
  double lamp_near = 0.5;  // metres; nearer than this the lamp grows no brighter
};

// Irradiance of a surface at `distance` (metres) from the lamp whose normal makes an angle with
// the direction to the lamp that has this cosine; the back of a surface gets no lamp light.
double irradiance(const Lighting& lighting, double distance, double cosine);

}  // namespace tagsmith::detail
