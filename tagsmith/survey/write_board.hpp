// SPDX-License-Identifier: Apache-2.0
// The file of a calibration board, for the board's user to complete.
#pragma once

#include <string>

#include "tagsmith/tag/board.hpp"

namespace tagsmith::detail {

// All that readers need of the board, with comments that say what its lengths are and how to
// measure the print: `measured` is a comment until the user has done so. What read_board makes of
// it is the board, its scale apart.
std::string board_file_text(const Board& board);

}  // namespace tagsmith::detail
