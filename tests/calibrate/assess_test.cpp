// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/assess.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tests/support/board_photos.hpp"

using namespace tagsmith::detail;
using Eigen::Vector2d;
using test::BoardStance;
using test::Draws;

namespace {

struct Assessed {
  CameraCalibration calibration;
  CalibrationAssessment assessment;

  const CalibrationFinding* find(CalibrationIssue issue) const {
    const auto found = std::ranges::find(assessment.findings, issue, &CalibrationFinding::issue);
    return found == assessment.findings.end() ? nullptr : &*found;
  }
};

Assessed assessed(const std::vector<BoardView>& views, const Board& board) {
  auto calibration = calibrate_camera(views, {&board, 1});
  REQUIRE(calibration.has_value());
  Assessed result{*calibration, assess_calibration(*calibration, views, {&board, 1})};
  for (const CalibrationFinding& one : result.assessment.findings) {
    CHECK(!one.message.empty());
    CHECK(!one.remedy.empty());
  }
  return result;
}

std::vector<BoardView> views_from(const Camera& camera, const Board& board, std::size_t count,
                                  Draws& draws,
                                  const std::function<BoardStance(std::size_t)>& stance) {
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < count; ++i) {
    views.push_back(
        test::seen_board(camera, board, test::camera_from_board(camera, board, stance(i)), draws));
    views.back().file = "photo" + std::to_string(i);
  }
  return views;
}

BoardStance frontal(double x, double y, double size) {
  BoardStance stance;
  stance.pixel = Vector2d(x, y);
  stance.size = size;
  return stance;
}

// Not off by more than it says, unless it is refused.
void check_honest(const Assessed& result, const Camera& truth) {
  if (result.assessment.trust == CalibrationTrust::refused) return;
  CHECK(std::abs(result.calibration.camera.fx / truth.fx - 1) < 4 * result.assessment.focal_sigma);
  for (const auto& cell : result.assessment.grid.cells) {
    const auto ray = ray_through(truth, cell.worst_pixel);
    if (!ray || !cell.has_ray) continue;
    const auto seen = project(result.calibration.camera, *ray);
    REQUIRE(seen.has_value());
    CHECK((*seen - cell.worst_pixel).norm() < 5 * cell.worst_sigma_px);
  }
}

}  // namespace

TEST_CASE("photos that cover the picture and tilt the board are good, and nothing is said") {
  const Board board = test::plate_board();
  Draws draws(1);
  const Assessed result = assessed(test::seen_boards(test::kWideCamera, board, 15, draws), board);
  CHECK(result.assessment.trust == CalibrationTrust::good);
  CHECK(result.assessment.findings.empty());
  CHECK(result.assessment.focal_sigma < 2e-4);
  CHECK(result.assessment.grid.worst_sigma_px() < 0.5);
}

TEST_CASE(
    "photos of two cameras of one kind, or of a lens that moves, are told and no less certain") {
  const Board board = test::plate_board();
  // Half a pixel of the principal point, or 0.1 % of the focal length, this way and that.
  for (const Vector2d& moved : {Vector2d(0.5, 0), Vector2d(0, 1e-3)}) {
    CAPTURE(moved.transpose());
    Draws draws(11);
    std::vector<BoardView> views;
    const auto camera_of = [&](double way) {
      Camera camera = test::kWideCamera;
      camera.cx += way * moved.x();
      camera.fx *= 1 + way * moved.y();
      camera.fy = camera.fx;
      return camera;
    };
    for (std::size_t i = 0; i < 16; ++i) {
      const Camera camera = camera_of(i % 2 == 0 ? 1 : -1);
      views.push_back(test::seen_boards(camera, board, 16, draws)[i]);
      views.back().file = "photo" + std::to_string(i);
    }
    const Assessed result = assessed(views, board);
    REQUIRE(result.find(CalibrationIssue::photos_differ) != nullptr);
    CHECK(result.assessment.trust != CalibrationTrust::good);
    CHECK(result.calibration.photo_factor > 1.5);
    // The next photo is of one of the two cameras, not of their mean.
    for (const double way : {-1.0, 0.0, 1.0}) check_honest(result, camera_of(way));
  }
}

TEST_CASE("boards seen from the front alone do not tell the focal length") {
  const Board board = test::plate_board();
  const Camera camera{1280, 960, 1100, 1100, 645.2, 473.1};
  Draws draws(2);
  const auto views = views_from(camera, board, 12, draws, [](std::size_t i) {
    return frontal(640 + 20.0 * static_cast<double>(i % 3), 480, 0.8);
  });
  const Assessed result = assessed(views, board);
  CHECK(result.assessment.trust == CalibrationTrust::refused);
  REQUIRE(result.find(CalibrationIssue::all_frontal) != nullptr);
  REQUIRE(result.find(CalibrationIssue::focal_unknown) != nullptr);
  CHECK(result.find(CalibrationIssue::focal_unknown)->measured > 0.01);
}

TEST_CASE("a board nearly parallel to the picture is not tilted, wherever in the picture it is") {
  const Board board = test::plate_board();
  const Camera camera{1280, 960, 800, 800, 645.2, 473.1};
  Draws draws(2);
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < 12; ++i) {
    const double across = i % 2 == 0 ? -0.7 : 0.1, down = i % 3 == 0 ? -0.5 : 0.1;
    Pose pose{Eigen::Matrix3d::Identity(), {across, down, 0.9}};
    pose.rotation = Eigen::AngleAxisd(
        radians(3), i % 2 == 0 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY());
    views.push_back(test::seen_board(camera, board, pose, draws));
  }
  const Assessed result = assessed(views, board);
  const CalibrationFinding* found = result.find(CalibrationIssue::all_frontal);
  REQUIRE(found != nullptr);
  CHECK(found->measured < radians(5));
}

TEST_CASE("few photos are refused or weak, however well they fit") {
  const Board board = test::plate_board();
  for (const auto& [count, trust] :
       {std::pair<std::size_t, CalibrationTrust>{2, CalibrationTrust::refused},
        {5, CalibrationTrust::refused},
        {6, CalibrationTrust::weak},
        {9, CalibrationTrust::weak}}) {
    CAPTURE(count);
    Draws draws(3);
    const Assessed result =
        assessed(test::seen_boards(test::kWideCamera, board, count, draws), board);
    CHECK(result.assessment.trust == trust);
    const CalibrationFinding* found = result.find(CalibrationIssue::too_few_photos);
    REQUIRE(found != nullptr);
    CHECK(found->trust == trust);
    CHECK(found->measured == count);
  }
}

TEST_CASE("a corner of the picture where no board was is named when its rays are not known") {
  const Board board = test::plate_board();
  Draws draws(4);
  const auto views = views_from(test::kWideCamera, board, 8, draws, [&](std::size_t) {
    BoardStance stance = frontal(draws.uniform(420, 520), draws.uniform(340, 420), 0.6);
    stance.yaw = radians(draws.uniform(-40, 40));
    stance.pitch = radians(draws.uniform(-40, 40));
    return stance;
  });
  const Assessed result = assessed(views, board);
  CHECK(result.assessment.trust != CalibrationTrust::good);
  const CalibrationFinding* uncovered = result.find(CalibrationIssue::not_covered);
  REQUIRE(uncovered != nullptr);
  CHECK(std::ranges::find(uncovered->cells, std::size_t{11}) != uncovered->cells.end());
  CHECK(uncovered->message.find("lower right") != std::string::npos);
  const std::string first = "the " + std::string(cell_name(uncovered->cells.front()));
  CHECK(uncovered->message.find(first) != std::string::npos);
  check_honest(result, test::kWideCamera);
}

TEST_CASE("poor sets of photos are refused, weak, or right: never sure and wrong") {
  const Board board = test::plate_board();
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    CAPTURE(seed);
    Draws draws(100 + seed);
    const std::size_t count = 1 + draws.index(6);
    const double most_tilt = radians(draws.uniform(0, 40));
    const double size = draws.uniform(0.2, 1.2);
    const auto views = views_from(test::kWideCamera, board, count, draws, [&](std::size_t) {
      BoardStance stance = frontal(draws.uniform(400, 900), draws.uniform(300, 700), size);
      stance.yaw = draws.uniform(-1, 1) * most_tilt;
      stance.pitch = draws.uniform(-1, 1) * most_tilt;
      return stance;
    });
    const bool is_any =
        std::ranges::any_of(views, [](const BoardView& view) { return view.tags.size() >= 4; });
    if (is_any) check_honest(assessed(views, board), test::kWideCamera);
  }
}

TEST_CASE("photos that each have a focal length of their own make no camera") {
  const Board board = test::plate_board();
  Draws draws(8);
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < 15; ++i) {
    Camera camera = test::kWideCamera;
    camera.fx = camera.fy = 800 * (1 + draws.normal(0.01));
    const Pose pose = test::camera_from_board(camera, board, test::varied_stance(camera, i, draws));
    views.push_back(test::seen_board(camera, board, pose, draws));
  }
  const CalibrationAssessment assessment = assessed(views, board).assessment;
  REQUIRE(assessment.trust == CalibrationTrust::refused);
  // Not first that rays are uncertain, where more photos would not help.
  CHECK(assessment.findings.front().issue == CalibrationIssue::photo_zoomed);
}

TEST_CASE("a photo with another zoom is named") {
  const Board board = test::plate_board();
  for (const double zoom : {1.004, 1.03}) {
    CAPTURE(zoom);
    Camera zoomed = test::kWideCamera;
    zoomed.fx *= zoom;
    zoomed.fy *= zoom;
    Draws draws(5);
    auto views = test::seen_boards(test::kWideCamera, board, 15, draws);
    const auto others = test::seen_boards(zoomed, board, 6, draws);
    views[5] = others[5];
    views[5].file = "zoomed";
    const Assessed result = assessed(views, board);
    const CalibrationFinding* found = result.find(CalibrationIssue::photo_zoomed);
    REQUIRE(found != nullptr);
    CHECK(found->view == std::size_t{5});
    CHECK(found->message.find("zoomed") != std::string::npos);
    CHECK(found->measured == doctest::Approx(zoom - 1).epsilon(0.3));
    check_honest(result, test::kWideCamera);
  }
}

TEST_CASE("a photo in which something moved is named") {
  const Board board = test::plate_board();
  Draws draws(6);
  auto views = test::seen_boards(test::kWideCamera, board, 15, draws);
  for (SeenBoardTag& tag : views[3].tags) {
    for (Eigen::Index i = 0; i < 8; ++i) tag.pixels[i] += draws.normal(0.06);
  }
  const Assessed result = assessed(views, board);
  const CalibrationFinding* found = result.find(CalibrationIssue::photo_contradicts);
  REQUIRE(found != nullptr);
  CHECK(found->view == std::size_t{3});
  check_honest(result, test::kWideCamera);
}

TEST_CASE("a photo that is left out is said to contradict, not by how many times it does") {
  const Board board = test::plate_board();
  Draws draws(6);
  auto views = test::seen_boards(test::kWideCamera, board, 15, draws);
  for (std::size_t i = 0; i < views[3].tags.size(); ++i) {
    const double way = i % 2 == 0 ? 3 : -3;
    views[3].tags[i].pixels.array() += way;
  }
  const Assessed result = assessed(views, board);
  const CalibrationFinding* found = result.find(CalibrationIssue::photo_contradicts);
  REQUIRE(found != nullptr);
  CHECK(found->message.find("left out") != std::string::npos);
  CHECK(found->message.find("times") == std::string::npos);
}

TEST_CASE("a bent board and one of another shape are named") {
  const Board board = test::plate_board(0.0002);
  Draws draws(7);
  const auto bent = [](const Vector2d& drawn) {
    const double x = drawn.x() / 0.3 - 1;
    return Eigen::Vector3d(drawn.x(), drawn.y(), 0.0015 * x * x);
  };
  const Assessed bowed =
      assessed(test::seen_boards(test::kWideCamera, board, 15, draws, {1, 0, bent}), board);
  REQUIRE(bowed.find(CalibrationIssue::board_bowed) != nullptr);
  CHECK(bowed.find(CalibrationIssue::board_bowed)->measured ==
        doctest::Approx(0.0015).epsilon(0.1));
  check_honest(bowed, test::kWideCamera);
  const auto wide = [](const Vector2d& drawn) {
    return Eigen::Vector3d(1.005 * drawn.x(), drawn.y(), 0);
  };
  const Assessed stretched =
      assessed(test::seen_boards(test::kWideCamera, board, 15, draws, {1, 0, wide}), board);
  const CalibrationFinding* found = stretched.find(CalibrationIssue::board_stretched);
  REQUIRE(found != nullptr);
  CHECK(found->measured == doctest::Approx(0.005).epsilon(0.2));
  CHECK(found->board == std::size_t{0});
}
