// SPDX-License-Identifier: Apache-2.0
// The bars of a region, followed line by line.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/searched_image.hpp"
#include "decoder/scan/elastic_scan.hpp"

namespace tagsmith::detail {

// A look of bars that is tried.
struct BarLook {
  BarShape bars;
  BarTemplates templates;
};

// One line of a region that a symbol was read from.
// Why: docs/decisions/0005-parts-and-frameless-symbols.md.
struct ReadLine {
  double offset = 0;  // along the bars, pixels
  ScanLine light;
  ElasticReading reading;
};

// A region with its lines and how its bars look.
struct RegionScan {
  LineFrame frame;
  double spacing = 0;  // of the lines along the bars, pixels
  const BarLook* look = nullptr;
  std::vector<ReadLine> lines;
};

// What is read from a line: where its symbol lies, or its digits too, which takes twice as long.
enum class Wanted { alignment, digits };

// Modules of an alignment's boundaries.
inline constexpr std::array<double, 16> kBoundaryModules{0,  3,  10, 17, 24, 31, 38, 45,
                                                         50, 57, 64, 71, 78, 85, 92, 95};

SymbolPlace place_of(const ElasticAlignment& alignment);

// The line that a region's bars are followed from.
struct FirstLine {
  LineFrame frame;
  ReadLine line;
};

// Of three thick lines the one that is most like a symbol, with its reading: the best of the places
// whose guard patterns suit best, in either direction. Where none is good, lines are tried along
// which the modules grow wider at one end. Nothing where none is like a symbol.
std::optional<FirstLine> first_line(SampledLight& image, const BarRegion& region, Wanted wanted);

// Reads some lines of the region (kBarLines.lines) from the first one outwards, each at the place
// of its neighbour, with the look of the bars that suits the first one best.
RegionScan scan_region(SampledLight& image, const BarRegion& region, FirstLine first,
                       Wanted wanted);

}  // namespace tagsmith::detail
