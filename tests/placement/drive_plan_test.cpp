// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/drive_plan.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/placement/optimise.hpp"
#include "tagsmith/placement/plan_summary.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/placement/corridors.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

DrivePlan planned(const Survey& survey, const Rig& rig, PlanOptions options = {}) {
  const Result<DrivePlan> plan = plan_drive(survey, rig, options);
  REQUIRE_MESSAGE(plan.has_value(), plan.error().message);
  return *plan;
}

Rig wandering() {
  Rig rig = crawler();
  rig.envelope = VehicleEnvelope{0.2, radians(6), 0, radians(1), radians(1)};
  return rig;
}

// What one pose sees, without blocks, candidates or threads.
WallCount seen_by_force(const Survey& survey, const Rig& rig, double chainage) {
  const SightModel model(survey, rig);
  const CenterlinePoint point = survey.tunnel.centerline.at(chainage);
  const Surroundings around{TunnelWalls(survey.tunnel, wall_standoff(survey, chainage), chainage),
                            FloorAndRoof(survey.tunnel, chainage)};
  WallCount count;
  for (int h = -2; h <= 2; ++h) {
    for (int l = -2; l <= 2; ++l) {
      for (int tilt = 0; tilt < 5; ++tilt) {
        FloorStance stance{rig.vehicle_height, 0.1 * l, radians(3) * h, 0, 0};
        stance.roll = tilt == 1 ? radians(1) : tilt == 2 ? -radians(1) : 0;
        stance.pitch = tilt == 3 ? radians(1) : tilt == 4 ? -radians(1) : 0;
        const VehiclePose pose = vehicle_on_floor(point, stance);
        bool left = false;
        bool right = false;
        for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
          const CameraStand stand = model.stand(camera, world_from_vehicle(pose), point.curvature);
          for (std::size_t tag = 0; tag < survey.tags.size(); ++tag) {
            if (!model.look(camera, stand, tag, around)) continue;
            (survey.tags[tag].side == Side::left ? left : right) = true;
          }
        }
        if (left && right) {
          ++count.both;
        } else if (left || right) {
          ++count.one;
        }
      }
    }
  }
  return count;
}

}  // namespace

TEST_CASE("the sweep sees what looking at every tag from every pose sees") {
  const Rig rig = wandering();
  const Survey bend = survey_along({{2, 0, 0}, {4, 0.25, 0}, {2, 0, 0}, {4, -0.25, 0.02}}, 10, 0.7);
  PlanOptions options;
  options.step = 0.31;
  options.accuracy = false;
  const Survey hills = survey_along({{3, 0, 0.15}, {2, 0.1, -0.2}, {4, 0, 0.15}}, 8, 0.5);
  for (const Survey& survey : {straight_survey(10, 6, 0.9), bend, hills}) {
    const DrivePlan plan = planned(survey, rig, options);
    CHECK(plan.poses_per_column == 125);
    for (const PlanColumn& column : plan.columns) {
      CAPTURE(column.chainage);
      const WallCount expected = seen_by_force(survey, rig, column.chainage);
      CHECK(column.seen.both == expected.both);
      CHECK(column.seen.one == expected.one);
    }
  }
}

TEST_CASE("a plan is the same whatever the number of threads and the steps around it") {
  const Survey survey = straight_survey(10, 8);
  PlanOptions one;
  one.jobs = 1;
  PlanOptions part;
  part.from = 2;
  part.to = 3;
  const DrivePlan all = planned(survey, wandering());
  const DrivePlan single = planned(survey, wandering(), one);
  const DrivePlan middle = planned(survey, wandering(), part);
  REQUIRE(all.columns.size() == 201);
  REQUIRE(middle.columns.size() == 21);
  for (std::size_t i = 0; i < all.columns.size(); ++i) {
    CHECK(all.columns[i].read.both == single.columns[i].read.both);
    CHECK(all.columns[i].worst.plane == single.columns[i].worst.plane);
  }
  for (std::size_t i = 0; i < middle.columns.size(); ++i) {
    CHECK(middle.columns[i].read.both == all.columns[i + 40].read.both);
    CHECK(middle.columns[i].nominal.plane ==
          doctest::Approx(all.columns[i + 40].nominal.plane).epsilon(1e-9));
  }
}

TEST_CASE("beyond the last tag there is a gap, and the summary says where") {
  const Survey survey = straight_survey(10, 4);
  const PlanSummary summary = summarize(planned(survey, crawler()));
  REQUIRE(summary.longest_gap.has_value());
  CHECK(summary.longest_gap->to == doctest::Approx(10));
  CHECK(summary.longest_gap->from > 2);
  CHECK(summary.longest_gap->from < 3.2);
  CHECK(summary.covered_share < 0.4);
  CHECK(summary.read.none == doctest::Approx(1 - summary.covered_share).epsilon(1e-6));
  REQUIRE(summary.nominal_plane.has_value());
  CHECK(summary.nominal_plane->median < 0.01);
  CHECK(summary.first_reading.has_value());
}

TEST_CASE("the summary's middle, 95 % and worst sigmas are those of the columns") {
  DrivePlan plan = planned(straight_survey(6, 8), crawler());
  plan.columns.resize(101);
  for (std::size_t i = 0; i < plan.columns.size(); ++i) {
    plan.columns[i].nominal.plane = 0.001 * static_cast<double>(37 * i % 101);
  }
  const PlanSummary summary = summarize(plan);
  REQUIRE(summary.nominal_plane.has_value());
  CHECK(summary.nominal_plane->median == doctest::Approx(0.050));
  CHECK(summary.nominal_plane->high == doctest::Approx(0.095));
  CHECK(summary.nominal_plane->worst == doctest::Approx(0.100));
}

TEST_CASE("without a tag there is nothing, and nothing breaks") {
  const PlanSummary summary = summarize(planned(straight_survey(5, 0), crawler()));
  CHECK(summary.read.none == 1);
  CHECK(summary.covered_share == 0);
  CHECK(summary.gaps.size() == 1);
  CHECK_FALSE(summary.nominal_plane.has_value());
  CHECK_FALSE(summary.paper.has_value());
}

TEST_CASE("a tag is indispensable where its loss leaves a pose without any") {
  // Far apart, on one wall each by turns: every tag is alone for a while.
  Survey survey = straight_survey(10, 8, 1.6);
  std::erase_if(survey.tags, [](const PlacedTag& tag) {
    return (tag.pair % 2 == 0) == (tag.side == Side::left);
  });
  const DrivePlan plan = planned(survey, crawler());
  const PlanSummary summary = summarize(plan);
  REQUIRE_FALSE(summary.critical_tags.empty());
  CHECK(summary.covered_share_one_lost < summary.covered_share);
  // Proved by taking the tag away.
  const CriticalTag& worst = summary.critical_tags.front();
  Survey without = survey;
  without.tags.erase(without.tags.begin() + static_cast<std::ptrdiff_t>(worst.tag));
  const PlanSummary after = summarize(planned(without, crawler()));
  CHECK((summary.covered_share - after.covered_share) * 10.05 ==
        doctest::Approx(worst.length).epsilon(0.01));
}

TEST_CASE("parts of tags confirm positions along more of the drive than whole tags alone") {
  const Survey survey = load_survey("surveys/curved/survey.yaml").value();
  const Rig rig = load_rig("surveys/curved/rig.yaml").value();
  const DrivePlan plan = planned(survey, rig);
  const PlanSummary summary = summarize(plan);
  CHECK(summary.confirmed_share > summary.covered_share_one_lost + 0.05);
  CHECK(summary.confirmed_share <= summary.covered_share);
  for (const PlanColumn& column : plan.columns) {
    CHECK(column.confirmed <= column.read.any());
    if (column.least_tags > 1) CHECK(column.confirmed == plan.poses_per_column);
  }
  // A single tag is confirmed by no part of itself.
  Survey alone = survey;
  alone.tags.resize(1);
  CHECK(summarize(planned(alone, rig)).confirmed_share == 0);
}

TEST_CASE("speed and exposure blur tags away, at the speed that the plan names") {
  const Survey survey = straight_survey(6, 8);
  Rig rig = crawler();
  for (RigCamera& camera : rig.cameras) camera.exposure = 0.004;
  PlanOptions options;
  options.to = 4;
  options.accuracy = false;
  const PlanSummary still = summarize(planned(survey, rig, options));
  REQUIRE(still.covered_share == 1);
  REQUIRE(std::isfinite(still.speed_all));
  CHECK(still.speed_all == doctest::Approx(still.travel_all / 0.004).epsilon(1e-9));
  options.speed = 0.99 * still.speed_all;
  CHECK(summarize(planned(survey, rig, options)).covered_share == 1);
  options.speed = 1.01 * still.speed_all;
  CHECK(summarize(planned(survey, rig, options)).covered_share < 1);
}

TEST_CASE("what does not fit is refused in words") {
  const Survey survey = straight_survey(10, 4);
  Rig wide = crawler();
  wide.envelope = VehicleEnvelope{0.95, 0, 0, 0, 0};
  CHECK(plan_drive(survey, wide, {}).error().message.find("expected less than the nearest wall") !=
        std::string::npos);
  PlanOptions backwards;
  backwards.from = 3;
  backwards.to = 2;
  CHECK_FALSE(plan_drive(survey, crawler(), backwards).has_value());
  PlanOptions endless;
  endless.step = 1e-7;
  CHECK(plan_drive(survey, crawler(), endless).error().message.find("longer steps") !=
        std::string::npos);
  Rig high = crawler();
  high.vehicle_height = 3.5;
  CHECK_FALSE(plan_drive(survey, high, {}).has_value());
}

TEST_CASE("a camera in the rock, or beside it at the envelope's edge, is refused in words") {
  const Survey survey = straight_survey(10, 4);
  const auto message = [&](const Rig& rig) {
    const auto plan = plan_drive(survey, rig, {});
    return plan ? std::string() : plan.error().message;
  };
  Rig rig = crawler();
  rig.cameras[1].vehicle_from_camera.translation.y() = 5;
  CHECK(message(rig).find("camera right is 5 m") != std::string::npos);
  rig = crawler();
  rig.cameras[0].vehicle_from_camera.translation.z() = 2.9;
  CHECK(message(rig).find("3.14 m above the floor") != std::string::npos);
  rig = crawler();
  rig.cameras[0].vehicle_from_camera.translation.y() = 0.6;
  CHECK(message(rig).empty());
  rig.envelope = VehicleEnvelope{0.5, 0, 0, 0, 0};
  CHECK(message(rig).find("the vehicle 0.5 m aside, camera left is 1.1 m") != std::string::npos);
}

TEST_CASE("a camera far ahead of the vehicle sees tags as much earlier") {
  Survey survey = straight_survey(60, 3);
  survey.series->first = 50;
  survey = with_layout(survey, {survey.tag_template, *survey.series, std::nullopt});
  const auto first_seen = [&](double arm) {
    Rig rig = crawler();
    for (RigCamera& camera : rig.cameras) camera.vehicle_from_camera.translation.x() = arm;
    const auto plan = plan_drive(survey, rig, {});
    REQUIRE(plan.has_value());
    REQUIRE(plan->tags[0].is_read);
    return plan->tags[0].first.chainage;
  };
  CHECK(first_seen(0) - first_seen(20) == doctest::Approx(20).epsilon(0.005));
}
