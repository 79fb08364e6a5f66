// SPDX-License-Identifier: Apache-2.0
// From a frame to a hypothesis of its symbol, and whether that is believed.
#include "decoder/reader/judge.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/reader/symbol_hypothesis.hpp"
#include "tests/reader/drawn_symbol.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::DrawnSymbol;
using tagsmith::detail::test::kDrawnDigits;

namespace {

// A dark cable over the whole plate, so many pixels wide.
void draw_cable(DrawnSymbol& symbol, int module, int width) {
  const int left = symbol.module * (9 + module);
  symbol.fill(left, -DrawnSymbol::kStroke, left + width, symbol.height() + DrawnSymbol::kStroke,
              60);
}

}  // namespace

TEST_CASE("the bars tell which corners may be P") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  const GrayView image = symbol.image.view();
  CHECK(possible_first_corners(image, symbol.frame().corners) == std::vector<std::size_t>{0});
  CHECK(possible_first_corners(image, turned_to(symbol.frame(), 1).corners) ==
        std::vector<std::size_t>{1});
  const DrawnSymbol blank = [] {
    DrawnSymbol drawn(kDrawnDigits, 3);
    drawn.fill(0, 0, drawn.width(), drawn.height(), DrawnSymbol::kWhite);
    return drawn;
  }();
  CHECK(possible_first_corners(blank.image.view(), blank.frame().corners).size() == 2);
}

TEST_CASE("a frame's symbol is the same from whichever corner the frame begins") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  for (const std::size_t turn : {0U, 1U, 2U, 3U}) {
    CAPTURE(turn);
    const RefinedFrame frame = turned_to(symbol.frame(), turn);
    const auto found = quick_hypothesis(symbol.image.view(), frame, {});
    REQUIRE(found);
    CHECK(found->decoding.digits == kDrawnDigits);
    const FrameCorners corners = corners_of(*found), by_bars = corners_by_bars(*found);
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(distance(corners[i], symbol.frame().corners[i]) < 0.05);
      CHECK(distance(by_bars[i], symbol.frame().corners[i]) < 0.3);
    }
    CHECK(!objection_to_quick(symbol.image.view(), *found, {}));
    CHECK(is_symbol_like(*found));
  }
}

TEST_CASE("the rows that a symbol was read from serve again while they are its frame's") {
  DrawnSymbol symbol(kDrawnDigits, 3);
  const GrayView image = symbol.image.view();
  const auto found = quick_hypothesis(image, symbol.frame(), {});
  REQUIRE(found);
  REQUIRE(found->rows);
  CHECK(rows_of(image, found->frame, *found) == found->rows);
  // Another frame, another way round, other light or another picture are cut out anew.
  RefinedFrame moved = found->frame;
  moved.corners[2].x += 0.01;
  CHECK(rows_of(image, moved, *found) != found->rows);
  CHECK(rows_of(image, turned_to(found->frame, 2), *found) != found->rows);
  const GrayImage copy = symbol.image;
  CHECK(rows_of(copy.view(), found->frame, *found) != found->rows);
  SymbolHypothesis evened = *found;
  evened.profile.is_evened = true;
  CHECK(rows_of(image, found->frame, evened) != found->rows);
  // What is told of it does not keep them.
  CHECK(!rejection_of(*found, {RejectionReason::doubtful}).symbol->rows);
  const auto reading = reading_where_bars_end(image, *found, {}, ReadingMethod::frame);
  REQUIRE(reading);
  CHECK(!reading->symbol->rows);
}

TEST_CASE("bars that lost more than narrow elements have are no symbol-like ones") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  auto found = quick_hypothesis(symbol.image.view(), symbol.frame(), {});
  REQUIRE(found);
  CHECK(is_symbol_like(*found));
  found->decoding.fit.image.growth = -0.8;
  CHECK(!is_symbol_like(*found));
}

TEST_CASE("what growth or blur leave no bars of is told as a tag only where bars explain it well") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  const auto found = quick_hypothesis(symbol.image.view(), symbol.frame(), {});
  REQUIRE(found);
  CHECK(may_be_symbol(*found));
  // Grown like the cells of a wire mesh are, though by all else it is a symbol.
  for (const double growth : {-2.0, 2.0}) {
    SymbolHypothesis grown = *found;
    grown.decoding.fit.image.growth = growth;
    CHECK(!may_be_symbol(grown));
  }
  SymbolHypothesis blurred = *found;
  blurred.decoding.fit.image.blur = 3;
  CHECK(may_be_symbol(blurred));
  blurred.decoding.fit.explained = 0.85;
  CHECK(!may_be_symbol(blurred));
  blurred.decoding.fit.image.blur = 2;
  CHECK(may_be_symbol(blurred));
}

TEST_CASE("bars suit a frame that is as sharp and as black as they are") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  const auto found = quick_hypothesis(symbol.image.view(), symbol.frame(), {});
  REQUIRE(found);
  SymbolHypothesis plain = *found;
  plain.decoding.guards = 0.5;  // no symbol by itself
  const double blur = plain.decoding.fit.image.blur * plain.profile.module_px;
  for (FrameSide& side : plain.frame.sides) side.blur_px = blur;
  CHECK(suits_its_frame(plain));
  for (const double factor : {0.3, 3.0}) {
    SymbolHypothesis other = plain;
    for (FrameSide& side : other.frame.sides) side.blur_px = factor * blur;
    CHECK(!suits_its_frame(other));
    // One of the two strokes along the bars is enough: something may cover the other.
    other.frame.sides[3].blur_px = blur;
    CHECK(suits_its_frame(other));
    other = plain;
    other.decoding.fit.image.black = other.decoding.fit.image.white + factor;
    CHECK(!suits_its_frame(other));
  }
  SymbolHypothesis like_symbol = plain;
  like_symbol.decoding.guards = 0.9;
  for (FrameSide& side : like_symbol.frame.sides) side.blur_px = 3 * blur;
  CHECK(suits_its_frame(like_symbol));
  like_symbol.decoding.fit.image.growth = -1.1;
  CHECK(!suits_its_frame(like_symbol));
  like_symbol.decoding.fit.image.growth = 0;
  // Too small for anything to be seen of a symbol.
  like_symbol.profile.module_px = 0.25;
  CHECK(!suits_its_frame(like_symbol));
}

TEST_CASE("a hidden side is where the bars put it") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  RefinedFrame frame = symbol.frame();
  // Said to be a third of a module further out than it is.
  frame.corners[1].x += 1;
  frame.corners[2].x += 1;
  frame.shown[1] = false;
  const auto found = better_hypothesis(symbol.image.view(), frame, {});
  REQUIRE(found);
  CHECK(found->decoding.digits == kDrawnDigits);
  const FrameCorners corners = corners_of(*found);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(distance(corners[i], symbol.frame().corners[i]) < 0.5);
  }
}

TEST_CASE("what is not believed says why, with what was measured and its limit") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  const GrayView image = symbol.image.view();
  SUBCASE("a cable along the bars") {
    draw_cable(symbol, 30, 6);
    const auto found = quick_hypothesis(image, symbol.frame(), {});
    REQUIRE(found);
    const auto objection = objection_to_quick(image, *found, {});
    REQUIRE(objection);
    const Rejection rejection = rejection_of(*found, *objection);
    CHECK(rejection.reason == objection->reason);
    CHECK(rejection.symbol);
  }
  SUBCASE("a digit that is covered at all heights") {
    symbol.fill(4 * 9 + 4 * first_module_of_digit(3), symbol.height() / 8,
                4 * 9 + 4 * (first_module_of_digit(3) + 7), symbol.height() * 7 / 8, 128);
    const auto found = quick_hypothesis(image, symbol.frame(), {});
    REQUIRE(found);
    const auto objection = objection_to_quick(image, *found, {});
    REQUIRE(objection);
    CHECK(objection->measured < objection->limit);
    CHECK(!believed_hypothesis(image, symbol.frame(), {}, true));
  }
  SUBCASE("no bars at all") {
    symbol.fill(0, 0, symbol.width(), symbol.height(), DrawnSymbol::kWhite);
    CHECK(!quick_hypothesis(image, symbol.frame(), {}));
  }
}

TEST_CASE("all rows together are believed where most of the height is hidden") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  symbol.fill(8, symbol.height() / 3, symbol.width() - 8, symbol.height() - 8, 140);
  const auto found = believed_hypothesis(symbol.image.view(), symbol.frame(), {}, true);
  REQUIRE(found);
  CHECK(found->decoding.digits == kDrawnDigits);
}

TEST_CASE("a clear symbol that is in no book is a stranger to it") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  ReadOptions options;
  options.code_book = {*parse_digits("019000900403")};
  const auto stranger = stranger_to_book(symbol.image.view(), symbol.frame(), options);
  REQUIRE(stranger);
  CHECK(stranger->decoding.digits == kDrawnDigits);
  options.code_book.push_back(kDrawnDigits);
  CHECK(!stranger_to_book(symbol.image.view(), symbol.frame(), options));
}

TEST_CASE("a believed symbol is a reading where its bars end as its layout says") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  const auto found = quick_hypothesis(symbol.image.view(), symbol.frame(), {});
  REQUIRE(found);
  const auto reading =
      reading_where_bars_end(symbol.image.view(), *found, {}, ReadingMethod::frame);
  REQUIRE(reading);
  CHECK(reading->digits == kDrawnDigits);
  CHECK(reading->confidence > kSureInFrame);
  CHECK(reading->module_px == doctest::Approx(4));
  CHECK(reading->method == ReadingMethod::frame);
  CHECK(reading->sum10_holds == has_check_digit(CheckDigit::sum10, kDrawnDigits));
}
