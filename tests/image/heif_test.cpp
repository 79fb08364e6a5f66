// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/heif.hpp"

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "decoder/image/annotate.hpp"
#include "decoder/image/exif.hpp"
#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "tagsmith/base/file.hpp"
#include "tests/image/ramp.hpp"
#include "tests/support/exif_jpeg.hpp"
#include "tests/support/program.hpp"
#include "tests/support/turned_heic.hpp"

namespace tagsmith::detail {
namespace {

// The picture as heif-enc writes it.
std::string heic_of(const cv::Mat& picture, const test::TemporaryFolder& folder) {
  REQUIRE_MESSAGE(test::has_program("heif-enc"), "heif-enc is missing: install libheif-examples");
  const std::string base = (folder.path() / "picture").string();
  REQUIRE(cv::imwrite(base + ".png", picture));
  REQUIRE(test::run_shell("heif-enc -q 95 -o '" + base + ".heic' '" + base + ".png'").exit_code ==
          0);
  return read_file(base + ".heic").value();
}

double mean_difference(const GrayImage& a, const GrayImage& b) {
  REQUIRE(a.width == b.width);
  REQUIRE(a.height == b.height);
  double sum = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    sum += std::abs(static_cast<double>(a.samples[i]) - b.samples[i]);
  }
  return sum / static_cast<double>(a.samples.size());
}

}  // namespace

TEST_CASE("HEIC pictures of ten bits, of grey and of odd sides become grey of eight bits") {
  const test::TemporaryFolder folder;
  for (const int type : {CV_8UC1, CV_16UC3}) {
    CAPTURE(type);
    cv::Mat ramp(61, 127, type);
    const double unit = ramp.depth() == CV_8U ? 1 : 257;
    for (int x = 0; x < ramp.cols; ++x) ramp.col(x).setTo(cv::Scalar::all(2 * x * unit));
    const auto image = decode_gray_image("ramp", heic_of(ramp, folder));
    REQUIRE_MESSAGE(image, image.error().message);
    REQUIRE(image->width >= ramp.cols);  // padding, which a HEIF file crops, is stored
    for (int x = 0; x < ramp.cols; ++x) {
      CAPTURE(x);
      CHECK(std::abs(image->view().at(x, 30) - 2 * x) <= 3);
    }
  }
}

TEST_CASE(
    "a HEIC file's rotation and mirroring are told as EXIF would, and as libheif shows them") {
  REQUIRE_MESSAGE(test::has_program("heif-convert"), "heif-convert: install libheif-examples");
  const test::TemporaryFolder folder;
  cv::Mat picture(64, 128, CV_8UC3);  // each corner is another grey
  picture.setTo(cv::Scalar::all(40));
  picture(cv::Rect(0, 0, 32, 16)).setTo(cv::Scalar::all(250));
  picture(cv::Rect(96, 0, 32, 16)).setTo(cv::Scalar::all(180));
  picture(cv::Rect(0, 48, 32, 16)).setTo(cv::Scalar::all(110));
  const std::string plain = heic_of(picture, folder);
  CHECK_FALSE(heif_orientation(plain));
  const GrayImage stored = decode_gray_image("plain", plain).value();
  for (const std::optional<unsigned> axis :
       {std::optional<unsigned>(), std::optional(0U), std::optional(1U)}) {
    for (unsigned quarters = 0; quarters < 4; ++quarters) {
      CAPTURE(quarters);
      CAPTURE(axis.value_or(9));
      const std::string turned = test::turned_heic(plain, quarters, axis);
      CHECK(decode_gray_image("turned", turned).value().samples == stored.samples);
      const std::string base = (folder.path() / "turned").string();
      REQUIRE(write_file(base + ".heic", turned));
      REQUIRE(test::run_shell("heif-convert '" + base + ".heic' '" + base + ".png'").exit_code ==
              0);
      const GrayImage shown = load_gray_image(base + ".png").value();
      const auto orientation = heif_orientation(turned);
      REQUIRE(orientation);
      CAPTURE(*orientation);
      CHECK(mean_difference(turn_upright(stored.view(), *orientation), shown) < 2);
    }
  }
}

TEST_CASE("a HEIC photo says its lens as the JPEG did that it was made of") {
  const test::TemporaryFolder folder;
  const std::string base = (folder.path() / "photo").string();
  const std::string jpeg = encode_gray_image("a.jpg", test::ramp(64, 64).view()).value();
  REQUIRE(write_file(base + ".jpg", test::with_lens(jpeg, "Phone 7", 26)));
  REQUIRE(test::run_shell("heif-enc -o '" + base + ".heic' '" + base + ".jpg'").exit_code == 0);
  const auto lens = photo_lens(read_file(base + ".heic").value());
  REQUIRE(lens);
  CHECK(lens->camera == "Maker Phone 7");
  CHECK(lens->focal_35_mm == 26);
}

TEST_CASE("a marked copy of a HEIC picture keeps its colours") {
  const test::TemporaryFolder folder;
  cv::Mat picture(64, 128, CV_8UC3, cv::Scalar(30, 90, 200));
  const auto copy = annotate_picture("a.heic", heic_of(picture, folder), {});
  REQUIRE(copy);
  const std::vector<char> bytes(copy->bytes.begin(), copy->bytes.end());
  const cv::Mat shown = cv::imdecode(bytes, cv::IMREAD_COLOR);
  REQUIRE(shown.cols == 128);
  const auto middle = shown.at<cv::Vec3b>(32, 64);
  CHECK(std::abs(middle[0] - 30) <= 6);
  CHECK(std::abs(middle[1] - 90) <= 6);
  CHECK(std::abs(middle[2] - 200) <= 6);
}

TEST_CASE("videos are told by how they begin, and no picture is taken for one") {
  using namespace std::string_literals;
  for (const std::string& bytes : {"\0\0\0\x18"
                                   "ftypmp42"s,
                                   "\0\0\0\x14"
                                   "ftypqt  "s,
                                   "\0\0\0\x08"
                                   "wide\0\0\0\0mdat"s,
                                   "\x1A\x45\xDF\xA3"s, "RIFF\0\0\0\0AVI LIST"s, "\0\0\1\xBA"s}) {
    CHECK(is_video(bytes));
    CHECK_FALSE(is_heif(bytes));
    CHECK(decode_image("x", bytes).error().message.find("ffmpeg -i") != std::string::npos);
  }
  for (const std::string& bytes : {"\0\0\0\x18"
                                   "ftypheic"s,
                                   "\0\0\0\x18"
                                   "ftypmif1"s,
                                   "RIFF\0\0\0\0WEBPVP8 "s, "\xFF\xD8\xFF\xE0"s, "wide"s, ""s}) {
    CHECK_FALSE(is_video(bytes));
  }
}

}  // namespace tagsmith::detail
