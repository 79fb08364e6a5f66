// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/pyramid.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "decoder/image/transform.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {

Pyramid::Pyramid(const GrayView& image) {
  // Noise halves from level to level, and with it the contrast that stands out from it.
  constexpr std::array<int, 3> kContrasts{20, 12, 7};
  add({image, 1, kContrasts[0]});
  while (levels_.size() < 3 ||
         std::min(coarsest().width, coarsest().height) >= 2 * kSearch.least_level) {
    const double scale = 2 * levels_.front().level.scale;
    reduced_.push_back(half_size(coarsest()));
    add({reduced_.back().view(), scale, kContrasts[std::min<std::size_t>(levels_.size(), 2)]});
  }
}

}  // namespace tagsmith::detail
