// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/annotate.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include "decoder/image/exif.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "tests/support/exif_jpeg.hpp"

namespace tagsmith::detail {
namespace {

// A white picture of 400 x 300 as a JPEG file that says it is to be turned so.
std::string jpeg_turned(int orientation) {
  const GrayImage white{400, 300, std::vector<std::uint8_t>(400 * 300, 255)};
  const std::string jpeg = encode_gray_image("a.jpg", white.view()).value();
  if (orientation == 0) return jpeg;
  return test::with_orientation(jpeg, orientation);
}

// A black mark whose P is at (50, 40).
std::vector<PictureMark> mark() {
  return {{{{{50, 40}, {150, 40}, {150, 90}, {50, 90}}}, {0, 0, 0}, {}}};
}

}  // namespace

TEST_CASE("a picture is turned as EXIF says, and its marks with it") {
  // Where the stored pixel (50, 40) of 400 x 300 comes to lie (CIPA DC-008, Orientation).
  const std::pair<int, int> expected[] = {{50, 40}, {50, 40},  {349, 40},  {349, 259}, {50, 259},
                                          {40, 50}, {259, 50}, {259, 349}, {40, 349}};
  for (int orientation = 0; orientation <= 8; ++orientation) {
    CAPTURE(orientation);
    const std::string jpeg = jpeg_turned(orientation);
    CHECK(exif_orientation(jpeg) == (orientation == 0 ? std::nullopt : std::optional(orientation)));
    const auto copy = annotate_picture("a.jpg", jpeg, mark());
    REQUIRE(copy.has_value());
    CHECK(copy->extension == ".jpg");
    const GrayImage image = decode_gray_image("copy", copy->bytes).value();
    CHECK(image.width == (orientation >= 5 ? 300 : 400));
    const auto [x, y] = expected[orientation];
    CHECK(image.view().at(x, y) < 60);
    CHECK(image.view().at(image.width / 2, image.height / 2) > 200);
    GrayImage stored{400, 300, std::vector<std::uint8_t>(400 * 300, 255)};
    stored.samples[40 * 400 + 50] = 0;
    const GrayImage shown = turn_upright(stored.view(), std::max(1, orientation));
    CHECK(shown.width == image.width);
    CHECK(shown.view().at(x, y) == 0);
  }
}

TEST_CASE("labels stay in the picture, and pictures without loss stay without") {
  const GrayImage white{120, 80, std::vector<std::uint8_t>(120 * 80, 255)};
  const std::string png = encode_gray_image("a.png", white.view()).value();
  std::vector<PictureMark> marks{
      {{{{-1e9, 10}, {40, 10}, {40, 30}, {5, 30}}},
       {200, 0, 0},
       {"a very long text \xCE\xB8", "b"}},
      {{{{60, 60}, {110, 60}, {110, 79}, {60, 79}}}, {0, 120, 0}, {"c"}}};
  const auto copy = annotate_picture("a.png", png, marks, {"caption"});
  REQUIRE(copy.has_value());
  CHECK(copy->extension == ".png");
  CHECK(decode_gray_image("copy", copy->bytes)->width == 120);
}

TEST_CASE("words are white, whole, on a plate that they fill to some part") {
  constexpr int kWidth = 1400, kHeight = 700;
  const GrayImage grey{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 128)};
  const std::string png = encode_gray_image("a.png", grey.view()).value();
  const auto copy = annotate_picture("a.png", png, {}, {"HHHH"});
  REQUIRE(copy.has_value());
  const GrayImage image = decode_gray_image("copy", copy->bytes).value();
  int right = 0, bottom = 0, white = 0, tallest = 0;
  for (int x = 0; x < kWidth; ++x) {
    int tall = 0;
    for (int y = 0; y < kHeight; ++y) {
      if (image.view().at(x, y) != 128) right = std::max(right, x), bottom = std::max(bottom, y);
      tall += image.view().at(x, y) > 240;
    }
    white += tall;
    tallest = std::max(tallest, tall);
  }
  // A seventieth of the picture's longer side is a capital's height.
  CHECK(tallest >= 17);
  CHECK(tallest <= 24);
  CHECK(right > 4 * 10);
  CHECK(right < 8 * 25);
  CHECK(bottom < 60);
  const double share = white / (static_cast<double>(right + 1) * (bottom + 1));
  CHECK(share > 0.05);
  CHECK(share < 0.4);
}

TEST_CASE("a label stands below its mark, or above it where it would not fit, never on it") {
  const GrayImage white{400, 300, std::vector<std::uint8_t>(400 * 300, 255)};
  const std::string png = encode_gray_image("a.png", white.view()).value();
  for (const double top : {20.0, 100.0, 150.0, 195.0}) {
    CAPTURE(top);
    const PictureMark mark{{{{100, top}, {300, top}, {300, top + 100}, {100, top + 100}}},
                           {0, 0, 0},
                           {"one", "two", "three"}};
    const GrayImage copy =
        decode_gray_image("copy", annotate_picture("a.png", png, {mark}).value().bytes).value();
    for (int y = static_cast<int>(top) + 20; y < static_cast<int>(top) + 90; ++y) {
      CHECK(copy.view().at(130, y) == 255);
    }
  }
}

TEST_CASE("what is no picture has no copy") {
  CHECK(!annotate_picture("a", "", {}).has_value());
  CHECK(!annotate_picture("a", "text", {}).has_value());
  CHECK(!annotate_picture("a", jpeg_turned(6).substr(0, 60), {}).has_value());
}

TEST_CASE("orientation that is cut short or out of range is none") {
  const std::string jpeg = jpeg_turned(6);
  for (std::size_t size = 0; size < 38; ++size) {
    CAPTURE(size);
    CHECK(exif_orientation(jpeg.substr(0, size)).value_or(6) == 6);
  }
  CHECK(!exif_orientation(jpeg_turned(9)));
  CHECK(!exif_orientation("\x89PNG\r\n"));
}

}  // namespace tagsmith::detail
