// SPDX-License-Identifier: Apache-2.0
// What an edge of a bar looks like in a profile: a step through the lens and through the pixels.
#pragma once

#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {

// The step from 0 to 1 at some distance behind an edge, and its derivatives by that distance and by
// the logarithm of the point spread, in units of the point spread's standard deviation.
struct StepValue {
  float integral = 0;
  float density = 0;
  float by_log_blur = 0;
};

// A normal point spread, averaged over the width of a pixel. A pixel measures the light on its
// area: where a module is about as wide as a pixel or narrower, the step is not that of any normal
// point spread. All lengths are in modules; a pixel of width 0 measures at a point.
class EdgeStep {
 public:
  EdgeStep(float blur, float pixel)
      : per_blur_(1 / blur), half_(pixel / (2 * blur)), is_point_(pixel == 0) {}

  StepValue operator()(float from_edge) const {
    const float z = from_edge * per_blur_;
    if (is_point_) {
      const NormalValue at = normal_(z);
      return {at.integral, at.density, -at.density * z};
    }
    const float right = z + half_, left = z - half_;
    const NormalValue a = normal_(right), b = normal_(left);
    const float scale = 1 / (right - left);
    return {scale * (right * a.integral + a.density - left * b.integral - b.density),
            scale * (a.integral - b.integral), scale * (a.density - b.density)};
  }

  float per_blur() const { return per_blur_; }

 private:
  const NormalTable& normal_ = NormalTable::get();
  float per_blur_;
  float half_;  // of the pixel's width, in standard deviations
  bool is_point_;
};

}  // namespace tagsmith::detail
