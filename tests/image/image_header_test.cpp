// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/image_header.hpp"

#include <cstdint>
#include <random>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "tests/image/ramp.hpp"

namespace tagsmith::detail {
namespace {

std::string encoded(const std::string& extension, int width = 37, int height = 23) {
  const GrayImage image = test::ramp(width, height);
  const auto bytes = encode_gray_image("image" + extension, image.view());
  REQUIRE(bytes);
  return *bytes;
}

TEST_CASE("The size is read from every format's header") {
  for (const char* extension : {".png", ".jpg", ".webp", ".tiff", ".pgm", ".bmp"}) {
    CAPTURE(extension);
    const auto header = read_image_header(encoded(extension));
    REQUIRE(header);
    CHECK(header->width == 37);
    CHECK(header->height == 23);
    CHECK(header->complete);
  }
}

TEST_CASE("Comments in a PNM header are skipped") {
  const auto header = read_image_header("P5 # by hand\n# 99 98\n 12\t34\n255\n");
  REQUIRE(header);
  CHECK(header->width == 12);
  CHECK(header->height == 34);
}

TEST_CASE("All ten digits count in a PNM header") {
  const auto header = read_image_header("P2\n12345 67890\n255\n");
  REQUIRE(header);
  CHECK(header->width == 12345);
  CHECK(header->height == 67890);
}

TEST_CASE(
    "Bitmaps have a size of two bytes in the oldest header, and rows from the top or bottom") {
  const auto header_of = [](const std::string& size_and_sides) {
    const auto header = read_image_header("BM" + std::string(12, '\0') + size_and_sides);
    return header ? std::pair(header->width, header->height) : std::pair(0U, 0U);
  };
  using namespace std::string_literals;
  CHECK(header_of("\x0C\0\0\0\x80\x02\xE0\x01\x01\0\x18\0"s) == std::pair(640U, 480U));
  CHECK(header_of("\x28\0\0\0\x80\x02\0\0\xE0\x01\0\0\x01\0\x18\0"s) == std::pair(640U, 480U));
  CHECK(header_of("\x28\0\0\0\x80\x02\0\0\x20\xFE\xFF\xFF\x01\0\x18\0"s) == std::pair(640U, 480U));
}

TEST_CASE("A TIFF's sides stand in two or four bytes, the greatest first or last") {
  using namespace std::string_literals;
  const std::string greatest_first =
      "MM\0*\0\0\0\x08\0\x02"
      "\x01\0\0\x03\0\0\0\x01\x02\x80\0\0"
      "\x01\x01\0\x04\0\0\0\x01\0\0\x01\xE0"s;
  const std::string greatest_last =
      "II*\0\x08\0\0\0\x02\0"
      "\0\x01\x03\0\x01\0\0\0\x80\x02\xFF\xFF"
      "\x01\x01\x04\0\x01\0\0\0\xE0\x01\0\0"s;
  for (const std::string& tiff : {greatest_first, greatest_last}) {
    const auto header = read_image_header(tiff);
    REQUIRE(header);
    CHECK(header->width == 640);
    CHECK(header->height == 480);
  }
}

TEST_CASE("Further pages of a TIFF are known from its thumbnail") {
  using namespace std::string_literals;
  const std::string first =
      "II*\0\x08\0\0\0\x02\0"
      "\0\x01\x03\0\x01\0\0\0\x80\x02\0\0"
      "\x01\x01\x03\0\x01\0\0\0\xE0\x01\0\0"
      "\x26\0\0\0"s;  // the next directory is at byte 38
  const std::string page = "\x01\0\xFE\0\x04\0\x01\0\0\0\x02\0\0\0\0\0\0\0"s;
  const std::string thumbnail = "\x01\0\xFE\0\x04\0\x01\0\0\0\x01\0\0\0\0\0\0\0"s;
  REQUIRE(first.size() == 38);
  CHECK(read_image_header(first + page)->has_more);
  CHECK_FALSE(read_image_header(first + thumbnail)->has_more);
  CHECK_FALSE(read_image_header(encoded(".tiff"))->has_more);
  // A directory that names itself as the next one.
  std::string endless = first + thumbnail;
  endless[52] = 38;
  CHECK_FALSE(read_image_header(endless)->has_more);
}

TEST_CASE("An animated WebP is known by its header") {
  using namespace std::string_literals;
  const std::string still = "RIFF\x16\0\0\0WEBPVP8X\x0A\0\0\0\0\0\0\0\x24\0\0\x16\0\0"s;
  REQUIRE(read_image_header(still));
  CHECK_FALSE(read_image_header(still)->has_more);
  std::string animated = still;
  animated[20] = 2;
  CHECK(read_image_header(animated)->has_more);
}

TEST_CASE("A JPEG's thumbnail does not stand in for its end") {
  std::string bytes = encoded(".jpg");
  bytes.insert(2, std::string("\xFF\xE1\x00\x06\xFF\xD8\xFF\xD9", 8));
  CHECK(read_image_header(bytes)->complete);
  bytes.resize(bytes.size() - 40);
  const auto header = read_image_header(bytes);
  REQUIRE(header);
  CHECK(header->width == 37);
  CHECK_FALSE(header->complete);
}

TEST_CASE("No header cut anywhere, nor any flipped byte, is read beyond its end") {
  std::mt19937 random(1);
  for (const char* extension : {".png", ".jpg", ".webp", ".tiff", ".pgm", ".bmp"}) {
    const std::string bytes = encoded(extension);
    for (std::size_t size = 0; size < bytes.size() && size < 800; ++size) {
      // A heap copy of exactly this size, so that the sanitizers see a read beyond it.
      const std::string cut = bytes.substr(0, size);
      const auto header = read_image_header(cut);
      CHECK((!header || header->width == 37));
    }
    for (int i = 0; i < 2000; ++i) {
      std::string changed = bytes;
      changed[random() % changed.size()] = static_cast<char>(random());
      const auto header = read_image_header(changed);
      CHECK((!header || header->height > 0));
    }
  }
}

TEST_CASE("Other files have no header") {
  for (const char* text : {"", "P", "P5", "P5 3", "GIF89a", "hello", "BM", "\xFF\xD8\xFF", "RIFF",
                           "RIFF....WEBP", "II*", "P5 0 10\n255\n", "P9 3 3"}) {
    CAPTURE(text);
    CHECK_FALSE(read_image_header(text));
  }
}

}  // namespace
}  // namespace tagsmith::detail
