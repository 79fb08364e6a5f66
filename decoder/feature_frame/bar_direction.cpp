// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_direction.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace tagsmith::detail {
namespace {

constexpr std::size_t kProfilePlaces = 80;
constexpr std::size_t kRows = 6;

// Places in the quadrilateral's unit square, inside the quiet zones, that are averaged along v.
struct Places {
  std::array<double, kProfilePlaces> u{};
  std::array<double, kRows> v{};
};

constexpr Places places() {
  Places places;
  for (std::size_t i = 0; i < kProfilePlaces; ++i) {
    places.u[i] = 0.12 + 0.76 * static_cast<double>(i) / (kProfilePlaces - 1);
  }
  for (std::size_t i = 0; i < kRows; ++i) {
    places.v[i] = 0.27 + 0.46 * static_cast<double>(i) / (kRows - 1);
  }
  return places;
}

// Mean step along u where `at(u, v)` is the image's place.
template <class At>
double mean_step(const GrayView& image, const At& at) {
  static constexpr Places kAt = places();
  double before = 0;
  double sum = 0;
  for (std::size_t place = 0; place < kProfilePlaces; ++place) {
    std::array<PixelPoint, kRows> pixels;
    for (std::size_t row = 0; row < kRows; ++row) pixels[row] = at(kAt.u[place], kAt.v[row]);
    double value = 0;
    for (const PixelPoint& pixel : pixels) value += sample_bilinear(image, pixel) / kRows;
    if (place > 0) sum += std::abs(value - before);
    before = value;
  }
  return sum / (kProfilePlaces - 1);
}

}  // namespace

BarSteps bar_steps(const GrayView& image, const Quad& quad) {
  const Homography map = homography_to(quad);
  return {mean_step(image, [&](double u, double v) { return map(u, v); }),
          mean_step(image, [&](double u, double v) { return map(v, u); })};
}

}  // namespace tagsmith::detail
