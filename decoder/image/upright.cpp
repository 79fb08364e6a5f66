// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/upright.hpp"

#include <cmath>
#include <utility>

namespace tagsmith::detail {

bool Upright::mirrors() const {
  return orientation == 2 || orientation == 4 || orientation == 5 || orientation == 7;
}

bool Upright::reverses_rows() const {
  return orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
}

bool Upright::reverses_columns() const {
  return orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
}

PixelPoint Upright::turn(PixelPoint at) const {
  const int across = transposes() ? height : width;
  const int down = transposes() ? width : height;
  if (transposes()) std::swap(at.x, at.y);
  if (reverses_rows()) at.x = across - 1 - at.x;
  if (reverses_columns()) at.y = down - 1 - at.y;
  return at;
}

GrayImage turn_upright(const GrayView& stored, int orientation) {
  const Upright upright{orientation, stored.width, stored.height};
  GrayImage shown{upright.transposes() ? stored.height : stored.width,
                  upright.transposes() ? stored.width : stored.height,
                  {}};
  shown.samples.resize(static_cast<std::size_t>(shown.width) *
                       static_cast<std::size_t>(shown.height));
  for (int y = 0; y < stored.height; ++y) {
    for (int x = 0; x < stored.width; ++x) {
      const PixelPoint at = upright.turn({static_cast<double>(x), static_cast<double>(y)});
      const auto column = static_cast<std::size_t>(std::lround(at.x));
      const auto row = static_cast<std::size_t>(std::lround(at.y));
      shown.samples[row * static_cast<std::size_t>(shown.width) + column] =
          static_cast<std::uint8_t>(stored.at(x, y));
    }
  }
  return shown;
}

}  // namespace tagsmith::detail
