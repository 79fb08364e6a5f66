// SPDX-License-Identifier: Apache-2.0
// What is known of a picture by its hypotheses, with hypotheses made for it.
#include "decoder/reader/tag_hypotheses.hpp"

#include <utility>

#include <doctest/doctest.h>

#include "decoder/feature_frame/frame.hpp"

using namespace tagsmith::detail;
using Source = TagHypothesis::Source;

namespace {

const Digits kOne = *parse_digits("019000900403");
const Digits kOther = *parse_digits("000001940404");

Quad upright(double x, double y, double width, double height) {
  return {{{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}};
}

const Quad kPlate = upright(100, 50, 226, 110.6);  // two pixels a module

TagHypothesis read_at(const Quad& corners, const Digits& digits, double explained) {
  Reading reading;
  reading.digits = digits;
  reading.corners = corners;
  reading.sum10_holds = reading.gs1_holds = true;
  reading.symbol.emplace();
  reading.symbol->frame.corners = corners;
  reading.symbol->decoding.digits = digits;
  reading.symbol->decoding.fit.explained = explained;
  TagHypothesis hypothesis{.rough = corners};
  hypothesis.outcome = std::move(reading);
  return hypothesis;
}

TagHypothesis refused_at(const Quad& corners, RejectionReason reason) {
  TagHypothesis hypothesis{.rough = corners};
  hypothesis.outcome = Rejection{reason, corners};
  return hypothesis;
}

BarRegion bars_at(PixelPoint centre) {
  BarRegion region;
  region.centre = centre;
  region.length = 190;
  region.height = 100;
  return region;
}

}  // namespace

TEST_CASE("of two equal readings in one place the one that explains more stays") {
  for (const bool later_is_better : {true, false}) {
    CAPTURE(later_is_better);
    TagHypotheses found{FrameShape{}};
    found.keep(read_at(kPlate, kOne, 0.97));
    const TagHypothesis& kept = found.keep(read_at(kPlate, kOne, later_is_better ? 0.99 : 0.95));
    CHECK((kept.reading() != nullptr) == later_is_better);
    REQUIRE(found.tags().size() == 1);
    CHECK(found.tags()[0].symbol->decoding.fit.explained == (later_is_better ? 0.99 : 0.97));
    CHECK(found.result(true).rejected.empty());
  }
}

TEST_CASE("of two readings in one place with other digits none stays, in another place both do") {
  TagHypotheses found{FrameShape{}};
  found.keep(read_at(kPlate, kOne, 0.99));
  found.keep(read_at(upright(130, 60, 150, 73), kOther, 0.95));
  CHECK(found.tags().empty());
  CHECK(!found.has_read_any());
  const ReadResult result = found.result(false);
  REQUIRE(result.rejected.size() == 2);
  for (const Rejection& rejection : result.rejected) {
    CHECK(rejection.reason == RejectionReason::doubtful);
  }
  TagHypotheses apart{FrameShape{}};
  apart.keep(read_at(kPlate, kOne, 0.99));
  apart.keep(read_at(upright(400, 50, 226, 110.6), kOther, 0.95));
  CHECK(apart.tags().size() == 2);
}

TEST_CASE("each frame is told once, and none as refused that was read") {
  const Quad nearly = upright(101, 51, 225, 110), beside = upright(500, 50, 226, 110.6);
  TagHypotheses found{FrameShape{}};
  found.keep(refused_at(kPlate, RejectionReason::element_widths));
  found.keep(refused_at(beside, RejectionReason::blur));
  found.keep(refused_at(widened(beside, 1), RejectionReason::doubtful));
  found.keep(read_at(nearly, kOne, 0.99));
  found.keep(refused_at(upright(50, 300, 20, 10), RejectionReason::no_guards));
  found.keep(refused_at(upright(90, 300, 20, 10), RejectionReason::frame_fault));
  for (const bool tell : {true, false}) {
    const ReadResult result = found.result(tell);
    CHECK(result.tags.size() == 1);
    REQUIRE(result.rejected.size() == 1);
    CHECK(result.rejected[0].reason == RejectionReason::blur);
    CHECK(result.passed_over.size() == (tell ? 2 : 0));
  }
}

TEST_CASE("a frame around what is no symbol is not told as a tag that cannot be read") {
  RejectionReason reason = RejectionReason::guard_pattern;
  double module_px = 2;
  const auto is_told = [&](double explained, double guards, double black) {
    TagHypothesis refused = refused_at(kPlate, reason);
    SymbolHypothesis& symbol = std::get<Rejection>(refused.outcome).symbol.emplace();
    symbol.profile.module_px = module_px;
    Decoding& decoding = symbol.decoding;
    for (FrameSide& side : symbol.frame.sides) side.blur_px = 2 * decoding.fit.image.blur;
    decoding.fit.explained = explained;
    decoding.guards = guards;
    decoding.fit.image.black = black;
    TagHypotheses found{FrameShape{}};
    found.keep(refused);
    const ReadResult result = found.result(true);
    CHECK(result.rejected.size() + result.passed_over.size() == 1);
    return result.passed_over.empty();
  };
  CHECK(is_told(0.85, 0.95, 1));
  CHECK(is_told(0.4, 0.8, 0.9));   // covered between its guard patterns
  CHECK(is_told(0.8, 0.4, 0.9));   // covered where a guard pattern is
  CHECK(!is_told(0.3, 0.5, 2));    // the bars of a grating
  CHECK(!is_told(0.5, 0.8, 0.2));  // hardly darker than the white of the frame, as a wall is
  CHECK(!is_told(0.8, 0.4, 3));    // much darker than the strokes around them
  module_px = 0.25;
  CHECK(!is_told(0.85, 0.95, 1));  // too small for bars to be seen
  reason = RejectionReason::doubtful;
  CHECK(is_told(0.95, 0.95, 1));  // but digits explain them
}

TEST_CASE("what began or was fitted in the same place is known") {
  TagHypotheses found{FrameShape{}};
  TagHypothesis outline{.source = Source::outline, .rough = kPlate};
  outline.frame.emplace();
  outline.frame->corners = kPlate;
  found.keep(outline);
  Quad near = kPlate;
  for (PixelPoint& corner : near) corner.x += 0.3;
  CHECK(found.was_proposed(Source::outline, near));
  CHECK(!found.was_proposed(Source::completed, near));
  for (PixelPoint& corner : near) corner.x += 0.3;
  CHECK(!found.was_proposed(Source::outline, near));
  RefinedFrame frame;
  frame.corners = kPlate;
  CHECK(found.was_fitted(frame));
  frame.corners = near;
  CHECK(!found.was_fitted(frame));
}

TEST_CASE(
    "the scheme that all check digits show is told, and none where they differ or hold both") {
  const auto read = [](double x, bool sum10, bool gs1) {
    TagHypothesis hypothesis = read_at(upright(x, 50, 226, 110.6), kOne, 0.99);
    std::get<Reading>(hypothesis.outcome).sum10_holds = sum10;
    std::get<Reading>(hypothesis.outcome).gs1_holds = gs1;
    return hypothesis;
  };
  TagHypotheses found{FrameShape{}};
  CHECK(!found.scheme_shown());
  found.keep(read(0, true, true));
  CHECK(!found.scheme_shown());
  found.keep(read(400, false, true));
  CHECK(found.scheme_shown() == CheckDigit::gs1);
  found.keep(read(800, true, false));
  CHECK(!found.scheme_shown());
}

TEST_CASE("covered frames and odd bars are counted as asking for a careful look, each once") {
  TagHypotheses found{FrameShape{}};
  CHECK(!found.has_met_covers());
  found.keep(refused_at(kPlate, RejectionReason::blur));
  TagHypothesis covered = refused_at(kPlate, RejectionReason::covered);
  covered.may_be_covered = true;
  TagHypothesis odd = refused_at(kPlate, RejectionReason::side_hidden);
  odd.odd_bars = bars_at({200, 100});
  found.keep(odd);
  CHECK(!found.has_met_covers());
  found.keep(covered);
  CHECK(found.has_met_covers());
  CHECK(found.covered_frames() == std::vector<std::size_t>{2});
  CHECK(found.odd_bars().size() == 1);
  CHECK(found.to_be_looked_at() == 2);
}

TEST_CASE("a refused tag tells of covers where its digits do not explain it") {
  for (const auto& [explained, is_covered] : {std::pair{0.95, false}, std::pair{0.8, true}}) {
    CAPTURE(explained);
    TagHypothesis refused = refused_at(kPlate, RejectionReason::doubtful);
    refused.may_be_covered = true;
    std::get<Rejection>(refused.outcome).symbol =
        std::get<Reading>(read_at(kPlate, kOne, explained).outcome).symbol;
    TagHypotheses found{FrameShape{}};
    found.keep(refused);
    CHECK(found.has_met_covers() == is_covered);
    CHECK(found.covered_frames().size() == 1);
  }
}

TEST_CASE("a tag that was read behind something tells of covers") {
  TagHypothesis behind = read_at(kPlate, kOne, 0.95);
  std::get<Reading>(behind.outcome).method = ReadingMethod::partly_covered;
  TagHypotheses found{FrameShape{}};
  found.keep(read_at(upright(500, 50, 226, 110.6), kOther, 0.99));
  CHECK(!found.has_met_covers());
  found.keep(behind);
  CHECK(found.has_met_covers());
}

TEST_CASE("a plate is known with its stroke, in pixels of the level") {
  TagHypotheses found{FrameShape{}};
  found.keep(read_at(kPlate, kOne, 0.99));
  PyramidLevel half;
  half.scale = 2;
  const std::vector<Quad> known = found.known_in(half);
  REQUIRE(known.size() == 1);
  // Four modules and a half of two pixels each, at half the size.
  CHECK(nearly_equal(known[0], widened(to_level(half, kPlate), 4.45), 1e-9));
  CHECK(found.has_reading_at({101, 51}));
  CHECK(!found.has_reading_at({99, 51}));
  CHECK(found.is_read(widened(kPlate, 2)));
  CHECK(!found.is_read(upright(100, 50, 113, 55)));
  ExpectedTag expected{kPlate, 2};
  expected.corners[1].x += 2.9;
  CHECK(found.has_read(expected));
  expected.corners[1].x += 0.2;
  CHECK(!found.has_read(expected));
}
