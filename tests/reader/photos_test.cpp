// SPDX-License-Identifier: Apache-2.0
// The shipped ray-traced photos: every fully visible tag is read, nothing is misread, and corners
// are where the truth says.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"

using namespace tagsmith::detail;
namespace fs = std::filesystem;

namespace {

struct Tally {
  int visible = 0;
  int read = 0;
  int wrong = 0;
  std::vector<double> errors;  // per coordinate, pixels
};

void compare(const ReadResult& result, const nlohmann::json& plates, double least_module_px,
             Tally& tally) {
  for (const Reading& reading : result.tags) {
    const auto same = [&](const auto& plate) {
      return plate.value("code", std::string()) == to_string(reading.digits);
    };
    tally.wrong += std::none_of(plates.begin(), plates.end(), same) ? 1 : 0;
  }
  for (const auto& plate : plates) {
    if (plate.at("kind") != "upca" || !plate.at("frame_in_image").get<bool>()) continue;
    if (plate.at("px_per_module").get<double>() < least_module_px) continue;
    ++tally.visible;
    const auto found = std::ranges::find_if(result.tags, [&](const Reading& reading) {
      return to_string(reading.digits) == plate.at("code").get<std::string>();
    });
    if (found == result.tags.end()) continue;
    ++tally.read;
    const char* names[] = {"P", "F", "R", "Q"};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& corner = plate.at("corners_px").at(names[i]);
      tally.errors.push_back(std::abs(found->corners[i].x - corner.at(0).get<double>()));
      tally.errors.push_back(std::abs(found->corners[i].y - corner.at(1).get<double>()));
    }
  }
}

Tally read_folder(const fs::path& folder, double least_module_px) {
  const auto truth = test::parsed_json(test::contents(folder / "truth.json"));
  Tally tally;
  ReadOptions options;
  options.check = parse_check_digit(truth.at("check").get<std::string>());
  for (const auto& item : truth.at("images")) {
    const auto image = load_gray_image(folder / item.at("file").get<std::string>());
    REQUIRE_MESSAGE(image.has_value(), item.at("file"));
    compare(read_tags(image->view(), options), item.at("plates"), least_module_px, tally);
  }
  return tally;
}

}  // namespace

TEST_CASE("shipped photos are read completely, rightly and sharply") {
  struct Case {
    const char* folder;
    int visible;
    double largest_median_error;  // pixels
  };
  // The curved set's tags of less than a pixel a module are seen at 75 to 78 degrees.
  const Case cases[] = {{"surveys/corridor/photos", 20, 0.02}, {"surveys/curved/photos", 12, 0.02}};
  for (const Case& example : cases) {
    CAPTURE(example.folder);
    const Tally tally = read_folder(example.folder, 1.0);
    CHECK(tally.visible == example.visible);
    CHECK(tally.read == example.visible);
    CHECK(tally.wrong == 0);
    std::vector<double> errors = tally.errors;
    REQUIRE_FALSE(errors.empty());
    std::ranges::sort(errors);
    CHECK(errors[errors.size() / 2] < example.largest_median_error);
    CHECK(errors.back() < 0.15);
  }
}

TEST_CASE("a picture turned by quarter and half turns gives the same tags") {
  const auto image = load_gray_image("surveys/corridor/photos/corridor_01_left.jpg");
  REQUIRE(image.has_value());
  const ReadResult upright = read_tags(image->view());
  REQUIRE(upright.tags.size() == 1);
  const GrayImage& source = *image;
  GrayImage turned{source.height, source.width, {}};
  for (int y = 0; y < turned.height; ++y) {
    for (int x = 0; x < turned.width; ++x) {
      turned.samples.push_back(source.view().at(y, source.height - 1 - x));
    }
  }
  const ReadResult quarter = read_tags(turned.view());
  REQUIRE(quarter.tags.size() == 1);
  CHECK(to_string(quarter.tags[0].digits) == to_string(upright.tags[0].digits));
  const PixelPoint p = upright.tags[0].corners[0];
  CHECK(distance(quarter.tags[0].corners[0], {source.height - 1 - p.y, p.x}) < 0.02);
  GrayImage half{source.width, source.height, source.samples};
  std::ranges::reverse(half.samples);
  const ReadResult upside_down = read_tags(half.view());
  REQUIRE(upside_down.tags.size() == 1);
  CHECK(to_string(upside_down.tags[0].digits) == to_string(upright.tags[0].digits));
  CHECK(distance(upside_down.tags[0].corners[0],
                 {source.width - 1 - p.x, source.height - 1 - p.y}) < 0.02);
}

TEST_CASE("a mirrored picture reads as the tag upside down: the bars are the same") {
  const auto image = load_gray_image("surveys/corridor/photos/corridor_01_left.jpg");
  REQUIRE(image.has_value());
  const ReadResult straight = read_tags(image->view());
  GrayImage mirrored = *image;
  for (int y = 0; y < mirrored.height; ++y) {
    const auto row = mirrored.samples.begin() + static_cast<std::ptrdiff_t>(y) * mirrored.width;
    std::reverse(row, row + mirrored.width);
  }
  const ReadResult result = read_tags(mirrored.view());
  REQUIRE(result.tags.size() == 1);
  CHECK(to_string(result.tags[0].digits) == to_string(straight.tags[0].digits));
  const PixelPoint q = straight.tags[0].corners[3];  // lower left appears lower right, taken for P
  CHECK(distance(result.tags[0].corners[0], {image->width - 1 - q.x, q.y}) < 0.05);
}

TEST_CASE("exposure changes no digit") {
  const auto image = load_gray_image("surveys/corridor/photos/corridor_04_right.jpg");
  REQUIRE(image.has_value());
  for (const double gain : {0.15, 0.5, 1.2}) {
    CAPTURE(gain);
    GrayImage exposed = *image;
    for (auto& sample : exposed.samples) {
      sample = static_cast<std::uint8_t>(std::min(255.0, sample * gain));
    }
    const ReadResult result = read_tags(exposed.view());
    REQUIRE(result.tags.size() == 1);
    CHECK(to_string(result.tags[0].digits) == "000001940408");
  }
}

TEST_CASE("a code book keeps strangers out") {
  const auto image = load_gray_image("surveys/corridor/photos/corridor_04_right.jpg");
  REQUIRE(image.has_value());
  ReadOptions options;
  options.code_book = {*parse_digits("000001940408")};
  CHECK(read_tags(image->view(), options).tags.size() == 1);
  options.code_book = {*parse_digits("000001140400"), *parse_digits("000002740407")};
  const ReadResult result = read_tags(image->view(), options);
  CHECK(result.tags.empty());
  CHECK_FALSE(result.rejected.empty());
}

TEST_CASE("tiny and empty images are no trouble") {
  CHECK(read_tags({}).tags.empty());
  for (const int size : {1, 2, 7, 8, 21}) {
    const GrayImage image{
        size, size,
        std::vector<std::uint8_t>(static_cast<std::size_t>(size) * static_cast<std::size_t>(size))};
    CHECK(read_tags(image.view()).tags.empty());
  }
}
