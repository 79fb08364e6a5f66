// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/write_board.hpp"

#include <array>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

// To a nanometre.
std::string metres(double value) { return format_number(value, 9); }

std::string pair_text(double right, double down) {
  return "[" + metres(right) + ", " + metres(down) + "]";
}

}  // namespace

std::string board_file_text(const Board& board) {
  const TagTemplate& tag = board.tag;
  const BoardGrid& grid = board.grid;
  const std::array<double, 2> drawn = drawn_distances(board.width, board.height);
  const std::string right = format_number(drawn[0] * 1e3);
  const std::string down = format_number(drawn[1] * 1e3);
  std::string text =
      "# A calibration board: tags whose codes are their places on the sheet. Keep this file with\n"
      "# it: `measured` says how large it came out. Lengths in metres; the origin is the sheet's\n"
      "# upper left corner, x to the right, y down.\n";
  text += fmt::format("board: \"{}\"\nserial: {}\nsheet: {}\n", board.name, board.serial,
                      pair_text(board.width, board.height));
  text += fmt::format(
      "feature_frame: {{ inner: {}, stroke: {} }}\n"
      "symbol: {{ quiet_zone: {}, margin: {}, dots_per_inch: {} }}\n",
      pair_text(tag.frame_inner_length, tag.frame_inner_height), metres(tag.frame_stroke),
      format_number(tag.quiet_zone_modules), format_number(tag.margin_modules), tag.dots_per_inch);
  text += fmt::format(
      "# P, the upper left inner corner of a frame: of the first tag, and from tag to tag.\n"
      "tags: {{ columns: {}, rows: {}, first: {}, step: {} }}\n",
      grid.columns, grid.rows, pair_text(grid.first.x, grid.first.y),
      pair_text(grid.step_right, grid.step_down));
  text += fmt::format(
      "# From cross to cross as drawn: A to B, A to C.\n"
      "drawn: {{ a_b_mm: {}, a_c_mm: {} }}\n"
      "# Glue the print on a flat plate, measure the same two distances, write them here with how\n"
      "# exactly you could measure (sigma), and remove the # before `measured`.\n"
      "# measured: {{ a_b_mm: {}, a_c_mm: {}, sigma_mm: 0.2 }}\n",
      right, down, right, down);
  return text;
}

}  // namespace tagsmith::detail
