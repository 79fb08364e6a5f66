// SPDX-License-Identifier: Apache-2.0
// Several plates on one sheet of paper or piece of a roll.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tagsmith/render/page.hpp"
#include "tagsmith/render/print_paper.hpp"

namespace tagsmith::detail {

// ---- Plates of one size beside and below each other on a strip of paper, as close as possible.

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

// `count` plates, or as many as a strip of this width and length holds, on the shortest piece of it
// that is found; of equally short ones, the way that turns fewer of them. Without `may_turn` each
// stands upright, row by row. Time grows with plates times their number across the strip; for many
// plates few packings are tried.
PlatePacking pack_plates(const PlateSize& plate, std::size_t count, double width, double length,
                         bool may_turn);

// ---- Pages.

struct NestPlan {
  double page_width = 0;
  double page_height = 0;          // of a full page
  std::vector<PlatePlace> places;  // on a full page, within its content_area
  bool roll = false;               // a page ends below its lowest plates
  double bleed = 0;
  int dots_per_inch = 0;
  bool lies = false;  // a page lies across the paper

  int plates() const { return static_cast<int>(places.size()); }
};

// More plates are put on several pages.
inline constexpr std::size_t kMostNestedPlates = 2000;

// As many plates of this size as the paper holds, at most `plates` on a roll and kMostNestedPlates
// on a page; nothing when it holds none. The way that holds more is taken, or is shorter on a roll:
// rows on the page, rows on the page lying, then with single plates turned by a quarter.
std::optional<NestPlan> plan_nest(const Rectangle& plate, const PrintPaper& paper, double bleed,
                                  int dots_per_inch, std::size_t plates = kMostNestedPlates);

// The papers that can hold a plate of this size: "A2, A1, A0 or a roll of 323 mm".
std::string papers_for(const Rectangle& plate, double bleed, const PrinterScale& reach);

struct NamedDrawing {
  std::string name;
  TagDrawing drawing;  // in the plate frame
};

// One page with these plates of one size, 1 to plan.plates() of them. A page of a roll is as short
// as its plates allow.
Page lay_out_nested(std::span<const NamedDrawing> tags, const PageNotes& notes,
                    const NestPlan& plan);

// The amount of a roll that pages use.
struct RollUse {
  double length = 0;  // metres
  double area = 0;    // square metres
  double plates = 0;  // square metres of it

  double waste() const { return area > 0 ? 1 - plates / area : 0; }  // share of the area
};

// Of so many plates of one size on pages of the plan, which is of a roll.
RollUse roll_use(const Rectangle& plate, const NestPlan& plan, std::size_t plates);

}  // namespace tagsmith::detail
