// SPDX-License-Identifier: Apache-2.0
// What becomes of each kind of proposal, with pictures worked out for it.
#include "decoder/reader/detector.hpp"

#include <algorithm>
#include <numbers>

#include <doctest/doctest.h>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/reader/proposal.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::SeenTag;

namespace {

SeenTag seen_aslant() {
  SeenTag tag;
  tag.width = 360;
  tag.height = 240;
  tag.view = {{180, 120}, 2.4, 0.15, {0.001, -0.002}};
  return tag;
}

// A picture of a tag, and a detector that has seen nothing of it yet.
struct Looked {
  explicit Looked(const SeenTag& tag, ReadOptions how = {})
      : seen(tag),
        image(tag.image()),
        options(std::move(how)),
        picture(image.view()),
        detector(picture, options) {}

  PyramidLevel level(int scale) {
    if (scale == 1) return picture.pyramid().levels().back().level;
    return picture.pyramid().scaled_down(scale).level;
  }

  // The frame's outline as it may be found in a level.
  Outline outline(int scale = 1) {
    return {level(scale), widened(to_level(level(scale), seen.corners()), 1)};
  }

  SeenTag seen;
  GrayImage image;
  ReadOptions options;
  SearchedImage picture;
  Detector detector;
};

// A tag of which the lower half is hidden behind something grey.
SeenTag half_hidden() {
  SeenTag tag = seen_aslant();
  tag.covers = {{-54, -5, 54, 25, 0.3}};
  return tag;
}

RejectionReason only_refusal(const ReadResult& result) {
  CHECK(result.tags.empty());
  REQUIRE(result.rejected.size() == 1);
  return result.rejected[0].reason;
}

// A tag in front of whose middle a smaller one hangs.
GrayImage one_in_front_of(const SeenTag& large, const SeenTag& small) {
  GrayImage image = large.image();
  const GrayImage in_front = small.image();
  const double left = SeenTag::kLeft - small.stroke - 7, top = SeenTag::kTop - small.stroke - 7;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const PixelPoint at = small.view.plane({static_cast<double>(x), static_cast<double>(y)});
      const bool is_hidden = at.x > left && at.x < -left && at.y > top && at.y < -top;
      const auto place = static_cast<std::size_t>(y * image.width + x);
      if (is_hidden) image.samples[place] = in_front.samples[place];
    }
  }
  return image;
}

}  // namespace

TEST_CASE("a tag is read in its outline, once for all levels that show it") {
  Looked looked(seen_aslant());
  CHECK(!looked.detector.found().has_read_any());
  for (const int scale : {2, 1, 2}) {
    looked.detector.consider(looked.outline(scale));
    const std::vector<Reading> tags = looked.detector.found().tags();
    REQUIRE(tags.size() == 1);
    CHECK(tags[0].digits == looked.seen.digits);
    CHECK(tags[0].method == ReadingMethod::frame);
    CHECK(farthest_apart(tags[0].corners, looked.seen.corners()) < 0.05);
    CHECK(tags[0].module_px == doctest::Approx(2.4).epsilon(0.02));
    CHECK(tags[0].sum10_holds);
    CHECK(!tags[0].gs1_holds);
  }
  CHECK(looked.detector.result().tags.size() == 1);
  CHECK(looked.detector.result().rejected.empty());
}

TEST_CASE("corners run clockwise from P, whichever way the tag is turned or its outline begins") {
  for (int quarter = 0; quarter < 4; ++quarter) {
    CAPTURE(quarter);
    SeenTag tag = seen_aslant();
    tag.width = tag.height = 360;
    tag.view.middle = {180, 180};
    tag.view.turn += quarter * std::numbers::pi / 2;
    Looked looked(tag);
    Outline outline = looked.outline();
    std::rotate(outline.quad.begin(), outline.quad.begin() + (quarter * 3 + 1) % 4,
                outline.quad.end());
    looked.detector.consider(outline);
    const std::vector<Reading> tags = looked.detector.found().tags();
    REQUIRE(tags.size() == 1);
    const FrameCorners& corners = tags[0].corners;
    CHECK(farthest_apart(corners, tag.corners()) < 0.05);
  }
}

TEST_CASE("what is read is known where it is, in every level, and nowhere else") {
  Looked looked(seen_aslant());
  CHECK(looked.detector.found().known_in(looked.level(2)).empty());
  looked.detector.consider(looked.outline());
  const SeenTag& tag = looked.seen;
  CHECK(looked.detector.found().has_read_any());
  CHECK(looked.detector.found().has_reading_at(tag.view.middle));
  CHECK(looked.detector.found().has_reading_at(tag.view.pixel({SeenTag::kLeft + 1, 0})));
  CHECK(!looked.detector.found().has_reading_at(tag.view.pixel({SeenTag::kLeft - 1, 0})));
  ExpectedTag expected{tag.corners(), 2};
  CHECK(looked.detector.found().has_read(expected));
  expected.corners[2].x += 4;
  CHECK(!looked.detector.found().has_read(expected));
  // With the stroke around the frame.
  const std::vector<Quad> known = looked.detector.found().known_in(looked.level(2));
  REQUIRE(known.size() == 1);
  const Quad inner = to_level(looked.level(2), tag.corners());
  for (const PixelPoint corner : inner) CHECK(contains(known[0], corner));
  CHECK(nearly_equal(known[0], widened(inner, 4 * 2.4 / 2), 3));
}

TEST_CASE("a rough frame is fitted without a look at what is around it") {
  SeenTag tag = seen_aslant();
  // A dark wall begins before the frame's stroke ends.
  tag.covers = {{-90, -60, 90, SeenTag::kTop - 3, 0.05},
                {-90, tag.bottom() + 3, 90, 60, 0.05},
                {-90, -60, SeenTag::kLeft - 3, 60, 0.05},
                {tag.right() + 3, -60, 90, 60, 0.05}};
  Looked looked(tag);
  looked.detector.consider(looked.outline());
  CHECK(looked.detector.found().tags().empty());
  RoughFrame rough{looked.level(2), to_level(looked.level(2), tag.corners())};
  for (PixelPoint& corner : rough.quad) corner = corner + PixelPoint{1, -0.8};
  looked.detector.consider(rough);
  REQUIRE(looked.detector.found().tags().size() == 1);
  CHECK(farthest_apart(looked.detector.found().tags()[0].corners, tag.corners()) < 0.05);
}

TEST_CASE("what is no frame is told where that is wanted, with its fault") {
  for (const bool tell : {false, true}) {
    CAPTURE(tell);
    ReadOptions options;
    options.tell_passed_over = tell;
    SeenTag tag = seen_aslant();
    tag.covers = {{-54, -26, 54, 26, tag.white}};  // a frame without bars
    Looked looked(tag, options);
    looked.detector.consider(looked.outline());
    const Quad on_white{{{160, 100}, {200, 100}, {200, 130}, {160, 130}}};
    looked.detector.consider(Outline{looked.level(1), on_white});
    looked.detector.consider(RoughFrame{looked.level(1), on_white});
    const ReadResult result = looked.detector.result();
    CHECK(result.tags.empty());
    CHECK(result.rejected.empty());
    REQUIRE(result.passed_over.size() == (tell ? 3 : 0));
    if (!tell) continue;
    CHECK(result.passed_over[0].reason == RejectionReason::no_guards);
    CHECK(farthest_apart(result.passed_over[0].corners, tag.corners()) < 0.1);
    CHECK(result.passed_over[1].fault == FrameFault::not_framed);
    CHECK(result.passed_over[2].fault == FrameFault::no_edge);
    CHECK(nearly_equal(result.passed_over[2].corners, on_white, 1e-9));
  }
}

TEST_CASE("what lies between crossing wires is passed over before anything is read in it") {
  ReadOptions options;
  options.tell_passed_over = true;
  SeenTag tag = seen_aslant();
  tag.covers = tag.lines_along_strokes();
  tag.covers.pop_back();
  Looked looked(tag, options);
  looked.detector.consider(looked.outline());
  const ReadResult result = looked.detector.result();
  CHECK(result.tags.empty());
  CHECK(result.rejected.empty());
  REQUIRE(result.passed_over.size() == 1);
  CHECK(result.passed_over[0].fault == FrameFault::crossed);
}

TEST_CASE("a refused frame that may be covered is read by a careful look") {
  Looked looked(half_hidden());
  looked.detector.consider(looked.outline());
  only_refusal(looked.detector.result());
  REQUIRE(looked.detector.found().covered_frames().size() == 1);
  CHECK(looked.detector.found().has_met_covers());
  looked.detector.consider(RefusedFrame{looked.detector.found().covered_frames()[0]});
  const ReadResult result = looked.detector.result();
  CHECK(result.rejected.empty());
  REQUIRE(result.tags.size() == 1);
  CHECK(result.tags[0].digits == looked.seen.digits);
  CHECK(result.tags[0].method == ReadingMethod::partly_covered);
  CHECK(farthest_apart(result.tags[0].corners, looked.seen.corners()) < 0.1);
}

TEST_CASE("bars whose frame is half hidden complete it") {
  SeenTag tag = seen_aslant();
  tag.covers = {{-80, -50, -52, 50, 0.4}};
  Looked looked(tag);
  looked.detector.consider(tag.region());
  const std::vector<Reading> tags = looked.detector.found().tags();
  REQUIRE(tags.size() == 1);
  CHECK(tags[0].digits == tag.digits);
  CHECK(tags[0].method == ReadingMethod::partly_covered);
  CHECK(farthest_apart(tags[0].corners, tag.corners()) < 0.5);
  CHECK(looked.detector.found().has_met_covers());
  looked.detector.consider(tag.region());
  looked.detector.consider(looked.outline());
  CHECK(looked.detector.found().tags().size() == 1);
}

TEST_CASE("bars in a frame of which one side is something else's are looked at once more") {
  SeenTag tag = seen_aslant();
  tag.bars_top += 5;
  tag.bars_bottom += 5;
  Looked looked(tag);
  looked.detector.consider(looked.outline());
  CHECK(only_refusal(looked.detector.result()) == RejectionReason::side_hidden);
  const std::vector<BarRegion> odd = looked.detector.found().odd_bars();
  REQUIRE(odd.size() == 1);
  CHECK(distance(odd[0].centre, tag.view.middle) < 10);
  CHECK(std::abs(dot(odd[0].across, tag.region().across)) > 0.99);
  CHECK(odd[0].length == doctest::Approx(tag.region().length).epsilon(0.1));
}

TEST_CASE("lines are followed for a blurred symbol unless its modules are narrower than a pixel") {
  for (const double module_px : {0.6, 1.5}) {
    CAPTURE(module_px);
    SeenTag tag = seen_aslant();
    tag.view.module_px = module_px;
    tag.blur_px = 2.33 * module_px;
    Looked looked(tag);
    looked.detector.consider(looked.outline());
    only_refusal(looked.detector.result());
    REQUIRE(looked.detector.found().covered_frames().size() == 1);
    CHECK(looked.detector.found().odd_bars().empty());
    looked.detector.consider(RefusedFrame{looked.detector.found().covered_frames()[0]});
    CHECK(looked.detector.found().tags().empty());
    CHECK(looked.detector.found().odd_bars().size() == (module_px < 1 ? 0 : 1));
  }
}

TEST_CASE("a symbol that is too blurred for any code is read again as a likely one") {
  SeenTag tag = seen_aslant();
  tag.view.module_px = 0.6;
  tag.blur_px = 1.4;
  Looked as_any(tag);
  as_any.detector.consider(as_any.outline());
  only_refusal(as_any.detector.result());
  for (const bool is_likely : {true, false}) {
    CAPTURE(is_likely);
    ReadOptions options;
    options.likely_codes = {*parse_digits("019000900403")};
    if (is_likely) options.likely_codes.push_back(tag.digits);
    Looked looked(tag, options);
    looked.detector.consider(looked.outline());
    CHECK(looked.detector.found().tags().empty());
    looked.detector.try_likely_codes();
    REQUIRE(looked.detector.found().tags().size() == (is_likely ? 1 : 0));
    if (!is_likely) continue;
    CHECK(looked.detector.found().tags()[0].digits == tag.digits);
    CHECK(looked.detector.result().rejected.empty());
  }
}

TEST_CASE("of two readings in one place one stays, and none where their digits differ") {
  SeenTag large;
  large.width = 600;
  large.height = 320;
  large.view = {{300, 160}, 4.4};
  SeenTag small = large;
  small.view.module_px = 1.2;
  for (const bool alike : {true, false}) {
    CAPTURE(alike);
    if (!alike) small.digits = *parse_digits("000001940404");
    const GrayImage image = one_in_front_of(large, small);
    const ReadOptions options;
    SearchedImage picture(image.view());
    Detector detector(picture, options);
    const PyramidLevel level = picture.pyramid().levels().back().level;
    detector.consider(Outline{level, to_level(level, widened(large.corners(), 1))});
    REQUIRE(detector.found().covered_frames().size() == 1);
    detector.note_proposer("refused");
    detector.consider(RefusedFrame{detector.found().covered_frames()[0]});
    REQUIRE(detector.found().tags().size() == 1);
    CHECK(detector.found().tags()[0].digits == large.digits);
    CHECK(detector.found().tags()[0].proposer == "refused");
    detector.note_proposer("pieces");
    detector.consider(Outline{level, to_level(level, widened(small.corners(), 1))});
    const ReadResult result = detector.result();
    REQUIRE(result.tags.size() == (alike ? 1 : 0));
    if (alike) {
      CHECK(farthest_apart(result.tags[0].corners, small.corners()) < 0.1);
      continue;
    }
    REQUIRE(result.rejected.size() == 2);
    // What was refused of the large one before it was read is told in place of that.
    CHECK(result.rejected[0].reason == RejectionReason::element_widths);
    CHECK(result.rejected[1].reason == RejectionReason::doubtful);
    CHECK(result.rejected[1].proposer == "pieces");
  }
}
