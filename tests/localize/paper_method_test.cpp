// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/paper_method.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"

using namespace tagsmith::detail;

namespace {

Survey survey_named(const std::string& name) {
  const auto survey = load_survey("surveys/" + name + "/survey.yaml");
  REQUIRE_MESSAGE(survey.has_value(), (survey ? "" : survey.error().message));
  return *survey;
}

Survey exactly_surveyed(const std::string& name) {
  Survey survey = survey_named(name);
  for (PlacedTag& tag : survey.tags) tag.sigma = 0;
  return survey;
}

Rig rig_named(const std::string& name) {
  const auto rig = load_rig("surveys/" + name + "/rig.yaml");
  REQUIRE_MESSAGE(rig.has_value(), (rig ? "" : rig.error().message));
  return *rig;
}

std::vector<Measurement> run_named(const std::string& path, const Rig& rig) {
  const auto run = load_run("surveys/" + path, rig);
  REQUIRE_MESSAGE(run.has_value(), (run ? "" : run.error().message));
  return run->measurements;
}

const ReaderChoice kNoReader{[](const GrayView&, const ReadOptions&) { return ReadResult{}; }, 1.0};

std::vector<Fix> localize_run(const Survey& survey, const Rig& rig,
                              const std::vector<Measurement>& measurements) {
  std::vector<Fix> fixes;
  for (const Measurement& measurement : measurements) {
    const Observation seen = observe(measurement, {survey}, rig, kNoReader);
    fixes.push_back(localize_by_paper(seen, {survey}, rig));
  }
  return fixes;
}

// A tag's corners as a camera of the vehicle sees them, also beyond the image's edge.
SeenTag seen_through(const RigCamera& camera, const Pose& world_from_vehicle, const Survey& survey,
                     const PlacedTag& tag, double sigma_px) {
  const Pose camera_from_plate =
      inverse(world_from_vehicle * camera.vehicle_from_camera) * tag.world_from_plate;
  const double length = survey.tag_template.frame_inner_length;
  const double height = survey.tag_template.frame_inner_height;
  const Eigen::Vector3d corners_in_plate[] = {
      {0, 0, 0}, {length, 0, 0}, {length, height, 0}, {0, height, 0}};
  SeenCorners seen;
  seen.sigma_px = sigma_px;
  for (std::size_t i = 0; i < seen.corners.size(); ++i) {
    const auto pixel = project(camera.camera, camera_from_plate * corners_in_plate[i]);
    REQUIRE(pixel.has_value());
    seen.corners[i] = {pixel->x(), pixel->y()};
  }
  return {camera.name, 0, tag, seen, std::nullopt};
}

// Horizontal distance from O to the plane of the tag's plate.
double distance_to_plate(const Eigen::Vector3d& o_in_world, const PlacedTag& tag) {
  return std::abs(
      (tag.world_from_plate.translation - o_in_world).dot(tag.world_from_plate.rotation.col(2)));
}

struct PairView {
  Eigen::Vector3d o_in_world = Eigen::Vector3d::Zero();
  Observation observation;
};

// A level vehicle some way behind the pair, everything measured without error.
PairView view_of_pair(const Survey& survey, const Rig& rig, int pair, double behind,
                      double offset) {
  const PlacedTag& left = survey.tags.at(static_cast<std::size_t>(2 * pair));
  const PlacedTag& right = survey.tags.at(static_cast<std::size_t>(2 * pair + 1));
  const double heading = heading_between(left, right);
  const Eigen::Vector3d middle =
      (left.world_from_plate.translation + right.world_from_plate.translation) / 2;
  PairView view;
  view.o_in_world = middle - behind * direction_of(heading) + offset * right_of(heading);
  view.o_in_world.z() = rig.vehicle_height;
  const Pose vehicle = world_from_vehicle(view.o_in_world, heading);
  for (const RigCamera& camera : rig.cameras) {
    const PlacedTag& tag = camera.name == "left" ? left : right;
    view.observation.tags.push_back(seen_through(camera, vehicle, survey, tag, 0.3));
  }
  view.observation.ranges["d"] = distance_to_plate(view.o_in_world, left);
  return view;
}

Eigen::Vector3d position_of(const Fix& fix) {
  REQUIRE_MESSAGE(fix.position_in_grid.has_value(), fix.reason);
  return *fix.position_in_grid;
}

}  // namespace

TEST_CASE("Table 4 comes out of a run with distances") {
  const Survey survey = survey_named("corridor-table4");
  const Rig rig = rig_named("corridor-table4");
  // The printed results, millimetres.
  const Eigen::Vector3d printed[] = {
      {0.980, -0.419, 0.151}, {0.964, 0.175, 0.201}, {0.517, 0.769, 0.183}, {0.983, 1.230, 0.112},
      {0.984, 2.208, 0.053},  {0.988, 2.906, 0.198}, {0.979, 3.500, 0.233}, {1.065, 3.951, 0.132},
      {0.467, 4.358, 0.210},  {0.975, 5.121, 0.096}};
  const std::vector<Measurement> measurements = run_named("corridor-table4/run.csv", rig);
  const std::vector<Fix> fixes = localize_run(survey, rig, measurements);
  REQUIRE(fixes.size() == 10);
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    CAPTURE(fixes[i].id);
    CHECK((position_of(fixes[i]) - printed[i]).cwiseAbs().maxCoeff() < 1e-3);
  }
  CHECK(fixes[2].tags == std::vector<std::string>{"002L", "001R"});
  const FixSummary summary = summarize(fixes, measurements);
  CHECK(summary.located == 10);
  CHECK(summary.mean_error->plane == doctest::Approx(0.142).epsilon(0.005));
  CHECK(summary.mean_error->height == doctest::Approx(0.083).epsilon(0.005));
  CHECK(summary.max_error->plane == doctest::Approx(0.270).epsilon(0.005));
  CHECK(summary.max_error->height == doctest::Approx(0.187).epsilon(0.005));
}

TEST_CASE("theta is the stated one for the paper's coded positions, and the tags' own elsewhere") {
  const Survey coded = survey_named("corridor-table4");
  const auto angle = [](const Survey& survey, const char* left, const char* right) {
    return degrees(pair_angle_for(survey, *find_tag(survey, left), *find_tag(survey, right)));
  };
  CHECK(angle(coded, "000L", "000R") == doctest::Approx(10.2));
  CHECK(angle(coded, "002L", "001R") == doctest::Approx(10.2));
  CHECK(angle(coded, "000L", "001R") == doctest::Approx(degrees(std::atan(1.2 / 1.9))));

  Survey facing = survey_named("corridor");
  REQUIRE_FALSE(facing.series->pair_angle.has_value());
  CHECK(angle(facing, "000L", "000R") == doctest::Approx(degrees(std::atan(0.343 / 1.9))));
  CHECK(angle(facing, "002L", "001R") == doctest::Approx(degrees(std::atan(0.457 / 1.9))));
  // Stated, it holds for the pair, and still not for tags of two pairs.
  facing.series->pair_angle = radians(10.2);
  CHECK(angle(facing, "000L", "000R") == doctest::Approx(10.2));
  CHECK(angle(facing, "002L", "001R") == doctest::Approx(degrees(std::atan(0.457 / 1.9))));
}

TEST_CASE("exact corners and range give back the position, straight and curved, in either grid") {
  constexpr unsigned kSeed = 20;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (const std::string name : {"corridor", "curved"}) {
    CAPTURE(name);
    const Survey survey = survey_named(name);
    const Rig rig = rig_named(name);
    const double width = width_at(survey.tunnel, 0);
    std::uniform_real_distribution<double> behind(0.3 * width, 0.6 * width);
    std::uniform_real_distribution<double> offset(-0.2 * width, 0.2 * width);
    std::uniform_int_distribution<int> pair(0, static_cast<int>(survey.tags.size() / 2) - 1);
    for (int i = 0; i < 200; ++i) {
      const PairView view = view_of_pair(survey, rig, pair(random), behind(random), offset(random));
      const Fix fix = localize_by_paper(view.observation, {survey}, rig);
      const Eigen::Vector3d truth = grid_from_world(survey.grid, view.o_in_world);
      CHECK((position_of(fix) - truth).norm() < 1e-7);
      CHECK_FALSE(fix.attitude.has_value());
    }
  }
}

TEST_CASE("the paper's W_T is the width at the pair") {
  const Diagnosed<Survey> reading = read_survey_text("w.yaml", R"(survey: w
tunnel:
  height: 3
  sections: [ { at: 0, width: 1.9 }, { at: 4.5, width: 1.9 }, { at: 4.5, width: 2.6 } ]
  centerline: { start: [5, 0, 0], heading: 0, elements: [ { line: 10.0 } ] }
tags: { template: tag-400x300, height: 0.4, spacing: 0.4, first: 0, pairs: 12 }
code: { check_digit: sum10 }
)");
  REQUIRE_MESSAGE(reading.value.has_value(), to_string(reading.diagnostics));
  const Survey& survey = *reading.value;
  const Rig rig = rig_named("corridor");
  for (const int pair : {1, 4, 8, 11}) {
    CAPTURE(pair);
    const PairView view = view_of_pair(survey, rig, pair, 0.8, 0.1);
    const Fix fix = localize_by_paper(view.observation, {survey}, rig);
    CHECK((position_of(fix) - grid_from_world(survey.grid, view.o_in_world)).norm() < 1e-7);
  }
}

TEST_CASE("a plate that turns out of its wall is no tag of the paper's pairs") {
  Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  PairView view = view_of_pair(survey, rig, 3, 0.7, 0.1);
  for (SeenTag& seen : view.observation.tags) {
    if (seen.tag.side != Side::left) continue;
    const Eigen::Vector3d p = seen.tag.p_in_grid;
    seen.tag = place_surveyed(survey, {3, Side::left}, p, PlateAttitude{radians(-60), 0, 0});
  }
  const Fix fix = localize_by_paper(view.observation, {survey}, rig);
  CHECK_FALSE(fix.position_in_grid.has_value());
  CHECK(fix.tags == std::vector<std::string>{"003L", "003R"});
  CHECK(fix.reason.find("left") != std::string::npos);
}

TEST_CASE("the rig's distortion is undone before the distance is taken") {
  const Survey survey = survey_named("corridor");
  Rig rig = rig_named("corridor");
  for (RigCamera& camera : rig.cameras) camera.camera.distortion = {-0.2, 0.05, 1e-3, -5e-4, 0};
  const PairView view = view_of_pair(survey, rig, 3, 0.7, 0.1);
  const Fix fix = localize_by_paper(view.observation, {survey}, rig);
  CHECK((position_of(fix) - grid_from_world(survey.grid, view.o_in_world)).norm() < 1e-6);
}

// The corridor's rig, its cameras mounted otherwise.
Rig rig_mounted(double pitch, double roll, const Eigen::Vector3d& left_position) {
  Rig rig = rig_named("corridor");
  for (RigCamera& camera : rig.cameras) {
    const MountingAngles angles = mounting_angles(camera.vehicle_from_camera);
    Eigen::Vector3d position = left_position;
    if (camera.name != "left") position.y() *= -1;
    camera.vehicle_from_camera =
        vehicle_from_camera(angles.yaw, radians(pitch), radians(roll), position);
  }
  return rig;
}

TEST_CASE("cameras that are tilted, upside down or away from O measure as level ones at O do") {
  const Survey survey = survey_named("corridor");
  for (const Rig& rig :
       {rig_mounted(-20, 0, {0, 0, 0}), rig_mounted(0, 180, {0, 0, 0}),
        rig_mounted(0, 90, {0, 0, 0}), rig_mounted(10, -15, {0, 0, 0}),
        rig_mounted(0, 0, {0.3, 0.2, 0.1}), rig_mounted(-10, 5, {-0.1, 0.15, -0.05})}) {
    const PairView view = view_of_pair(survey, rig, 3, 0.7, 0.1);
    const Fix fix = localize_by_paper(view.observation, {survey}, rig);
    CHECK((position_of(fix) - grid_from_world(survey.grid, view.o_in_world)).norm() < 1e-6);
  }
}

TEST_CASE(
    "distances measured from cameras above the tags, or that see the pair crossed, are right") {
  const Survey survey = survey_named("corridor");
  for (const auto& [left_x, right_x] : {std::pair{0.1, 0.1}, std::pair{-0.5, 0.5}}) {
    CAPTURE(left_x);
    Rig rig = rig_mounted(0, 0, {0, 0.1, 0.3});  // P is 0.16 m above O
    for (RigCamera& camera : rig.cameras) {
      camera.vehicle_from_camera.translation.x() = camera.name == "left" ? left_x : right_x;
    }
    PairView view = view_of_pair(survey, rig, 3, 0.7, 0.1);
    for (SeenTag& seen : view.observation.tags) {
      const Eigen::Vector3d p = seen.tag.world_from_plate.translation;
      const PlacedTag& left = view.observation.tags.front().tag;
      const PlacedTag& right = view.observation.tags.back().tag;
      const Pose vehicle = world_from_vehicle(view.o_in_world, heading_between(left, right));
      const RigCamera& camera = *find_camera(rig, seen.camera);
      seen.distance = (p - vehicle * camera.vehicle_from_camera.translation).norm();
      seen.seen_corners.reset();
    }
    const Fix fix = localize_by_paper(view.observation, {survey}, rig);
    CHECK((position_of(fix) - grid_from_world(survey.grid, view.o_in_world)).norm() < 1e-6);
  }
}

TEST_CASE("the covariance contains what calibration and a leaning vehicle do") {
  constexpr unsigned kSeed = 12;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const Survey survey = exactly_surveyed("corridor");
  Rig rig = rig_named("corridor");
  rig.ranges.front().sigma = 1e-4;
  rig.roll_sigma = rig.pitch_sigma = radians(0.3);
  for (RigCamera& camera : rig.cameras) {
    camera.calibration_sigma = {
        .position = 0.0005, .angle = radians(0.1), .focal = 0.001, .center = 0.5};
  }
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  int located = 0;
  for (int i = 0; i < 600; ++i) {
    Rig true_rig = rig;
    const auto turn = [&](double sigma) {
      const Eigen::Vector3d by = sigma * Eigen::Vector3d(normal(random), normal(random), 0);
      return Eigen::Matrix3d(Eigen::AngleAxisd(by.norm(), by.normalized()));
    };
    const Eigen::Matrix3d lean = turn(rig.roll_sigma);
    for (RigCamera& camera : true_rig.cameras) {
      const CalibrationSigma& sigma = camera.calibration_sigma;
      Pose& pose = camera.vehicle_from_camera;
      pose.rotation = lean * pose.rotation * turn(sigma.angle);
      const Eigen::Vector3d off(normal(random), normal(random), normal(random));
      pose.translation += lean * (sigma.position * off);
      camera.camera.fx *= 1 + sigma.focal * normal(random);
      camera.camera.fy = camera.camera.fx;
      camera.camera.cx += sigma.center * normal(random);
      camera.camera.cy += sigma.center * normal(random);
    }
    PairView view = view_of_pair(survey, true_rig, 3, 0.55, 0.0);
    for (SeenTag& seen : view.observation.tags) seen.seen_corners->sigma_px = 0.001;
    const Fix fix = localize_by_paper(view.observation, {survey}, rig);
    if (!fix.position_in_grid || !fix.covariance_in_grid) continue;
    ++located;
    const Eigen::Vector3d error =
        *fix.position_in_grid - grid_from_world(survey.grid, view.o_in_world);
    squares += error.cwiseAbs2().cwiseQuotient(fix.covariance_in_grid->diagonal());
  }
  REQUIRE(located > 400);
  squares /= located;
  MESSAGE("mean square of errors over their sigmas: " << squares.transpose());
  for (const int axis : {1, 2}) {
    CHECK(squares[axis] > 0.4);
    CHECK(squares[axis] < 1.5);
  }
}

TEST_CASE("the covariance is what noise of the stated size does") {
  constexpr unsigned kSeed = 4;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const Survey survey = exactly_surveyed("corridor");
  Rig rig = rig_named("corridor");
  rig.roll_sigma = rig.pitch_sigma = 0;
  // Small enough for the closed form to be linear; a centimetre leaves it without solution.
  rig.ranges.front().sigma = 2e-4;
  const double corner_sigma = 0.02;
  PairView view = view_of_pair(survey, rig, 3, 0.55, 0.0);
  for (SeenTag& seen : view.observation.tags) seen.seen_corners->sigma_px = corner_sigma;
  const Fix fix = localize_by_paper(view.observation, {survey}, rig);
  REQUIRE(fix.covariance_in_grid.has_value());
  CHECK(fix.notes.empty());

  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  constexpr int kTrials = 4000;
  for (int i = 0; i < kTrials; ++i) {
    Observation noisy = view.observation;
    noisy.ranges["d"] += rig.ranges.front().sigma * normal(random);
    for (SeenTag& seen : noisy.tags) {
      for (PixelPoint& corner : seen.seen_corners->corners) {
        corner = corner + corner_sigma * PixelPoint{normal(random), normal(random)};
      }
    }
    const Eigen::Vector3d error =
        position_of(localize_by_paper(noisy, {survey}, rig)) - *fix.position_in_grid;
    spread += error * error.transpose() / kTrials;
  }
  for (int row = 0; row < 3; ++row) {
    CHECK(std::sqrt((*fix.covariance_in_grid)(row, row)) ==
          doctest::Approx(std::sqrt(spread(row, row))).epsilon(0.08));
    for (int column = 0; column < row; ++column) {
      const double scale = std::sqrt(spread(row, row) * spread(column, column));
      CHECK(std::abs((*fix.covariance_in_grid)(row, column) - spread(row, column)) < 0.1 * scale);
    }
  }
}

TEST_CASE("in a bend, where d is not the distance to the plate's plane, the solution is refused") {
  const Survey survey = survey_named("curved");
  // The same tags over a floor three metres lower, where what the bend does is no contradiction.
  Survey pit = survey;
  const CenterlinePoint start = survey.tunnel.centerline.at(0);
  pit.tunnel.centerline = Centerline(start.position - Eigen::Vector3d(0, 0, 3), start.heading,
                                     survey.tunnel.centerline.elements());
  pit.tunnel.height = pit.tunnel.height.scaled(1, 3);
  const Rig rig = rig_named("curved");
  for (int pair = 2; pair < 6; ++pair) {  // on the arc, and two metres behind them too
    CAPTURE(pair);
    PairView view = view_of_pair(survey, rig, pair, 1.4, 0.0);
    const Centerline& line = survey.tunnel.centerline;
    const double offset = line.locate(view.o_in_world.head<2>()).offset;
    view.observation.ranges["d"] = width_at(survey.tunnel, 0) / 2 + offset;
    const Fix refused = localize_by_paper(view.observation, {survey}, rig);
    CHECK_FALSE(refused.position_in_grid.has_value());
    CHECK(refused.reason.find("below the floor") != std::string::npos);
    const Fix fix = localize_by_paper(view.observation, {pit}, rig);
    const Eigen::Vector3d error = position_of(fix) - grid_from_world(survey.grid, view.o_in_world);
    CHECK(error.norm() > 0.3);
    REQUIRE(fix.covariance_in_grid.has_value());
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(std::abs(error[axis]) < 3 * std::sqrt((*fix.covariance_in_grid)(axis, axis)));
    }
    CHECK(std::ranges::any_of(fix.notes, [](const std::string& note) {
      return note.find("the wall bends") != std::string::npos;
    }));
  }
}

TEST_CASE("the covariance contains what wrong tag positions do") {
  const Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  PairView view = view_of_pair(survey, rig, 2, 0.55, 0.0);
  for (SeenTag& seen : view.observation.tags) seen.tag.sigma = 0;
  const Eigen::Matrix3d without =
      localize_by_paper(view.observation, {survey}, rig).covariance_in_grid.value();
  for (SeenTag& seen : view.observation.tags) seen.tag.sigma = 0.002;
  const Eigen::Matrix3d with =
      localize_by_paper(view.observation, {survey}, rig).covariance_in_grid.value();
  for (int axis = 0; axis < 3; ++axis) CHECK(with(axis, axis) > without(axis, axis));
}

TEST_CASE("close to having no solution the fix says that its covariance is rough") {
  const Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  const PairView view = view_of_pair(survey, rig, 3, 0.7, 0.1);
  const Fix fix = localize_by_paper(view.observation, {survey}, rig);
  REQUIRE(fix.position_in_grid.has_value());
  REQUIRE(fix.notes.size() == 1);
  CHECK(fix.notes.front().find("rough") != std::string::npos);
}

TEST_CASE("a centimetre of range noise leaves no real solution at several points in ten") {
  const Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  constexpr unsigned kSeed = 42;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> behind(0.3, 0.9);
  int unsolved = 0;
  int in_the_rock = 0;
  constexpr int kTrials = 500;
  for (int i = 0; i < kTrials; ++i) {
    PairView view = view_of_pair(survey, rig, i % 8, behind(random), 0.05);
    view.observation.ranges["d"] += noise(random);
    const Fix fix = localize_by_paper(view.observation, {survey}, rig);
    if (fix.position_in_grid) continue;
    CHECK_FALSE(fix.covariance_in_grid.has_value());
    if (fix.reason.find("below the floor") != std::string::npos) {
      ++in_the_rock;
      continue;
    }
    ++unsolved;
    CHECK(fix.reason.find("no real solution") != std::string::npos);
  }
  CHECK(in_the_rock < unsolved);
  MESSAGE("without a real solution: ", unsolved, " of ", kTrials);
  CHECK(unsolved > kTrials / 5);
  CHECK(unsolved < kTrials * 3 / 5);
}

TEST_CASE("tags of one pair go before nearer ones, then the tags nearest each other") {
  const Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  const Pose vehicle = world_from_vehicle({-1.0, 0.5, 0.24}, 0);
  const auto seen = [&](const char* camera, const char* tag) {
    return seen_through(*find_camera(rig, camera), vehicle, survey, *find_tag(survey, tag), 0.3);
  };
  Observation observation;
  observation.ranges["d"] = 0.9;
  using Names = std::vector<std::string>;
  observation.tags = {seen("left", "002L"), seen("left", "003L"), seen("right", "003R"),
                      seen("right", "001R")};
  CHECK(localize_by_paper(observation, {survey}, rig).tags == Names{"003L", "003R"});
  observation.tags.push_back(seen("right", "002R"));
  CHECK(localize_by_paper(observation, {survey}, rig).tags == Names{"002L", "002R"});
  observation.tags = {seen("left", "003L"), seen("left", "002L"), seen("right", "001R"),
                      seen("right", "004R")};
  CHECK(localize_by_paper(observation, {survey}, rig).tags == Names{"002L", "001R"});
}

TEST_CASE("what is missing or wrong is the reason") {
  const Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  const Observation good = view_of_pair(survey, rig, 3, 0.7, 0.0).observation;
  const auto reason = [&](const Observation& observation) {
    const Fix fix = localize_by_paper(observation, {survey}, rig);
    CHECK_FALSE(fix.position_in_grid.has_value());
    CHECK(status_of(fix) == "no_position");
    return fix.reason;
  };
  Observation changed = good;
  changed.tags.clear();
  CHECK(reason(changed) == "no tag was seen");
  changed.faults = {"left.jpg: cannot be opened"};
  CHECK(reason(changed) == "left.jpg: cannot be opened; no tag was seen");
  changed = good;
  changed.tags.pop_back();
  CHECK(reason(changed) == "no tag on the right wall was seen");
  changed = good;
  changed.tags.erase(changed.tags.begin());
  CHECK(reason(changed) == "no tag on the left wall was seen");
  changed = good;
  for (SeenTag& seen : changed.tags) seen.camera = "left";
  CHECK(reason(changed) ==
        "no two tags of one survey on the left and right walls were seen by different cameras");
  changed = good;
  changed.ranges.clear();
  CHECK(reason(changed) == "no range to the left wall was measured");
  changed.ranges["d"] = 0.1;
  CHECK(reason(changed) == "d is 0.1 m, expected 0.25 to 5 m");
  changed.ranges["d"] = 2.5;
  CHECK(reason(changed) == "d is 2.5 m, expected less than the 1.9 m between the walls");
  changed = good;
  changed.tags.front().tag.p_in_grid.z() += 0.1;
  CHECK(reason(changed).find("different heights") != std::string::npos);
  changed = good;
  changed.tags.front().seen_corners->corners = {};
  CHECK_FALSE(reason(changed).empty());
}

TEST_CASE("the least range within its sensor's limits is taken") {
  const Survey survey = survey_named("corridor");
  Rig rig = rig_named("corridor");
  RigRange second = rig.ranges.front();
  second.name = "d2";
  rig.ranges.push_back(second);
  second.name = "to_the_right";
  second.wall = Side::right;
  rig.ranges.push_back(second);
  PairView view = view_of_pair(survey, rig, 3, 0.6, 0.0);
  view.observation.ranges["d2"] = view.observation.ranges["d"];
  view.observation.ranges["d"] += 0.2;            // it looks along the wall
  view.observation.ranges["to_the_right"] = 0.3;  // another wall
  const Fix fix = localize_by_paper(view.observation, {survey}, rig);
  CHECK((position_of(fix) - grid_from_world(survey.grid, view.o_in_world)).norm() < 1e-7);
  view.observation.ranges["d"] = 0.0;  // no echo
  const Fix again = localize_by_paper(view.observation, {survey}, rig);
  CHECK((position_of(again) - *fix.position_in_grid).norm() < 1e-12);
}

TEST_CASE("a broken image is a fault of its row alone") {
  const Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  Measurement measurement;
  measurement.id = "1";
  measurement.cameras["left"].image = "no/such/picture.jpg";
  measurement.cameras["right"].image = "surveys/corridor/survey.yaml";
  const Observation seen = observe(measurement, {survey}, rig, kNoReader);
  REQUIRE(seen.faults.size() == 2);
  CHECK(seen.faults[0].find("no/such/picture.jpg") != std::string::npos);
  CHECK(seen.faults[1].find("survey.yaml") != std::string::npos);
}

TEST_CASE("a measured distance names its tag by name or by digits") {
  const Survey survey = survey_named("corridor");
  const Rig rig = rig_named("corridor");
  const auto seen = [&](const std::vector<Survey>& surveys, const std::string& tag) {
    Measurement measurement;
    measurement.cameras["left"].tag = tag;
    measurement.cameras["left"].distance = 1.0;
    return observe(measurement, surveys, rig, kNoReader);
  };
  CHECK(seen({survey}, "002L").tags.at(0).tag.name == "002L");
  CHECK(seen({survey}, to_string(find_tag(survey, "002L")->digits)).tags.at(0).tag.name == "002L");
  REQUIRE(seen({survey}, "999L").faults.size() == 1);
  CHECK(seen({survey}, "999L").faults[0] == "left_tag is 999L, expected a tag of the survey");
  const Observation twice = seen({survey, survey_named("corridor-table4")}, "002L");
  REQUIRE(twice.faults.size() == 1);
  CHECK(twice.faults[0].find("several surveys") != std::string::npos);
}
