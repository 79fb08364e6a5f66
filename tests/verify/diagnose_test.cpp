// SPDX-License-Identifier: Apache-2.0
// Why tags cannot be read, on rendered pictures.
#include "decoder/verify/diagnose.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include "decoder/image/transform.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "decoder/verify/evidence.hpp"
#include "decoder/verify/findings.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/turned_plate.hpp"

namespace tagsmith::detail {
namespace {

struct Shot {
  double distance = 1.2;
  double yaw = 0;  // degrees
  PlateFinish finish{};
  SensorModel sensor{};
};

const Survey& corridor() {
  static const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  return survey;
}

// What verify finds in a picture, stored as a camera stores it that was held so (EXIF).
std::vector<VerifiedTag> tags_in(const GrayView& image, const std::optional<int>& orientation,
                                 const PictureReading& read = read_tags) {
  PictureEvidence evidence{corridor(), image};
  evidence.is_photo = true;
  evidence.orientation = orientation;
  see_tags(read, evidence);
  find_faults(evidence);
  std::vector<VerifiedTag> tags;
  for (const TagEvidence& seen : evidence.tags) tags.push_back(seen.tag);
  return tags;
}

// The same of a picture of 000L.
std::vector<VerifiedTag> found_in(const Shot& shot, const std::optional<int>& orientation = 1) {
  const Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  ScenePlate plate{draw_tag(corridor().tag_template, corridor().tags[0].digits), {}, shot.finish};
  plate.camera_from_plate = camera_from_turned_plate(camera, plate.drawing, {640, 480},
                                                     shot.distance, radians(shot.yaw), 0, 0);
  ViewOptions options;
  options.sensor = shot.sensor;
  options.sensor.noise_sigma = 1.5;
  const View view = render_view(camera, std::span(&plate, 1), options);
  const int back = orientation == 6 ? 8 : orientation == 8 ? 6 : orientation.value_or(3);
  const GrayImage stored = turn_upright(view.image.view(), back);
  return tags_in(stored.view(), orientation);
}

}  // namespace

TEST_CASE("a refusal without a measured cause says what is suspected") {
  const Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  ScenePlate plate{draw_tag(corridor().tag_template, corridor().tags[0].digits), {}, {}};
  plate.camera_from_plate =
      camera_from_turned_plate(camera, plate.drawing, {640, 480}, 1.5, 0, 0, 0);
  const View view = render_view(camera, std::span(&plate, 1), {});
  const GrayView image = view.image.view();
  const ReadResult read = read_tags(image);
  REQUIRE(read.tags.size() == 1);
  const auto words = [&](RejectionReason reason) {
    ReadResult refused;
    refused.rejected.push_back({reason, read.tags[0].corners});
    const std::vector<VerifiedTag> tags =
        tags_in(image, 1, [&](auto&, auto&) { return std::exchange(refused, {}); });
    CHECK(tags.at(0).finding.rule == "undecodable");
    return tags[0].finding.message;
  };
  CHECK(words(RejectionReason::element_widths).find("Dirt, a scratch or a cable") !=
        std::string::npos);
  CHECK(words(RejectionReason::guard_pattern).find("They are covered, or it is no tag") !=
        std::string::npos);
  CHECK(words(RejectionReason::doubtful).find("one of its digits is in doubt") !=
        std::string::npos);
  CHECK(words(RejectionReason::covered).find("hangs before it or sticks on it") !=
        std::string::npos);
}

TEST_CASE("a tag that is in order has no diagnosis") {
  for (const double yaw : {-50.0, 0.0, 50.0}) {
    for (const double distance : {0.8, 1.5, 3.0}) {
      CAPTURE(yaw);
      CAPTURE(distance);
      const std::vector<VerifiedTag> tags = found_in({distance, yaw});
      REQUIRE(tags.size() == 1);
      CHECK(tags[0].finding.status == TagStatus::ok);
    }
  }
}

TEST_CASE("a tag seen from beyond the greatest angle at which any is read is end on") {
  const Camera camera{1280, 960, 6400, 6400, 639.5, 479.5};
  const TagTemplate& tag = corridor().tag_template;
  ScenePlate plate{draw_tag(tag, corridor().tags[0].digits), {}, {}};
  for (const double yaw : {86.0, -86.0}) {
    plate.camera_from_plate =
        camera_from_turned_plate(camera, plate.drawing, {640, 480}, 2, radians(yaw), 0, 0);
    const View view = render_view(camera, std::span(&plate, 1), {});
    Rejection refused;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d corner = view.plates[0].corners[i].value();
      refused.corners[i] = {corner.x(), corner.y()};
    }
    const Diagnosis why = diagnose(view.image.view(), tag, refused);
    CHECK(why.rule == "end-on");
    CHECK(why.words.find(" degrees from its front, 0.") != std::string::npos);
    CHECK(why.words.find("nothing is read so obliquely") != std::string::npos);
  }
}

TEST_CASE("what keeps a tag from being read is named, with number and limit") {
  struct Case {
    std::string name;
    Shot shot;
    const char* rule;
    const char* measured;
  };
  std::vector<Case> cases{
      {"far away", {10.8}, "too-small", "0.45 pixels a module"},
      {"farther", {11}, "too-small", "pixels a module"},
      {"out of focus", {2}, "blurred", "modules, limit 0.9"},
      {"far out of focus", {2}, "blurred", "modules, limit 0.9"},
      {"moved", {1.5}, "blurred", "modules, limit 0.9"},
      {"ink spread", {2.5}, "bars-grown", "modules, limit 0.7"},
      {"bars that nearly touch", {2.5, 35}, "bars-grown", "bars wider by 0.75 modules, limit 0.7"},
      {"bars like hairs", {2.5, 35}, "bars-grown", "bars narrower by 0.79 modules, limit 0.7"},
      {"a cable", {}, "covered", "(limit 5 %), at the middle left"},
      {"a pipe, blurred", {2, 20}, "covered", "of the bars are covered or damaged"},
      {"a pipe",
       {},
       "covered",
       "could not be read: 32 % of the bars are covered or damaged (limit 5 %), in the middle (the "
       "reader says: "},
      {"a pipe, overexposed", {}, "covered", "of the bars are covered or damaged"},
      {"dirt", {}, "covered", "of the bars are covered or damaged"},
      {"overexposed", {4.4}, "glare", "overexposed: its white is 255 of 255, the end of the scale"},
      {"much overexposed", {4.4}, "glare", "leaves bars narrower by 0."},
      {"a highlight", {}, "glare", "its darkest bars are"}};
  const auto shot_of = [&](const std::string& name) -> Shot& {
    return std::ranges::find(cases, name, &Case::name)->shot;
  };
  shot_of("far away").sensor.blur_sigma_px = 1.3;
  shot_of("farther").sensor.blur_sigma_px = 1.3;
  shot_of("out of focus").sensor.blur_sigma_px = 6.2;
  shot_of("far out of focus").sensor.blur_sigma_px = 8;
  shot_of("moved").sensor.motion_px = {15, 0};
  shot_of("ink spread").finish.bar_growth = 0.72;
  shot_of("bars that nearly touch").finish.bar_growth = 0.75;
  shot_of("bars that nearly touch").sensor.blur_sigma_px = 1;
  shot_of("bars like hairs").finish.bar_growth = -0.8;
  shot_of("bars like hairs").sensor.blur_sigma_px = 1;
  shot_of("a cable").finish.cover = Cover{{0.1, 0.02, 0.03, 0.13}};
  shot_of("a pipe").finish.cover = Cover{{0.1, 0.02, 0.1, 0.13}};
  shot_of("a pipe, blurred").finish.cover = Cover{{0.1, 0.02, 0.1, 0.13}};
  shot_of("a pipe, blurred").sensor.blur_sigma_px = 1;
  shot_of("a pipe, overexposed").finish.cover = Cover{{0.1, 0.02, 0.1, 0.13}};
  shot_of("a pipe, overexposed").sensor.exposure = 2;
  shot_of("overexposed").sensor.exposure = 2.1;
  shot_of("much overexposed").sensor.exposure = 2.5;
  shot_of("dirt").finish.dirt = Dirt{0.42, 0.03, 0.25, 11};
  shot_of("a highlight").finish.glare = Glare{{0.17, 0.08}, 0.1, 1};
  for (const Case& c : cases) {
    CAPTURE(c.name);
    const std::vector<VerifiedTag> tags = found_in(c.shot);
    REQUIRE(tags.size() == 1);
    CAPTURE(tags[0].finding.message);
    CHECK(tags[0].finding.status == TagStatus::unreadable);
    CHECK(tags[0].finding.rule == c.rule);
    CHECK(tags[0].finding.message.find(c.measured) != std::string::npos);
  }
}

TEST_CASE("a tag that is in doubt on an overexposed plate is not called dirty") {
  const Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  ScenePlate plate{draw_tag(corridor().tag_template, corridor().tags[0].digits), {}, {}};
  plate.camera_from_plate =
      camera_from_turned_plate(camera, plate.drawing, {640, 480}, 4.4, 0, 0, 0);
  const auto rule_at = [&](double exposure) {
    ViewOptions options;
    options.sensor.exposure = exposure;
    const View view = render_view(camera, std::span(&plate, 1), options);
    ReadOptions never_sure;
    never_sure.min_confidence = 1.1;
    const ReadResult read = read_tags(view.image.view(), never_sure);
    REQUIRE(read.rejected.size() == 1);
    CHECK(read.rejected[0].reason == RejectionReason::doubtful);
    return diagnose(view.image.view(), corridor().tag_template, read.rejected[0]).rule;
  };
  CHECK(rule_at(1) == "undecodable");
  CHECK(rule_at(1.8) == "glare");
}

TEST_CASE("white paper at the end of the scale is overexposed in photos alone") {
  const Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  ScenePlate plate{draw_tag(corridor().tag_template, corridor().tags[0].digits), {}, {}};
  plate.finish.bar_growth = -0.8;
  plate.camera_from_plate =
      camera_from_turned_plate(camera, plate.drawing, {640, 480}, 2.5, radians(35), 0, 0);
  ViewOptions options;
  options.sensor.blur_sigma_px = 1;
  options.sensor.exposure = 1.5;
  const View view = render_view(camera, std::span(&plate, 1), options);
  const GrayView image = view.image.view();
  const ReadResult read = read_tags(image);
  REQUIRE(read.rejected.size() == 1);
  const TagTemplate& tag = corridor().tag_template;
  CHECK(diagnose(image, tag, read.rejected[0]).rule == "glare");
  CHECK(diagnose(image, tag, read.rejected[0], 1, false).rule == "bars-grown");
}

TEST_CASE("a plate white on black is overexposed when its bars are too wide") {
  TagTemplate tag = corridor().tag_template;
  tag.white_on_black = true;
  const Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  ScenePlate plate{draw_tag(tag, corridor().tags[0].digits), {}, {}};
  plate.camera_from_plate =
      camera_from_turned_plate(camera, plate.drawing, {640, 480}, 4.4, 0, 0, 0);
  ViewOptions options;
  options.sensor.exposure = 2;
  const View view = render_view(camera, std::span(&plate, 1), options);
  const GrayImage negative = exchange_black_and_white(view.image.view());
  const ReadResult read = read_tags(negative.view());
  REQUIRE(read.rejected.size() == 1);
  const Diagnosis why = diagnose(negative.view(), tag, read.rejected[0]);
  CHECK(why.rule == "glare");
  CHECK(why.words.find("leaves bars wider by 0.") != std::string::npos);
}

TEST_CASE("the place on a plate is told as one sees it upright, however the camera was held") {
  Shot cable;
  cable.finish.cover = Cover{{0.1, 0.02, 0.03, 0.13}};
  for (const int orientation : {1, 3, 6, 8}) {
    CAPTURE(orientation);
    const std::vector<VerifiedTag> tags = found_in(cable, orientation);
    REQUIRE(tags.size() == 1);
    CAPTURE(tags[0].finding.message);
    CHECK(tags[0].finding.message.find("damaged (limit 5 %), at the middle left (the") !=
          std::string::npos);
  }
  // On its head, and nothing says so.
  CHECK(
      found_in(cable, std::nullopt)
          .at(0)
          .finding.message.find(
              "damaged (limit 5 %), at the middle right as the picture stands (which way is up") !=
      std::string::npos);
}

TEST_CASE("a picture too dark to show a tag, or washed out, is told") {
  const auto rule_of_light = [](std::uint8_t level) {
    const GrayImage flat{64, 48, std::vector<std::uint8_t>(64 * 48, level)};
    const auto diagnosis = diagnose_picture(flat.view());
    return diagnosis ? diagnosis->rule : "";
  };
  CHECK(rule_of_light(12) == "too-dark");
  CHECK(rule_of_light(250) == "glare");
  CHECK(rule_of_light(120) == "low-contrast");
}

}  // namespace tagsmith::detail
