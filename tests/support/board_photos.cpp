// SPDX-License-Identifier: Apache-2.0
#include "tests/support/board_photos.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"

namespace tagsmith::detail::test {

using Eigen::Vector2d;
using Eigen::Vector3d;

Board plate_board(double scale_sigma, int serial) {
  BoardRequest request;
  request.name = "plate";
  request.serial = serial;
  request.width = 0.6;
  request.height = 0.4;
  request.room = {0.005, 0.005, 0.59, 0.39};
  request.columns = 5;
  Board board = *make_board(request);
  board.scale_sigma = scale_sigma;
  return board;
}

Pose camera_from_board(const Camera& camera, const Board& board, const BoardStance& stance) {
  const Vector3d sight = ray_through(camera, stance.pixel).value().normalized();
  const double diagonal = std::hypot(board.width, board.height);
  const auto turn = [](double angle, const Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  };
  const Eigen::Matrix3d towards =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), sight).toRotationMatrix();
  Pose pose;
  pose.rotation = towards * turn(stance.roll, Vector3d::UnitZ()) *
                  turn(stance.pitch, Vector3d::UnitX()) * turn(stance.yaw, Vector3d::UnitY());
  const Vector3d middle(board.width / 2, board.height / 2, 0);
  pose.translation = diagonal / stance.size * sight - pose.rotation * middle;
  return pose;
}

BoardStance varied_stance(const Camera& camera, std::size_t index, Draws& draws) {
  // The middle of the board goes through a grid of three by three places.
  const double x = static_cast<double>(index % 3), y = static_cast<double>(index / 3 % 3);
  BoardStance stance;
  stance.pixel << camera.width * (0.25 * (1 + x) + draws.uniform(-0.08, 0.08)),
      camera.height * (0.25 * (1 + y) + draws.uniform(-0.08, 0.08));
  stance.size = camera.width / camera.fx * draws.uniform(0.45, 0.8);
  stance.yaw = radians(draws.uniform(-45, 45));
  stance.pitch = radians(draws.uniform(-45, 45));
  stance.roll = radians(draws.uniform(-30, 30)) + (index % 4 == 3 ? radians(90) : 0);
  return stance;
}

namespace {

// Sides known to 0.02 px, each with its own ends.
CornerCovariance stated_covariance() {
  CornerCovariance covariance = 0.0004 * CornerCovariance::Identity();
  for (Eigen::Index side = 0; side < 4; ++side) {
    // Above and below v, left and right u, of both corners alike.
    Eigen::Matrix<double, 8, 1> alike = Eigen::Matrix<double, 8, 1>::Zero();
    const Eigen::Index along = side % 2 == 0 ? 1 : 0;
    alike[2 * side + along] = 0.02;
    alike[2 * ((side + 1) % 4) + along] = 0.02;
    covariance += alike * alike.transpose();
  }
  return covariance;
}

std::optional<CornerPixels> projected(const Camera& camera, const Board& board, const BoardTag& tag,
                                      const Pose& pose, const SeenHow& how) {
  CornerPixels pixels;
  Eigen::Index row = 0;
  for (const PlatePoint& corner : corners_of(board, tag)) {
    const Vector2d drawn(corner.x, corner.y);
    const Vector3d point = how.warp ? how.warp(drawn) : Vector3d(drawn.x(), drawn.y(), 0);
    const auto pixel = project(camera, pose * point);
    if (!pixel || !in_image(camera, *pixel)) return std::nullopt;
    pixels.segment<2>(row) = *pixel;
    row += 2;
  }
  return CornerPixels(pixels + how.edge_px * by_outward_edges(pixels));
}

bool is_seen_well(const Board& board, const Pose& pose, const CornerPixels& pixels) {
  constexpr double kLeast = 0.5;  // pixels a module
  const double modules = board.tag.frame_inner_length / module_width(board.tag);
  const Vector3d away = pose * Vector3d(board.width / 2, board.height / 2, 0);
  return pose.rotation.col(2).dot(away.normalized()) > std::cos(radians(70)) &&
         (pixels.segment<2>(2) - pixels.segment<2>(0)).norm() > kLeast * modules;
}

}  // namespace

BoardView seen_board(const Camera& camera, const Board& board, const Pose& pose, Draws& draws,
                     const SeenHow& how) {
  const CornerCovariance covariance = stated_covariance();
  const Eigen::LLT<CornerCovariance> root(covariance);
  BoardView view{"view", camera.width, camera.height, {}};
  for (std::size_t t = 0; t < board.tags.size(); ++t) {
    auto pixels = projected(camera, board, board.tags[t], pose, how);
    if (!pixels || !is_seen_well(board, pose, *pixels)) continue;
    CornerPixels noise;
    for (double& value : noise) value = draws.normal(how.noise);
    view.tags.push_back({0, t, *pixels + root.matrixL() * noise, covariance});
  }
  return view;
}

std::vector<BoardView> seen_boards(const Camera& camera, const Board& board, std::size_t count,
                                   Draws& draws, const SeenHow& how) {
  std::vector<BoardView> views;
  for (std::size_t i = 0; views.size() < count && i < 20 * count; ++i) {
    const BoardStance stance = varied_stance(camera, views.size(), draws);
    if (!ray_through(camera, stance.pixel)) continue;
    BoardView view =
        seen_board(camera, board, camera_from_board(camera, board, stance), draws, how);
    if (view.tags.size() < 4) continue;
    view.file = "photo" + std::to_string(views.size());
    views.push_back(std::move(view));
  }
  return views;
}

ScenePlate board_plate(const Board& board, const Pose& camera_from_board) {
  ScenePlate plate;
  plate.camera_from_plate = camera_from_board;
  plate.drawing.plate = {0, 0, board.width, board.height};
  plate.drawing.frame_inner = plate.drawing.frame_outer = {board.width / 2, board.height / 2, 0, 0};
  plate.drawing.module = module_width(board.tag);
  for (const BoardTag& tag : board.tags) {
    const TagDrawing drawing = moved(draw_tag(board.tag, tag.digits), tag.corner.x, tag.corner.y);
    const Rectangle& out = drawing.frame_outer;
    const Rectangle& in = drawing.frame_inner;
    std::vector<Rectangle>& bars = plate.drawing.bars;
    bars.insert(bars.end(), drawing.bars.begin(), drawing.bars.end());
    bars.push_back({out.x, out.y, out.width, in.y - out.y});
    bars.push_back({out.x, in.y + in.height, out.width, in.y - out.y});
    bars.push_back({out.x, in.y, in.x - out.x, in.height});
    bars.push_back({in.x + in.width, in.y, in.x - out.x, in.height});
  }
  return plate;
}

}  // namespace tagsmith::detail::test
