// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_direction.hpp"

#include <cmath>

#include "decoder/image/bilinear.hpp"

namespace tagsmith {
namespace {

// Mean step along u where `at(u, v)` is the image's place.
template <class At>
double mean_step(const GrayView& image, const At& at) {
  constexpr int kPlaces = 80;
  constexpr int kRows = 6;
  double before = 0;
  double sum = 0;
  for (int place = 0; place < kPlaces; ++place) {
    const double u = 0.12 + 0.76 * place / (kPlaces - 1);  // inside the quiet zones
    double value = 0;
    for (int row = 0; row < kRows; ++row) {
      const double v = 0.27 + 0.46 * row / (kRows - 1);
      value += sample_bilinear(image, at(u, v)) / kRows;
    }
    if (place > 0) sum += std::abs(value - before);
    before = value;
  }
  return sum / (kPlaces - 1);
}

}  // namespace

BarSteps bar_steps(const GrayView& image, const Quad& quad) {
  const Homography map = homography_to(quad);
  return {mean_step(image, [&](double u, double v) { return map(u, v); }),
          mean_step(image, [&](double u, double v) { return map(v, u); })};
}

}  // namespace tagsmith
