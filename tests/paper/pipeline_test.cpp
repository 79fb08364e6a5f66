// SPDX-License-Identifier: Apache-2.0
#include "decoder/paper/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/image/load.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/json.hpp"

using namespace tagsmith::detail;

namespace {

constexpr std::uint8_t kWall = 70;
constexpr std::uint8_t kWhite = 210;
constexpr std::uint8_t kBlack = 25;

GrayImage plain_image(int width, int height, std::uint8_t gray) {
  return {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), gray)};
}

// Fills the pixels whose centres lie in the rectangle, which is `scale` pixels a metre with P at
// (left, top).
void fill(GrayImage& image, const Rectangle& area, double scale, double left, double top,
          std::uint8_t gray) {
  const auto inside = [](double centre, double start, double length) {
    return centre >= start && centre < start + length;
  };
  for (int y = 0; y < image.height; ++y) {
    if (!inside(y, top + scale * area.y, scale * area.height)) continue;
    for (int x = 0; x < image.width; ++x) {
      if (!inside(x, left + scale * area.x, scale * area.width)) continue;
      image.samples[static_cast<std::size_t>(y * image.width + x)] = gray;
    }
  }
}

constexpr double kLeft = 120;  // of P
constexpr double kTop = 100;

// A plate seen straight on, `module_px` pixels a module.
GrayImage draw_plate(const Digits& digits, double module_px) {
  const TagTemplate tag = test::corridor_template();
  const TagDrawing drawing = draw_tag(tag, digits);
  const double scale = module_px / drawing.module;
  GrayImage image = plain_image(static_cast<int>(240 + scale * tag.frame_inner_length),
                                static_cast<int>(240 + scale * tag.frame_inner_height), kWall);
  fill(image, drawing.plate, scale, kLeft, kTop, kWhite);
  fill(image, drawing.frame_outer, scale, kLeft, kTop, kBlack);
  fill(image, drawing.frame_inner, scale, kLeft, kTop, kWhite);
  for (const Rectangle& bar : drawing.bars) fill(image, bar, scale, kLeft, kTop, kBlack);
  return image;
}

// (1) and (2) as printed, for every t.
int otsu_by_definition(const GrayImage& image) {
  int best = 0;
  double greatest = 0;
  const double count = static_cast<double>(image.samples.size());
  for (int t = 0; t < 256; ++t) {
    double white = 0, white_sum = 0, black = 0, black_sum = 0;
    for (const std::uint8_t sample : image.samples) {
      (sample >= t ? white : black) += 1 / count;
      (sample >= t ? white_sum : black_sum) += sample / count;
    }
    if (white <= 0 || black <= 0) continue;
    const double mean = white_sum + black_sum;
    const double g = white * std::pow(white_sum / white - mean, 2) +
                     black * std::pow(black_sum / black - mean, 2);
    if (g > greatest + 1e-9) {
      greatest = g;
      best = t;
    }
  }
  return best;
}

PixelPoint pixel_of(const nlohmann::json& point) {
  return {point.at(0).get<double>(), point.at(1).get<double>()};
}

// The code of the plate in the picture whose corners P and Q these are, to 3 pixels; empty when
// there is none.
std::string plate_at(const nlohmann::json& plates, const PixelPoint& p, const PixelPoint& q) {
  for (const auto& plate : plates) {
    const auto& corners = plate.at("corners_px");
    if (distance(pixel_of(corners.at("P")), p) < 3 && distance(pixel_of(corners.at("Q")), q) < 3) {
      return plate.at("code").get<std::string>();
    }
  }
  return {};
}

const PaperOutline& largest_outline(const PaperSegmentation& segmentation) {
  REQUIRE_FALSE(segmentation.outlines.empty());
  return segmentation.outlines.front();
}

}  // namespace

TEST_CASE("Otsu's threshold is the one that formula (2) defines") {
  std::mt19937 random(5);
  for (int i = 0; i < 5; ++i) {
    CAPTURE(i);
    std::normal_distribution<double> dark(60 + 10 * i, 20);
    std::normal_distribution<double> light(180, 15);
    GrayImage image = plain_image(60, 40, 0);
    for (std::size_t pixel = 0; pixel < image.samples.size(); ++pixel) {
      const double sample = pixel % 3 == 0 ? light(random) : dark(random);
      image.samples[pixel] = static_cast<std::uint8_t>(std::clamp(sample, 0.0, 255.0));
    }
    CHECK(otsu_threshold(image.view()) == otsu_by_definition(image));
  }
}

TEST_CASE("a sample equal to the threshold is white") {
  GrayImage image = plain_image(20, 20, 40);
  std::fill_n(image.samples.begin(), 200, std::uint8_t{90});
  // Every t in 41..90 separates the two greys; the least is taken.
  CHECK(otsu_threshold(image.view()) == 41);
  std::fill_n(image.samples.begin(), 200, std::uint8_t{41});
  const PaperSegmentation segmentation = segment_paper(image.view());
  CHECK(segmentation.threshold == 41);
  CHECK(segmentation.binary.samples.front() == 1);
  CHECK(segmentation.binary.samples.back() == 0);
}

TEST_CASE("two greys are parted where the darker one ends, however few pixels have them") {
  for (const int dark : {0, 1, 10, 254}) {
    CAPTURE(dark);
    GrayImage image = plain_image(3, 1, 255);
    image.samples[0] = static_cast<std::uint8_t>(dark);
    CHECK(otsu_threshold(image.view()) == dark + 1);
    image.samples[1] = static_cast<std::uint8_t>(dark);
    CHECK(otsu_threshold(image.view()) == dark + 1);
  }
}

TEST_CASE("a picture without rows or columns has no regions") {
  for (const auto& [width, height] : {std::pair(0, 5), std::pair(5, 0), std::pair(0, 0)}) {
    const PaperSegmentation segmentation =
        segment_paper(GrayView{nullptr, width, height, static_cast<std::ptrdiff_t>(width)});
    CHECK(segmentation.outlines.empty());
  }
}

TEST_CASE("a region with holes has its outer outline alone, one within a hole has its own") {
  GrayImage image = plain_image(100, 100, 10);
  fill(image, {10, 10, 80, 80}, 1, 0, 0, 200);
  fill(image, {20, 20, 20, 20}, 1, 0, 0, 10);
  fill(image, {50, 20, 30, 60}, 1, 0, 0, 10);
  CHECK(segment_paper(image.view()).outlines.size() == 1);
  fill(image, {55, 30, 10, 10}, 1, 0, 0, 200);
  const PaperSegmentation segmentation = segment_paper(image.view());
  REQUIRE(segmentation.outlines.size() == 2);
  CHECK(segmentation.outlines[0].area == 79 * 79);
  CHECK(segmentation.outlines[1].area == 9 * 9);
}

TEST_CASE("the steepest point from P is the lower left one at the picture's border too") {
  GrayImage image = plain_image(200, 100, 20);
  fill(image, {100, 5, 90, 90}, 1, 0, 0, 220);
  fill(image, {0, 20, 40, 50}, 1, 0, 0, 220);
  const auto reading = read_paper(segment_paper(image.view()));
  REQUIRE_FALSE(reading.has_value());
  REQUIRE(reading.error().corners.has_value());
  CHECK(reading.error().corners->back().x == 0);
  CHECK(reading.error().corners->back().y == 69);
}

TEST_CASE("opening removes specks that hold no 3x3 square, and keeps larger regions") {
  GrayImage image = plain_image(100, 100, 10);
  fill(image, {20, 20, 30, 10}, 1, 0, 0, 200);
  fill(image, {70, 70, 2, 20}, 1, 0, 0, 200);  // two pixels wide
  const PaperSegmentation segmentation = segment_paper(image.view());
  CHECK(segmentation.outlines.size() == 1);
  CHECK(largest_outline(segmentation).area == 29 * 9);     // through the pixels' centres
  CHECK(segmentation.binary.samples[71 + 100 * 80] == 1);  // I_2 still has the speck
}

TEST_CASE("a clean picture gives P', Q' and the digits") {
  const Digits digits = *parse_digits("019000000404");
  for (const double module_px : {3.0, 4.0, 5.5}) {
    CAPTURE(module_px);
    const GrayImage image = draw_plate(digits, module_px);
    const auto reading = read_paper(segment_paper(image.view()));
    REQUIRE(reading.has_value());
    CHECK(to_string(reading->digits) == to_string(digits));
    CHECK(reading->sum10_holds);
    CHECK_FALSE(reading->gs1_holds);
    CHECK(reading->module_px == doctest::Approx(module_px).epsilon(0.01));
    CHECK(reading->rows_agreeing > 0);
    CHECK(reading->rows_agreeing <= reading->rows_decoded);
    CHECK(reading->rows_decoded <= reading->rows_with_59_elements);
    // The outermost white pixels, so within a pixel of the frame's edges.
    const double height = module_px * 0.168 / (0.343 / 113);
    const double length = module_px * 113;
    CHECK(std::abs(reading->p.x - kLeft) <= 1);
    CHECK(std::abs(reading->p.y - kTop) <= 1);
    CHECK(std::abs(reading->q.x - kLeft) <= 1);
    CHECK(std::abs(reading->q.y - (kTop + height)) <= 1);
    CHECK(std::abs(reading->upper_right.x - (kLeft + length)) <= 1);
    CHECK(std::abs(reading->lower_right.y - (kTop + height)) <= 1);
  }
}

TEST_CASE("a picture without a tag says at which step it failed") {
  const auto blank = read_paper(segment_paper(plain_image(64, 48, 128).view()));
  REQUIRE_FALSE(blank.has_value());
  CHECK(blank.error().step == PaperStep::locate_frame);
  CHECK_FALSE(blank.error().corners.has_value());

  GrayImage patches = plain_image(200, 100, 20);
  fill(patches, {10, 10, 80, 80}, 1, 0, 0, 220);
  fill(patches, {110, 20, 50, 50}, 1, 0, 0, 220);
  const auto no_symbol = read_paper(segment_paper(patches.view()));
  REQUIRE_FALSE(no_symbol.has_value());
  CHECK(no_symbol.error().step == PaperStep::scan_rows);
  REQUIRE(no_symbol.error().corners.has_value());
  CHECK(no_symbol.error().corners->front().x == 110);

  CHECK_FALSE(read_paper(segment_paper(GrayImage{}.view())).has_value());
  CHECK(read_tags_paper(plain_image(1, 1, 0).view()).rejected.size() == 1);
}

TEST_CASE("rows that disagree equally often are a draw") {
  const Digits digits = *parse_digits("019000000404");
  const Digits others = *parse_digits("000004000408");
  GrayImage image = draw_plate(digits, 3);
  const GrayImage other = draw_plate(others, 3);
  // The lower half of the symbol from another tag; the rows of the bars split evenly.
  const auto upper = read_paper(segment_paper(image.view()));
  REQUIRE(upper.has_value());
  int first_row = -1;
  int last_row = -1;
  for (int y = 0; y < image.height; ++y) {
    if (!std::equal(image.view().row(y), image.view().row(y) + image.width, other.view().row(y))) {
      first_row = first_row < 0 ? y : first_row;
      last_row = y;
    }
  }
  const int rows = last_row - first_row + 1;
  const int own_rows = rows / 2;
  for (int y = first_row + own_rows; y < first_row + 2 * own_rows; ++y) {
    std::copy_n(other.view().row(y), image.width,
                image.samples.begin() + static_cast<std::ptrdiff_t>(y) * image.width);
  }
  for (int y = first_row + 2 * own_rows; y <= last_row; ++y) {  // an odd row has no bars
    std::fill_n(image.samples.begin() + static_cast<std::ptrdiff_t>(y) * image.width + 130,
                3 * 113 - 20, kWhite);
  }
  const auto drawn = read_paper(segment_paper(image.view()));
  REQUIRE_FALSE(drawn.has_value());
  CHECK(drawn.error().step == PaperStep::vote);
}

TEST_CASE("the reader refuses a wrong check digit and unknown digits") {
  const Digits digits = *parse_digits("019000000404");
  const GrayImage image = draw_plate(digits, 3);
  ReadOptions options;
  const ReadResult found = read_tags_paper(image.view(), options);
  REQUIRE(found.tags.size() == 1);
  CHECK(found.tags.front().method == ReadingMethod::paper);
  CHECK(found.tags.front().confidence == 1.0);
  CHECK(found.rejected.empty());

  options.check = CheckDigit::gs1;
  const ReadResult wrong_check = read_tags_paper(image.view(), options);
  CHECK(wrong_check.tags.empty());
  REQUIRE(wrong_check.rejected.size() == 1);
  CHECK(wrong_check.rejected.front().reason == RejectionReason::check_digit);

  options.check = CheckDigit::sum10;
  options.code_book = {*parse_digits("019000800402")};
  const ReadResult unknown = read_tags_paper(image.view(), options);
  CHECK(unknown.tags.empty());
  REQUIRE(unknown.rejected.size() == 1);
  CHECK(unknown.rejected.front().reason == RejectionReason::not_in_survey);

  options.code_book.push_back(digits);
  CHECK(read_tags_paper(image.view(), options).tags.size() == 1);
}

// What the method does as published is measured here, not aimed at: the rule of the two largest
// white areas fails where another plate is cut by the border, and a module width taken over the
// whole symbol fails where perspective makes near modules wider than far ones.
TEST_CASE("the corridor photos: right frames in about 14 of 20, digits in about 9, none wrong") {
  const std::string folder = "surveys/corridor/photos/";
  const nlohmann::json truth = test::parsed_json(test::contents(folder + "truth.json"));
  const auto survey = load_survey("surveys/corridor/survey.yaml");
  REQUIRE(survey.has_value());
  int right_frames = 0;
  int right_digits = 0;
  int wrong_digits = 0;
  for (const auto& photo : truth.at("images")) {
    const std::string file = photo.at("file").get<std::string>();
    CAPTURE(file);
    const auto image = load_gray_image(folder + file);
    REQUIRE(image.has_value());
    const auto reading = read_paper(segment_paper(image->view()));
    const auto corners = reading ? FrameCorners{reading->p, {}, {}, reading->q}
                                 : reading.error().corners.value_or(FrameCorners{});
    if (!plate_at(photo.at("plates"), corners[0], corners[3]).empty()) ++right_frames;
    if (!reading) continue;
    const std::string digits = to_string(reading->digits);
    const bool in_picture = std::ranges::any_of(
        photo.at("plates"),
        [&](const nlohmann::json& plate) { return plate.at("code").get<std::string>() == digits; });
    const bool accepted = reading->sum10_holds && find_tag(*survey, reading->digits) != nullptr;
    if (in_picture && accepted) ++right_digits;
    if (!in_picture && accepted) ++wrong_digits;
  }
  MESSAGE("right frames ", right_frames, ", right digits ", right_digits, " of 20");
  CHECK(truth.at("images").size() == 20);
  CHECK(right_frames >= 12);
  CHECK(right_frames <= 15);
  CHECK(right_digits >= 7);
  CHECK(right_digits <= 11);
  CHECK(wrong_digits == 0);
}
