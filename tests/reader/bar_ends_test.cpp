// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_ends.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::SeenTag;

namespace {

constexpr SymbolLayout kLayout;

// The layout's v of a height in the plane of the tag.
double v_of(double y) { return (y - SeenTag::kTop) / (-2 * SeenTag::kTop); }

SeenTag tag_seen_aslant() {
  SeenTag tag;
  tag.view = {{150, 95}, 2, 0.1, {0.002, -0.002}};
  return tag;
}

EndsVerdict judged(const GrayView& image, const Quad& corners, const SymbolLayout& layout) {
  const BothEnds ends = find_both_ends(image, bar_field(corners, layout));
  return judge_by_bar_ends(image, ends, corners, layout);
}

}  // namespace

TEST_CASE("the bars of a frame stand where its layout has them") {
  const SeenTag tag;
  const BarField field = bar_field(tag.corners(), kLayout);
  CHECK(field.first == doctest::Approx(9.0 / 113));
  CHECK(field.last == doctest::Approx(104.0 / 113));
  CHECK(field.top == kLayout.bars_top);
  CHECK(field.bottom == kLayout.bars_bottom);
  CHECK(farthest_apart(field.corners, tag.corners()) == 0);
  SymbolLayout wide;
  wide.quiet_zone_modules = 20;
  CHECK(bar_field(tag.corners(), wide).first == doctest::Approx(20.0 / 135));
}

TEST_CASE("the line on which bars end is found to a fifth of a pixel, sloping as it does") {
  SeenTag tag = tag_seen_aslant();
  for (const double lean : {0.0, 0.05, -0.03}) {
    for (const double blur : {0.4, 1.0}) {
      CAPTURE(lean);
      CAPTURE(blur);
      tag.bars_lean = lean;
      tag.blur_px = blur;
      const GrayImage image = tag.image();
      const BarField field = bar_field(tag.corners(), kLayout);
      const auto upper = find_bar_ends(image.view(), field, 0.4, -0.1);
      const auto lower = find_bar_ends(image.view(), field, 0.6, 1.1);
      REQUIRE(upper);
      REQUIRE(lower);
      const double pixels = 2 * -2 * SeenTag::kTop;  // of v, about
      for (const double x : {-47.5, 0.0, 47.5}) {
        const double u = 0.5 + x / 113;
        CHECK(std::abs(upper->at(u) - v_of(tag.bars_top + lean * x)) * pixels < 0.2);
        CHECK(std::abs(lower->at(u) - v_of(tag.bars_bottom + lean * x)) * pixels < 0.2);
      }
      CHECK(upper->sigma_px > 0.05);
      CHECK(upper->sigma_px < 0.5);
    }
  }
}

TEST_CASE("what is dark in front of the bars' ends hides them") {
  SeenTag tag;
  const auto upper_of = [](const SeenTag& seen) {
    const GrayImage image = seen.image();
    return find_bar_ends(image.view(), bar_field(seen.corners(), kLayout), 0.4, -0.1);
  };
  // Over a quarter of the ends the others still tell; over three quarters nothing is told.
  tag.covers = {{-50, -24, -24, -12, 0.03}};
  const auto upper = upper_of(tag);
  REQUIRE(upper);
  CHECK(std::abs(upper->at(0.2) - kLayout.bars_top) * 110 < 0.3);
  tag.covers = {{-50, -24, 24, -12, 0.03}};
  CHECK(!upper_of(tag));
  // A thin dark cable across bars that go on behind it does not.
  tag.covers = {{-50, -14, 50, -13, 0.03}};
  const auto behind = upper_of(tag);
  REQUIRE(behind);
  CHECK(std::abs(behind->at(0.2) - kLayout.bars_top) * 110 < 0.3);
  // White over a quarter of them, as of paper: the line is that of the others.
  tag.covers = {{-50, -24, -24, tag.bars_top + 4, tag.white}};
  const auto others = upper_of(tag);
  REQUIRE(others);
  CHECK(std::abs(others->at(0.2) - kLayout.bars_top) * 110 < 0.3);
  // Bars that go on to the end of where they are looked for do not end there.
  tag.covers.clear();
  tag.bars_top = -40;
  CHECK(!upper_of(tag));
}

TEST_CASE("bars that end a few pixels elsewhere are told from those that end where they should") {
  const SeenTag tag = tag_seen_aslant();
  const GrayImage image = tag.image();
  CHECK(bars_end_near(image.view(), bar_field(tag.corners(), kLayout)));
  for (const double off : {-4.0, 4.0}) {
    CAPTURE(off);
    Quad quad = tag.corners();
    for (PixelPoint& corner : quad) corner.y += off;
    CHECK(!bars_end_near(image.view(), bar_field(quad, kLayout)));
    quad = tag.corners();
    quad[0].y += off * 1.2;
    quad[1].y += off * 1.2;
    CHECK(!bars_end_near(image.view(), bar_field(quad, kLayout)));
  }
}

TEST_CASE("bars that end too far out or too far in, on either side, are told") {
  for (const double off : {-3.0, 3.0}) {
    CAPTURE(off);
    SeenTag tag = tag_seen_aslant();
    tag.bars_top += off;
    CHECK(!bars_end_near(tag.image().view(), bar_field(tag.corners(), kLayout)));
    tag = tag_seen_aslant();
    tag.bars_bottom += off;
    CHECK(!bars_end_near(tag.image().view(), bar_field(tag.corners(), kLayout)));
  }
}

TEST_CASE("a frame is suited where both ends are where its layout has them") {
  const SeenTag tag = tag_seen_aslant();
  const GrayImage image = tag.image();
  const EndsVerdict verdict = judged(image.view(), tag.corners(), kLayout);
  CHECK(verdict.kind == EndsVerdict::suited);
  CHECK(farthest_apart(verdict.corners, tag.corners()) == 0);
}

TEST_CASE("an upper or lower side that is something else's edge is put where the bars have it") {
  const SeenTag tag = tag_seen_aslant();
  const GrayImage image = tag.image();
  for (const std::size_t side : {0U, 2U}) {
    for (const double off : {-7.0, 6.0}) {
      CAPTURE(side);
      CAPTURE(off);
      // The edge of something else, that many modules away and not quite parallel.
      Quad quad = tag.corners();
      const double y = side == 0 ? SeenTag::kTop : tag.bottom();
      quad[side == 0 ? 0 : 3] = tag.view.pixel({SeenTag::kLeft, y + off});
      quad[side == 0 ? 1 : 2] = tag.view.pixel({tag.right(), y + 0.8 * off});
      const EndsVerdict verdict = judged(image.view(), quad, kLayout);
      REQUIRE(verdict.kind == EndsVerdict::hidden);
      CHECK(verdict.side == side);
      CHECK(farthest_apart(verdict.corners, tag.corners()) < 1);
      CHECK(verdict.sigma_px > 0.1);
      CHECK(verdict.sigma_px < 1);
    }
  }
}

TEST_CASE("bars that end elsewhere, explained by no one side, are odd") {
  SeenTag tag;
  tag.bars_top += 5;
  tag.bars_bottom += 5;
  const GrayImage image = tag.image();
  CHECK(judged(image.view(), tag.corners(), kLayout).kind == EndsVerdict::odd);
}

TEST_CASE("a frame whose upper and lower sides both lie beyond its stroke is none") {
  const SeenTag tag;
  const GrayImage image = tag.image();
  for (const double off : {6.0, 8.0, 10.0}) {
    CAPTURE(off);
    // As the plate's own edges may be taken for both: the bars end as far above as below.
    const Quad quad{tag.view.pixel({SeenTag::kLeft, SeenTag::kTop - off}),
                    tag.view.pixel({tag.right(), SeenTag::kTop - off}),
                    tag.view.pixel({tag.right(), tag.bottom() + off}),
                    tag.view.pixel({SeenTag::kLeft, tag.bottom() + off})};
    CHECK(judged(image.view(), quad, kLayout).kind == EndsVerdict::odd);
  }
}

TEST_CASE("bars that end as far above as below are another layout's") {
  SeenTag tag;
  tag.bars_top += 4;
  tag.bars_bottom -= 4;
  const GrayImage image = tag.image();
  CHECK(judged(image.view(), tag.corners(), kLayout).kind == EndsVerdict::other_layout);
  SymbolLayout own;
  own.bars_top = v_of(tag.bars_top);
  own.bars_bottom = v_of(tag.bars_bottom);
  CHECK(judged(image.view(), tag.corners(), own).kind == EndsVerdict::suited);
}
