// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hanging.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "decoder/verify/evidence.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/turned_plate.hpp"
#include "tests/verify/survey_of_four.hpp"

namespace tagsmith::detail {
namespace {

// 000L and 001L 0.8 m apart on the left wall, 000R facing them.
Survey hung() {
  Survey survey = test::survey_of_four();
  for (PlacedTag& tag : survey.tags) {
    const bool left = tag.name.ends_with('L');
    tag.side = left ? Side::left : Side::right;
    tag.world_from_plate.translation = {left ? -1.0 : 1.0, tag.name[2] == '1' ? 0.8 : 0.0, 1.0};
    // Plate axes in the world: right along the drive on the left wall, back along it on the right.
    tag.world_from_plate.rotation.col(0) = Eigen::Vector3d(0, left ? 1 : -1, 0);
  }
  return survey;
}

// 1000 pixels a metre, as seen facing the wall.
TagEvidence seen(const std::string& digits, double x) {
  TagEvidence tag;
  const Reading reading = test::reading_of(digits, x);
  tag.tag.tag = find_tag(hung(), reading.digits)->name;
  tag.tag.digits = reading.digits;
  tag.tag.corners = reading.corners;
  tag.tag.module_px = reading.module_px;
  return tag;
}

std::optional<Finding> finding_of(std::vector<TagEvidence> tags, std::size_t tag) {
  const Survey survey = hung();
  PictureEvidence evidence{survey, {}};
  evidence.is_photo = true;
  evidence.tags = std::move(tags);
  return find_misplaced(evidence, evidence.tags[tag]);
}

std::string rule_of(std::vector<TagEvidence> tags) {
  const auto found = finding_of(std::move(tags), 0);
  return found ? found->rule : "";
}

}  // namespace

TEST_CASE("neighbours in order are in order, exchanged ones are swapped") {
  CHECK(rule_of({seen("019000000404", 100), seen("019000800402", 900)}) == "");
  CHECK(rule_of({seen("019000000404", 900), seen("019000800402", 100)}) == "swapped");
  CHECK(rule_of({seen("019000800402", 100), seen("019000000404", 900)}) == "swapped");
}

TEST_CASE(
    "of two tags that contradict each other the one hangs wrong that more others contradict") {
  const auto first = seen("019000000404", 100), second = seen("019000800402", 900);
  const auto pair = finding_of({second, seen("019000000404", 1700)}, 0);
  REQUIRE(pair.has_value());
  CHECK(pair->status == TagStatus::doubtful);
  // Two of the left wall as they should hang, and one of the right wall between them.
  const std::vector<TagEvidence> three{first, seen("000000340401", 500), second};
  CHECK_FALSE(finding_of(three, 0).has_value());
  CHECK_FALSE(finding_of(three, 2).has_value());
  const auto between = finding_of(three, 1);
  REQUIRE(between.has_value());
  CHECK(between->status == TagStatus::misplaced);
  CHECK(between->rule == "wrong-wall");
}

TEST_CASE("tags of opposite walls side by side in one plane are on a wrong wall") {
  CHECK(rule_of({seen("019000000404", 100), seen("000000340401", 900)}) == "wrong-wall");
  // Seen from within the drive the other wall's plate narrows the other way.
  TagEvidence other = seen("000000340401", 900);
  other.tag.corners = {{{900, 160}, {1000, 100}, {1000, 268}, {900, 208}}};
  CHECK(rule_of({seen("019000000404", 100), other}) == "");
}

TEST_CASE("a mirrored plate without a label is told by its margins, before a dark ground") {
  TagTemplate tag;
  tag.plate_length = 0.246;
  tag.plate_height = 0.170;
  tag.frame_inner_length = 0.2201;
  tag.frame_inner_height = 0.110;
  tag.frame_stroke = 0.008;
  tag.frame_offset_up = 0.018;
  tag.label.shown = false;
  const Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  ReadOptions options;
  options.layouts = {layout_of(tag)};
  for (const double yaw : {-0.7, 0.0, 0.6}) {
    for (const double ground : {0.05, 0.8}) {
      CAPTURE(yaw);
      CAPTURE(ground);
      ScenePlate plate{draw_tag(tag, *parse_digits("019000000404")), {}, {}};
      plate.camera_from_plate =
          camera_from_turned_plate(camera, plate.drawing, {600, 500}, 1.0, yaw, 0.1, 0.2);
      ViewOptions view;
      view.background_light = ground;
      view.sensor.noise_sigma = 2;
      GrayImage image = render_view(camera, std::span(&plate, 1), view).image;
      for (const bool mirrored : {false, true}) {
        CAPTURE(mirrored);
        if (mirrored) {
          for (auto row = image.samples.begin(); row != image.samples.end(); row += image.width) {
            std::reverse(row, row + image.width);
          }
        }
        const ReadResult read = read_tags(image.view(), options);
        REQUIRE(read.tags.size() == 1);
        const std::string how =
            find_mirroring(image.view(), tag, read.tags[0].corners, read.tags[0].module_px);
        CHECK(!how.empty() == (mirrored && ground < 0.5));
      }
    }
  }
}

TEST_CASE("a tag on its head is told by the up that a camera noted, or by the other tags") {
  Survey survey = hung();
  for (PlacedTag& tag : survey.tags) {
    tag.world_from_plate.rotation.col(1) = -Eigen::Vector3d::UnitZ();
  }
  const auto on_head = [](TagEvidence tag) {
    std::swap(tag.tag.corners[0], tag.tag.corners[2]);
    std::swap(tag.tag.corners[1], tag.tag.corners[3]);
    return tag;
  };
  const TagEvidence a = seen("019000000404", 100);
  const TagEvidence b = seen("019000800402", 900);
  const TagEvidence c = seen("000000340401", 1700);
  // The rules of the tags, one letter each: H = on its head, ? = it or the camera; then of what is
  // known of up: its first letter.
  const auto heads = [&](std::vector<TagEvidence> tags, const std::optional<int>& orientation) {
    const GrayImage picture{2100, 400, std::vector<std::uint8_t>(2100 * 400)};
    PictureEvidence evidence{survey, picture.view()};
    evidence.is_photo = true;
    evidence.orientation = orientation;
    evidence.tags = std::move(tags);
    evidence.up = up_of_photo(evidence);
    std::string told;
    for (const TagEvidence& tag : evidence.tags) {
      const auto found = find_upside_down(evidence, tag);
      told += !found ? "-" : found->status == TagStatus::doubtful ? "?" : "H";
    }
    return told + to_string(evidence.up).front();
  };
  CHECK(heads({a}, 1) == "-c");
  CHECK(heads({a}, 3) == "?d");
  CHECK(heads({on_head(a)}, 1) == "?d");
  CHECK(heads({on_head(a)}, 3) == "-c");
  CHECK(heads({a}, 6) == "-c");  // on its side: neither
  CHECK(heads({on_head(a)}, 2) == "-u");
  CHECK(heads({on_head(a)}, std::nullopt) == "-u");
  CHECK(heads({on_head(a), b}, 1) == "H-c");
  CHECK(heads({on_head(a), on_head(b)}, 1) == "--d");  // so was the camera
  CHECK(heads({on_head(a), b}, std::nullopt) == "--u");
  CHECK(heads({on_head(a), b, c}, std::nullopt) == "H--u");
  CHECK(heads({a, on_head(b), on_head(c)}, std::nullopt) == "H--u");
  survey.tags[0].world_from_plate.rotation.col(1) *= -1;  // as surveyed
  CHECK(heads({on_head(a)}, 1) == "-c");
}

TEST_CASE("a tag on its head on a page is upside down") {
  const Survey survey = hung();
  PictureEvidence evidence{survey, {}};
  evidence.up = UpSource::page;
  evidence.tags = {seen("019000000404", 100), seen("019000800402", 600)};
  FrameCorners& corners = evidence.tags[1].tag.corners;
  std::swap(corners[0], corners[2]);
  std::swap(corners[1], corners[3]);
  CHECK(!find_upside_down(evidence, evidence.tags[0]));
  CHECK(find_upside_down(evidence, evidence.tags[1])->rule == "upside-down");
}

}  // namespace tagsmith::detail
