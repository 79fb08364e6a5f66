// SPDX-License-Identifier: Apache-2.0
// Tags with something in front of a part of their bars' height.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>
#include <Eigen/LU>
#include <doctest/doctest.h>

#include "decoder/reader/explain.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;

namespace {

constexpr const char* kCoveredCode = "019002400404";

struct CoveredPicture {
  View view;
  ReadResult result;
};

// How the tag is turned (radians) and where its middle is off the picture's (pixels).
struct Hanging {
  double yaw = 0.3, pitch = 0.1, roll = 0.2;
  Eigen::Vector2d off{0, 0};
  double focal_px = 1600;
};

Camera camera_of_width(int width, double focal_px = 1600) {
  Camera camera;
  camera.width = width;
  camera.height = 340;
  camera.fx = camera.fy = focal_px;
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  return camera;
}

// The tag at 3 px a module, seen a little obliquely, with something in front.
CoveredPicture read_behind(const PlateFinish& finish, const std::string& code = kCoveredCode,
                           const Hanging& pose = {},
                           std::optional<CheckDigit> check = CheckDigit::gs1) {
  const Camera camera = camera_of_width(480, pose.focal_px);
  ScenePlate plate;
  plate.drawing = draw_tag(test::corridor_template(), *parse_digits(code));
  plate.finish = finish;
  const double distance = camera.fx * plate.drawing.module / 3;
  plate.camera_from_plate = camera_from_turned_plate(
      camera, plate.drawing, Eigen::Vector2d(camera.cx, camera.cy) + pose.off, distance, pose.yaw,
      pose.pitch, pose.roll);
  ViewOptions options;
  options.sensor.noise_sigma = 2;
  CoveredPicture picture{render_view(camera, std::span(&plate, 1), options), {}};
  ReadOptions read_options;
  read_options.check = check;
  picture.result = read_tags(picture.view.image.view(), read_options);
  return picture;
}

ReadResult read_covered(const Cover& cover) {
  PlateFinish finish;
  finish.cover = cover;
  return read_behind(finish).result;
}

// Over the frame's stroke and the quiet zone's first part, not over the bars: left, right, above,
// below.
constexpr double kModule = 0.343 / 113, kFrameWidth = 0.343, kFrameHeight = 0.168;
constexpr std::array<Rectangle, 4> kBoardsOverSides{
    {{-0.02, -0.08, 0.02 + 4 * kModule, 0.32},
     {kFrameWidth - 4 * kModule, -0.08, 0.02 + 4 * kModule, 0.32},
     {-0.04, -0.02, 0.42, 0.02 + 4 * kModule},
     {-0.04, kFrameHeight - 4 * kModule, 0.42, 0.02 + 4 * kModule}}};

bool reads_wrongly(const ReadResult& result) {
  return std::ranges::any_of(
      result.tags, [](const Reading& tag) { return to_string(tag.digits) != kCoveredCode; });
}

}  // namespace

TEST_CASE("a board before the upper third of the bars hides nothing") {
  for (const double reflectance : {0.05, 0.3, 0.9}) {
    CAPTURE(reflectance);
    const ReadResult result = read_covered({{0.09, 0.02, 0.17, 0.042}, reflectance});
    REQUIRE(result.tags.size() == 1);
    CHECK(to_string(result.tags[0].digits) == kCoveredCode);
  }
}

TEST_CASE("what hides most of the bars' height is never taken for bars") {
  for (const double reflectance : {0.05, 0.3, 0.5, 0.9}) {
    for (const double height : {0.06, 0.075, 0.09, 0.12}) {
      CAPTURE(reflectance);
      CAPTURE(height);
      const ReadResult result = read_covered({{0.09, 0.025, 0.1, height}, reflectance});
      CHECK_FALSE(reads_wrongly(result));
    }
  }
}

TEST_CASE("a board over a side of the frame: the bars say where the side is, and how surely") {
  for (const Rectangle& board : kBoardsOverSides) {
    CAPTURE(board.x);
    CAPTURE(board.y);
    PlateFinish finish;
    finish.cover = Cover{board, 0.1};
    const CoveredPicture picture = read_behind(finish);
    REQUIRE(picture.result.tags.size() == 1);
    const Reading& tag = picture.result.tags[0];
    CHECK(to_string(tag.digits) == kCoveredCode);
    CHECK(tag.method == ReadingMethod::partly_covered);
    // The explanation shows what decided, with the places that nothing showed.
    REQUIRE(tag.symbol);
    CHECK(tag.symbol->decoding.confidence == tag.confidence);
    const Explanation explanation = explain(picture.result);
    REQUIRE(!explanation.symbols.empty());
    CHECK(explanation.symbols[0].decoding.fit.explained == tag.symbol->decoding.fit.explained);
    for (std::size_t i = 0; i < 4; ++i) {
      CAPTURE(i);
      const Eigen::Vector2d truth = *picture.view.plates.front().corners[i];
      const auto row = static_cast<Eigen::Index>(2 * i);
      const double off = std::hypot(tag.corners[i].x - truth.x(), tag.corners[i].y - truth.y());
      const double sigma = std::sqrt(tag.corner_covariance.block<2, 2>(row, row).trace());
      CHECK(off < 1);
      CHECK(off < 4 * sigma + 0.05);
    }
  }
}

TEST_CASE("a board over a side of a tag that is seen from near, twice as large at one end") {
  for (const double yaw : {-0.8, 0.8}) {
    for (const Rectangle& board : kBoardsOverSides) {
      CAPTURE(yaw);
      CAPTURE(board.x);
      CAPTURE(board.y);
      PlateFinish finish;
      finish.cover = Cover{board, 0.1};
      const CoveredPicture picture =
          read_behind(finish, kCoveredCode, {yaw, 0.1, 0.2, {0, 0}, 800});
      REQUIRE(picture.result.tags.size() == 1);
      CHECK(to_string(picture.result.tags[0].digits) == kCoveredCode);
    }
  }
}

// Paint or a belt across the plate, at every height about the bars' ends, level or not.
TEST_CASE("a band across the bars is not taken for their ends while the frame's own side shows") {
  std::size_t read = 0;
  for (const double height : {0.008, 0.014}) {
    for (double top = 0.014; top < 0.05; top += 0.004) {
      for (const double reflectance : {0.1, 0.4}) {
        CAPTURE(height);
        CAPTURE(top);
        CAPTURE(reflectance);
        PlateFinish finish;
        finish.cover = Cover{{-0.06, top, 0.46, height}, reflectance};
        const CoveredPicture picture = read_behind(finish);
        for (const Reading& tag : picture.result.tags) {
          CHECK(to_string(tag.digits) == kCoveredCode);
          for (std::size_t i = 0; i < 4; ++i) {
            const Eigen::Vector2d truth = *picture.view.plates.front().corners[i];
            CHECK(std::hypot(tag.corners[i].x - truth.x(), tag.corners[i].y - truth.y()) < 1);
          }
          ++read;
        }
      }
    }
  }
  CHECK(read > 20);
}

TEST_CASE("corners at a hidden side are off by what their covariance says") {
  const std::array<Hanging, 4> ways{{{-0.5, 0.1, 0.0, {0.1, -0.4}},
                                     {0.6, -0.2, -0.1, {-0.3, 0.2}},
                                     {0.0, 0.0, 0.05, {0.4, 0.4}},
                                     {-0.2, 0.3, -0.3, {-0.2, 0.3}}}};
  // The corners at the hidden side, of left, right, upper, lower.
  constexpr std::array<std::array<std::size_t, 2>, 4> kAtSide{{{3, 0}, {1, 2}, {0, 1}, {2, 3}}};
  double sum = 0, worst = 0;
  std::size_t count = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    for (const Hanging& way : ways) {
      CAPTURE(side);
      CAPTURE(way.yaw);
      PlateFinish finish;
      finish.cover = Cover{kBoardsOverSides[side], 0.1};
      const CoveredPicture picture = read_behind(finish, kCoveredCode, way);
      REQUIRE(picture.result.tags.size() == 1);
      const Reading& tag = picture.result.tags[0];
      for (const std::size_t i : kAtSide[side]) {
        const Eigen::Vector2d truth = *picture.view.plates.front().corners[i];
        const Eigen::Vector2d off(tag.corners[i].x - truth.x(), tag.corners[i].y - truth.y());
        const auto row = static_cast<Eigen::Index>(2 * i);
        const Eigen::Matrix2d covariance = tag.corner_covariance.block<2, 2>(row, row);
        CHECK(off.norm() < 0.25);
        const double chi_square = off.dot(covariance.inverse() * off);
        sum += chi_square;
        worst = std::max(worst, chi_square);
        ++count;
      }
    }
  }
  // Two degrees of freedom each: their mean is 2 if the covariances are right, less where they
  // promise too little; the worst of 32 exceeds 15 once in sixty times.
  CHECK(sum / static_cast<double>(count) < 2.5);
  CHECK(worst < 15);
}

// Where nothing of the first bars is left below, their place there follows from those above.
TEST_CASE("a corner beside which neither frame nor bars show is placed by the other bars") {
  for (const double from : {0.07, 0.08, 0.09}) {
    for (const double until : {0.11, 0.15, 0.19}) {
      CAPTURE(from);
      CAPTURE(until);
      PlateFinish finish;
      finish.cover = Cover{{-0.06, from, until, 0.3}, 0.8};
      const CoveredPicture picture = read_behind(finish);
      REQUIRE(picture.result.tags.size() == 1);
      const Reading& tag = picture.result.tags[0];
      CHECK(to_string(tag.digits) == kCoveredCode);
      const Eigen::Vector2d truth = *picture.view.plates.front().corners[3];
      const double off = std::hypot(tag.corners[3].x - truth.x(), tag.corners[3].y - truth.y());
      const double sigma = std::sqrt(tag.corner_covariance.block<2, 2>(6, 6).trace());
      CHECK(off < 4 * sigma);
      CHECK(off < 0.3);
    }
  }
}

TEST_CASE("a seventh of the bars' height above a cover is enough") {
  const double start = 0.163 * kFrameHeight + 0.0165;
  for (const int modules : {8, 14, 21}) {
    for (const double reflectance : {0.05, 0.4, 0.82}) {
      CAPTURE(modules);
      CAPTURE(reflectance);
      const ReadResult result =
          read_covered({{45 * kModule, start, modules * kModule, 0.32}, reflectance});
      REQUIRE(result.tags.size() == 1);
      CHECK(to_string(result.tags[0].digits) == kCoveredCode);
    }
  }
}

TEST_CASE("a covered tag beside a clean one is read too") {
  const Camera camera = camera_of_width(960);
  const double module = 0.343 / 113;
  std::array<ScenePlate, 2> plates;
  plates[0].drawing = draw_tag(test::corridor_template(), *parse_digits(kCoveredCode));
  plates[0].finish.cover = Cover{{-0.04, -0.02, 0.42, 0.02 + 4 * module}, 0.1};
  plates[1].drawing = draw_tag(test::corridor_template(), *parse_digits("000001140408"));
  for (std::size_t i = 0; i < 2; ++i) {
    const double distance = camera.fx * plates[i].drawing.module / 3;
    const Eigen::Vector2d middle{240.0 + 480.0 * static_cast<double>(i), camera.cy};
    plates[i].camera_from_plate =
        camera_from_turned_plate(camera, plates[i].drawing, middle, distance, 0.3, 0.1, 0.1);
  }
  ViewOptions options;
  options.sensor.noise_sigma = 2;
  const View view = render_view(camera, plates, options);
  const ReadResult result = read_tags(view.image.view());
  REQUIRE(result.tags.size() == 2);
  for (const Reading& tag : result.tags) {
    const bool covered = to_string(tag.digits) == kCoveredCode;
    CHECK((covered || to_string(tag.digits) == "000001140408"));
    CHECK(tag.method == (covered ? ReadingMethod::partly_covered : ReadingMethod::frame));
  }
}

TEST_CASE("a highlight on the bars is read around") {
  PlateFinish finish;
  finish.glare = Glare{{0.12, 0.11}, 0.025, 1.5};
  const ReadResult result = read_behind(finish).result;
  REQUIRE(result.tags.size() == 1);
  CHECK(to_string(result.tags[0].digits) == kCoveredCode);
}

TEST_CASE("a cable along the bars that turns one digit into another is no part of the code") {
  // Over the second and third module of the sixth digit, a 9 (0001011), which become those of a 7
  // (0111011): the other scheme's check digit holds.
  const std::string code = "019009766589";
  const double module = 0.343 / 113;
  PlateFinish finish;
  finish.cover = Cover{{(9 + 3 + 7 * 5 + 1) * module, -0.08, 2 * module, 0.32}, 0.05};
  const auto is_right = [&](const Reading& tag) { return to_string(tag.digits) == code; };
  const ReadResult clear = read_behind({}, code, {}, std::nullopt).result;
  REQUIRE(clear.tags.size() == 1);
  CHECK(is_right(clear.tags[0]));
  const ReadResult covered = read_behind(finish, code, {}, std::nullopt).result;
  CHECK(std::ranges::all_of(covered.tags, is_right));
}

TEST_CASE("a cable as light as the plate, too, is no part of the code") {
  // Over the same two modules of a 7, which become those of a 9; only the frame's stroke shows it.
  const std::string code = "019007766589";
  const double module = 0.343 / 113;
  for (const double reflectance : {0.75, 0.82, 0.9}) {
    CAPTURE(reflectance);
    PlateFinish finish;
    finish.cover = Cover{{(9 + 3 + 7 * 5 + 1) * module, -0.08, 2 * module, 0.32}, reflectance};
    const ReadResult covered = read_behind(finish, code, {}, std::nullopt).result;
    CHECK(std::ranges::all_of(covered.tags,
                              [&](const Reading& tag) { return to_string(tag.digits) == code; }));
  }
}

TEST_CASE("a digit that no row shows is not filled in from the check digit") {
  // Eight modules wide over the whole height.
  const double module = 0.343 / 113;
  for (const int digit : {0, 5, 11}) {
    CAPTURE(digit);
    const double first = 9 + 3 + 7 * digit + (digit >= 6 ? 5 : 0);
    for (const double reflectance : {0.05, 0.82}) {
      CAPTURE(reflectance);
      const ReadResult result =
          read_covered({{(first - 0.5) * module, -0.08, 8 * module, 0.32}, reflectance});
      CHECK_FALSE(reads_wrongly(result));
      CHECK(result.tags.empty());
    }
  }
}

TEST_CASE("what its frame shows to be covered is not believed by its bars alone") {
  const CoveredPicture picture = read_behind({});
  REQUIRE(picture.result.tags.size() == 1);
  ReadOptions options;
  options.frameless = Frameless::fallback;
  SearchedImage shared(picture.view.image.view());
  ReadResult nothing_found;
  CHECK(with_frameless(shared, options, nothing_found).frameless.read.size() == 1);
  for (const RejectionReason reason : {RejectionReason::covered, RejectionReason::doubtful}) {
    ReadResult refused;
    refused.rejected.push_back({reason, picture.result.tags[0].corners});
    const FramelessResult by_bars = with_frameless(shared, options, refused).frameless;
    CHECK(by_bars.read.empty());
    CHECK(std::ranges::any_of(by_bars.rejected, [&](const FramelessRejection& rejection) {
      return rejection.reason == reason && rejection.bars_are_sure;
    }));
  }
}
