// SPDX-License-Identifier: Apache-2.0
// Calibration boards before simulated cameras: what a reader would say of them, and pictures.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "decoder/calibrate/board_view.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/tag/board.hpp"
#include "tests/support/draws.hpp"

namespace tagsmith::detail::test {

// A board of 5 columns on a plate of 600 x 400 mm, exact unless told otherwise.
Board plate_board(double scale_sigma = 0, int serial = 1);

// How a board stands before a camera.
struct BoardStance {
  Eigen::Vector2d pixel;  // where its middle is seen
  double size = 0;        // of the board's diagonal across the line of sight, in focal lengths
  double yaw = 0;         // radians, about the board's upright axis, then its level one
  double pitch = 0;
  double roll = 0;  // in the picture
};

Pose camera_from_board(const Camera& camera, const Board& board, const BoardStance& stance);

// With a lens that bends straight lines.
inline const Camera kWideCamera{1280, 960, 800, 800, 633.5, 488, {-0.35, 0.12}};

// As somebody moves a board about who was told to cover the picture and to tilt it.
BoardStance varied_stance(const Camera& camera, std::size_t index, Draws& draws);

// A board that is not as drawn: its point of the drawing, as it is in space.
using BoardWarp = std::function<Eigen::Vector3d(const Eigen::Vector2d&)>;

// What the reader would see of the board: tags whose corners are all in the picture, with noise of
// the covariance that is stated times `noise` squared. `edge_px` moves all sides outward.
struct SeenHow {
  double noise = 1;
  double edge_px = 0;
  BoardWarp warp{};
};
BoardView seen_board(const Camera& camera, const Board& board, const Pose& pose, Draws& draws,
                     const SeenHow& how = {});

// So many varied views.
std::vector<BoardView> seen_boards(const Camera& camera, const Board& board, std::size_t count,
                                   Draws& draws, const SeenHow& how = {});

// The board as one plate of a scene: its frames and bars are the drawing's bars.
ScenePlate board_plate(const Board& board, const Pose& camera_from_board);

}  // namespace tagsmith::detail::test
