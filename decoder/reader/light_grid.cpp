// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/light_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "decoder/image/tone_curve.hpp"

namespace tagsmith {
namespace {

std::array<float, 256> light_table() {
  std::array<float, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] = static_cast<float>(ToneCurve::srgb().light_of(static_cast<int>(i)));
  }
  return light;
}

PixelPoint corrected(const FrameMap& map, PixelPoint flat) {
  auto u = static_cast<float>(flat.x), v = static_cast<float>(flat.y);
  map.correct(u, v);
  return {static_cast<double>(u), static_cast<double>(v)};
}

}  // namespace

LightGrid light_grid(const GrayView& image, const FrameMap& image_from_unit, double modules,
                     int bins_per_module, std::size_t rows) {
  LightGrid grid{rows,
                 static_cast<std::size_t>(std::ceil(modules * bins_per_module)),
                 static_cast<double>(bins_per_module),
                 {}};
  grid.cells.resize(grid.rows * grid.bins);
  const std::array<float, 256> light = light_table();
  const Homography unit_from_image = inverse(image_from_unit.flat());
  // Bowed sides may reach beyond the corners.
  const std::array<PixelPoint, 8> outline{image_from_unit(0, 0), image_from_unit(0.5, 0),
                                          image_from_unit(1, 0), image_from_unit(1, 0.5),
                                          image_from_unit(1, 1), image_from_unit(0.5, 1),
                                          image_from_unit(0, 1), image_from_unit(0, 0.5)};
  const auto [left, right] = std::ranges::minmax(outline, {}, &PixelPoint::x);
  const auto [top, bottom] = std::ranges::minmax(outline, {}, &PixelPoint::y);
  const auto pixel = [](double at, int size) {
    return static_cast<int>(std::clamp(at, 0.0, size - 1.0));
  };
  const int x_end = pixel(std::ceil(right.x), image.width);
  const int y_end = pixel(std::ceil(bottom.y), image.height);
  for (int y = pixel(top.y, image.height); y <= y_end; ++y) {
    const std::uint8_t* row = image.row(y);
    for (int x = pixel(left.x, image.width); x <= x_end; ++x) {
      PixelPoint unit = unit_from_image(x, y);
      if (image_from_unit.bends()) unit = corrected(image_from_unit, unit);
      if (!(unit.x >= 0 && unit.x < 1 && unit.y >= 0 && unit.y < 1)) continue;
      const double place = unit.x * modules;
      const auto bin = std::min(grid.bins - 1, static_cast<std::size_t>(place * bins_per_module));
      const auto at = static_cast<std::size_t>(unit.y * static_cast<double>(rows));
      LightCell& cell = grid.cells[at * grid.bins + bin];
      cell.light += light[row[x]];
      cell.place += static_cast<float>(place);
      cell.count += 1;
    }
  }
  for (LightCell& cell : grid.cells) {
    if (cell.count == 0) continue;
    cell.light /= cell.count;
    cell.place /= cell.count;
  }
  return grid;
}

}  // namespace tagsmith
