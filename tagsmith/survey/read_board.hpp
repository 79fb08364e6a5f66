// SPDX-License-Identifier: Apache-2.0
// Files of calibration boards, as `tagsmith board` writes and their users complete them.
#pragma once

#include <filesystem>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/board.hpp"

namespace tagsmith::detail {

// How exactly a board is taken to be measured where its file does not say: what a hand with a steel
// rule or a tape does. Metres.
inline constexpr double kUsualMeasuringSigma = 0.0002;

// Fails only when the file cannot be read at all. The scale is what was measured over what was
// drawn; its sigma is the measurement's over the shorter of the two distances, or
// kUnmeasuredScaleSigma where nothing was measured.
Result<Diagnosed<Board>> read_board(const std::filesystem::path& path);

// The board of a file without errors; fails with all of its findings.
Result<Board> load_board(const std::filesystem::path& path);

}  // namespace tagsmith::detail
