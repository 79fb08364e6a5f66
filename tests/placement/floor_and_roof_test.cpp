// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <doctest/doctest.h>

#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/placement/sight.hpp"
#include "tagsmith/placement/tunnel_surfaces.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/placement/corridors.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using Eigen::Vector3d;

TEST_CASE("a crest hides what stands low behind it, a sag what hangs high") {
  Survey survey = survey_along({{5, 0, 0.2}, {5, 0, -0.2}}, 4);
  const FloorAndRoof crest(survey.tunnel, 5);
  REQUIRE_FALSE(crest.is_even());
  // From 2 m before the top, 0.3 m above the floor, to 2 m behind it: the top lies 0.4 m higher
  // than both floors.
  const Vector3d eye(0, 3, 0.6 + 0.3);
  const auto low = crest.first_exit(eye, Vector3d(0, 4, 0), 1);
  REQUIRE(low.has_value());
  CHECK(low->through_floor);
  CHECK(low->first_outside == doctest::Approx(0.5));
  CHECK_FALSE(crest.first_exit(eye, Vector3d(0, 4, 0.3), 1).has_value());
  CHECK_FALSE(crest.first_exit(eye, Vector3d(0, 1.9, 0), 1).has_value());

  survey = survey_along({{5, 0, -0.2}, {5, 0, 0.2}}, 4);
  const FloorAndRoof sag(survey.tunnel, 5);
  const Vector3d high(0, 3, -0.6 + 2.9);  // 0.1 m below the roof of 3 m
  const auto roof = sag.first_exit(high, Vector3d(0, 4, 0), 1);
  REQUIRE(roof.has_value());
  CHECK_FALSE(roof->through_floor);
  CHECK(FloorAndRoof(straight_survey(10, 2).tunnel, 5).is_even());
}

namespace {

// Least height of a ray above the floor or below the roof, looked at every few centimetres.
double clearance(const Tunnel& tunnel, const Vector3d& from, const Vector3d& way) {
  constexpr int kSteps = 300;
  double least = 10;
  for (int i = 0; i <= kSteps; ++i) {
    const Vector3d point = from + way * i / kSteps;
    const double chainage = tunnel.centerline.locate(point.head<2>()).chainage;
    const double above = point.z() - tunnel.centerline.at(chainage).position.z();
    least = std::min({least, above, tunnel.height.at(chainage) - above});
  }
  return least;
}

}  // namespace

TEST_CASE(
    "in bends with grades, only lines of sight that graze the floor or the roof are told wrong") {
  // Cameras and plates just above the floor, so that much is hidden.
  const Survey survey = load_survey("tests/bench/decline/survey.yaml").value();
  constexpr double kEye = 0.25;
  constexpr double kPlatesLower = 1.5;
  int hidden = 0;
  int wrong = 0;
  for (double chainage = 1; chainage < 72; chainage += 0.5) {
    const CenterlinePoint floor = survey.tunnel.centerline.at(chainage);
    const FloorAndRoof floor_and_roof(survey.tunnel, chainage);
    for (const PlacedTag& tag : survey.tags) {
      if (std::abs(tag.chainage - chainage) > 15) continue;
      for (const double offset : {-1.2, 0.0, 1.2}) {
        const Vector3d eye =
            floor.position + offset * right_of(floor.heading) + Vector3d(0, 0, kEye);
        const Vector3d way = tag.world_from_plate.translation - Vector3d(0, 0, kPlatesLower) - eye;
        const double least = clearance(survey.tunnel, eye, way);
        const bool is_hidden = floor_and_roof.first_exit(eye, way, 1).has_value();
        hidden += is_hidden ? 1 : 0;
        wrong += is_hidden != (least < 0) ? 1 : 0;
      }
    }
  }
  CHECK(hidden > 400);
  CHECK(wrong == 0);
}

TEST_CASE("behind a crest the plan sees the plates that the simulation shows") {
  const Survey survey = survey_along({{6, 0, 0.25}, {6, 0, -0.25}}, 13);
  Rig rig = crawler();
  for (RigCamera& camera : rig.cameras) {  // looks farther ahead
    camera.camera = camera_from_sensor(640, 480, 0.012, 0.0048, 0.0036);
    camera.vehicle_from_camera = vehicle_from_side_camera(*camera.side, radians(65));
  }
  const SightModel model(survey, rig);
  const FloorAndRoof floor_and_roof(survey.tunnel, 5);
  int hidden = 0;
  int open = 0;
  for (const double chainage : {3.0, 4.0, 4.6, 5.2}) {
    const CenterlinePoint floor = survey.tunnel.centerline.at(chainage);
    const Pose pose = world_from_vehicle(vehicle_on_floor(floor, {.height = 0.24}));
    for (const std::size_t camera : {std::size_t{0}, std::size_t{1}}) {
      const SurveyView view = render_survey_view(survey, rig.cameras[camera], pose, {}, 1);
      const CameraStand stand = model.stand(camera, pose, 0);
      for (std::size_t tag = 0; tag < survey.tags.size(); ++tag) {
        if (!model.look(camera, stand, tag, {})) continue;
        const auto shown = std::ranges::find(view.tags, tag);
        const double visible =
            shown == view.tags.end()
                ? 0
                : view.view.plates[static_cast<std::size_t>(shown - view.tags.begin())]
                      .visible_fraction;
        const bool in_open = model.look(camera, stand, tag, {{}, floor_and_roof}).has_value();
        CAPTURE(chainage);
        CAPTURE(survey.tags[tag].name);
        CAPTURE(visible);
        if (in_open) CHECK(visible > 0.95);
        if (!in_open) CHECK(visible < 0.999);
        ++(in_open ? open : hidden);
      }
    }
  }
  CHECK(open > 0);
  CHECK(hidden > 0);
}
