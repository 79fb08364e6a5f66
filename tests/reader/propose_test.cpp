// SPDX-License-Identifier: Apache-2.0
// The places that each proposer hands on, with pictures worked out for it.
#include "decoder/reader/propose.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>
#include <variant>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/reader/detector.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::PlaneCover;
using tagsmith::detail::test::SeenTag;

namespace {

SeenTag large_seen_aslant() {
  SeenTag tag;
  tag.width = 520;
  tag.height = 400;
  tag.view = {{280, 210}, 1.7, 0.15, {0.001, -0.002}};
  return tag;
}

// A picture with what is proposed of it. The detector sees nothing unless it is told to.
struct Proposed {
  explicit Proposed(const SeenTag& tag, ReadOptions how = {})
      : image(tag.image()), options(std::move(how)), picture(image.view()) {}

  template <class Place>
  std::vector<Place> places() const {
    std::vector<Place> found;
    for (const Proposal& proposal : all) {
      if (const auto* place = std::get_if<Place>(&proposal)) found.push_back(*place);
    }
    return found;
  }

  // Whether an outline is this one, to some pixels of the full image.
  bool has_outline(const Quad& quad, double pixels) const {
    return std::ranges::any_of(places<Outline>(), [&](const Outline& outline) {
      return nearly_equal(to_full(outline.level, outline.quad), quad, pixels);
    });
  }

  // Reads the tag by its outline.
  void read(const SeenTag& tag) {
    detector.consider(Outline{picture.pyramid().levels().back().level, tag.corners()});
  }

  GrayImage image;
  ReadOptions options;
  SearchedImage picture;
  Detector detector{picture, options};
  std::vector<Proposal> all;
  std::deque<GrayImage> levels;  // of these: a proposer's own are gone when it is done
  SearchContext search{picture, options, detector.found(),
                       [this](const Proposal& proposal) { keep(proposal); }};

 private:
  void keep(Proposal proposal) {
    std::visit(
        [this](auto& place) {
          if constexpr (requires { place.level; }) {
            place.level.image = levels.emplace_back(copy_of(place.level.image)).view();
          }
        },
        proposal);
    all.push_back(std::move(proposal));
  }

  static GrayImage copy_of(const GrayView& level) {
    GrayImage copy{level.width, level.height, {}};
    for (int y = 0; y < level.height; ++y) {
      for (int x = 0; x < level.width; ++x) copy.samples.push_back(level.at(x, y));
    }
    return copy;
  }
};

bool is_of(const BarRegion& region, const SeenTag& tag) {
  const BarRegion expected = tag.region();
  return distance(region.centre, expected.centre) < 0.1 * expected.length &&
         std::abs(dot(region.across, expected.across)) > 0.99 &&
         std::abs(region.length / expected.length - 1) < 0.25;
}

// How many regions of bars are followed where this frame was read, by this method.
std::size_t followed_beside(const SeenTag& tag, const Quad& corners, ReadingMethod method) {
  Proposed proposed(tag);
  TagHypothesis read{.rough = corners};
  Reading reading;
  reading.corners = corners;
  reading.method = method;
  read.outcome = std::move(reading);
  TagHypotheses found{FrameShape{}};
  found.keep(std::move(read));
  std::size_t count = 0;
  SearchContext search{proposed.picture, proposed.options, found,
                       [&](const Proposal&) { ++count; }};
  propose_bars(search);
  return count;
}

// Something dark over the frame and the bars, from above to below.
PlaneCover cable_at(double x) { return {x, -60, x + 6, 60, 0.05}; }

}  // namespace

TEST_CASE("an expected tag is proposed where it should be, in a level that reaches so far") {
  const SeenTag tag = large_seen_aslant();
  for (const double uncertainty : {2.0, 12.0}) {
    CAPTURE(uncertainty);
    ReadOptions options;
    options.expected = {{tag.corners(), uncertainty}};
    Proposed proposed(tag, options);
    propose_expected(proposed.search);
    REQUIRE(!proposed.all.empty());
    const auto* rough = std::get_if<RoughFrame>(&proposed.all.front());
    REQUIRE(rough != nullptr);
    CHECK(nearly_equal(to_full(rough->level, rough->quad), tag.corners(), 1e-9));
    CHECK((rough->level.scale > 1) == (uncertainty > 5));
    // The level is the part of the picture around it, of the same pixels.
    const PixelPoint at = tag.view.pixel({SeenTag::kLeft - 2, -5});
    const Quad in_level = to_level(rough->level, {at, at, at, at});
    const int x = static_cast<int>(std::lround(in_level[0].x));
    const int y = static_cast<int>(std::lround(in_level[0].y));
    CHECK(rough->level.image.at(x, y) < 130);
    CHECK(rough->level.image.width * rough->level.scale < 400);
    // Nothing was read there: the outlines around follow.
    CHECK(proposed.has_outline(tag.corners(), 4));
  }
}

TEST_CASE("around an expected tag that was read nothing more is proposed") {
  const SeenTag tag = large_seen_aslant();
  ReadOptions options;
  options.expected = {{tag.corners(), 2}};
  Proposed proposed(tag, options);
  proposed.read(tag);
  propose_expected(proposed.search);
  CHECK(proposed.all.size() == 1);
}

TEST_CASE("a tag that is expected outside of the picture is not proposed") {
  const SeenTag tag = large_seen_aslant();
  ReadOptions options;
  options.expected = {{tag.corners(), 2}};
  for (PixelPoint& corner : options.expected[0].corners) corner.x += 900;
  Proposed proposed(tag, options);
  propose_expected(proposed.search);
  CHECK(proposed.all.empty());
}

TEST_CASE("a tag's outline is proposed near its bars, once each in full and half size") {
  const SeenTag tag = large_seen_aslant();
  Proposed proposed(tag);
  propose_near_bars(proposed.search);
  CHECK(proposed.search.is_searched);
  CHECK(proposed.has_outline(tag.corners(), 4));
  // The picture's coarsest level comes first.
  double scale = proposed.places<Outline>().front().level.scale;
  for (const Outline& outline : proposed.places<Outline>()) {
    CHECK(outline.level.scale <= scale);
    scale = outline.level.scale;
  }
}

TEST_CASE("a tag that is too small for the coarsest level is proposed in a finer one") {
  SeenTag tag = large_seen_aslant();
  tag.view.module_px = 0.6;
  Proposed proposed(tag);
  propose_near_bars(proposed.search);
  CHECK(proposed.has_outline(tag.corners(), 3));
}

TEST_CASE("what was read is not proposed again") {
  const SeenTag tag = large_seen_aslant();
  Proposed proposed(tag);
  proposed.read(tag);
  REQUIRE(proposed.detector.found().has_read_any());
  propose_near_bars(proposed.search);
  CHECK(!proposed.has_outline(tag.corners(), 4));
}

TEST_CASE("the options say when the whole picture is searched") {
  const SeenTag tag = large_seen_aslant();
  const auto is_searched = [&](Search when, bool expected, bool read) {
    ReadOptions options;
    options.search = when;
    if (expected) options.expected = {{tag.corners(), 2}};
    Proposed proposed(tag, options);
    if (read) proposed.read(tag);
    propose_near_bars(proposed.search);
    CHECK(proposed.search.is_searched != proposed.all.empty());
    return proposed.search.is_searched;
  };
  CHECK(is_searched(Search::always, true, false));
  CHECK(is_searched(Search::when_missing, false, false));
  CHECK(is_searched(Search::when_missing, true, false));
  CHECK_FALSE(is_searched(Search::when_missing, true, true));
  CHECK_FALSE(is_searched(Search::never, false, false));
  CHECK_FALSE(is_searched(Search::never, true, false));
}

TEST_CASE("a frame that does not show as one piece is proposed around its bars") {
  SeenTag tag = large_seen_aslant();
  // So near that the quiet zones keep bars and frame apart in the image at half its size.
  tag.width = 680;
  tag.view = {{340, 200}, 4.5, 0.15, {}};
  // Gaps in the stroke, through which the white inside is one with that around it.
  tag.covers = {{-10, SeenTag::kTop - 5, 8, SeenTag::kTop + 1, tag.white},
                {20, tag.bottom() - 1, 30, tag.bottom() + 5, tag.white}};
  Proposed near(tag);
  propose_near_bars(near.search);
  CHECK(!near.has_outline(tag.corners(), 4));
  Proposed around(tag);
  propose_around_bars(around.search);
  CHECK(around.has_outline(tag.corners(), 6));
}

TEST_CASE("a frame is proposed around bars that show at a quarter of the size") {
  SeenTag tag = large_seen_aslant();
  tag.width = 1150;
  tag.height = 760;
  tag.view = {{575, 380}, 7.5, 0.1, {}};
  tag.covers = {{-10, SeenTag::kTop - 5, 8, SeenTag::kTop + 1, tag.white}};
  Proposed around(tag);
  propose_around_bars(around.search);
  // Near enough for its sides to be found: three modules.
  CHECK(around.has_outline(tag.corners(), 3 * 7.5));
}

TEST_CASE("a frame that is cut in two is proposed as its pieces joined") {
  SeenTag tag = large_seen_aslant();
  tag.covers = {cable_at(-20)};
  Proposed near(tag);
  propose_near_bars(near.search);
  CHECK(!near.has_outline(tag.corners(), 6));
  Proposed joined(tag);
  propose_pieces(joined.search);
  CHECK(joined.has_outline(tag.corners(), 6));
}

TEST_CASE("where something was read no pieces are joined") {
  const SeenTag tag = large_seen_aslant();
  Proposed proposed(tag);
  proposed.read(tag);
  REQUIRE(proposed.detector.found().has_read_any());
  propose_pieces(proposed.search);
  CHECK(proposed.all.empty());
}

TEST_CASE("frames that were refused and may be covered are proposed, each by its hypothesis") {
  SeenTag tag = large_seen_aslant();
  tag.view.module_px = 2.4;
  tag.covers = {{-54, -5, 54, 25, 0.3}};
  Proposed proposed(tag);
  propose_refused(proposed.search);
  CHECK(proposed.all.empty());
  proposed.read(tag);
  REQUIRE(proposed.detector.found().covered_frames().size() == 1);
  propose_refused(proposed.search);
  const std::vector<RefusedFrame> refused = proposed.places<RefusedFrame>();
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].hypothesis == proposed.detector.found().covered_frames()[0]);
}

TEST_CASE("bars in a frame that is not theirs are proposed, unless they are none") {
  SeenTag tag = large_seen_aslant();
  tag.bars_top += 5;
  tag.bars_bottom += 5;
  Proposed proposed(tag);
  proposed.read(tag);
  REQUIRE(proposed.detector.found().odd_bars().size() == 1);
  propose_refused(proposed.search);
  const std::vector<BarRegion> bars = proposed.places<BarRegion>();
  REQUIRE(bars.size() == 1);
  CHECK(is_of(bars[0], tag));
}

TEST_CASE("bars that no reading explains are proposed where they are") {
  SeenTag tag = large_seen_aslant();
  tag.framed = false;
  Proposed proposed(tag);
  propose_bars(proposed.search);
  const std::vector<BarRegion> bars = proposed.places<BarRegion>();
  REQUIRE(bars.size() == 1);
  CHECK(is_of(bars[0], tag));
}

TEST_CASE("bars beside a tag that was read are proposed where something was in its way") {
  SeenTag tag = large_seen_aslant();
  tag.framed = false;
  const Quad elsewhere{{{5, 5}, {45, 5}, {45, 25}, {5, 25}}};
  CHECK(followed_beside(tag, elsewhere, ReadingMethod::frame) == 0);
  CHECK(followed_beside(tag, elsewhere, ReadingMethod::partly_covered) == 1);
  CHECK(followed_beside(tag, tag.corners(), ReadingMethod::partly_covered) == 0);
}

TEST_CASE("bars that were read are not proposed") {
  const SeenTag tag = large_seen_aslant();
  Proposed read(tag);
  read.read(tag);
  REQUIRE(read.detector.found().has_read_any());
  propose_bars(read.search);
  CHECK(read.all.empty());
}
