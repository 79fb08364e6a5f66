// SPDX-License-Identifier: Apache-2.0
// Files of calibration boards.
#pragma once

#include <filesystem>
#include <string>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/board.hpp"

namespace tagsmith::detail {

// ---- Files of calibration boards, as `tagsmith board` writes and their users complete them.

// The accuracy that is assumed for the measurement of a board where its file does not say: that of
// a steel rule or a tape in the hand. Metres.
inline constexpr double kUsualMeasuringSigma = 0.0002;

// Fails only when the file cannot be read at all. The scale is what was measured over what was
// drawn; its sigma is the measurement's over the shorter of the two distances, or
// kUnmeasuredScaleSigma where nothing was measured.
Result<Diagnosed<Board>> read_board(const std::filesystem::path& path);

// The board of a file without errors; fails with all of its findings.
Result<Board> load_board(const std::filesystem::path& path);

// ---- The file of a calibration board, for the board's user to complete.

// Everything that readers need of the board, with comments that say what its lengths are and how to
// measure the print: `measured` is a comment until the user has done so. read_board returns the
// same board from it, except for its scale.
std::string board_file_text(const Board& board);

}  // namespace tagsmith::detail
