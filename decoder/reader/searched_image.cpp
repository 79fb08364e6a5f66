// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/searched_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

// Whether two regions are the same bars, seen at two levels.
bool same_bars(const BarRegion& a, const BarRegion& b) {
  return distance(a.centre, b.centre) < 0.15 * a.length &&
         std::abs(dot(a.across, b.across)) > 0.97 && a.length < 1.25 * b.length &&
         b.length < 1.25 * a.length;
}

}  // namespace

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
