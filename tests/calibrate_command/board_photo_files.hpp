// SPDX-License-Identifier: Apache-2.0
// Photos of a board and the board's file, as `calibrate` takes them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/tag/board.hpp"
#include "tests/support/board_photos.hpp"

namespace tagsmith::detail::test {

// A wide-angle camera whose pictures are quick to read.
Camera photo_camera();

// Renders the board with sensor noise, and writes the PNG.
void write_photo(const std::filesystem::path& file, const Camera& camera, const Board& board,
                 const BoardStance& stance, std::uint64_t seed);

// photo00.png ... of so many varied stances, in the folder.
void write_varied_photos(const std::filesystem::path& folder, const Camera& camera,
                         const Board& board, std::size_t count);

// The board's file; returns its path.
std::filesystem::path write_board(const std::filesystem::path& file, const Board& board);

}  // namespace tagsmith::detail::test
