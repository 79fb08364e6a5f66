// SPDX-License-Identifier: Apache-2.0
// Pictures of a camera that moves while it reads its rows one after another.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "decoder/image/gray.hpp"
#include "decoder/image/tone_curve.hpp"

namespace tagsmith::detail::test {

// Shifts each row to the right by a number of pixels.
template <class Shift>
void shift_rows(GrayImage& image, const Shift& shift) {
  const GrayImage still = image;
  const ToneCurve& tone = ToneCurve::srgb();
  for (int y = 0; y < image.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
    for (int x = 0; x < image.width; ++x) {
      const double from = std::clamp(x - shift(y), 0.0, image.width - 1.001);
      const std::size_t left = row + static_cast<std::size_t>(from);
      const double share = from - std::floor(from);
      const double light = (1 - share) * tone.light_of(still.samples[left]) +
                           share * tone.light_of(still.samples[left + 1]);
      image.samples[row + static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(std::lround(tone.sample_of(light)));
    }
  }
}

}  // namespace tagsmith::detail::test
