// SPDX-License-Identifier: Apache-2.0
// Papers and rolls for printing, and their area for plates.
#pragma once

#include <span>
#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/page.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// Metres; sheets upright. A roll has no height: pages are as long as their content.
struct PrintPaper {
  std::string name;
  double width = 0;
  double height = 0;
  PrinterScale reach{};  // of drawings of true size, across the paper and along it

  bool roll() const { return height == 0; }
};

// A4, A3, A2, A1, A0 (ISO 216), Letter, Tabloid (ANSI/ASME Y14.1), smallest first.
std::span<const PrintPaper> print_papers();

// A name of these in any case of letters, WIDTHxHEIGHT or roll:WIDTH in millimetres. Fails on
// others and on papers that cannot hold a scale bar or that PDF cannot express.
Result<PrintPaper> parse_print_paper(const std::string& text);

// WIDTHxHEIGHT in millimetres of a plate that is printed on, as it lies: the width may be the
// longer side. Fails as parse_print_paper does, in the words of --plate.
Result<PrintPaper> parse_print_plate(const std::string& text);

// What a page keeps around its content, metres: the 5 mm that office printers leave blank, and
// outside of them notes above, scale bars at the left and below.
struct PaperBorder {
  static constexpr double kLeft = 0.014;
  static constexpr double kTop = 0.015;
  static constexpr double kRight = 0.008;
  static constexpr double kBottom = 0.014;
};

// The longest page of a roll, metres: the limit of PDF (ISO 32000-1, Annex C.2), rounded down.
inline constexpr double kLongestPage = 5.0;

// The part of a page of this size that holds plates.
Rectangle content_area(double page_width, double page_height);

// Crop marks beside a plate or a tile on paper.
inline constexpr double kPaperMarkGap = 0.001;
inline constexpr double kPaperMarkLength = 0.004;

// The two lines above the content.
void add_paper_notes(Page& page, const std::string& first, const std::string& second,
                     double max_width);

}  // namespace tagsmith::detail
