// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/sampled_light.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "decoder/image/tone_curve.hpp"

namespace tagsmith::detail {

SampledLight::SampledLight(const GrayView& image)
    : image_(image), made_(static_cast<std::size_t>(image.height)) {}

void SampledLight::make_rows(int first, int last) {
  const auto width = static_cast<std::size_t>(image_.width);
  if (!light_) light_ = std::make_unique_for_overwrite<float[]>(width * made_.size());
  const std::array<float, 256>& light = ToneCurve::of(image_).light_table();
  const int end = std::min(last, image_.height - 1) + 1;
  for (int y = std::max(0, first); y < end; ++y) {
    const auto at = static_cast<std::size_t>(y);
    if (made_[at]) continue;
    made_[at] = true;
    const std::uint8_t* samples = image_.row(y);
    float* row = light_.get() + at * width;
    for (std::size_t x = 0; x < width; ++x) row[x] = light[samples[x]];
  }
}

}  // namespace tagsmith::detail
