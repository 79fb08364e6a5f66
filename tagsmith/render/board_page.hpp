// SPDX-License-Identifier: Apache-2.0
// The printed sheet of a calibration board.
#pragma once

#include <string>

#include "tagsmith/render/page.hpp"
#include "tagsmith/tag/board.hpp"

namespace tagsmith::detail {

// What a board's sheet states about itself.
struct BoardNotes {
  std::string sheet;       // "A4", "plate"
  std::string program;     // name and version of the program that drew it
  std::string board_file;  // name of the file in which the user writes the measurements
  bool to_glue = true;     // paper, to be glued on a plate; false = the plate itself is printed
};

// The part of a sheet for tags and their clearance: without scale bars, marks, notes and the 5 mm
// that printers leave blank.
Rectangle board_room(double width, double height);

// The sheet at true scale: the tags, scale bars in both directions, the crosses A to D for tape or
// caliper, and notes on how to print, glue and measure it.
Page lay_out_board(const Board& board, const BoardNotes& notes);

}  // namespace tagsmith::detail
