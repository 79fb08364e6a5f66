// SPDX-License-Identifier: Apache-2.0
// Which way bars run inside a quadrilateral.
#pragma once

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// How much the grey level changes along the sides 0 and 2 (`along`) and along the sides 1 and 3
// (`across`), averaged over the other direction so that only what runs through counts: mean
// absolute step between neighbouring places, grey levels.
struct BarSteps {
  double along = 0;
  double across = 0;
};

BarSteps bar_steps(const GrayView& image, const Quad& quad);

}  // namespace tagsmith::detail
