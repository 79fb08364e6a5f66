// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/calibrate_camera.hpp"

#include <initializer_list>

#include <Eigen/Cholesky>
#include <doctest/doctest.h>

#include "decoder/calibrate/assess.hpp"
#include "decoder/calibrate/ray_sigma.hpp"
#include "tests/support/board_photos.hpp"

using namespace tagsmith::detail;
using Eigen::Vector2d;
using test::Draws;

namespace {

struct NamedCamera {
  const char* name;
  Camera camera;
};

std::vector<NamedCamera> cameras() {
  return {
      {"no distortion", {1280, 960, 1100, 1100, 645.2, 473.1}},
      {"telephoto", {1280, 960, 6000, 6000, 630, 485, {-0.2}}},
      {"k1 0.05", {1280, 960, 1400, 1400, 650, 470, {0.05}}},
      {"k1 -0.35", {1280, 960, 800, 800, 633.5, 488, {-0.35, 0.12}}},
      {"tangential, two focal lengths",
       {1920, 1080, 1000, 1004, 980, 520, {-0.28, 0.09, 0.0012, -0.0009}}},
      {"rational", {1280, 960, 700, 700, 645, 474, {0.6, -0.02, 0, 0, 0.001, 0.95, 0.12, 0.004}}},
      {"fisheye of 180 degrees",
       {1280, 960, 400, 400, 645, 474, {-0.02, 0.004, -0.001, 0.0001}, LensModel::fisheye}},
      {"fisheye of 120 degrees",
       {1280, 960, 640, 640, 631, 484, {0.03, -0.02, 0, 0}, LensModel::fisheye}},
  };
}

// The largest distance, over the picture, between where a camera and its calibration see a ray.
double worst_ray(const Camera& truth, const CameraCalibration& calibration, double& worst_sigmas) {
  double worst = 0;
  for (int x = 0; x <= 10; ++x) {
    for (int y = 0; y <= 10; ++y) {
      const Vector2d pixel(x * (truth.width - 1) / 10.0, y * (truth.height - 1) / 10.0);
      const auto ray = ray_through(truth, pixel);
      if (!ray) continue;
      const auto seen = project(calibration.camera, *ray);
      if (!seen) continue;
      const auto sigma = ray_sigma_px(calibration, *seen);
      const double off = (*seen - pixel).norm();
      worst = std::max(worst, off);
      worst_sigmas = std::max(worst_sigmas, sigma ? off / *sigma : 0);
    }
  }
  return worst;
}

std::size_t count_unused(const CameraCalibration& calibration) {
  return static_cast<std::size_t>(std::ranges::count_if(
      calibration.residuals, [](const TagResidual& tag) { return !tag.used; }));
}

void check_sound(const CameraCalibration& calibration, const Camera& truth) {
  double sigmas = 0;
  const double worst = worst_ray(truth, calibration, sigmas);
  CHECK(worst < 0.4);
  CHECK(sigmas < 4);
}

}  // namespace

TEST_CASE("a camera is found without any guess, to within what it says of itself") {
  const Board board = test::plate_board();
  for (const NamedCamera& one : cameras()) {
    CAPTURE(one.name);
    Draws draws(7);
    const auto views = test::seen_boards(one.camera, board, 15, draws);
    const auto calibration = calibrate_camera(views, {&board, 1});
    REQUIRE(calibration.has_value());
    double sigmas = 0;
    const double worst = worst_ray(one.camera, *calibration, sigmas);
    CHECK(calibration->sigma_factor < 1.06);
    // A long lens looks almost the same wherever its axis is.
    CHECK(worst < (one.camera.fx > 5000 ? 10 : 0.3));
    CHECK(sigmas < 4);
    CHECK(std::abs(calibration->camera.fx - one.camera.fx) <
          3 * std::sqrt(calibration->covariance(0, 0)));
  }
}

// Of these draws of a camera: how many calibrations are good, and how many standard deviations the
// worst ray of those is off.
struct GoodOnes {
  int count = 0;
  double worst_sigmas = 0;
};

GoodOnes good_ones(const Camera& camera, std::initializer_list<unsigned> seeds) {
  const Board board = test::plate_board();
  GoodOnes good;
  for (const unsigned seed : seeds) {
    Draws draws(seed);
    const auto views = test::seen_boards(camera, board, 15, draws);
    const auto calibration = calibrate_camera(views, {&board, 1});
    REQUIRE(calibration.has_value());
    const auto assessment = assess_calibration(*calibration, views, {&board, 1});
    if (assessment.trust != CalibrationTrust::good) continue;
    ++good.count;
    worst_ray(camera, *calibration, good.worst_sigmas);
  }
  return good;
}

TEST_CASE("a wide lens of eight coefficients is right or not called good") {
  const Camera wide{960, 720, 640, 640, 487.3, 351.8, {0.4, 0.05, 0, 0, 0.002, 0.8, 0.15, 0.01}};
  const GoodOnes good = good_ones(wide, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
  CHECK(good.count > 0);
  CHECK(good.worst_sigmas < 4);
}

TEST_CASE("a wide lens is not refused for a form with more coefficients than it shows") {
  const Camera wide{
      1280, 960, 1150, 1150, 645, 474, {0.4, 0.05, 0.0003, -0.0002, 0.002, 0.8, 0.15, 0.01}};
  const GoodOnes good = good_ones(wide, {13, 21, 47, 118, 134});
  CHECK(good.count == 5);
  CHECK(good.worst_sigmas < 4);
}

TEST_CASE("a rich form that turns back beyond the corners read does not refuse a good set") {
  const Camera camera{1280, 960, 800, 800, 633.5, 488, {-0.35, 0.12}};
  const GoodOnes good = good_ones(camera, {23, 32, 66});
  CHECK(good.count == 3);
  CHECK(good.worst_sigmas < 4);
}

// Moves the tag that has the farthest corner outward: that corner by so many pixels, the others, as
// a lens that bends near its border would, by much less.
void move_outermost_tag(std::vector<BoardView>& views, const Camera& camera, double pixels) {
  const Vector2d middle(camera.cx, camera.cy);
  SeenBoardTag* outermost = nullptr;
  double radius = 0;
  for (BoardView& view : views) {
    for (SeenBoardTag& tag : view.tags) {
      for (Eigen::Index i = 0; i < 4; ++i) {
        const double r = (tag.pixels.segment<2>(2 * i) - middle).norm();
        if (r > radius) outermost = &tag;
        radius = std::max(radius, r);
      }
    }
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Vector2d way = outermost->pixels.segment<2>(2 * i) - middle;
    outermost->pixels.segment<2>(2 * i) +=
        pixels * std::pow(way.norm() / radius, 8) * way.normalized();
  }
}

TEST_CASE("one tag near the border that is off does not decide the lens form") {
  const Board board = test::plate_board();
  const Camera camera{1280, 960, 1290, 1290, 639.5, 479.5, {-0.0737, 0.1417}};
  Draws draws(11);
  auto views = test::seen_boards(camera, board, 20, draws);
  move_outermost_tag(views, camera, 0.2);
  const auto calibration = calibrate_camera(views, {&board, 1});
  REQUIRE(calibration.has_value());
  check_sound(*calibration, camera);
  CHECK(count_unused(*calibration) == 1);
  CHECK(assess_calibration(*calibration, views, {&board, 1}).trust == CalibrationTrust::good);
}

TEST_CASE("a rich form that only one tag near the border supports does not refuse a good set") {
  const Board board = test::plate_board();
  for (const auto& [seed, pixels] : {std::pair{1004U, 0.1}, {1007U, 0.1}, {1007U, 0.2}}) {
    CAPTURE(seed);
    CAPTURE(pixels);
    Draws draws(seed);
    auto views = test::seen_boards(test::kWideCamera, board, 20, draws);
    move_outermost_tag(views, test::kWideCamera, pixels);
    const auto calibration = calibrate_camera(views, {&board, 1});
    REQUIRE(calibration.has_value());
    check_sound(*calibration, test::kWideCamera);
    CHECK(assess_calibration(*calibration, views, {&board, 1}).trust == CalibrationTrust::good);
  }
}

TEST_CASE("tags that were misread or moved are left out and spoil nothing") {
  const Board board = test::plate_board();
  Draws draws(3);
  auto views = test::seen_boards(test::kWideCamera, board, 15, draws);
  std::size_t bad = 0;
  for (BoardView& view : views) {
    for (std::size_t i = bad % 7; i < view.tags.size(); i += 11) {
      // By a pixel up to across the picture.
      const double off = std::pow(10.0, draws.uniform(0, 2.5));
      for (Eigen::Index c = 0; c < 4; ++c) view.tags[i].pixels[2 * c + 1] += off;
      ++bad;
    }
    std::swap(view.tags[1].pixels, view.tags[2].pixels);
    bad += 2;
  }
  const auto calibration = calibrate_camera(views, {&board, 1});
  REQUIRE(calibration.has_value());
  check_sound(*calibration, test::kWideCamera);
  CHECK(count_unused(*calibration) >= bad - 15);  // swaps may have swapped what was moved
  CHECK(count_unused(*calibration) <= bad + 3);
}

TEST_CASE("edges that sharpening moves are told from distances") {
  const Board board = test::plate_board();
  Draws draws(4);
  const auto views = test::seen_boards(test::kWideCamera, board, 15, draws, {1, 0.12});
  const auto calibration = calibrate_camera(views, {&board, 1});
  REQUIRE(calibration.has_value());
  check_sound(*calibration, test::kWideCamera);
  CHECK(calibration->edge_px == doctest::Approx(0.12).epsilon(0.05));
}

TEST_CASE("residuals larger than stated raise the covariance, smaller ones lower nothing") {
  const Board board = test::plate_board();
  const auto calibrated = [&](double noise) {
    Draws draws(5);
    const auto views = test::seen_boards(test::kWideCamera, board, 15, draws, {noise});
    return calibrate_camera(views, {&board, 1}).value();
  };
  const CameraCalibration usual = calibrated(1);
  const CameraCalibration noisy = calibrated(3);
  const CameraCalibration quiet = calibrated(0.3);
  CHECK(usual.sigma_factor == doctest::Approx(1).epsilon(0.05));
  CHECK(noisy.sigma_factor == doctest::Approx(3).epsilon(0.05));
  CHECK(quiet.sigma_factor == 1);
  CHECK(noisy.covariance(0, 0) == doctest::Approx(9 * quiet.covariance(0, 0)).epsilon(0.15));
}

TEST_CASE("a board that is bent or stretched is found so, and the camera is right") {
  const Board board = test::plate_board(0.002);
  Draws draws(6);
  const double bow = 0.002, stretch = 0.004;
  const auto warp = [&](const Vector2d& drawn) {
    const Vector2d at(drawn.x() / 0.3 - 1, drawn.y() / 0.2 - 1);
    return Eigen::Vector3d(drawn.x() + stretch / 2 * (drawn.x() - 0.3),
                           drawn.y() - stretch / 2 * (drawn.y() - 0.2), bow * at.x() * at.x());
  };
  const auto views = test::seen_boards(test::kWideCamera, board, 20, draws, {1, 0, warp});
  const auto calibration = calibrate_camera(views, {&board, 1});
  REQUIRE(calibration.has_value());
  const CalibratedBoard& found = calibration->boards[0];
  CHECK(std::abs(found.shape.bow[0] - bow) < 4 * found.sigma.bow[0]);
  CHECK(found.sigma.bow[0] < 2e-5);
  CHECK(std::abs(found.shape.stretch - stretch) < 4 * found.sigma.stretch);
  check_sound(*calibration, test::kWideCamera);
}

TEST_CASE("poses are where the boards stood, to within their covariance") {
  const Board board = test::plate_board();
  Draws draws(8);
  std::vector<BoardView> views;
  std::vector<Pose> truth;
  for (std::size_t i = 0; i < 15; ++i) {
    const Pose pose = test::camera_from_board(test::kWideCamera, board,
                                              test::varied_stance(test::kWideCamera, i, draws));
    BoardView view = test::seen_board(test::kWideCamera, board, pose, draws);
    if (view.tags.size() < 4) continue;
    views.push_back(std::move(view));
    truth.push_back(pose);
  }
  const auto calibration = calibrate_camera(views, {&board, 1});
  REQUIRE(calibration.has_value());
  REQUIRE(calibration->sightings.size() == truth.size());
  const Eigen::Vector3d middle(board.width / 2, board.height / 2, 0);
  double nees = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const CalibratedSighting& sighting = calibration->sightings[i];
    const Eigen::AngleAxisd turn(sighting.camera_from_board.rotation *
                                 truth[i].rotation.transpose());
    Eigen::Matrix<double, 6, 1> off;
    off << sighting.camera_from_board * middle - truth[i] * middle, turn.angle() * turn.axis();
    nees += off.dot(sighting.covariance.ldlt().solve(off)) / 6;
  }
  nees /= static_cast<double>(truth.size());
  CHECK(nees > 0.5);  // poses share the camera's error: far fewer degrees than 90
  CHECK(nees < 1.8);
}

TEST_CASE("two boards in the same photos are placed each by itself") {
  const Board boards[] = {test::plate_board(0, 1), test::plate_board(0, 2)};
  Draws draws(9);
  auto views = test::seen_boards(test::kWideCamera, boards[0], 12, draws);
  const auto others = test::seen_boards(test::kWideCamera, boards[1], 12, draws);
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (SeenBoardTag tag : others[i].tags) {
      tag.board = 1;
      views[i].tags.push_back(tag);
    }
  }
  const auto calibration = calibrate_camera(views, boards);
  REQUIRE(calibration.has_value());
  CHECK(calibration->sightings.size() == 24);
  CHECK(calibration->boards.size() == 2);
  check_sound(*calibration, test::kWideCamera);
}

TEST_CASE("what cannot be calibrated is refused with what to do") {
  const Board board = test::plate_board();
  const auto message = [&](const std::vector<BoardView>& views) {
    const auto calibration = calibrate_camera(views, {&board, 1});
    REQUIRE_FALSE(calibration.has_value());
    return calibration.error().message;
  };
  CHECK(message({}).find("0 of the boards' tags") != std::string::npos);
  Draws draws(10);
  auto views = test::seen_boards(test::kWideCamera, board, 4, draws);
  views[2].width = 640;
  CHECK(message(views).find("photo2: is 640 x 960") != std::string::npos);
  const Board twice[] = {board, board};
  const auto same = check_boards(twice);
  REQUIRE_FALSE(same.has_value());
  CHECK(same.error().message.find("serial") != std::string::npos);
}
