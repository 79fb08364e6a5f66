// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/sight.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/simulate/plate_in_image.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tests/placement/corridors.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

ScenePlate scene_plate(const Survey& survey, const RigCamera& camera,
                       const Pose& world_from_vehicle, std::size_t tag) {
  const Pose camera_from_plate =
      inverse(world_from_vehicle * camera.vehicle_from_camera) * survey.tags[tag].world_from_plate;
  return {draw_tag(survey.tag_template, survey.tags[tag].digits), camera_from_plate, {}};
}

// What the simulation, which shares no code with the planner's sight, says of the plate.
PlateTruth truth_of(const Survey& survey, const RigCamera& camera, const Pose& world_from_vehicle,
                    std::size_t tag) {
  const ScenePlate plate = scene_plate(survey, camera, world_from_vehicle, tag);
  return plate_truths(camera.camera, std::span(&plate, 1)).front();
}

bool is_inside(const Camera& camera, const PlateTruth& truth, double border) {
  return std::ranges::all_of(truth.corners, [&](const auto& corner) {
    return corner && corner->x() >= border && corner->y() >= border &&
           corner->x() <= camera.width - 1 - border && corner->y() <= camera.height - 1 - border;
  });
}

// Calls `look` with each camera's stand at 400 drawn poses, and each tag.
void from_drawn_poses(const SightModel& model, const auto& look) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> either(-1, 1);
  for (int i = 0; i < 400; ++i) {
    CAPTURE(i);
    // In stated order: compilers evaluate the arguments of a call in different orders.
    const double x = 0.5 * either(random);
    const double y = 4 + 4 * either(random);
    const Pose pose = world_from_vehicle({x, y, 0.24}, radians(20) * either(random));
    for (std::size_t c = 0; c < model.rig().cameras.size(); ++c) {
      const CameraStand stand = model.stand(c, pose, 0);
      for (std::size_t tag = 0; tag < model.survey().tags.size(); ++tag) {
        CAPTURE(model.survey().tags[tag].name);
        look(pose, c, stand, tag);
      }
    }
  }
}

void check_against_simulation(const Survey& survey, const Rig& rig) {
  const SightModel model(survey, rig);
  int seen = 0;
  from_drawn_poses(
      model, [&](const Pose& pose, std::size_t c, const CameraStand& stand, std::size_t tag) {
        const auto sight = model.look(c, stand, tag, {});
        const PlateTruth truth = truth_of(survey, rig.cameras[c], pose, tag);
        const bool is_whole = truth.incidence < radians(89) && truth.module_px >= 0.8 &&
                              is_inside(rig.cameras[c].camera, truth, kBorderPx);
        if (is_whole) REQUIRE(sight.has_value());
        if (!sight) return;
        ++seen;
        CHECK(is_inside(rig.cameras[c].camera, truth, kBorderPx - 1e-6));
        CHECK(sight->module_px == doctest::Approx(truth.module_px).epsilon(1e-4));
        CHECK(std::acos(sight->cosine) == doctest::Approx(truth.incidence).epsilon(1e-6));
        CHECK(model.may_see(c, stand, tag, 0, 0));
      });
  CHECK(seen > 300);
}

}  // namespace

TEST_CASE("what is seen, how large and how obliquely is what the simulation shows") {
  check_against_simulation(straight_survey(10, 8), crawler());
}

TEST_CASE("a part of a plate is what the simulation shows from one end to beyond the middle") {
  const Survey survey = straight_survey(10, 8);
  Rig rig = crawler();
  const SightModel model(survey, rig);
  int parts = 0;
  from_drawn_poses(model,
                   [&](const Pose& pose, std::size_t c, const CameraStand& stand, std::size_t tag) {
                     if (!model.shows_part(c, stand, tag, {}, 0)) return;
                     CHECK(model.may_see(c, stand, tag, 0, 0));
                     if (model.look(c, stand, tag, {})) return;
                     ++parts;
                     const PlateTruth truth = truth_of(survey, rig.cameras[c], pose, tag);
                     const auto is_in = [&](std::size_t corner) {
                       const auto& at = truth.corners[corner];
                       return at && in_image(rig.cameras[c].camera, *at);
                     };
                     CHECK(((is_in(0) && is_in(3)) || (is_in(1) && is_in(2))));
                     CHECK_FALSE(is_inside(rig.cameras[c].camera, truth, kBorderPx));
                   });
  CHECK(parts > 20);
  for (RigCamera& camera : rig.cameras) camera.camera.distortion = {-0.2, 0.05, 0.001, -0.001, 0};
  const SightModel bent(survey, rig);
  const Pose inside = world_from_vehicle({0, 2, 0.24}, 0);
  for (std::size_t tag = 0; tag < survey.tags.size(); ++tag) {
    CHECK_FALSE(bent.shows_part(0, bent.stand(0, inside, 0), tag, {}, 0));
  }
}

TEST_CASE("also through a lens that distorts") {
  Rig rig = crawler();
  for (RigCamera& camera : rig.cameras) camera.camera.distortion = {-0.2, 0.05, 0.001, -0.001, 0};
  check_against_simulation(straight_survey(10, 8), rig);
}

TEST_CASE("a plate is not seen from behind, nor behind the camera") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  const SightModel model(survey, rig);
  const auto sees = [&](const Pose& pose, std::size_t tag) {
    return model.look(0, model.stand(0, pose, 0), tag, {}).has_value();
  };
  const Pose inside = world_from_vehicle({0, 2, 0.24}, 0);
  CHECK(sees(inside, 6));  // 003L, ahead to the left
  CHECK_FALSE(sees(inside, 7));
  CHECK_FALSE(sees(inside, 0));
  // In the rock behind the right wall, looking to the left: 003R shows its back.
  CHECK_FALSE(sees(world_from_vehicle({1.9, 2, 0.24}, 0), 7));
}

TEST_CASE("the inner wall of a bend hides what lies behind it") {
  const double radius = 3;
  const Survey survey =
      survey_along({{2, 0, 0}, {radius * radians(90), 1 / radius, 0}, {6, 0, 0}}, 12);
  Rig rig = crawler();
  rig.cameras[1].vehicle_from_camera = vehicle_from_camera(radians(-30), 0, 0, {0, 0, 0});
  const SightModel model(survey, rig);
  const Pose pose = world_from_vehicle({0, 0.2, 0.24}, 0);
  const CameraStand stand = model.stand(1, pose, 0);
  const Surroundings around = model.surroundings(0, 0);
  int open = 0;
  int hidden = 0;
  for (std::size_t tag = 0; tag < survey.tags.size(); ++tag) {
    const bool in_open = model.look(1, stand, tag, around).has_value();
    if (model.look(1, stand, tag, {})) ++(in_open ? open : hidden);
    if (in_open) CHECK(survey.tags[tag].chainage < 7);
  }
  CHECK(open >= 1);
  CHECK(hidden >= 1);
}

TEST_CASE("a plate on a pillar hides what the simulation hides behind it") {
  Survey survey = straight_survey(10, 8);
  const PlateAttitude attitude{radians(150), 0, 0};
  survey.tags.push_back(place_surveyed(survey, {900, Side::left}, {-0.5, 5, 0.45}, attitude));
  const Rig rig = crawler();
  const SightModel model(survey, rig);
  const Surroundings around = model.surroundings(0, 8);
  REQUIRE(around.standing_out == std::vector{survey.tags.size() - 1});
  int open = 0;
  int hidden = 0;
  int at_corner = 0;
  from_drawn_poses(
      model, [&](const Pose& pose, std::size_t c, const CameraStand& stand, std::size_t tag) {
        if (!model.look(c, stand, tag, {})) return;
        std::vector<ScenePlate> plates;
        for (std::size_t i = 0; i < survey.tags.size(); ++i) {
          plates.push_back(scene_plate(survey, rig.cameras[c], pose, i));
        }
        const double visible = plate_truths(rig.cameras[c].camera, plates)[tag].visible_fraction;
        const bool in_open = model.look(c, stand, tag, around).has_value();
        CHECK(model.shows_part(c, stand, tag, around, 0) <= in_open);
        ++(in_open ? open : hidden);
        // Between the lines of sight that are tried, a corner of the other plate may hide a little.
        if (in_open) CHECK(visible > 0.95);
        // The simulation counts places within the frame, none of them exactly at a corner.
        if (!in_open && visible == 1) ++at_corner;
      });
  CHECK(open > 300);
  CHECK(hidden > 20);
  CHECK(at_corner <= hidden / 20);
  CHECK(SightModel(straight_survey(10, 8), rig).surroundings(0, 8).standing_out.empty());
}

TEST_CASE("the picture smears by speed, exposure and nearness") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  const SightModel model(survey, rig);
  const Pose pose = world_from_vehicle({0, 2, 0.24}, 0);
  const auto sight = model.look(0, model.stand(0, pose, 0), 6, {});
  REQUIRE(sight.has_value());
  // By the simulation: where the middle of the frame goes when the vehicle goes on by 1 mm.
  const Pose ahead = world_from_vehicle({0, 2.001, 0.24}, 0);
  const RigCamera& camera = rig.cameras[0];
  const PlateTruth before = truth_of(survey, camera, pose, 6);
  const PlateTruth after = truth_of(survey, camera, ahead, 6);
  double moved = 0;
  for (std::size_t i = 0; i < 4; ++i) moved += (*after.corners[i] - *before.corners[i]).norm() / 4;
  CHECK(sight->smear_px == doctest::Approx(1000 * moved).epsilon(0.1));
  CHECK(sight->travel_book >= sight->travel_plain);
  CHECK(sight->travel_plain > 0);
}

TEST_CASE("out of focus is blurred") {
  const Survey survey = straight_survey(10, 8);
  Rig rig = crawler();
  const Pose pose = world_from_vehicle({0, 2, 0.24}, 0);
  const SightModel sharp(survey, rig);
  const auto without = sharp.look(0, sharp.stand(0, pose, 0), 6, {});
  rig.cameras[0].focus = 0.3;
  rig.cameras[0].aperture = 0.003;
  const SightModel near(survey, rig);
  const auto with = near.look(0, near.stand(0, pose, 0), 6, {});
  REQUIRE(without.has_value());
  REQUIRE(with.has_value());
  // Thin lens: 1600 px * 3 mm * |1/0.3 - 1/depth| / 4.
  CHECK(without->blur_px == kUsualBlurPx);
  CHECK(with->blur_px > 2);
  CHECK(with->travel_book < without->travel_book);
}

TEST_CASE("a plate is judged by its farther end, and no exposure smears it by more than is read") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  const SightModel model(survey, rig);
  int seen = 0;
  from_drawn_poses(model, [&](const Pose& pose, std::size_t c, const CameraStand& stand,
                              std::size_t tag) {
    const auto sight = model.look(c, stand, tag, {});
    if (!sight || sight->travel_book < 0) return;
    ++seen;
    // A module at each end of the frame, by the camera.
    const double module = module_width(survey.tag_template);
    const Pose camera_from_plate =
        inverse(pose * rig.cameras[c].vehicle_from_camera) * survey.tags[tag].world_from_plate;
    double least = sight->module_px;
    for (const double x : {0.0, survey.tag_template.frame_inner_length}) {
      const double y = survey.tag_template.frame_inner_height / 2;
      const auto from =
          project(rig.cameras[c].camera, camera_from_plate * Eigen::Vector3d(x - module / 2, y, 0));
      const auto to =
          project(rig.cameras[c].camera, camera_from_plate * Eigen::Vector3d(x + module / 2, y, 0));
      least = std::min(least, (*to - *from).norm());
    }
    CHECK(sight->effective_px == doctest::Approx(least).epsilon(0.001));
    CHECK(sight->travel_book * sight->smear_px <= 3.001 * sight->module_px);
    CHECK(sight->travel_book * sight->smear_down <= 1.001);
  });
  CHECK(seen > 100);
}

TEST_CASE("bars that lie along the way are smeared by a stroke at most") {
  Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  const Pose pose = world_from_vehicle({0, 2, 0.24}, 0);
  // Turned in its plane about the middle of its frame.
  Pose& placed = survey.tags[6].world_from_plate;
  const TagTemplate& tag = survey.tag_template;
  const Eigen::Vector3d middle(tag.frame_inner_length / 2, tag.frame_inner_height / 2, 0);
  const Eigen::Vector3d at = placed * middle;
  placed.rotation =
      placed.rotation * Eigen::AngleAxisd(radians(90), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  placed.translation = at - placed.rotation * middle;
  const SightModel model(survey, rig);
  const auto sight = model.look(0, model.stand(0, pose, 0), 6, {});
  REQUIRE(sight.has_value());
  CHECK(sight->travel_book > 0.3 * tag.frame_stroke);
  CHECK(sight->travel_book < 3 * tag.frame_stroke);
}
