// SPDX-License-Identifier: Apache-2.0
// What a photo shows of calibration boards.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/tag/board.hpp"

namespace tagsmith::detail {

// u, v of a frame's inner corners P, F, lower right, Q, pixels.
using CornerPixels = Eigen::Matrix<double, 8, 1>;

// A board's tag in a photo.
struct SeenBoardTag {
  std::size_t board = 0;  // its place among the boards that were looked for
  std::size_t tag = 0;    // in Board::tags
  CornerPixels pixels = CornerPixels::Zero();
  CornerCovariance covariance = CornerCovariance::Identity();  // of these, pixels^2
};

// What one photo shows of all boards.
struct BoardView {
  std::string file;
  int width = 0;  // pixels
  int height = 0;
  std::vector<SeenBoardTag> tags;  // each tag once at most
  std::string objection{};         // why nothing of it is used; then it has no tags
};

// Where a board is, as a first solution has it.
struct PlacedBoard {
  std::size_t board = 0;
  Pose camera_from_board;
};

// The camera of a photo and the boards before it, as far as they are known.
struct BoardGuess {
  Camera camera;  // of the photo's size
  std::vector<PlacedBoard> boards;
};

// Fails where two boards have a tag of the same code: they were made with the same serial number.
Result<void> check_boards(std::span<const Board> boards);

// Searches the whole photo for the boards' tags. `file` names it. Boards that check_boards accepts.
BoardView read_board_view(const GrayView& image, std::string file, std::span<const Board> boards);

// Photos that must not count: mirrored ones, those with two prints of a board, and those that show
// the boards from where another one does, such as copies in another file format. These lose their
// tags and get an objection. `views` are as read first.
void object_to_views(std::span<const Board> boards, std::vector<BoardView>& views);

// Reads it again when the places of everything are known: corners are fitted through the lens, and
// tags that the search missed (small, oblique, strongly bent) are looked for where they must be. A
// tag that was in `first` and is not found now stays unchanged; so do all of them where the guess's
// camera has another size, or the photo does not count.
BoardView read_board_view_again(const GrayView& image, const BoardView& first,
                                std::span<const Board> boards, const BoardGuess& guess);

}  // namespace tagsmith::detail
