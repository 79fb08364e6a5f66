// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_edges.hpp"

#include <cstdint>
#include <limits>
#include <utility>

#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

constexpr float kHalfLength = kModuleCount / 2.0F;
constexpr float kReach = 4.5F;  // blurs; beyond, the step of an edge is flat to 1e-5

// One over the standard deviations of the point spread, and how far an edge reaches, modules.
TAGSMITH_WIDE void set_reaches(const std::vector<float>& spread, float blur_at_middle,
                               std::vector<float>& per_blur, std::vector<float>& reach) {
  const std::size_t size = spread.size();
  const float* from = spread.data();
  float* inverse = per_blur.data();
  float* far = reach.data();
  for (std::size_t i = 0; i < size; ++i) {
    const float blur = blur_at_middle * from[i];
    inverse[i] = 1 / blur;
    far[i] = kReach * blur;
  }
}

}  // namespace

ScanPlaces::ScanPlaces(const ScanProfile& profile)
    : at(profile.size()), from_middle(profile.size()), spread(profile.size()) {
  for (std::size_t i = 0; i < profile.size(); ++i) {
    at[i] = static_cast<float>(profile[i].at);
    from_middle[i] = (at[i] - kHalfLength) / kHalfLength;
    spread[i] = static_cast<float>(profile[i].spread);
  }
}

SymbolEdges::SymbolEdges(const ImagingModel& image, const Digits& digits)
    : blur_(static_cast<float>(image.blur)) {
  const std::array<std::uint8_t, kElementCount> elements = elements_of(digits);
  int nominal = 0;
  for (std::size_t i = 0; i < kEdgeCount; ++i) {
    const float from_middle = static_cast<float>(nominal) - kHalfLength;
    const float t = from_middle / kHalfLength;
    const float widening = (i % 2 == 0 ? -0.5F : 0.5F) * static_cast<float>(image.growth);
    from_middle_[i] = from_middle;
    bend_[i] = t * t;
    actual_[i] = static_cast<float>(nominal) + static_cast<float>(image.shift) +
                 static_cast<float>(image.stretch) * from_middle +
                 static_cast<float>(image.bend) * bend_[i] + widening;
    if (i < elements.size()) nominal += elements[i];
  }
}

// Calls visit_place(i, first, last, per_blur) for each place with the edges within its reach: from
// `first` up to `last`. Those before `first` are passed for good.
template <class Visit>
void SymbolEdges::visit(const ScanPlaces& places, const Visit& visit_place) const {
  std::vector<float> per_blur(places.size()), reach(places.size());
  set_reaches(places.spread, blur_, per_blur, reach);
  std::size_t first = 0, last = 0;
  float end = -std::numeric_limits<float>::infinity();  // edges before `last` are before this
  for (std::size_t i = 0; i < places.size(); ++i) {
    const float begin = places.at[i] - reach[i];
    while (first < kEdgeCount && actual_[first] < begin) ++first;
    const float before = std::exchange(end, places.at[i] + reach[i]);
    if (last < first || !(end >= before)) last = first;
    while (last < kEdgeCount && actual_[last] < end) ++last;
    visit_place(i, first, last, per_blur[i]);
  }
}

std::vector<float> SymbolEdges::shares_at(const ScanPlaces& places) const {
  std::vector<float> shares(places.size());
  visit(places, [&](std::size_t i, std::size_t first, std::size_t last, float per_blur) {
    float share = first % 2 == 0 ? 0 : 1;
    for (std::size_t k = first; k < last; ++k) {
      const float integral = normal_((places.at[i] - actual_[k]) * per_blur).integral;
      share += k % 2 == 0 ? integral : -integral;
    }
    shares[i] = share;
  });
  return shares;
}

std::vector<BarShare> SymbolEdges::with_derivatives_at(const ScanPlaces& places) const {
  std::vector<BarShare> shares(places.size());
  visit(places, [&](std::size_t i, std::size_t first, std::size_t last, float per_blur) {
    BarShare bars;
    bars.share = first % 2 == 0 ? 0 : 1;
    for (std::size_t k = first; k < last; ++k) {
      const float z = (places.at[i] - actual_[k]) * per_blur;
      const NormalValue value = normal_(z);
      const float sign = k % 2 == 0 ? 1.0F : -1.0F;
      const float density = sign * value.density;
      const float by_edge = -density * per_blur;
      bars.share += sign * value.integral;
      bars.by_log_blur -= density * z;
      bars.by_shift += by_edge;
      bars.by_stretch += by_edge * from_middle_[k];
      bars.by_bend += by_edge * bend_[k];
      bars.by_growth -= 0.5F * sign * by_edge;
    }
    shares[i] = bars;
  });
  return shares;
}

}  // namespace tagsmith::detail
