// SPDX-License-Identifier: Apache-2.0
// Symbols without a frame.
#include "decoder/reader/frameless.hpp"

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tests/support/bar_picture.hpp"

namespace tagsmith::detail::test {
namespace {

constexpr const char* kProductCode = "036000291452";  // GS1's own example of a UPC-A number

std::vector<int> elements(const char* text) {
  const auto widths = elements_of(parse_digits(text).value());
  return {widths.begin(), widths.end()};
}

// The codes read in a picture, joined.
std::string read(const std::vector<int>& widths, const BarPicture& how) {
  std::string codes;
  for (const FramelessReading& reading : read_frameless(picture_of(widths, how).view()).read) {
    codes += (codes.empty() ? "" : " ") + to_string(reading.digits);
  }
  return codes;
}

void paint_over(GrayImage& image, PixelPoint centre, int half, std::uint8_t grey) {
  const int middle_x = static_cast<int>(centre.x);
  const int middle_y = static_cast<int>(centre.y);
  for (int y = std::max(0, middle_y - half); y < std::min(image.height, middle_y + half); ++y) {
    for (int x = std::max(0, middle_x - half); x < std::min(image.width, middle_x + half); ++x) {
      image.samples[static_cast<std::size_t>(y * image.width + x)] = grey;
    }
  }
}

}  // namespace

TEST_CASE("a symbol without a frame is read whichever way it is turned") {
  for (const double degrees : {0.0, 20.0, 45.0, 90.0, 137.0, 180.0, 275.0}) {
    CAPTURE(degrees);
    BarPicture how;
    how.roll = degrees * std::numbers::pi / 180;
    CHECK(read(elements(kProductCode), how) == kProductCode);
  }
}

TEST_CASE("blurred, small, bent, crumpled, grown and noisy symbols without a frame are read") {
  BarPicture blurred;
  blurred.blur_px = 1.6;
  BarPicture small;
  small.module_px = 1.3;
  BarPicture large;
  large.module_px = 9;
  BarPicture bottle;
  bottle.module_px = 3;
  bottle.bend = 0.8;
  BarPicture turned;
  turned.module_px = 3;
  turned.incidence = 0.8;
  BarPicture crumpled;
  crumpled.crumple = 2;
  crumpled.module_px = 3;
  BarPicture grown;
  grown.growth = 0.4;
  BarPicture noisy;
  noisy.noise = 20;
  BarPicture faint;
  faint.ink = 0.3;
  faint.paper = 0.45;
  for (const BarPicture& how :
       {blurred, small, large, bottle, turned, crumpled, grown, noisy, faint}) {
    CAPTURE(how.module_px);
    CAPTURE(how.blur_px);
    CAPTURE(how.bend);
    CAPTURE(how.crumple);
    CAPTURE(how.growth);
    CAPTURE(how.noise);
    CAPTURE(how.paper);
    CHECK(read(elements(kProductCode), how) == kProductCode);
  }
}

TEST_CASE("what is no UPC-A symbol with a gs1 check digit is not read") {
  const std::vector<int> code = elements(kProductCode);
  std::vector<int> ean13 = code;  // digits 1, 2 and 4 of the left half in even parity
  for (const int place : {1, 2, 4}) {
    const auto first = ean13.begin() + first_element_of_digit(place);
    std::reverse(first, first + kElementsPerDigit);
  }
  std::vector<int> short_symbol(code.begin(), code.begin() + first_element_of_digit(6));
  short_symbol.insert(short_symbol.end(), {1, 1, 1, 1, 1, 1});
  const std::vector<int> grating(95, 1);
  const std::vector<int> wide_grating(48, 2);
  for (const double module_px : {1.5, 3.0}) {
    BarPicture how;
    how.module_px = module_px;
    CAPTURE(module_px);
    CHECK(read(ean13, how) == "");
    CHECK(read(elements("036000291453"), how) == "");
    CHECK(read(short_symbol, how) == "");
    CHECK(read(grating, how) == "");
    CHECK(read(wide_grating, how) == "");
  }
}

TEST_CASE("a reading without a frame tells its bars' outline and module") {
  BarPicture how;
  how.module_px = 3;
  const GrayImage image = picture_of(elements(kProductCode), how);
  const FramelessResult result = read_frameless(image.view());
  REQUIRE(result.read.size() == 1);
  const FramelessReading& reading = result.read[0];
  CHECK(reading.gs1_holds);
  CHECK(reading.confidence > 1 - 1e-6);
  CHECK(reading.module_px == doctest::Approx(3).epsilon(0.02));
  const double left = (image.width - 95 * 3) / 2.0;
  CHECK(reading.bars[0].x == doctest::Approx(left).epsilon(0.05));
  CHECK(reading.bars[1].x == doctest::Approx(left + 95 * 3).epsilon(0.05));
  CHECK(reading.bars[0].y < reading.bars[3].y);
}

TEST_CASE("a tag with a broken frame is read by its bars, when that is asked for") {
  const auto photo = load_gray_image("surveys/curved/photos/curved_02_left.jpg");
  REQUIRE(photo);
  ReadResult whole = read_tags(photo->view());
  REQUIRE(whole.tags.size() >= 1);
  const auto nearest = std::ranges::max_element(whole.tags, {}, &Reading::module_px);
  GrayImage broken = *photo;  // blots all along every frame
  for (const Reading& tag : whole.tags) {
    for (int blot = 0; blot < 64; ++blot) {
      const auto side = static_cast<std::size_t>(blot / 16);
      const PixelPoint from = tag.corners[side];
      const PixelPoint at = from + (blot % 16) / 16.0 * (tag.corners[(side + 1) % 4] - from);
      paint_over(broken, at, static_cast<int>(4 * tag.module_px), 90);
    }
  }
  CHECK(read_tags(broken.view()).tags.empty());
  CHECK(read_tags(broken.view()).frameless.read.empty());
  ReadOptions options;
  options.frameless = Frameless::fallback;
  const ReadResult result = read_tags(broken.view(), options);
  CHECK(result.tags.empty());
  REQUIRE(result.frameless.read.size() >= 1);
  const auto found = [&](const FramelessReading& reading) {
    return reading.digits == nearest->digits;
  };
  CHECK(std::ranges::any_of(result.frameless.read, found));
  options.frameless = Frameless::always;
  CHECK(read_tags(photo->view(), options).frameless.read.empty());
}

TEST_CASE("images without room for a symbol are no trouble") {
  for (const int side : {0, 1, 2, 3, 9, 30, 100}) {
    const GrayImage image{side, side,
                          std::vector<std::uint8_t>(
                              static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 90)};
    CHECK(read_frameless(image.view()).read.empty());
  }
}

}  // namespace tagsmith::detail::test
