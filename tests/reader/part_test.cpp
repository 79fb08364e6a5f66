// SPDX-License-Identifier: Apache-2.0
// Tags that the picture's border cuts, read against a code book.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/reader/cut_frame.hpp"
#include "decoder/reader/part_reading.hpp"
#include "decoder/reader/read_part.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::SeenTag;

namespace {

ReadOptions with_book(const std::vector<std::string>& codes) {
  ReadOptions options;
  for (const std::string& code : codes) options.code_book.push_back(*parse_digits(code));
  return options;
}

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

}  // namespace

TEST_CASE("a tag that the border cuts is identified by the digits in sight") {
  for (const SeenTag& tag : {cut_at_left(), cut_at_right()}) {
    CAPTURE(tag.view.middle.x);
    const GrayImage image = tag.image();
    const ReadResult result =
        read_tags(image.view(), with_book({"000005140404", "019000700401", "050806630604"}));
    CHECK(result.tags.empty());
    REQUIRE(result.parts.size() == 1);
    const PartReading& part = result.parts.front();
    REQUIRE(part.candidates.size() == 1);
    CHECK(to_string(part.candidates.front().digits) == "019000700401");
    CHECK(part.confidence >= kSureWithBook);
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
  CHECK(read_tags(dirty.image().view(), with_book({"019000700401"})).parts.empty());
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
  const auto frame = fit_cut_frame(image.view(), rough, {});
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
