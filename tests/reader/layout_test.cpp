// SPDX-License-Identifier: Apache-2.0
// Plates of other proportions than the paper's, on simulated pictures.
#include <algorithm>
#include <cmath>
#include <span>

#include <doctest/doctest.h>

#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;

namespace {

TagTemplate wide_margins() {
  TagTemplate tag;
  tag.plate_length = 0.5;
  tag.plate_height = 0.36;
  tag.frame_inner_length = 0.4;
  tag.frame_inner_height = 0.22;
  tag.frame_stroke = 0.014;
  tag.quiet_zone_modules = 14;
  tag.margin_modules = 20;
  return tag;
}

// A square frame of a stroke three times as thick as the paper's.
TagTemplate square_frame() {
  TagTemplate tag;
  tag.plate_length = 0.46;
  tag.plate_height = 0.46;
  tag.frame_inner_length = 0.3;
  tag.frame_inner_height = 0.3;
  tag.frame_stroke = 0.032;
  return tag;
}

View picture_of(const TagTemplate& tag, const Digits& digits) {
  Camera camera = camera_from_sensor(480, 360, 0.006, 0.0018, 0.00135);
  ScenePlate plate;
  plate.drawing = draw_tag(tag, digits);
  plate.camera_from_plate = camera_from_turned_plate(camera, plate.drawing, {240, 180}, 2.0,
                                                     radians(25), radians(5), radians(12));
  return render_view(camera, std::span(&plate, 1));
}

}  // namespace

TEST_CASE("the layout of the paper's plates is the default") {
  const auto survey = load_survey("surveys/corridor/survey.yaml");
  REQUIRE(survey.has_value());
  const SymbolLayout layout = layout_of(survey->tag_template);
  CHECK(layout.quiet_zone_modules == 9);
  CHECK(layout.bars_top == doctest::Approx(SymbolLayout{}.bars_top).epsilon(0.01));
  CHECK(layout.bars_bottom == doctest::Approx(SymbolLayout{}.bars_bottom).epsilon(0.01));
}

TEST_CASE("a layout has its quiet zone in modules and its bars in shares of the frame's height") {
  // A module is 0.4 / (95 + 2 * 14) m wide; 20 of them of 0.22 m are left above and below the bars.
  const double margin = 20 * (0.4 / 123) / 0.22;
  const SymbolLayout layout = layout_of(wide_margins());
  CHECK(layout.quiet_zone_modules == 14);
  CHECK(layout.bars_top == doctest::Approx(margin));
  CHECK(layout.bars_bottom == doctest::Approx(1 - margin));
  CHECK(!(layout == SymbolLayout{}));
}

TEST_CASE("a plate with wider margins is read by its own layout, and by no other") {
  const Digits digits = *parse_digits("019000000404");
  const View picture = picture_of(wide_margins(), digits);
  CHECK(read_tags(picture.image.view()).tags.empty());
  ReadOptions options;
  options.layouts = {SymbolLayout{}, layout_of(wide_margins())};
  const ReadResult result = read_tags(picture.image.view(), options);
  REQUIRE(result.tags.size() == 1);
  CHECK(to_string(result.tags[0].digits) == to_string(digits));
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d truth = picture.plates[0].corners[i].value();
    CHECK(distance(result.tags[0].corners[i], {truth.x(), truth.y()}) < 0.05);
  }
}

TEST_CASE(
    "tags of several templates are read, also where these differ only in where the bars end") {
  const TagTemplate paper = load_survey("surveys/corridor/survey.yaml")->tag_template;
  TagTemplate low = paper;  // lower bars
  low.margin_modules += 6;
  REQUIRE(layout_of(low).quiet_zone_modules == layout_of(paper).quiet_zone_modules);
  const Digits digits = *parse_digits("019000800402");
  for (const TagTemplate& drawn : {low, paper, square_frame()}) {
    const View view = picture_of(drawn, digits);
    for (const auto& layouts :
         {std::vector{layout_of(paper), layout_of(low), layout_of(square_frame())},
          std::vector{layout_of(low), layout_of(square_frame()), layout_of(paper)}}) {
      ReadOptions options;
      options.layouts = layouts;
      const ReadResult result = read_tags(view.image.view(), options);
      CAPTURE(drawn.frame_inner_height);
      CAPTURE(drawn.margin_modules);
      CAPTURE(result.rejected.size());
      REQUIRE(result.tags.size() == 1);
      CHECK(result.tags.front().digits == digits);
    }
  }
}

TEST_CASE("the search takes the frame's proportions from the template") {
  const FrameShape shape = layout_of(square_frame()).frame;
  CHECK(shape.length == doctest::Approx(113));
  CHECK(shape.height == doctest::Approx(113));
  CHECK(shape.stroke == doctest::Approx(12.05).epsilon(0.001));
  const Quad quad{{{0, 0}, {226, 0}, {226, 226}, {0, 226}}};
  CHECK(side_of(quad, 0, shape).stroke == doctest::Approx(24.1).epsilon(0.001));
  // Of the paper's frame a square does not show which way its symbol runs.
  CHECK(side_of(quad, 0).stroke == doctest::Approx(226 * 3.95 / std::sqrt(113 * 55.3)));
  const Quad wide{{{0, 0}, {226, 0}, {226, 110.6}, {0, 110.6}}};
  CHECK(side_of(wide, 0).stroke == doctest::Approx(7.9));
  CHECK(side_of(wide, 1).stroke == doctest::Approx(7.9));
}

TEST_CASE("an outline around a thick stroke leads to the frame's inner edge") {
  const Digits digits = *parse_digits("019000000404");
  const View picture = picture_of(square_frame(), digits);
  Quad inner{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d corner = picture.plates[0].corners[i].value();
    inner[i] = {corner.x(), corner.y()};
  }
  const auto found = [&](const CandidateOptions& options) {
    return std::ranges::count_if(find_candidates({picture.image.view()}, options),
                                 [&](const Quad& quad) { return nearly_equal(quad, inner, 3); });
  };
  CandidateOptions options;
  CHECK(found(options) == 1);  // the white inside
  options.shape = layout_of(square_frame()).frame;
  CHECK(found(options) == 2);  // the stroke's outer edge too
  ReadOptions read;
  read.layouts = {layout_of(square_frame())};
  const ReadResult result = read_tags(picture.image.view(), read);
  REQUIRE(result.tags.size() == 1);
  CHECK(to_string(result.tags[0].digits) == to_string(digits));
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(distance(result.tags[0].corners[i], inner[i]) < 0.05);
  }
}

TEST_CASE(
    "several surveys are read with all their layouts, codes and, where they agree, check digit") {
  auto corridor = load_survey("surveys/corridor/survey.yaml");
  auto curved = load_survey("surveys/curved/survey.yaml");
  REQUIRE(corridor.has_value());
  REQUIRE(curved.has_value());
  const std::vector<Survey> both{*corridor, *curved};
  const ReadOptions options = read_options_for(both);
  CHECK(options.code_book.size() == corridor->tags.size() + curved->tags.size());
  CHECK_FALSE(options.check.has_value());  // sum10 and gs1
  CHECK(read_options_for(std::span(both).first(1)).check == CheckDigit::sum10);
  CHECK(read_options_for({}).layouts.size() == 1);
}
