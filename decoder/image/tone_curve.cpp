// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/tone_curve.hpp"

#include <cmath>

namespace tagsmith::detail {
namespace {

double encode(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

double decode(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

}  // namespace

ToneCurve::ToneCurve(bool is_negative) {
  for (std::size_t i = 0; i < light_.size(); ++i) {
    const double value = static_cast<double>(i) / 255;
    light_[i] = is_negative ? 1 - decode(1 - value) : decode(value);
    light_table_[i] = static_cast<float>(light_[i]);
  }
  for (std::size_t i = 0; i < sample_.size(); ++i) {
    const double light = static_cast<double>(i) / kSteps;
    sample_[i] = 255 * (is_negative ? 1 - encode(1 - light) : encode(light));
    rounded_[i] = static_cast<float>(sample_[i]);
  }
}

const ToneCurve& ToneCurve::srgb() {
  static const ToneCurve curve(false);
  return curve;
}

const ToneCurve& ToneCurve::of(const GrayView& image) {
  static const ToneCurve negative(true);
  return image.is_negative ? negative : srgb();
}

double ToneCurve::sample_of(double light) const {
  const double position = std::clamp(light, 0.0, 1.0) * kSteps;
  const auto index = static_cast<std::size_t>(position);
  const double fraction = position - static_cast<double>(index);
  return sample_[index] + fraction * (sample_[index + 1] - sample_[index]);
}

}  // namespace tagsmith::detail
