// SPDX-License-Identifier: Apache-2.0
// Tags that the picture's border cuts, read against a code book.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/reader/cut_frame.hpp"
#include "decoder/reader/part_reading.hpp"
#include "decoder/reader/read_part.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/reader/shifted_rows.hpp"
#include "tests/reader/with_book.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::SeenTag;
using tagsmith::detail::test::shift_rows;
using tagsmith::detail::test::with_book;

namespace {

// Of which the left border cuts off the first third.
SeenTag cut_at_left() {
  SeenTag tag;
  tag.view.middle = {30, 90};
  tag.view.slant = {0.0008, 0.0001};
  return tag;
}

// Of which the right border cuts off the last third.
SeenTag cut_at_right() {
  SeenTag tag;
  tag.view.middle = {270, 90};
  tag.view.slant = {0.0008, 0.0001};
  return tag;
}

// What is read of a tag in part, which is that of one code of a book, and nothing else.
PartReading identified_part(const GrayImage& image, std::optional<Camera> camera = {}) {
  ReadOptions options = with_book({"000005140404", "019000700401", "050806630604"});
  options.camera = std::move(camera);
  const ReadResult result = read_tags(image.view(), options);
  CHECK(result.tags.empty());
  REQUIRE(result.parts.size() == 1);
  const PartReading& part = result.parts.front();
  REQUIRE(part.candidates.size() == 1);
  CHECK(to_string(part.candidates.front().digits) == "019000700401");
  CHECK(part.confidence >= kSureWithBook);
  return part;
}

// A picture through a lens that shows what is r pixels from the middle at about r (1 - by r^2).
GrayImage bent(const GrayImage& image, double by) {
  const PixelPoint middle{(image.width - 1) / 2.0, (image.height - 1) / 2.0};
  GrayImage result{image.width, image.height, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const PixelPoint from = PixelPoint{1.0 * x, 1.0 * y} - middle;
      const PixelPoint at = middle + (1 + by * dot(from, from)) * from;
      result.samples.push_back(
          static_cast<std::uint8_t>(std::lround(sample_bilinear(image.view(), at))));
    }
  }
  return result;
}

}  // namespace

TEST_CASE("a tag that the border cuts is identified by the digits in sight") {
  for (const SeenTag& tag : {cut_at_left(), cut_at_right()}) {
    CAPTURE(tag.view.middle.x);
    const PartReading part = identified_part(tag.image());
    CHECK(part.share > 0.6);
    CHECK(part.share < 0.7);
    CHECK(farthest_apart(part.corners, tag.corners()) < 0.5);
    const bool at_left = tag.view.middle.x < 150;
    CHECK(part.corner_in_sight == std::array{!at_left, at_left, at_left, !at_left});
    CHECK(digits_in_sight(part) == (at_left ? "-----0700401" : "0190007-----"));
    // What is out of sight is known less well.
    const Eigen::Index seen = at_left ? 2 : 0, unseen = at_left ? 0 : 2;
    CHECK(part.corner_covariance(unseen, unseen) > part.corner_covariance(seen, seen));
  }
}

TEST_CASE("a part is unsure where a shaken camera's rows carry its bars from a straight line") {
  for (const double turn : {0.0, std::numbers::pi}) {
    for (const double phase : {0.5, 1.5, 2.5, 3.5, 4.5, 5.5}) {
      CAPTURE(turn);
      CAPTURE(phase);
      SeenTag tag = cut_at_left();
      tag.view.turn = turn;
      GrayImage image = tag.image();
      const auto shake = [&](double y) { return 0.4 * std::sin(y / 20 + phase); };
      shift_rows(image, shake);
      const PartReading part = identified_part(image);
      for (std::size_t i = 0; i < 4; ++i) {
        CAPTURE(i);
        const double off = part.corners[i].x - tag.corners()[i].x - shake(tag.corners()[i].y);
        const auto row = static_cast<Eigen::Index>(2 * i);
        CHECK(std::abs(off) < 4 * std::sqrt(part.corner_covariance(row, row)));
      }
    }
  }
}

// The camera of such a picture, to the seventh power of r, and where it sees a point of a straight
// picture.
Camera camera_with_lens(const GrayImage& image, double by) {
  constexpr double kFocal = 375;
  const double f2 = by * kFocal * kFocal;
  Camera camera = camera_from_sensor(image.width, image.height, kFocal, image.width, image.height);
  camera.distortion = {-f2, 3 * f2 * f2, 0, 0, -12 * f2 * f2 * f2};
  return camera;
}

Quad through_lens(const Quad& corners, const Camera& camera) {
  Quad seen{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = project(camera, {(corners[i].x - camera.cx) / camera.fx,
                                        (corners[i].y - camera.cy) / camera.fy, 1});
    REQUIRE(pixel);
    seen[i] = {pixel->x(), pixel->y()};
  }
  return seen;
}

TEST_CASE("a part is placed through a lens that is stated, and is less sure through another") {
  constexpr double kBy = 5e-7;
  for (SeenTag tag : {cut_at_left(), cut_at_right()}) {
    CAPTURE(tag.view.middle.x);
    tag.view.slant = {};  // seen squarely, as any camera may
    const GrayImage image = bent(tag.image(), kBy);
    const Camera camera = camera_with_lens(image, kBy);
    const Eigen::Index unseen = tag.view.middle.x < 150 ? 0 : 2;
    const auto variance = [&](const PartReading& part) {
      return part.corner_covariance(unseen, unseen);
    };
    const PartReading stated = identified_part(image, camera);
    CHECK(farthest_apart(stated.corners, through_lens(tag.corners(), camera)) < 0.5);
    CHECK(variance(identified_part(image)) > 4 * variance(stated));
  }
}

TEST_CASE("half a symbol is not read without a code book") {
  const GrayImage image = cut_at_left().image();
  const ReadResult result = read_tags(image.view());
  CHECK(result.tags.empty());
  CHECK(result.parts.empty());
}

TEST_CASE("all codes with the digits in sight are candidates") {
  const GrayImage image = cut_at_left().image();
  const ReadResult result =
      read_tags(image.view(), with_book({"019000700401", "555500700401", "000005140404"}));
  REQUIRE(result.parts.size() == 1);
  CHECK(result.parts.front().candidates.size() == 2);
  CHECK(result.parts.front().candidates[1].odds == doctest::Approx(1));
}

TEST_CASE("a part of a stranger that differs in one digit in sight is refused") {
  const GrayImage image = cut_at_left().image();
  for (const char* code : {"019000700301", "019000700402", "019000100401"}) {
    CAPTURE(code);
    CHECK(read_tags(image.view(), with_book({code, "000005140404"})).parts.empty());
  }
}

TEST_CASE("a symbol that stands on its head is cut like any other") {
  SeenTag tag = cut_at_left();
  tag.view.turn = 3.14159265358979;
  const GrayImage image = tag.image();
  const ReadResult result = read_tags(image.view(), with_book({"019000700401", "000005140404"}));
  REQUIRE(result.parts.size() == 1);
  CHECK(to_string(result.parts.front().candidates.front().digits) == "019000700401");
  CHECK(digits_in_sight(result.parts.front()) == "0190007-----");
  CHECK(farthest_apart(result.parts.front().corners, tag.corners()) < 0.5);
}

TEST_CASE("too few digits are no part, and dirt over one is not looked through") {
  SeenTag little = cut_at_left();
  little.view.middle = {-50, 90};
  CHECK(read_tags(little.image().view(), with_book({"019000700401"})).parts.empty());
  SeenTag dirty = cut_at_left();
  dirty.covers = {{8, -40, 16, 40, 0.3}};
  const ReadResult result = read_tags(dirty.image().view(), with_book({"019000700401"}));
  for (const PartReading& part : result.parts) {
    CHECK_FALSE(part.in_sight[6]);
    CHECK_FALSE(part.in_sight[7]);
  }
  std::vector<std::string> many{"019000700401"};
  for (int i = 0; i < 20; ++i) many.push_back(std::to_string(123456789000 + 7 * i));
  CHECK(read_tags(dirty.image().view(), with_book(many)).parts.empty());
}

TEST_CASE("digits that something hides are left open, and the others tell which code it is") {
  SeenTag tag;
  tag.view.slant = {0.0008, 0.0001};
  tag.covers = {{-16, -60, -10, 60, 0.04}};
  const GrayImage image = tag.image();
  const PartReading part = identified_part(image);
  CHECK_FALSE(part.in_sight[4]);
  CHECK(std::ranges::count(part.in_sight, true) >= 9);
  CHECK(part.share > 0.85);
  CHECK(part.share < 1);
  CHECK(part.corner_in_sight == std::array{true, true, true, true});
  CHECK(farthest_apart(part.corners, tag.corners()) < 0.1);
  CHECK(read_tags(image.view()).parts.empty());
}

TEST_CASE("a covered stranger that differs in one digit in sight is refused") {
  SeenTag tag;
  tag.covers = {{-16, -60, -10, 60, 0.04}};
  const GrayImage image = tag.image();
  for (const char* code : {"119000700401", "019000700402", "019000100401"}) {
    CAPTURE(code);
    const ReadResult result = read_tags(image.view(), with_book({code, "000005140404"}));
    CHECK(result.tags.empty());
    CHECK(result.parts.empty());
  }
}

TEST_CASE("what hides the end of a tag cuts it like the border") {
  for (const double light : {0.04, 0.2}) {
    CAPTURE(light);
    SeenTag tag;
    tag.covers = {{20, -90, 90, 90, light}};
    const ReadResult result =
        read_tags(tag.image().view(), with_book({"019000700401", "000005140404"}));
    CHECK(result.tags.empty());
    REQUIRE(result.parts.size() == 1);
    const PartReading& part = result.parts.front();
    CHECK(to_string(part.candidates.front().digits) == "019000700401");
    CHECK(digits_in_sight(part).substr(0, 6) == "019000");
    CHECK_FALSE(part.in_sight[9]);
    CHECK(part.corner_in_sight == std::array{true, false, false, true});
    CHECK(farthest_apart(part.corners, tag.corners()) < 1);
  }
}

TEST_CASE("parts are searched with a book, once, and where no tag was read") {
  const SeenTag tag = cut_at_right();
  const GrayImage image = tag.image();
  const auto nothing = [](PixelPoint) { return false; };
  const auto everything = [](PixelPoint) { return true; };
  const Homography map = homography_to(tag.corners());
  const Quad corners = tag.corners();
  // To where the border cuts both long sides.
  const auto at_border = [&](double v) {
    double u = 0;
    while (map(u, v).x < image.width - 1) u += 1e-3;
    return map(u, v);
  };
  const Outline outline{{image.view(), 1, 20, {}},
                        {corners[0], at_border(0), at_border(1), corners[3]}};
  const auto parts_of = [&](const ReadOptions& options, const PartSearch::IsRead& is_read) {
    PartSearch search(options);
    search.note_cut(outline, {});
    search.note_cut(outline, {});
    search.read_cut(image.view(), is_read);
    search.read_cut(image.view(), is_read);
    return search.parts().size();
  };
  CHECK(parts_of(with_book({"019000700401"}), nothing) == 1);
  CHECK(parts_of(with_book({"019000700401"}), everything) == 0);
  CHECK(parts_of({}, nothing) == 0);
  ReadOptions likely;
  likely.likely_codes = {tag.digits};
  CHECK(parts_of(likely, nothing) == 1);
}

TEST_CASE("an outline is noted once for each side that something may hide") {
  SeenTag tag;
  tag.covers = {{20, -90, 90, 90, 0.04}};
  const GrayImage image = tag.image();
  const Homography map = homography_to(tag.corners());
  // To the cover's edge, which begins 20 modules right of the middle.
  const double share = (20 - SeenTag::kLeft) / (2 * -SeenTag::kLeft);
  const Quad frame{tag.corners()[0], map(share, 0), map(share, 1), tag.corners()[3]};
  PartSearch search(with_book({"019000700401"}));
  search.note_hidden_end(image.view(), frame);
  search.note_hidden_end(image.view(), frame);
  search.read_beside(image.view(), [](PixelPoint) { return false; });
  REQUIRE(search.parts().size() == 1);
  CHECK(digits_in_sight(search.parts().front()).substr(0, 6) == "019000");
}

TEST_CASE("rows or columns up to what hides a side are a picture of their own") {
  const GrayImage image{100, 80, std::vector<std::uint8_t>(8000)};
  const auto right =
      picture_beside(image.view(), Quad{PixelPoint{20, 20}, {70, 20}, {60, 50}, {20, 50}});
  REQUIRE(right);
  CHECK(right->view.width == 58);  // up to three pixels before the leftmost of the side's corners
  CHECK(right->view.height == 80);
  CHECK(right->first.x == 0);
  CHECK(right->quad[1].x == doctest::Approx(57));
  CHECK(right->quad[2].x == doctest::Approx(57));
  const auto below =
      picture_beside(image.view(), Quad{PixelPoint{80, 60}, {80, 20}, {20, 20}, {20, 60}});
  REQUIRE(below);
  CHECK(below->first.y == 23);
  CHECK(below->view.height == 57);
  CHECK(below->view.data == image.view().row(23));
  CHECK(below->quad[0].y == doctest::Approx(37));
  CHECK(below->quad[1].y == doctest::Approx(0));
  // Next to nothing is left.
  CHECK_FALSE(picture_beside(image.view(), Quad{PixelPoint{20, 20}, {70, 20}, {22, 50}, {20, 50}}));
}

TEST_CASE("a cut outline is turned so that its side on the border is the second") {
  const GrayImage image{100, 80, std::vector<std::uint8_t>(8000)};
  const PyramidLevel level{image.view()};
  const Quad at_left{PixelPoint{0, 20}, {50, 22}, {51, 60}, {0, 61}};
  const auto cut = cut_by_border(level, at_left);
  REQUIRE(cut);
  CHECK((*cut)[1].x == 0);
  CHECK((*cut)[2].x == 0);
  CHECK((*cut)[0].y == 60);
  CHECK_FALSE(cut_by_border(level, Quad{PixelPoint{20, 20}, {50, 22}, {51, 60}, {20, 61}}));
  // Two borders cut it.
  CHECK_FALSE(cut_by_border(level, Quad{PixelPoint{0, 0}, {50, 0}, {51, 60}, {0, 61}}));
}

TEST_CASE("a side lies on a border that is less than three pixels away, whichever border it is") {
  const GrayImage image{100, 80, std::vector<std::uint8_t>(8000)};
  const PyramidLevel level{image.view()};
  for (const double away : {2.9, 3.1}) {
    CAPTURE(away);
    // The outermost pixels have their centres at 0, and at 99 or 79.
    const double left = away, right = 99 - away, top = away, bottom = 79 - away;
    const std::array<Quad, 4> quads{{{{{left, 20}, {50, 20}, {50, 60}, {left, 60}}},
                                     {{{50, 20}, {right, 20}, {right, 60}, {50, 60}}},
                                     {{{20, top}, {70, top}, {70, 40}, {20, 40}}},
                                     {{{20, 40}, {70, 40}, {70, bottom}, {20, bottom}}}}};
    for (const Quad& quad : quads) {
      CAPTURE(centre_of(quad).x);
      CAPTURE(centre_of(quad).y);
      CHECK(cut_by_border(level, quad).has_value() == (away < 3));
    }
  }
}

TEST_CASE("three sides, the proportions and the camera say where the far side is") {
  Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  const FrameShape shape;
  // A plate 400 modules away, turned by 0.6 radians about its bars, and leaning a little.
  const double c = std::cos(0.6), s = std::sin(0.6);
  const Eigen::Vector3d along(c, 0.05, s), at(-150, -20, 400);
  const Eigen::Vector3d down = Eigen::Vector3d(0.02, 1, -(0.02 * c + 0.05) / s).normalized();
  const Eigen::Vector3d right = shape.length * along.normalized(), below = shape.height * down;
  Quad whole{};
  const std::array<Eigen::Vector3d, 4> corners{at, at + right, at + right + below, at + below};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d pixel = *project(camera, corners[i]);
    whole[i] = {pixel.x(), pixel.y()};
  }
  const Homography map = homography_to(whole);
  const Quad cut{whole[0], map(0.4, 0), map(0.5, 1), whole[3]};
  const auto completed = completed_by_shape(cut, shape, camera);
  REQUIRE(completed);
  CHECK(farthest_apart(*completed, whole) < 1e-6);
  // Whose long sides meet on the wrong side.
  CHECK_FALSE(completed_by_shape(Quad{PixelPoint{0, 0}, {0, 50}, {50, 0}, {0, 50}}, shape, camera));
}

TEST_CASE("a cut frame is fitted by its three sides, and read without a search") {
  const SeenTag tag = cut_at_right();
  const GrayImage image = tag.image();
  Quad rough = tag.corners();
  rough[0].x += 1;
  const auto frame = fit_cut_frame(image.view(), rough, {}, {});
  REQUIRE(frame);
  CHECK(frame->shown == std::array{true, false, true, true});
  CHECK(distance(frame->corners[0], tag.corners()[0]) < 0.1);
  CHECK(distance(frame->corners[3], tag.corners()[3]) < 0.1);
  const Homography map = homography_to(tag.corners());
  const Quad cut{rough[0], map(0.6, 0), map(0.6, 1), rough[3]};
  const auto part = read_part(image.view(), cut, with_book({"019000700401"}));
  REQUIRE(part);
  CHECK(digits_in_sight(*part) == "0190007-----");
  // A lens that bends says nothing of what is beyond the border.
  ReadOptions bent = with_book({"019000700401"});
  bent.camera = Camera{300, 180, 375, 375, 149.5, 89.5, {0.1}};
  CHECK_FALSE(read_part(image.view(), cut, bent));
}
