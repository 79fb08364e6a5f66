// SPDX-License-Identifier: Apache-2.0
// Where a plan says that each tag is read, how far it looks, and which walls it minds.
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/placement/optimise.hpp"
#include "tagsmith/placement/reader_limits.hpp"
#include "tagsmith/placement/sight.hpp"
#include "tagsmith/placement/tunnel_surfaces.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/placement/corridors.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

// The crawler with a camera more, which sees the left wall farther ahead.
Rig three_cameras() {
  Rig rig = crawler();
  rig.cameras.push_back(rig.cameras.front());
  rig.cameras.back().name = "ahead";
  rig.cameras.back().vehicle_from_camera = vehicle_from_side_camera(Side::left, radians(60));
  return rig;
}

// A crawler that looks back, where tags grow smaller until they are lost.
Rig looking_back() {
  Rig rig = crawler();
  for (RigCamera& camera : rig.cameras) {
    const Side side = camera.name == "left" ? Side::left : Side::right;
    camera.vehicle_from_camera = vehicle_from_side_camera(side, radians(-35));
  }
  return rig;
}

// The best view of each tag that is read with the book, standing on the center line.
std::map<std::size_t, TagView> views_from(const SightModel& model, double chainage) {
  const CenterlinePoint point = model.survey().tunnel.centerline.at(chainage);
  const Pose pose =
      world_from_vehicle(vehicle_on_floor(point, {model.rig().vehicle_height, 0, 0, 0, 0}));
  std::map<std::size_t, TagView> views;
  for (std::size_t camera = 0; camera < model.rig().cameras.size(); ++camera) {
    const CameraStand stand = model.stand(camera, pose, point.curvature);
    for (std::size_t tag = 0; tag < model.survey().tags.size(); ++tag) {
      const auto sight = model.look(camera, stand, tag, model.surroundings(chainage, chainage));
      if (!sight || sight->travel_book < 0 || views[tag].module_px > sight->module_px) continue;
      views[tag] = {chainage, sight->distance, sight->module_px, std::acos(sight->cosine)};
    }
  }
  std::erase_if(views, [](const auto& view) { return view.second.module_px == 0; });
  return views;
}

// The most pixels that the picture's corner moves by for a small turn of its ray.
double corner_px_per_radian(const Camera& camera) {
  constexpr double kTurn = 1e-5;
  const Eigen::Vector3d ray = ray_through(camera, {0, 0}).value().normalized();
  const Eigen::Vector3d aside = ray.unitOrthogonal();
  double most = 0;
  for (int i = 0; i < 180; ++i) {
    const Eigen::Vector3d turned =
        Eigen::AngleAxisd(kTurn, Eigen::AngleAxisd(radians(i), ray) * aside) * ray;
    most = std::max(most, project(camera, turned).value().norm() / kTurn);
  }
  return most;
}

}  // namespace

TEST_CASE("a tag's last view is that of the last place from which it is read, in the best camera") {
  const Survey survey = straight_survey(10, 8);
  PlanOptions options;
  options.step = 0.06;
  options.accuracy = false;
  for (const Rig& rig : {three_cameras(), looking_back()}) {
    const DrivePlan plan = plan_drive(survey, rig, options).value();
    const SightModel model(survey, rig);
    std::map<std::size_t, TagView> first, last;
    for (const PlanColumn& column : plan.columns) {
      for (const auto& [tag, view] : views_from(model, column.chainage)) {
        first.try_emplace(tag, view);
        last[tag] = view;
      }
    }
    REQUIRE(first.size() >= 14);
    for (std::size_t tag = 0; tag < survey.tags.size(); ++tag) {
      CAPTURE(survey.tags[tag].name);
      CHECK(plan.tags[tag].is_read == first.contains(tag));
      if (!first.contains(tag)) continue;
      CHECK(plan.tags[tag].first.chainage == first[tag].chainage);
      CHECK(plan.tags[tag].last.chainage == last[tag].chainage);
      CHECK(plan.tags[tag].last.module_px == doctest::Approx(last[tag].module_px));
      CHECK(plan.tags[tag].last.distance == doctest::Approx(last[tag].distance));
      CHECK(plan.tags[tag].last.incidence == doctest::Approx(last[tag].incidence));
    }
  }
}

TEST_CASE("a plan must share more than a point with the center line") {
  const Survey survey = straight_survey(10, 4);
  const auto plan = [&](double from, double to) {
    PlanOptions options;
    options.from = from;
    options.to = to;
    options.accuracy = false;
    return plan_drive(survey, crawler(), options).has_value();
  };
  CHECK_FALSE(plan(10, 12));
  CHECK_FALSE(plan(-2, 0));
  CHECK(plan(9.5, 12));
  CHECK(plan(-2, 0.5));
}

TEST_CASE("no tag is looked for farther away than the picture's corner could show it") {
  const Survey survey = straight_survey(10, 4);
  Rig rig = crawler();
  rig.cameras.resize(1);
  for (const double width : {640.0, 1280.0, 2560.0}) {
    CAPTURE(width);
    Camera& camera = rig.cameras.front().camera;
    camera = camera_from_sensor(static_cast<int>(width), 480, 0.006, 0.0048, 0.0036);
    const double px_per_radian = corner_px_per_radian(camera);
    const double module = draw_tag(survey.tag_template, survey.tags.front().digits).module;
    const double farthest = px_per_radian * module / BlurLimits(true).least_module_px();
    CHECK(SightModel(survey, rig).reach() == doctest::Approx(farthest).epsilon(1e-3));
  }
  rig.cameras.front().camera = camera_from_sensor(400'000, 300'000, 0.006, 0.0048, 0.0036);
  CHECK(SightModel(survey, rig).reach() == kFarthestSight);
}

TEST_CASE("walls hide tags where the tunnel bends or either wall does not run straight") {
  const Rig rig = crawler();
  Survey survey = straight_survey(30, 8);
  const auto has_walls = [&](double first, double last) {
    return SightModel(survey, rig).surroundings(first, last).walls.has_value();
  };
  CHECK_FALSE(has_walls(5, 6));
  const ChainageProfile left = survey.tunnel.left, right = survey.tunnel.right;
  survey.tunnel.left = ChainageProfile({{0, -0.95}, {5, -1.2}});
  CHECK(has_walls(5, 6));
  survey.tunnel.left = left;
  survey.tunnel.right = ChainageProfile({{0, 0.95}, {5, 1.2}});
  CHECK(has_walls(5, 6));

  survey = survey_along({{60, 0, 0}, {5, 0.1, 0}, {60, 0, 0}}, 8);
  const double reach = SightModel(survey, rig).reach();
  REQUIRE(reach < 30);
  for (const double from_bend : {-reach + 0.5, -0.5, 0.5 + 5, reach - 0.5 + 5}) {
    CAPTURE(from_bend);
    CHECK(has_walls(60 + from_bend, 60 + from_bend));
  }
  CHECK_FALSE(has_walls(60 - reach - 0.5, 60 - reach - 0.5));
  CHECK_FALSE(has_walls(65 + reach + 0.5, 65 + reach + 0.5));
}

TEST_CASE("the walls go straight on before the tunnel's start and beyond its end") {
  const Survey survey = straight_survey(10, 4);
  const TunnelWalls walls(survey.tunnel, 0, 5);
  for (const double from : {-7.0, 3.0, 16.0}) {
    for (const double side : {-1.0, 1.0}) {
      const auto hit = walls.first_hit({0, from}, {side, 0.25});
      REQUIRE(hit);
      CHECK(hit->way == doctest::Approx(0.95));
      CHECK(hit->chainage == doctest::Approx(from + 0.25 * 0.95));
      CHECK(hit->side == (side < 0 ? Side::left : Side::right));
    }
  }
}

TEST_CASE("a bend whose centre lies within the tunnel has no inner wall") {
  Survey survey = survey_along({{4, 0, 0}, {2 * radians(90), -0.5, 0}, {4, 0, 0}}, 4);
  survey.tunnel.left = -2.5;
  const TunnelWalls walls(survey.tunnel, 0, 4);
  const CenterlinePoint start = survey.tunnel.centerline.at(4);
  const Eigen::Vector2d centre = start.position.head<2>() - 2 * right_of(start.heading).head<2>();
  for (int i = 0; i < 360; ++i) {
    CAPTURE(i);
    const Eigen::Vector2d direction = direction_of(radians(i)).head<2>();
    const auto hit = walls.first_hit(centre, direction);
    if (!hit) continue;
    const bool beside_bend = hit->chainage > 4.01 && hit->chainage < 3.99 + 2 * radians(90);
    CHECK((hit->side == Side::right || !beside_bend));
  }
}

TEST_CASE("layouts are the same when all is the same that a printer or a surveyor would notice") {
  const Survey survey = straight_survey(10, 4);
  const Layout layout{survey.tag_template, *survey.series, radians(30)};
  CHECK(is_same(layout, layout));
  std::vector<Layout> others(6, layout);
  others[0].tag_template.name = "other";
  others[1].series.spacing += 0.1;
  others[2].series.mount_height += 0.1;
  others[3].series.pairs += 1;
  others[4].series.pair_angle = radians(11);
  others[5].alpha = std::nullopt;
  for (const Layout& other : others) CHECK_FALSE(is_same(layout, other));
}
