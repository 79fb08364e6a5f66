// SPDX-License-Identifier: Apache-2.0
// The curve between light and the sample a camera stores.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// sRGB (IEC 61966-2-1), with samples 0-255 and light 0-1. Blur happens in light, so edges are
// located there; a camera without the curve is recognised by the bars, whose widths are known.
class ToneCurve {
 public:
  static const ToneCurve& srgb();

  // The curve of the image's samples: sRGB, or that of a negative, whose light is 1 minus that of
  // the picture, so that its blur is as linear as the picture's.
  static const ToneCurve& of(const GrayView& image);

  double light_of(int sample) const { return light_[static_cast<std::size_t>(sample)]; }

  // The light of the sample nearest to a level between samples, 0-255.
  float light_near(double level) const {
    const double rounded = level + 0.5;
    return light_table_[static_cast<std::size_t>(rounded)];
  }

  // The light of every sample, in single precision.
  const std::array<float, 256>& light_table() const { return light_table_; }

  // The sample for an amount of light, not rounded, clamped to 0-255, and d sample / d light there.
  struct Point {
    float sample = 0;
    float slope = 0;
  };
  Point point_of(float light) const {
    // Light that is no number counts as none.
    const float position = (light > 0 ? std::min(light, 1.0F) : 0.0F) * kSteps;
    const int index = static_cast<int>(position);
    const float low = rounded_[static_cast<std::size_t>(index)];
    const float high = rounded_[static_cast<std::size_t>(index) + 1];
    return {low + (position - static_cast<float>(index)) * (high - low), (high - low) * kSteps};
  }

  // The sample for an amount of light, not rounded; clamped to 0-255.
  double sample_of(double light) const;

 private:
  explicit ToneCurve(bool is_negative);
  static constexpr int kSteps = 4096;
  std::array<double, 256> light_{};
  std::array<float, 256> light_table_{};  // the same
  std::array<double, kSteps + 2> sample_{};
  std::array<float, kSteps + 2> rounded_{};  // the same, for point_of
};

}  // namespace tagsmith::detail
