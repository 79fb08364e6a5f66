// SPDX-License-Identifier: Apache-2.0
// Plates of one size beside and below each other on a strip of paper, as close as they go.
#pragma once

#include <cstddef>
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
  std::vector<PlatePlace> places;  // plate by plate
  double length = 0;               // of the strip that they take
};

// `count` plates, or as many as a strip of this width and length holds, on as short a piece of it
// as is found; equally short, the way that turns fewer of them. Without `may_turn` each stands as
// it is, row by row. Time grows with plates times their number across the strip; packings that are
// tried are few for many plates.
PlatePacking pack_plates(const PlateSize& plate, std::size_t count, double width, double length,
                         bool may_turn);

}  // namespace tagsmith::detail
