// SPDX-License-Identifier: Apache-2.0
// Where a symbol may lie on a line of light, by its quiet zones and guard patterns.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tagsmith::detail {

// Light along a line across the bars, evenly spaced; any unit. Lines are handled in their own
// samples: sample i covers i to i + 1.
using ScanLine = std::vector<float>;

// Where a symbol may lie on a line.
struct SymbolPlace {
  double begin = 0;   // of the first bar, samples
  double module = 0;  // width, samples; negative when the symbol runs against the line
  double cost = 0;    // of its three guard patterns, 0 to 6; less is better
};

// Places whose quiet zones and three guard patterns suit, best first, at most `most` of them. Both
// directions fit equally well; the one along the line is returned. `least` and `greatest` bound
// the module's width in samples, kPlace.worst the places' cost.
std::vector<SymbolPlace> find_symbol_places(const ScanLine& line, double least, double greatest,
                                            std::size_t most);

inline constexpr int kPlacedPerModule = 5;  // samples of a placed line
inline constexpr int kPlacedMargin = 14;    // modules of a placed line on both sides of the symbol
inline constexpr int kPlacedSlack = 5;      // modules that a symbol may reach beyond its line

// A line resampled about a place, as darkness (0 space, 1 bar), the symbol running along it.
struct PlacedLine {
  std::vector<float> darkness;
  double begin = 0;  // of the place, samples of the line in its own or the turned direction
  double module = 0;
  double turned_size = 0;  // samples of the line when it was turned, else 0
};

// Nothing when the place does not fit on the line.
std::optional<PlacedLine> placed_line(const ScanLine& line, const SymbolPlace& place);

}  // namespace tagsmith::detail
