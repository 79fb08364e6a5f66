// SPDX-License-Identifier: Apache-2.0
// Points of a plate that a surveyor may measure in place of P.
#pragma once

#include <vector>

#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

struct MeasuredPoint {
  const char* option = "";  // as `tagsmith new --point` has it: "top-right"
  const char* name = "";    // "the frame's top right corner"
  // From P, as seen by who faces the plate, metres.
  double right = 0;
  double down = 0;
};

// P, the inner top left corner of the frame, is none of them.
std::vector<MeasuredPoint> points_besides_p(const TagTemplate& tag);

}  // namespace tagsmith::detail
