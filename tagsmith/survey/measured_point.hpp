// SPDX-License-Identifier: Apache-2.0
// Points of a plate that a surveyor may measure in place of P.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

struct MeasuredPoint {
  const char* option = "";      // as `tagsmith new --point` has it: "top-right"
  const char* name = "";        // "the frame's top right corner"
  Eigen::Vector2d place{0, 0};  // from P to the right and down, as seen by who faces the plate, m
};

// P, the inner top left corner of the frame, is none of them.
std::vector<MeasuredPoint> points_besides_p(const TagTemplate& tag);

}  // namespace tagsmith::detail
