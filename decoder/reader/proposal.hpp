// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <variant>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/quad.hpp"

namespace tagsmith::detail {

// An outline found in a level, which may be that of a feature frame.
struct Outline {
  PyramidLevel level;
  Quad quad{};
};

// A frame that is known to a few pixels of the level.
struct RoughFrame {
  PyramidLevel level;
  Quad quad{};
};

// A frame that was refused and may be covered: the hypothesis with this index.
struct RefusedFrame {
  std::size_t hypothesis = 0;
};

// A place where a tag may be, to be considered at once: its level's pixels may be freed when the
// proposer returns. Bars are those of a frame that is not visible, in pixels of the full image.
using Proposal = std::variant<Outline, RoughFrame, RefusedFrame, BarRegion>;

}  // namespace tagsmith::detail
