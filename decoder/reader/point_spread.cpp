// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/point_spread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "decoder/image/pixel.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

// Distance in the image between bars that are a unit apart, by which a module's width goes.
// Why: docs/decisions/0002-likelihood-decoding.md.
double width_across(const FrameHomography& image_from_frame, double u) {
  constexpr double kStep = 1e-3;
  const PixelPoint by_u = image_from_frame(u + kStep, 0.5) - image_from_frame(u - kStep, 0.5);
  const PixelPoint by_v = image_from_frame(u, 0.5 + kStep) - image_from_frame(u, 0.5 - kStep);
  return std::abs(cross(by_u, by_v)) / std::max(std::hypot(by_v.x, by_v.y), 1e-12);
}

// A smooth function from its values at a few places: Newton's polynomial through Chebyshev's nodes,
// where it is off least between them.
class Interpolation {
 public:
  template <class Function>
  Interpolation(double begin, double end, const Function& function)
      : middle_((begin + end) / 2), per_half_(2 / std::max(end - begin, 1e-12)) {
    for (std::size_t i = 0; i < kNodes; ++i) {
      nodes_[i] = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / kNodes);
      coefficients_[i] = function(middle_ + nodes_[i] / per_half_);
    }
    for (std::size_t order = 1; order < kNodes; ++order) {
      for (std::size_t i = kNodes; i-- > order;) {
        coefficients_[i] =
            (coefficients_[i] - coefficients_[i - 1]) / (nodes_[i] - nodes_[i - order]);
      }
    }
  }

  double operator()(double at) const {
    const double t = (at - middle_) * per_half_;
    double value = 0;
    for (std::size_t i = kNodes; i-- > 0;) value = value * (t - nodes_[i]) + coefficients_[i];
    return value;
  }

 private:
  // Exact to 1e-9 where one end of the frame is four times as far away as the other.
  static constexpr std::size_t kNodes = 9;
  double middle_, per_half_;
  std::array<double, kNodes> nodes_{}, coefficients_{};
};

}  // namespace

void set_spreads(const FrameHomography& image_from_frame, const SymbolLayout& layout,
                 ScanProfile& profile) {
  if (profile.empty()) return;
  const double middle = width_across(image_from_frame, 0.5);
  const auto u_of = [&](const ScanBin& bin) { return layout.width_share(bin.at); };
  const Interpolation spread(u_of(profile.front()), u_of(profile.back()), [&](double u) {
    return middle / std::max(width_across(image_from_frame, u), 1e-12);
  });
  for (ScanBin& bin : profile)
    bin.spread = std::clamp(spread(u_of(bin)), 1 / kProfile.most_spread, kProfile.most_spread);
}

}  // namespace tagsmith::detail
