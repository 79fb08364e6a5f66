// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_edges.hpp"

#include <cstdint>
#include <limits>
#include <utility>

#include "decoder/scan/edge_step.hpp"

namespace tagsmith::detail {
namespace {

constexpr float kReach = 4.5F;  // blurs; beyond, the step of an edge is flat to 1e-5

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
    : blur_(static_cast<float>(image.blur)), pixel_(static_cast<float>(image.pixel)) {
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

// Calls visit_place(i, first, last, step) for each place with the edges within its reach: from
// `first` up to `last`. Those before `first` are not needed again.
template <class Visit>
void SymbolEdges::visit(const ScanPlaces& places, const Visit& visit_place) const {
  const float reach_at_middle = kReach * blur_ + pixel_ / 2;
  std::size_t first = 0, last = 0;
  float end = -std::numeric_limits<float>::infinity();  // edges before `last` are before this
  for (std::size_t i = 0; i < places.size(); ++i) {
    const float reach = reach_at_middle * places.spread[i];
    const float begin = places.at[i] - reach;
    while (first < kEdgeCount && actual_[first] < begin) ++first;
    const float before = std::exchange(end, places.at[i] + reach);
    if (last < first || !(end >= before)) last = first;
    while (last < kEdgeCount && actual_[last] < end) ++last;
    visit_place(i, first, last, EdgeStep(blur_ * places.spread[i], pixel_ * places.spread[i]));
  }
}

std::vector<float> SymbolEdges::shares_at(const ScanPlaces& places) const {
  std::vector<float> shares(places.size());
  visit(places, [&](std::size_t i, std::size_t first, std::size_t last, const EdgeStep& step) {
    float share = first % 2 == 0 ? 0.0F : 1.0F;
    for (std::size_t k = first; k < last; ++k) {
      const float integral = step(places.at[i] - actual_[k]).integral;
      share += k % 2 == 0 ? integral : -integral;
    }
    shares[i] = share;
  });
  return shares;
}

std::vector<BarShare> SymbolEdges::with_derivatives_at(const ScanPlaces& places) const {
  std::vector<BarShare> shares(places.size());
  visit(places, [&](std::size_t i, std::size_t first, std::size_t last, const EdgeStep& step) {
    BarShare bars;
    bars.share = first % 2 == 0 ? 0.0F : 1.0F;
    for (std::size_t k = first; k < last; ++k) {
      const StepValue value = step(places.at[i] - actual_[k]);
      const float sign = k % 2 == 0 ? 1.0F : -1.0F;
      const float by_edge = -sign * value.density * step.per_blur();
      bars.share += sign * value.integral;
      bars.by_log_blur += sign * value.by_log_blur;
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
