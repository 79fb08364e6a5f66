// SPDX-License-Identifier: Apache-2.0
// The curve between light and the sample a camera stores.
#pragma once

#include <array>

namespace tagsmith {

// sRGB (IEC 61966-2-1), with samples 0-255 and light 0-1. Blur happens in light, so edges are
// located there; cameras without the curve are told by the bars, whose widths are known.
class ToneCurve {
 public:
  static const ToneCurve& srgb();

  double light_of(int sample) const { return light_[static_cast<std::size_t>(sample)]; }

  // The sample for an amount of light, not rounded; clamped to 0-255.
  double sample_of(double light) const;

  // d sample / d light there.
  double slope_of(double light) const;

 private:
  ToneCurve();
  static constexpr int kSteps = 4096;
  std::array<double, 256> light_{};
  std::array<double, kSteps + 2> sample_{};
};

}  // namespace tagsmith
