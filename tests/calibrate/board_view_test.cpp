// SPDX-License-Identifier: Apache-2.0
// Rendered photos through the reader.
#include "decoder/calibrate/board_view.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "decoder/calibrate/assess.hpp"
#include "decoder/calibrate/calibrate_camera.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tests/support/board_photos.hpp"

using namespace tagsmith::detail;
using Eigen::Vector2d;
using test::Draws;

namespace {

GrayImage photo_of(const Camera& camera, const Board& board, const Pose& pose, std::uint64_t seed) {
  ViewOptions options;
  options.sensor.noise_sigma = 2;
  options.sensor.exposure = 0.85;
  options.seed = seed;
  const ScenePlate plate = test::board_plate(board, pose);
  return render_view(camera, std::span(&plate, 1), options).image;
}

// The largest error of a corner, pixels.
double worst_corner(const BoardView& view, const Camera& camera, const Board& board,
                    const Pose& pose) {
  double worst = 0;
  for (const SeenBoardTag& seen : view.tags) {
    Eigen::Index row = 0;
    for (const PlatePoint& corner : corners_of(board, board.tags[seen.tag])) {
      const auto pixel = project(camera, pose * Eigen::Vector3d(corner.x, corner.y, 0));
      worst = std::max(worst, (seen.pixels.segment<2>(row) - *pixel).norm());
      row += 2;
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("every tag of a board in a photo is seen where it is") {
  const Board board = test::plate_board();
  const Camera camera{1280, 960, 900, 900, 650, 470, {-0.2, 0.05}};
  const Pose pose =
      test::camera_from_board(camera, board, {Vector2d(640, 480), 0.8, 0.4, -0.3, 0.2});
  const GrayImage image = photo_of(camera, board, pose, 1);
  const BoardView view = read_board_view(image.view(), "a.jpg", {&board, 1});
  CHECK(view.file == "a.jpg");
  CHECK(view.width == 1280);
  CHECK(view.tags.size() == board.tags.size());
  CHECK(worst_corner(view, camera, board, pose) < 0.4);
  // Through the lens they are ten times as exact.
  const BoardView again =
      read_board_view_again(image.view(), view, {&board, 1}, {camera, {{0, pose}}});
  CHECK(again.tags.size() == board.tags.size());
  CHECK(worst_corner(again, camera, board, pose) < 0.1);
}

TEST_CASE("tags that a search misses are found where the board must have them") {
  const Board board = test::plate_board();
  const Camera fisheye{1280, 960, 400, 400, 645, 474, {-0.02, 0.004}, LensModel::fisheye};
  const Pose pose = test::camera_from_board(fisheye, board, {Vector2d(250, 300), 3, 0.6, 0.3, 0.1});
  const GrayImage image = photo_of(fisheye, board, pose, 2);
  const BoardView view = read_board_view(image.view(), "a.jpg", {&board, 1});
  const BoardView again =
      read_board_view_again(image.view(), view, {&board, 1}, {fisheye, {{0, pose}}});
  CHECK(again.tags.size() > view.tags.size());
  CHECK(worst_corner(again, fisheye, board, pose) < 0.3);
}

TEST_CASE("copies, mirrored photos and those with two prints of a board do not count") {
  const Board board = test::plate_board();
  const Camera camera{1280, 960, 900, 900, 650, 470, {-0.2, 0.05}};
  const Pose pose =
      test::camera_from_board(camera, board, {Vector2d(420, 480), 0.4, 0.4, -0.3, 0.2});
  const Pose other =
      test::camera_from_board(camera, board, {Vector2d(900, 470), 0.4, -0.2, 0.3, 1.0});
  const GrayImage image = photo_of(camera, board, pose, 1);
  GrayImage mirrored = image;
  for (int y = 0; y < image.height; ++y) {
    const auto row = mirrored.samples.begin() + std::ptrdiff_t{y} * image.width;
    std::reverse(row, row + image.width);
  }
  ViewOptions options;
  options.sensor.noise_sigma = 2;
  const std::array both{test::board_plate(board, pose), test::board_plate(board, other)};
  std::vector<BoardView> views;
  for (const GrayImage& each :
       {image, photo_of(camera, board, other, 2), photo_of(camera, board, pose, 3), mirrored,
        render_view(camera, both, options).image}) {
    views.push_back(read_board_view(each.view(), fmt::format("{}.jpg", views.size()), {&board, 1}));
  }
  object_to_views({&board, 1}, views);
  CHECK(views[0].objection.empty());
  CHECK(views[1].objection.empty());
  CHECK(views[2].objection == "shows the boards from where 0.jpg does: no new photo");
  CHECK(views[3].objection.find("mirrored") != std::string::npos);
  CHECK(views[4].objection.find("two prints of the board") != std::string::npos);
  for (std::size_t i = 0; i < views.size(); ++i) CHECK(views[i].tags.empty() == (i > 1));
}

TEST_CASE("a camera is calibrated from photos, and every photo is read twice") {
  const Board board = test::plate_board();
  const Camera camera{1280, 960, 900, 900, 650, 470, {-0.2, 0.05}};
  Draws draws(3);
  std::vector<GrayImage> images;
  PhotoSource photos;
  for (std::size_t i = 0; i < 10; ++i) {
    const Pose pose = test::camera_from_board(camera, board, test::varied_stance(camera, i, draws));
    images.push_back(photo_of(camera, board, pose, i));
    photos.files.push_back("photo" + std::to_string(i));
  }
  photos.load = [&](std::size_t i) -> Result<GrayImage> { return images[i]; };
  PhotoCalibrationOptions options;
  std::size_t told = 0;
  options.on_read = [&](std::size_t done, std::size_t of) {
    CHECK(done == ++told);
    CHECK(of == 20);
  };
  const auto result = calibrate_photos(photos, {&board, 1}, options);
  REQUIRE(result.has_value());
  CHECK(told == 20);
  const auto assessment = assess_calibration(result->calibration, result->views, {&board, 1});
  CHECK(assessment.trust == CalibrationTrust::good);
  CHECK(result->calibration.camera.fx == doctest::Approx(900).epsilon(3e-4));
  CHECK(std::abs(result->calibration.camera.cx - 650) < 0.3);
  CHECK(std::abs(result->calibration.camera.cy - 470) < 0.3);

  photos.load = [](std::size_t) -> Result<GrayImage> { return fail("a.jpg: is no picture"); };
  const auto none = calibrate_photos(photos, {&board, 1});
  REQUIRE_FALSE(none.has_value());
  CHECK(none.error().message == "a.jpg: is no picture");
}
