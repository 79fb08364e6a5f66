// SPDX-License-Identifier: Apache-2.0
// A plate larger than the paper, on several sheets that are cut and glued together.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/page.hpp"
#include "tagsmith/render/print_paper.hpp"

namespace tagsmith::detail {

// Sheets in columns and rows; each shows its window of the plate. Neighbours share a strip as wide
// as the overlap.
struct TilePlan {
  int columns = 0;
  int rows = 0;
  double page_width = 0;
  double page_height = 0;
  double overlap = 0;
  Rectangle window{};           // on the page
  PlatePoint first_in_plate{};  // upper left corner of the first window, plate frame
  double step_right = 0;        // from window to window
  double step_down = 0;
  bool lies = false;  // its pages lie across the paper

  int tiles() const { return columns * rows; }
};

// The plan with the fewest sheets, paper upright or across. Beyond the plate's edge at least 8 mm
// are shown, for marks. Fails when the paper leaves too little between two overlaps.
Result<TilePlan> plan_tiles(const Rectangle& plate, const PrintPaper& paper, double overlap,
                            int dots_per_inch);

// Rows are letters, columns numbers: "A1" is the upper left sheet. Row 27 is "AA".
std::string tile_address(int column, int row);

// Names of a plate's pages: "assembly", then the tiles' addresses row by row.
std::vector<std::string> tile_page_names(const TilePlan& plan);

// The assembly sheet and the tiles, row by row, with these names. The assembly sheet shows the
// plate reduced with the addresses, and says how to assemble it and what to measure. A tile has
// crop marks at its window's corners, a dashed line where the edge of the next sheet will lie,
// crosses at the ends of each seam that must coincide, and the plate's edge as a line.
std::vector<Page> lay_out_tiles(const std::string& name, const TagDrawing& tag,
                                const PageNotes& notes, const TilePlan& plan);

}  // namespace tagsmith::detail
