// SPDX-License-Identifier: Apache-2.0
// Wires of a mesh leave outlines like those of frames between them; a frame's strokes end at its
// corners.
#include "decoder/feature_frame/crossing_lines.hpp"

#include <cstddef>

#include <doctest/doctest.h>

#include "decoder/feature_frame/refine.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::PlaneCover;
using tagsmith::detail::test::SeenTag;

namespace {

bool lies_between_crossing_lines(const SeenTag& tag) {
  const GrayImage image = tag.image();
  const auto frame = refine_frame(image.view(), tag.corners());
  REQUIRE(frame);
  return tagsmith::detail::lies_between_crossing_lines(image.view(), *frame);
}

}  // namespace

TEST_CASE("a frame lies between crossing lines where most of its strokes' ends go on") {
  SeenTag tag;
  CHECK(!lies_between_crossing_lines(tag));
  const std::vector<PlaneCover> lines = tag.lines_along_strokes();
  for (std::size_t count = 1; count <= lines.size(); ++count) {
    CAPTURE(count);
    tag.covers.push_back(lines[count - 1]);
    CHECK(lies_between_crossing_lines(tag) == (count >= 3));
  }
}

TEST_CASE("a frame around which everything is dark does not lie between lines") {
  SeenTag tag;
  constexpr double kFar = 200;
  const double stroke = tag.stroke;
  tag.covers = {{-kFar, -kFar, kFar, SeenTag::kTop - stroke, tag.black},
                {-kFar, tag.bottom() + stroke, kFar, kFar, tag.black},
                {-kFar, -kFar, SeenTag::kLeft - stroke, kFar, tag.black},
                {tag.right() + stroke, -kFar, kFar, kFar, tag.black}};
  CHECK(!lies_between_crossing_lines(tag));
}

TEST_CASE("lines that leave the picture beside a frame's corners are not seen to go on") {
  SeenTag tag;
  tag.covers = tag.lines_along_strokes();
  CHECK(lies_between_crossing_lines(tag));
  tag.width = 276;  // the right stroke ends at 273
  CHECK(!lies_between_crossing_lines(tag));
}
