// SPDX-License-Identifier: Apache-2.0
// Tags of which the picture's border cuts off the upper or the lower side.
#include "decoder/reader/part_of_height.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/reader/part_reading.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/reader/with_book.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::SeenTag;
using tagsmith::detail::test::with_book;

namespace {

// Of which a border leaves so much of the frame's height, the upper or the lower one.
SeenTag cut_above_or_below(bool is_above, double left, double turn = 0) {
  SeenTag tag;
  const double half = SeenTag::kTop * -tag.view.module_px;
  tag.view.middle.y = is_above ? (2 * left - 1) * half : tag.height - 1 - (2 * left - 1) * half;
  tag.view.turn = turn;
  return tag;
}

std::optional<PartReading> part_of(const SeenTag& tag, const std::vector<std::string>& codes,
                                   std::optional<Camera> camera = {}) {
  const GrayImage image = tag.image();
  ReadOptions options = with_book(codes);
  options.camera = std::move(camera);
  const ReadResult result = read_tags(image.view(), options);
  CHECK(result.tags.empty());
  REQUIRE(result.parts.size() <= 1);
  return result.parts.empty() ? std::nullopt : std::optional(result.parts.front());
}

const std::vector<std::string> kCodes{"000005140404", "019000700401", "050806630604"};
const Camera kCamera{300, 180, 375, 375, 149.5, 89.5, {}};  // of these pictures

}  // namespace

TEST_CASE("a tag that is cut above or below is identified, by two of its corners exactly") {
  for (const bool is_above : {true, false}) {
    for (const double left : {0.4, 0.55, 0.7}) {
      for (const double turn : {0.0, std::numbers::pi}) {
        CAPTURE(is_above);
        CAPTURE(left);
        CAPTURE(turn);
        const SeenTag tag = cut_above_or_below(is_above, left, turn);
        const auto part = part_of(tag, kCodes);
        REQUIRE(part);
        REQUIRE(part->candidates.size() == 1);
        CHECK(digits_in_sight(*part) == "019000700401");
        CHECK(part->confidence >= kSureWithBook);
        CHECK(part->share == doctest::Approx(left).epsilon(0.02));
        const Quad corners = tag.corners();
        for (std::size_t i = 0; i < 4; ++i) {
          const bool in_sight = (is_above == (turn == 0)) == (i >= 2);
          CHECK(part->corner_in_sight[i] == in_sight);
          const PixelPoint off = part->corners[i] - corners[i];
          const auto k = static_cast<Eigen::Index>(2 * i);
          const double along = std::sqrt(part->corner_covariance(k + 1, k + 1));
          CHECK(std::abs(off.x) < 0.15);  // the sides' lines go on straight
          CHECK(std::abs(off.y) < (in_sight ? 0.15 : along));
          // 12 % of the height of 110 pixels, for the camera is not known.
          CHECK(along == doctest::Approx(in_sight ? 0.03 : 13).epsilon(in_sight ? 1.5 : 0.3));
        }
      }
    }
  }
}

TEST_CASE("a camera that is known says better where the side out of sight is") {
  const SeenTag tag = cut_above_or_below(false, 0.6);
  const auto part = part_of(tag, kCodes, kCamera);
  REQUIRE(part);
  CHECK(std::sqrt(part->corner_covariance(5, 5)) < 5);
}

TEST_CASE("an outline that is cut above or below is read without a search, not one cut at an end") {
  SeenTag tag = cut_above_or_below(false, 0.6);
  const GrayImage image = tag.image();
  const Homography map = homography_to(tag.corners());
  const Quad below{map(1, 0), map(1, 0.6), map(0, 0.6), map(0, 0)};
  const auto part = read_part_of_height(image.view(), below, kCamera, with_book(kCodes));
  REQUIRE(part);
  CHECK(digits_in_sight(*part) == "019000700401");
  const Quad at_end{map(0, 0), map(0.6, 0), map(0.6, 0.55), map(0, 0.55)};
  CHECK_FALSE(read_part_of_height(image.view(), at_end, kCamera, with_book(kCodes)));
}

TEST_CASE("cut above or below, no code is read but one of the book") {
  const SeenTag tag = cut_above_or_below(false, 0.6);
  CHECK_FALSE(part_of(tag, {"019000700402", "000005140404"}));
  CHECK_FALSE(part_of(tag, {"019000400401"}));
  CHECK_FALSE(part_of(tag, {}));
}

TEST_CASE("a board along the side in sight is not taken for the side, and makes it unsure") {
  for (const double inside : {0.2, 0.4, 0.6, 0.8}) {  // modules
    CAPTURE(inside);
    SeenTag tag = cut_above_or_below(false, 0.6);
    tag.covers.push_back(
        {SeenTag::kLeft - 8, SeenTag::kTop - 4, tag.right() + 8, SeenTag::kTop + inside, 0.05});
    const auto part = part_of(tag, kCodes, kCamera);
    REQUIRE(part);
    const double off = part->corners[0].y - tag.corners()[0].y;
    const double sigma = std::sqrt(part->corner_covariance(1, 1));
    CHECK(sigma > 0.3);
    CHECK(std::abs(off) < sigma);
  }
}

TEST_CASE("bars of a tag that is cut above or below are not told a second time without a frame") {
  const GrayImage image = cut_above_or_below(false, 0.6).image();
  ReadOptions options = with_book(kCodes);
  options.frameless = Frameless::fallback;
  const ReadResult in_book = read_tags(image.view(), options);
  CHECK(in_book.parts.size() == 1);
  CHECK(in_book.frameless.read.empty());
  options.code_book.clear();
  options.check = CheckDigit::sum10;
  CHECK(read_tags(image.view(), options).frameless.read.size() == 1);
}
