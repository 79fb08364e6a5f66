// SPDX-License-Identifier: Apache-2.0
// Plates beside and below each other on a strip of paper, as close as they go.
#pragma once

#include <span>
#include <vector>

namespace tagsmith::detail {

// Metres; with the plate's share of the gaps around it.
struct PlateSize {
  double width = 0;
  double height = 0;
};

// Where the upper left corner of a plate's room lies, from the strip's.
struct PlatePlace {
  double x = 0;
  double y = 0;
  bool turned = false;  // by a quarter: the plate's width lies along the strip
};

struct PlatePacking {
  std::vector<PlatePlace> places;  // of the first plates, in their order
  double length = 0;               // of the strip that they take
};

// A strip as long as this, metres, has no end.
inline constexpr double kEndless = 1e9;

// The first plates of `plates`, as many as a strip of this width and length holds, on as short a
// piece of it as is found; equally short, the way that turns fewer of them. Without `may_turn` each
// stands as it is, row by row. No place when not even the first plate has room. Mixed sizes are
// packed more closely where the strip holds all of them. Time grows with plates times
// their number across the strip; packings that are tried are few for many plates.
PlatePacking pack_plates(std::span<const PlateSize> plates, double width, double length,
                         bool may_turn);

}  // namespace tagsmith::detail
