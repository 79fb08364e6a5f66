// SPDX-License-Identifier: Apache-2.0
// Boards before a camera: equal frames beside each other at every angle.
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/board/seen_board.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using Eigen::Vector3d;

namespace {

Camera camera_of(int width, int height, double focal) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focal;
  camera.fy = focal;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

// The board's middle straight ahead, turned as camera_from_turned_plate does.
Pose camera_from_board(const Board& board, double distance, double yaw_deg, double pitch_deg,
                       double roll_deg) {
  using Eigen::AngleAxisd;
  Pose pose;
  pose.rotation = (AngleAxisd(radians(roll_deg), Vector3d::UnitZ()) *
                   AngleAxisd(radians(pitch_deg), Vector3d::UnitX()) *
                   AngleAxisd(-radians(yaw_deg), Vector3d::UnitY()))
                      .toRotationMatrix();
  pose.translation =
      Vector3d(0, 0, distance) - pose.rotation * Vector3d(board.width / 2, board.height / 2, 0);
  return pose;
}

std::vector<ScenePlate> plates_of(const Board& board, const Pose& camera_from_board) {
  std::vector<ScenePlate> plates;
  for (const BoardTag& tag : board.tags) {
    Pose board_from_plate;
    board_from_plate.translation = {tag.corner.x, tag.corner.y, 0};
    plates.push_back({draw_tag(board.tag, tag.digits), camera_from_board * board_from_plate, {}});
  }
  return plates;
}

struct Turned {
  double distance;
  double yaw;
  double pitch;
  double roll;
};

}  // namespace

TEST_CASE("every tag of a board is read at every angle, its corners within 0.3 px of the truth") {
  const Board board = board_on(0.297, 0.210, 17);
  const Camera camera = camera_of(1600, 1200, 1500);
  ViewOptions options;
  options.sensor.noise_sigma = 2;
  for (const Turned& turned : std::vector<Turned>{{0.45, 0, 0, 0},
                                                  {0.5, 40, 0, 5},
                                                  {0.5, 0, 45, -20},
                                                  {0.6, -35, 30, 90},
                                                  {0.55, 30, -30, 180},
                                                  {0.9, 20, 10, 33}}) {
    CAPTURE(turned.yaw);
    CAPTURE(turned.roll);
    const Pose pose =
        camera_from_board(board, turned.distance, turned.yaw, turned.pitch, turned.roll);
    const View view = render_view(camera, plates_of(board, pose), options);
    const ReadResult result = read_tags(view.image.view(), options_for(board));
    CHECK(result.tags.size() == board.tags.size());
    for (const BoardTag& tag : board.tags) {
      const Reading* reading = reading_of(result, tag.digits);
      REQUIRE(reading != nullptr);
      const auto corners = corners_of(board, tag);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d point = pose * Vector3d(corners[i].x, corners[i].y, 0);
        const Eigen::Vector2d truth = project(camera, point).value();
        CHECK(std::hypot(reading->corners[i].x - truth.x(), reading->corners[i].y - truth.y()) <
              0.3);
      }
    }
  }
}

TEST_CASE("two boards in one picture are told apart by their serials") {
  const Board left = board_on(0.297, 0.210, 1);
  const Board right = board_on(0.297, 0.210, 2);
  const Camera camera = camera_of(1920, 1080, 1500);
  Pose left_pose = camera_from_board(left, 0.7, 15, 5, 0);
  Pose right_pose = left_pose;
  left_pose.translation.x() -= 0.16;
  right_pose.translation.x() += 0.16;
  std::vector<ScenePlate> plates = plates_of(left, left_pose);
  for (ScenePlate& plate : plates_of(right, right_pose)) plates.push_back(plate);
  const View view = render_view(camera, plates);
  ReadOptions options = options_for(left);
  for (const BoardTag& tag : right.tags) options.code_book.push_back(tag.digits);
  const ReadResult result = read_tags(view.image.view(), options);
  CHECK(result.tags.size() == 40);
  for (const Board* board : {&left, &right}) {
    for (const BoardTag& tag : board->tags) CHECK(reading_of(result, tag.digits) != nullptr);
  }
}
