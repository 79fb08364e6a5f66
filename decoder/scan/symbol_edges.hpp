// SPDX-License-Identifier: Apache-2.0
// The share of the light that the bars of a symbol take at each place of a profile.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/profile.hpp"
#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// Places of a profile in single precision, quantity by quantity.
struct ScanPlaces {
  explicit ScanPlaces(const ScanProfile& profile);

  std::size_t size() const { return at.size(); }

  std::vector<float> at;
  std::vector<float> from_middle;  // -1 to 1 from the symbol's begin to its end
  std::vector<float> spread;
};

// The bars' share of the light at a place (0 in a wide space, 1 in a wide bar) and its derivatives
// by the edges' common movements.
struct BarShare {
  float by_log_blur = 0;
  float by_shift = 0;
  float by_stretch = 0;
  float by_bend = 0;
  float by_growth = 0;
  float share = 0;
};

// The edges of a symbol where its image has them.
class SymbolEdges {
 public:
  SymbolEdges(const ImagingModel& image, const Digits& digits);

  std::vector<float> shares_at(const ScanPlaces& places) const;
  std::vector<BarShare> with_derivatives_at(const ScanPlaces& places) const;

 private:
  static constexpr std::size_t kEdgeCount = kElementCount + 1;

  template <class Visit>
  void visit(const ScanPlaces& places, const Visit& visit_place) const;

  // Even edges begin a bar, odd ones end it.
  std::array<float, kEdgeCount> from_middle_{};
  std::array<float, kEdgeCount> bend_{};
  std::array<float, kEdgeCount> actual_{};
  float blur_;
  float pixel_;
};

}  // namespace tagsmith::detail
