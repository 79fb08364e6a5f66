// SPDX-License-Identifier: Apache-2.0
// Why tags cannot be read, on rendered pictures.
#include "decoder/verify/diagnose.hpp"

#include <string>

#include <doctest/doctest.h>

#include "decoder/reader/survey_options.hpp"
#include "decoder/simulate/render_view.hpp"
#include "decoder/verify/check_tags.hpp"
#include "decoder/verify/verify_file.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {
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

// What verify finds in a picture of 000L.
std::vector<TagFinding> found_in(const Shot& shot) {
  const Camera camera{1280, 960, 1600, 1600, 639.5, 479.5};
  ScenePlate plate{draw_tag(corridor().tag_template, corridor().tags[0].digits), {}, shot.finish};
  plate.camera_from_plate = camera_from_turned_plate(camera, plate.drawing, {640, 480},
                                                     shot.distance, radians(shot.yaw), 0, 0);
  ViewOptions options;
  options.sensor = shot.sensor;
  options.sensor.noise_sigma = 1.5;
  const View view = render_view(camera, std::span(&plate, 1), options);
  const GrayView image = view.image.view();
  std::vector<TagFinding> tags = check_tags(corridor(), read_for_survey(image, corridor()),
                                            PictureSize{image.width, image.height});
  diagnose_tags(image, corridor().tag_template, read_options_for(std::span(&corridor(), 1)), tags);
  return tags;
}

std::string rule_of(const std::vector<TagFinding>& tags) {
  return tags.empty() ? "nothing found" : tags[0].rule;
}

}  // namespace

TEST_CASE("a tag that is in order has no diagnosis") {
  for (const double yaw : {-50.0, 0.0, 50.0}) {
    for (const double distance : {0.8, 1.5, 3.0}) {
      CAPTURE(yaw);
      CAPTURE(distance);
      const std::vector<TagFinding> tags = found_in({distance, yaw});
      REQUIRE(tags.size() == 1);
      CHECK(tags[0].status == TagStatus::ok);
    }
  }
}

TEST_CASE("EXPLORE") {
  for (double d : {4.0, 6.0, 8.0, 10.0, 12.0, 14.0}) { auto t = found_in({d}); printf("dist %.1f: %s %s\n", d, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
  for (double y : {60.0, 68.0, 72.0, 75.0, 78.0}) { auto t = found_in({1.0, y}); printf("yaw %.1f: %s %s\n", y, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
  for (double e : {0.2, 0.1, 0.05, 0.02, 0.01}) { Shot s; s.sensor.exposure = e; auto t = found_in(s); printf("exp %.3f: %s %s\n", e, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
  for (double b : {2.0, 3.0, 4.0, 5.0, 6.0, 8.0}) { Shot s; s.sensor.blur_sigma_px = b; auto t = found_in(s); printf("blur %.1f: %s %s\n", b, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
  for (double g : {-0.9, -0.75, 0.5, 0.7, 0.8, 0.9}) { Shot s; s.finish.bar_growth = g; auto t = found_in(s); printf("growth %.2f: %s %s\n", g, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
  for (double w : {0.03, 0.06, 0.1, 0.15}) { Shot s; s.finish.cover = Cover{{0.1, 0.02, w, 0.13}, 0.15}; auto t = found_in(s); printf("cover %.2f: %s %s\n", w, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
  for (double w : {1.0, 3.0, 10.0, 30.0}) { Shot s; s.finish.glare = Glare{{0.17, 0.08}, 0.1, w}; auto t = found_in(s); printf("glare %.2f: %s %s\n", w, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
  for (double w : {0.5, 0.7, 0.75, 0.78}) { Shot s; s.finish.ink_reflectance = w; auto t = found_in(s); printf("ink %.2f: %s %s\n", w, rule_of(t).c_str(), t.empty() ? "" : t[0].message.c_str()); }
}

}  // namespace tagsmith
