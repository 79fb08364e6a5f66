// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/load.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/resource.h>

#include "decoder/image/exif.hpp"
#include "decoder/image/png_chunks.hpp"
#include "decoder/image/transform.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/image/ramp.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

// The error of loading a file of these bytes; "" when it could be loaded.
std::string error_of(const std::string& bytes, const std::string& name = "image") {
  const test::TemporaryFolder folder;
  const fs::path path = folder.path() / name;
  REQUIRE(write_file(path, bytes));
  const auto image = load_gray_image(path);
  if (image) return "";
  CHECK(image.error().message.find(path.string()) == 0);
  return image.error().message;
}

long peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

// Three by two grey levels without compression, to be shown as the orientation says.
std::string tiff_turned(std::uint8_t orientation, bool greatest_first) {
  std::string bytes = greatest_first ? std::string("MM\0*", 4) : std::string("II*\0", 4);
  const auto put = [&](std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) {
      bytes += static_cast<char>(value >> (8 * (greatest_first ? size - 1 - i : i)));
    }
  };
  const std::pair<std::uint16_t, std::uint16_t> entries[] = {
      {256, 3},   {257, 2},           {258, 8}, {259, 1}, {262, 1},
      {273, 134}, {274, orientation}, {277, 1}, {278, 2}, {279, 6}};
  put(8, 4);
  put(10, 2);
  for (const auto& [tag, value] : entries) {
    put(tag, 2);
    put(3, 2);
    put(1, 4);
    put(value, 2);
    put(0, 2);
  }
  put(0, 4);

  return bytes + std::string("\x0A\x14\x1E\x28\x32\x3C");
}

TEST_CASE("A TIFF's pixels are taken as they are stored, whatever its orientation") {
  for (std::uint8_t orientation = 1; orientation <= 8; ++orientation) {
    for (const bool greatest_first : {false, true}) {
      CAPTURE(int{orientation});
      const std::string tiff = tiff_turned(orientation, greatest_first);
      CHECK(exif_orientation(tiff) == orientation);
      const auto image = decode_gray_image("a.tiff", tiff);
      REQUIRE_MESSAGE(image.has_value(), image.error().message);
      CHECK(image->width == 3);
      CHECK(image->samples == std::vector<std::uint8_t>{10, 20, 30, 40, 50, 60});
    }
  }
}

TEST_CASE("Lossless formats come back as they were") {
  const test::TemporaryFolder folder;
  const GrayImage image = test::ramp(61, 40);
  for (const char* name : {"a.png", "b.tiff", "c.pgm", "d.bmp", "E.PNG"}) {
    CAPTURE(name);
    REQUIRE(save_gray_image(folder.path() / name, image.view()));
    const auto loaded = load_gray_image(folder.path() / name);
    REQUIRE(loaded);
    CHECK(loaded->width == 61);
    CHECK(loaded->height == 40);
    CHECK(loaded->samples == image.samples);
  }
}

TEST_CASE("A view with padded rows is saved without the padding") {
  const test::TemporaryFolder folder;
  const GrayImage image = test::ramp(50, 30);
  const GrayView left{image.samples.data(), 20, 30, 50};
  REQUIRE(save_gray_image(folder.path() / "left.png", left));
  const auto loaded = load_gray_image(folder.path() / "left.png");
  REQUIRE(loaded);
  CHECK(loaded->width == 20);
  CHECK(loaded->samples[20] == image.samples[50]);
}

TEST_CASE("16-bit samples are scaled to 8 bits and rounded") {
  const test::TemporaryFolder folder;
  const std::string pixels("\x00\x00\x80\x80\xFF\xFF\x01\x01", 8);
  REQUIRE(write_file(folder.path() / "deep.pgm", "P5 4 1 65535\n" + pixels));
  const auto image = load_gray_image(folder.path() / "deep.pgm");
  REQUIRE(image);
  CHECK(image->samples == std::vector<std::uint8_t>{0, 128, 255, 1});
}

TEST_CASE("Colour becomes luma") {
  const test::TemporaryFolder folder;
  const std::string pixels("\xFF\x00\x00\x00\xFF\x00\x00\x00\xFF\x64\x64\x64", 12);
  REQUIRE(write_file(folder.path() / "colour.ppm", "P6 4 1 255\n" + pixels));
  const auto image = load_gray_image(folder.path() / "colour.ppm");
  REQUIRE(image);
  // ITU-R BT.601: 0.299, 0.587, 0.114 of 255.
  const std::vector<std::uint8_t> expected{76, 150, 29, 100};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CAPTURE(i);
    CHECK(std::abs(image->samples[i] - expected[i]) <= 1);
  }
}

TEST_CASE("What is no image says so") {
  CHECK(error_of("").find("is empty") != std::string::npos);
  CHECK(error_of("hello, I am text").find("is no image") != std::string::npos);
  CHECK(error_of(std::string(1000, '\0')).find("is no image") != std::string::npos);
  const auto missing = load_gray_image("no/such/image.png");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().message ==
        "no/such/image.png: no such file, nor a folder no/such, nor a folder no");
  CHECK_FALSE(load_gray_image("tests"));
}

TEST_CASE("A file cut short is refused, never half a picture") {
  const GrayImage image = test::ramp(200, 150);
  for (const char* name : {"a.png", "a.jpg", "a.webp", "a.tiff", "a.pgm", "a.bmp"}) {
    const auto bytes = encode_gray_image(name, image.view());
    REQUIRE(bytes);
    CHECK(error_of(*bytes) == "");
    for (const double share : {0.001, 0.02, 0.3, 0.6, 0.9, 0.999}) {
      CAPTURE(name);
      CAPTURE(share);
      const auto size = static_cast<std::size_t>(share * static_cast<double>(bytes->size()));
      CHECK(error_of(bytes->substr(0, size)) != "");
    }
  }
}

TEST_CASE(
    "What a PNG holds besides its pixels is passed over, a wrong checksum of them is refused") {
  const GrayImage image = test::ramp(200, 150);
  const std::string png = encode_gray_image("a.png", image.view()).value();
  constexpr std::size_t kAfterHeader = 33;
  std::string odd = png;
  odd.insert(kAfterHeader, std::string("\0\0\0\3iCCPabc\0\0\0\0", 15));  // no profile at all
  CHECK(png_of_pixels(odd).value() == png_of_pixels(png).value());
  CHECK(decode_gray_image("a.png", odd).value().samples == image.samples);
  std::string corrupted = png;
  corrupted[png.size() / 2] = static_cast<char>(corrupted[png.size() / 2] ^ 1);
  CHECK(error_of(corrupted, "b.png")
            .ends_with("b.png: cannot be decoded, it is damaged or cut short: the checksum of a "
                       "chunk is wrong"));
}

TEST_CASE("A picture is made smaller by whole squares of pixels") {
  const GrayImage wide{7, 3, {0, 2, 4, 6, 8, 10, 99, 2, 4, 6, 8, 10, 12, 99, 9, 9, 9, 9, 9, 9, 9}};
  const GrayImage small = shrunk_to(wide.view(), 4);
  CHECK(small.width == 3);
  CHECK(small.height == 1);
  CHECK(small.samples == std::vector<std::uint8_t>{2, 6, 10});
  CHECK(shrunk_to(wide.view(), 7).samples == wide.samples);
  const GrayImage line{9, 1, std::vector<std::uint8_t>(9, 5)};
  CHECK(shrunk_to(line.view(), 4).samples == line.samples);  // a row has no square to lose
}

TEST_CASE("A header that asks for a huge picture is refused before memory is taken") {
  const long before = peak_megabytes();
  const std::string huge = error_of("P5 40000 40000 255\nabc");
  CHECK(huge.find(" 40000 x 40000 ") != std::string::npos);
  CHECK(huge.find(" 200 million") != std::string::npos);
  auto png = *encode_gray_image("a.png", test::ramp(8, 8).view());
  png.replace(16, 8, std::string("\x00\x00\xFF\xFF\x00\x00\xFF\xFF", 8));
  CHECK(error_of(png).find("65535 x 65535") != std::string::npos);
  auto jpeg = *encode_gray_image("a.jpg", test::ramp(8, 8).view());
  const std::size_t frame = jpeg.find("\xFF\xC0");
  REQUIRE(frame != std::string::npos);
  jpeg.replace(frame + 5, 4, std::string("\xFF\xFF\xFF\xFF", 4));
  CHECK(error_of(jpeg).find("65535 x 65535") != std::string::npos);
  CHECK(peak_megabytes() - before < 200);
}

TEST_CASE("Saving needs a format and a place") {
  const GrayImage image = test::ramp(5, 5);
  const auto unknown = save_gray_image("image.xyz", image.view());
  REQUIRE_FALSE(unknown);
  CHECK(unknown.error().message.starts_with("image.xyz"));
  CHECK(unknown.error().message.find(" .png ") < unknown.error().message.find(" .jpg"));
  CHECK(unknown.error().message.find(" .jpg") != std::string::npos);
  CHECK_FALSE(save_gray_image("image", image.view()));
  CHECK_FALSE(save_gray_image("/proc/no/such/image.png", image.view()));
  CHECK_FALSE(save_gray_image("empty.png", GrayView{}));
}

TEST_CASE("JPEG quality decides the size") {
  const GrayImage image = test::ramp(300, 200);
  const auto fine = encode_gray_image("a.jpg", image.view(), 95);
  const auto coarse = encode_gray_image("a.jpg", image.view(), 30);
  REQUIRE(fine);
  REQUIRE(coarse);
  CHECK(coarse->size() < fine->size());
}

}  // namespace
TEST_CASE("a damaged JPEG is decoded as far as it goes, with a warning in words") {
  const std::string jpeg = *read_file("surveys/corridor/photos/corridor_01_left.jpg");
  const DecodedImage whole = decode_image("a.jpg", jpeg).value();
  CHECK(whole.warning.empty());
  std::string holed = jpeg;
  holed.erase(jpeg.size() / 2, jpeg.size() / 3);
  const DecodedImage damaged = decode_image("a.jpg", holed).value();
  CHECK(damaged.warning.find("Corrupt JPEG data") != std::string::npos);
  REQUIRE(damaged.image.samples.size() == whole.image.samples.size());
  CHECK(std::equal(whole.image.samples.begin(), whole.image.samples.begin() + 1280 * 100,
                   damaged.image.samples.begin()));

  std::string unknown = jpeg;
  unknown[unknown.find("\xFF\xC0") + 1] = '\xC3';  // lossless, which libjpeg does not know
  const auto refused = decode_image("a.jpg", unknown);
  REQUIRE(!refused);
  CHECK(refused.error().message.starts_with("a.jpg: "));
  CHECK(refused.error().message.find("Unsupported JPEG process") != std::string::npos);
}

TEST_CASE("a JPEG's warning counts what else is odd, if anything") {
  const std::string jpeg = encode_gray_image("a.jpg", test::ramp(200, 150).view()).value();
  int alone = 0, with_others = 0;
  for (std::size_t at = jpeg.size() / 2; at + 2 < jpeg.size(); at += 9) {
    std::string odd = jpeg;
    odd[at] = '\xFF';  // begins a marker
    const auto decoded = decode_image("a.jpg", odd);
    if (!decoded || decoded->warning.empty()) continue;
    CHECK(decoded->warning.find("(and 0 more)") == std::string::npos);
    ++(decoded->warning.ends_with(" more)") ? with_others : alone);
  }
  CHECK(alone > 0);
  CHECK(with_others > 0);
}

TEST_CASE("a PNG says whether it ends too early or a chunk is too long") {
  const std::string png = encode_gray_image("a.png", test::ramp(64, 48).view()).value();
  constexpr std::size_t kEnd = 12;
  const auto problem = [](const std::string& bytes) {
    return png_of_pixels(bytes).error().message;
  };
  CHECK(problem(png.substr(0, png.size() - kEnd)) == "its last chunk is missing");
  CHECK(problem(png.substr(0, png.size() - 1)) == "a chunk goes beyond its end");
}

TEST_CASE("the luma of JPEGs is what OpenCV decodes, grey, colour and progressive") {
  const cv::Mat colour = cv::imread("surveys/corridor/photos/corridor_02_left.jpg");
  cv::Mat grey;
  cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
  for (const cv::Mat& picture : {colour, grey, cv::Mat(grey(cv::Rect(0, 0, 101, 77)))}) {
    for (const int progressive : {0, 1}) {
      std::vector<std::uint8_t> bytes;
      cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
      const cv::Mat expected = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
      const GrayImage image =
          decode_gray_image("a.jpg", std::string(bytes.begin(), bytes.end())).value();
      REQUIRE(image.width == expected.cols);
      CHECK(std::equal(image.samples.begin(), image.samples.end(), expected.datastart));
    }
  }
}

}  // namespace tagsmith::detail
