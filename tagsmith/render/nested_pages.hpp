// SPDX-License-Identifier: Apache-2.0
// Several plates on one sheet of paper or piece of a roll.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "tagsmith/render/page.hpp"
#include "tagsmith/render/print_paper.hpp"

namespace tagsmith::detail {

struct NestPlan {
  int columns = 0;
  int rows = 0;  // of a full page
  double page_width = 0;
  double page_height = 0;        // of a full page
  bool shortened_down = false;   // a roll's last page is cut off below its last row
  bool shortened_right = false;  // or right of its last column
  double bleed = 0;
  int dots_per_inch = 0;

  int plates() const { return columns * rows; }
};

// As many plates of this size as the paper holds, turned whichever way holds more; nothing when it
// holds none.
std::optional<NestPlan> plan_nest(const Rectangle& plate, const PrintPaper& paper, double bleed,
                                  int dots_per_inch);

// What carries a plate of this size: "A2, A1, A0 or a roll of 323 mm".
std::string papers_for(const Rectangle& plate, double bleed);

struct NamedDrawing {
  std::string name;
  TagDrawing drawing;  // in the plate frame
};

// One page with these plates, at most plan.plates() of them and all of one size, row by row.
Page lay_out_nested(std::span<const NamedDrawing> tags, const PageNotes& notes,
                    const NestPlan& plan);

}  // namespace tagsmith::detail
