// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/searched_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "decoder/image/tone_curve.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {

// ---- Light.

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

// ---- Levels.

Pyramid::Pyramid(const GrayView& image) {
  // Noise halves from level to level, and so does the smallest contrast that is visible above it.
  constexpr std::array<int, 3> kContrasts{20, 12, 7};
  add({image, 1, kContrasts[0]});
  while (levels_.size() < 3 ||
         std::min(coarsest().width, coarsest().height) >= 2 * kSearch.least_level) {
    const double scale = 2 * levels_.front().level.scale;
    reduced_.push_back(half_size(coarsest()));
    add({reduced_.back().view(), scale, kContrasts[std::min<std::size_t>(levels_.size(), 2)]});
  }
}

// ---- The picture.

const Pyramid& SearchedImage::pyramid() {
  if (!pyramid_) pyramid_.emplace(image());
  return *pyramid_;
}

const std::vector<BarRegion>& SearchedImage::bars() {
  if (bars_) return *bars_;
  std::vector<BarRegion> all;
  for (const SearchLevel& at : pyramid().levels()) {
    if (static_cast<double>(at.level.image.width) * at.level.image.height > kSearch.most_pixels)
      continue;
    for (const BarRegion& region : find_bar_regions(at.texture)) {
      all.push_back(scaled(region, at.level.scale));
    }
  }
  std::ranges::stable_sort(all, std::ranges::greater{},
                           [](const BarRegion& region) { return region.length * region.height; });
  bars_.emplace();
  for (const BarRegion& region : all) {
    if (bars_->size() == kSearch.most_regions) break;
    const auto same = [&](const BarRegion& other) { return same_bars(region, other); };
    if (std::ranges::none_of(*bars_, same)) bars_->push_back(region);
  }
  return *bars_;
}

}  // namespace tagsmith::detail
