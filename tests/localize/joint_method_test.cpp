// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/joint_method.hpp"

#include <cmath>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/localize/joint_model.hpp"
#include "decoder/localize/motion.hpp"
#include "decoder/localize/plate_pose.hpp"
#include "decoder/localize/travel.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/localize/site.hpp"
#include "tests/support/draws.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;
using tagsmith::detail::test::Draws;
using tagsmith::detail::test::error_of;
using tagsmith::detail::test::observation_at;
using tagsmith::detail::test::pose_at;
using tagsmith::detail::test::Site;
using tagsmith::detail::test::site_named;

namespace {

// The corridor, surveyed exactly, with cameras of which little is known.
Site site_of_unknown_cameras() {
  Site site = site_named("corridor");
  site.survey.sigma = 0;
  for (PlacedTag& tag : site.survey.tags) tag.sigma = 0;
  for (RigCamera& camera : site.rig.cameras) {
    camera.calibration_sigma = {0.005, radians(0.5), 0.02, 12.8};
  }
  return site;
}

// A third and a fourth camera see more tags.
Site with_four_cameras(Site site) {
  for (const RigCamera& camera : std::vector<RigCamera>(site.rig.cameras)) {
    RigCamera ahead = camera;
    ahead.name += "_ahead";
    ahead.vehicle_from_camera =
        vehicle_from_camera(camera.name == "left" ? radians(25) : radians(-25), 0, 0, {0, 0, 0});
    site.rig.cameras.push_back(ahead);
  }
  return site;
}

// What the cameras see where each row of an image is exposed a little later than the one above it,
// and the vehicle drives `way` metres from the first row to the last.
Observation observation_in_passing(const Site& site, const VehiclePose& middle, double way) {
  Observation observation = observation_at(site, middle);
  for (SeenTag& seen : observation.tags) {
    const RigCamera& camera = *find_camera(site.rig, seen.camera);
    const double length = site.survey.tag_template.frame_inner_length;
    const double height = site.survey.tag_template.frame_inner_height;
    const Vector3d in_plate[] = {{0, 0, 0}, {length, 0, 0}, {length, height, 0}, {0, height, 0}};
    for (std::size_t i = 0; i < 4; ++i) {
      PixelPoint& corner = seen.seen_corners->corners[i];
      for (int again = 0; again < 5; ++again) {
        VehiclePose later = middle;
        const double driven = way * (corner.y / camera.camera.height - 0.5);
        later.position += driven * world_from_vehicle(middle).rotation.col(0);
        const auto point =
            observe_point(camera.camera, camera.vehicle_from_camera, vehicle_frame(later),
                          seen.tag.world_from_plate, in_plate[i]);
        corner = {point->pixel.x(), point->pixel.y()};
      }
    }
  }
  return observation;
}

}  // namespace

TEST_CASE("exact corners give back the pose, straight and curved, in either grid") {
  for (const std::string name : {"corridor", "curved"}) {
    CAPTURE(name);
    const Site site = site_named(name);
    for (double chainage = 0; chainage < 5; chainage += 0.5) {
      CAPTURE(chainage);
      const VehiclePose truth = pose_at(site, chainage, 0.1);
      const Observation observation = observation_at(site, truth);
      if (observation.tags.empty()) continue;
      const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
      CHECK(error_of(fix, site, truth) < 1e-4);
      CHECK(fix.attitude->pitch == doctest::Approx(truth.pitch).epsilon(1e-3));
      CHECK(fix.attitude->roll == doctest::Approx(truth.roll).epsilon(1e-3));
      CHECK(fix.attitude->heading ==
            doctest::Approx(grid_heading_from_world(site.survey.grid, truth.heading)));
      CHECK((fix.pose_covariance_in_grid->topLeftCorner<3, 3>() - *fix.covariance_in_grid).norm() ==
            0);
    }
  }
}

TEST_CASE("in a drive with surveyed walls, leaning and turned plates, corners and range agree") {
  Site site = site_named("drift");
  site.survey.angle_sigma = 0;  // what is not sure of a plate leaves room for the stance's prior
  const Tunnel& tunnel = site.survey.tunnel;
  int with_pillar = 0;
  for (double chainage = 1; chainage < 60; chainage += 1.5) {
    CAPTURE(chainage);
    const VehiclePose truth = pose_at(site, chainage, 0.2);
    Observation observation = observation_at(site, truth);
    if (observation.tags.empty()) continue;
    for (const SeenTag& seen : observation.tags) with_pillar += seen.tag.name == "900R";
    observation.ranges["d"] = observe_wall(tunnel.centerline, tunnel.left, truth.position).distance;
    const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
    CHECK(error_of(fix, site, truth) < 2e-4);
    CHECK(fix.ranges == std::vector<std::string>{"d"});
    CHECK(fix.dropped.empty());
  }
  CHECK(with_pillar > 0);
}

TEST_CASE("a calibration that the corners bear out stands, with its doubt in the covariance") {
  const Site site = site_of_unknown_cameras();
  const VehiclePose truth = pose_at(site, 2, 0.1);
  Observation observation = observation_at(site, truth);
  const Tunnel& tunnel = site.survey.tunnel;
  observation.ranges["d"] =
      observe_wall(tunnel.centerline, tunnel.left, truth.position).distance + 0.02;
  const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
  CHECK(error_of(fix, site, truth) < 1e-4);
  CHECK(fix.ranges == std::vector<std::string>{"d"});
  CHECK(std::sqrt((*fix.covariance_in_grid)(0, 0)) > 0.003);
  const ErrorBudget& budget = fix.budget.value();
  const Eigen::Matrix3d sum = budget.pixels + budget.edges + budget.survey + budget.coding +
                              budget.ranges + budget.calibration + budget.vehicle;
  CHECK((sum - *fix.covariance_in_grid).norm() < 1e-12);
}

TEST_CASE("a rolling shutter whose readout is stated makes no tag contradict its wall") {
  constexpr double kWay = 0.013;
  Site global = site_named("drift");
  global.rig.cameras.pop_back();
  Site rolling = global;
  rolling.rig.cameras[0].readout = kWay / rolling.rig.envelope->speed;
  set_motion_sigmas(rolling.rig);
  CHECK(rolling.rig.cameras[0].calibration_sigma.shutter == doctest::Approx(kWay));
  int seen = 0, refused_as_global = 0;
  for (double chainage = 1; chainage < 60; chainage += 1.5) {
    CAPTURE(chainage);
    const VehiclePose truth = pose_at(rolling, chainage, 0.2);
    const Observation observation = observation_in_passing(rolling, truth, kWay);
    const auto off = [&](const Fix& fix) {
      const Vector3d error =
          *fix.position_in_grid - grid_from_world(rolling.survey.grid, truth.position);
      return std::sqrt(error.dot(fix.covariance_in_grid->inverse() * error));
    };
    const Fix fix = localize_jointly(observation, {rolling.survey}, rolling.rig);
    if (!fix.position_in_grid) continue;
    ++seen;
    CHECK(off(fix) < 3.5);
    const Fix as_global = localize_jointly(observation, {global.survey}, global.rig);
    if (!as_global.position_in_grid) ++refused_as_global;
  }
  CHECK(seen > 5);
  CHECK(2 * refused_as_global >= seen);
}

// Each camera takes its photo a little before or after the moment of the row.
Observation observation_of_free_cameras(const Site& site, const VehiclePose& vehicle, double way,
                                        Draws& draws) {
  Observation all;
  for (const RigCamera& camera : site.rig.cameras) {
    VehiclePose there = vehicle;
    const Vector3d ahead = world_from_vehicle(vehicle).rotation.col(0);
    there.position += draws.normal(way) * ahead;
    for (SeenTag& seen : observation_at(site, there).tags) {
      if (seen.camera == camera.name) all.tags.push_back(std::move(seen));
    }
  }
  return all;
}

TEST_CASE("photos that are not of one moment fit where the rig states their delay") {
  constexpr double kWay = 0.03;
  const Site together = site_named("corridor");
  Site free = together;
  free.rig.envelope = VehicleEnvelope{0.1, radians(2), 1.5};
  for (RigCamera& camera : free.rig.cameras) camera.delay = 0.02;
  set_motion_sigmas(free.rig);
  CHECK(free.rig.cameras[0].calibration_sigma.delay == doctest::Approx(kWay));
  Draws draws(31);
  double squares = 0;
  int located = 0, located_together = 0, draw = 0;
  for (; draw < 300; ++draw) {
    const VehiclePose truth = pose_at(free, draws.uniform(0, 5), draws.uniform(-0.2, 0.2));
    const Observation seen = observation_of_free_cameras(free, truth, kWay, draws);
    const Fix fix = localize_jointly(seen, {free.survey}, free.rig);
    const Fix strict = localize_jointly(seen, {together.survey}, together.rig);
    if (strict.position_in_grid) ++located_together;
    if (!fix.position_in_grid) continue;
    ++located;
    const Vector3d error =
        *fix.position_in_grid - grid_from_world(free.survey.grid, truth.position);
    squares += error.y() * error.y() / (*fix.covariance_in_grid)(1, 1);  // along the drive
    CHECK(std::abs(error.y()) < 4.5 * std::sqrt((*fix.covariance_in_grid)(1, 1)));
  }
  CHECK(located > 0.95 * draw);
  CHECK(located_together < 0.5 * draw);
  CHECK(squares / located > 0.7);
  CHECK(squares / located < 1.3);
}

TEST_CASE("rows that only a rolling shutter explains are told as that") {
  Site site = site_named("corridor");
  std::vector<Observation> rows;
  std::vector<Fix> fixes;
  for (double chainage = 1; chainage < 4; chainage += 0.5) {
    rows.push_back(observation_in_passing(site, pose_at(site, chainage, 0.1), 0.02));
    fixes.push_back(localize_jointly(rows.back(), {site.survey}, site.rig));
    CHECK_FALSE(fixes.back().position_in_grid);
  }
  const auto rolling = rolling_shutter(fixes, rows, {site.survey}, site.rig);
  REQUIRE(rolling);
  CHECK(rolling->rows >= 5);  // of the rows that show two tags
  CHECK(rolling->located == rolling->rows);
  for (RigCamera& camera : site.rig.cameras) camera.readout = 0;  // stated, and wrong
  CHECK(rolling_shutter(fixes, rows, {site.survey}, site.rig));
  Site stated = site;
  stated.rig.cameras[0].readout = 0.01;
  CHECK_FALSE(rolling_shutter(fixes, rows, {site.survey}, stated.rig));

  Site turned = site;
  turned.rig.cameras[0].vehicle_from_camera.rotation *= rotation_of(Vector3d(0, radians(1), 0));
  for (Fix& fix : fixes) fix = {};
  for (Observation& row : rows) row = observation_at(turned, pose_at(turned, 2, 0.1));
  CHECK_FALSE(rolling_shutter(fixes, rows, {site.survey}, site.rig));
}

TEST_CASE("a calibration that the corners contradict is estimated") {
  const Site site = site_of_unknown_cameras();
  Site bent = site;
  bent.rig.cameras.front().vehicle_from_camera.rotation *=
      Eigen::AngleAxisd(radians(0.5), Vector3d::UnitY()).toRotationMatrix();
  const VehiclePose truth = pose_at(bent, 2, 0.1);
  const Observation observation = observation_at(bent, truth);
  const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
  REQUIRE_MESSAGE(fix.position_in_grid.has_value(), fix.reason);
  CHECK(fix.tags.size() == 3);
  CHECK(fix.chi_square < fix.degrees_of_freedom);
  CHECK(error_of(fix, site, truth) < 0.02);
  Site exact = site;
  for (RigCamera& camera : exact.rig.cameras) camera.calibration_sigma = {};
  const Fix as_said = localize_jointly(observation, {exact.survey}, exact.rig);
  CHECK((!as_said.position_in_grid || as_said.tags != fix.tags));  // refused, or by one tag alone
}

TEST_CASE(
    "a plate that is turned as far as the survey allows for does not disagree with the others") {
  Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 2, 0.1);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    for (const bool is_allowed : {true, false}) {
      site.survey.angle_sigma = is_allowed ? radians(1) : 0;
      Site hung = site;
      std::vector<SeenTag> seen = observation_at(site, truth).tags;
      REQUIRE(seen.size() == 3);
      for (PlacedTag& tag : hung.survey.tags) {
        if (tag.name != seen[2].tag.name) continue;
        tag.world_from_plate.rotation *=
            Eigen::AngleAxisd(radians(1.5), Vector3d::Unit(axis)).toRotationMatrix();
      }
      seen = observation_at(hung, truth).tags;
      JointProblem problem{&site.rig, &site.survey.tunnel, {}, {}, {}};
      for (const SeenTag& one : seen) {
        const std::size_t camera = one.camera == site.rig.cameras[0].name ? 0 : 1;
        problem.plates.push_back(sighted_plate(*find_tag(site.survey, one.tag.name), site.survey));
        problem.sightings.push_back(
            sighting_of(*one.seen_corners, site.rig, camera, problem.plates.size() - 1));
      }
      const auto fit = fit_jointly(problem, {{0, 1}, {}}, truth);
      REQUIRE(fit);
      const auto difference = disagreement(problem, *fit, 2);
      REQUIRE(difference);
      // One in a thousand that hang as surveyed is above 26.
      CHECK((difference->chi_square < 26) == is_allowed);
    }
  }
}

TEST_CASE("a tag that was measured worse counts for less") {
  Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  const auto sigma_of = [&](double tag_sigma) {
    Observation observation = observation_at(site, truth);
    for (SeenTag& seen : observation.tags) seen.tag.sigma = tag_sigma;
    const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
    REQUIRE(fix.covariance_in_grid.has_value());
    return std::sqrt((*fix.covariance_in_grid)(0, 0));
  };
  CHECK(sigma_of(0.02) > 5 * sigma_of(0.002));
}

TEST_CASE("tags that place the vehicle alike but turn it are told apart by the headings") {
  const Site site = site_named("corridor");
  Observation swapped = observation_at(site, pose_at(site, 1.0, 0.0));
  REQUIRE(swapped.tags.size() == 2);
  std::swap(swapped.tags[0].camera, swapped.tags[1].camera);  // cameras 110 degrees off
  const Fix fix = localize_jointly(swapped, {site.survey}, site.rig);
  CHECK_FALSE(fix.position_in_grid.has_value());
  CHECK_MESSAGE(fix.reason.find(" 106 ") != std::string::npos, fix.reason);
  CHECK_MESSAGE(fix.reason.find(" -114 ") != std::string::npos, fix.reason);
}

TEST_CASE("two tags that contradict each other make no position, three outvote one") {
  const Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  Observation two = observation_at(site, truth);
  REQUIRE(two.tags.size() >= 2);
  while (two.tags.size() > 2) two.tags.pop_back();
  two.tags[0].tag.world_from_plate.translation.y() += 0.8;
  const Fix none = localize_jointly(two, {site.survey}, site.rig);
  CHECK_FALSE(none.position_in_grid.has_value());
  CHECK(none.reason.find("contradict each other") != std::string::npos);

  const Site wide = with_four_cameras(site);
  Observation many = observation_at(wide, truth);
  REQUIRE(many.tags.size() >= 4);
  const std::string wrong = many.tags[0].tag.name;
  for (SeenTag& seen : many.tags) {
    if (seen.tag.name == wrong) seen.tag.world_from_plate.translation.y() += 0.8;
  }
  const Fix fix = localize_jointly(many, {wide.survey}, wide.rig);
  CHECK(error_of(fix, wide, truth) < 1e-3);
  REQUIRE_FALSE(fix.dropped.empty());
  CHECK(fix.dropped[0].name == wrong);
}

TEST_CASE("a range outside its sensor's limits is no measurement, and is named") {
  const Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  Observation seen = observation_at(site, truth);
  const RigRange& range = site.rig.ranges.at(0);
  seen.ranges[range.name] = range.max + 0.5;  // as a sensor says that has no echo
  const Fix fix = localize_jointly(seen, {site.survey}, site.rig);
  CHECK(error_of(fix, site, truth) < 1e-3);
  CHECK(fix.ranges.empty());
  REQUIRE(fix.dropped.size() == 1);
  CHECK(fix.dropped[0].name == range.name);
  CHECK(fix.dropped[0].reason.find(", expected ") != std::string::npos);
}

TEST_CASE("a range that contradicts the only tag leaves no position, whichever is wrong") {
  const Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  Observation seen = observation_at(site, truth);
  REQUIRE(!seen.tags.empty());
  seen.tags.resize(1);
  const RigRange& range = site.rig.ranges.at(0);
  const ChainageProfile& wall = wall_of(site.survey.tunnel, range.wall);
  const double distance =
      observe_wall(site.survey.tunnel.centerline, wall, truth.position).distance;
  seen.ranges[range.name] = distance;
  CHECK(error_of(localize_jointly(seen, {site.survey}, site.rig), site, truth) < 1e-3);
  seen.ranges[range.name] = distance + 0.4;
  const Fix fix = localize_jointly(seen, {site.survey}, site.rig);
  CHECK_FALSE(fix.position_in_grid.has_value());
  CHECK(fix.reason.find("range and tag contradict each other") == 0);
}

TEST_CASE("nothing confirms a vehicle that stands much higher than its rig says") {
  const Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 0.5, 0.0);
  const Observation seen = observation_at(site, truth);
  const auto fix_with_height = [&](double sigmas) {
    Rig rig = site.rig;
    rig.vehicle_height -= sigmas * rig.height_sigma;
    return localize_jointly(seen, {site.survey}, rig);
  };
  CHECK(fix_with_height(3).confirmations > 0);
  const Fix high = fix_with_height(5);
  CHECK(error_of(high, site, truth) < 1e-3);
  CHECK(high.tags.size() >= 2);
  CHECK(high.confirmations == 0);
  CHECK(confirmed_by_motion(high).confirmations == 0);
  CHECK_FALSE(fix_with_height(7).position_in_grid.has_value());
}

TEST_CASE(
    "tags that a range contradicts are confirmed by two photos unless it reaches beyond the wall") {
  const Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 0.5, 0.0);
  Observation of_both = observation_at(site, truth);
  const RigRange& range = site.rig.ranges.at(0);
  const double distance = observe_wall(site.survey.tunnel.centerline,
                                       wall_of(site.survey.tunnel, range.wall), truth.position)
                              .distance;
  const auto confirmations = [&](const Observation& seen, double measured) {
    Observation with = seen;
    with.ranges[range.name] = measured;
    const Fix fix = localize_jointly(with, {site.survey}, site.rig);
    CHECK(error_of(fix, site, truth) < 1e-3);
    CHECK(fix.tags.size() >= 2);
    CHECK(fix.unconfirmed.empty() == (fix.confirmations > 0));
    CHECK(confirmed_by_motion(fix).confirmations ==
          (fix.confirmations == 0 ? 0 : fix.confirmations + 1));
    return fix.confirmations;
  };
  CHECK(confirmations(of_both, distance - 0.4) > 0);
  CHECK(confirmations(of_both, distance + 0.4) == 0);  // through the wall
  Observation of_one = of_both;
  std::erase_if(of_one.tags, [](const SeenTag& seen) { return seen.camera != "left"; });
  CHECK(confirmations(of_one, distance) > 0);
  CHECK(confirmations(of_one, range.max + 0.5) > 0);  // no echo contradicts nothing
  CHECK(confirmations(of_one, distance - 0.4) == 0);
  of_one.ranges[range.name] = distance - 0.4;
  const Fix refused = if_confirmed(localize_jointly(of_one, {site.survey}, site.rig));
  CHECK_FALSE(refused.position_in_grid.has_value());
  CHECK_MESSAGE(refused.reason.ends_with(": a photo of another moment would go unnoticed"),
                refused.reason);
}

namespace {

// The corridor as two surveys in one grid, the second from this pair on; in the second, all plates
// stand `displaced` metres along the drive from where they hang.
std::vector<Survey> in_two_surveys(const Site& site, int second_from, double displaced) {
  std::vector<Survey> surveys{site.survey, site.survey};
  surveys[0].name = "near";
  surveys[1].name = "far";
  std::erase_if(surveys[0].tags, [&](const PlacedTag& tag) { return tag.pair >= second_from; });
  std::erase_if(surveys[1].tags, [&](const PlacedTag& tag) { return tag.pair < second_from; });
  for (PlacedTag& tag : surveys[1].tags) tag.world_from_plate.translation.y() += displaced;
  return surveys;
}

// What is seen of all plates, each given to the survey that has it, at its place there.
Observation by_surveys(Observation seen, const std::vector<Survey>& surveys) {
  for (SeenTag& tag : seen.tags) {
    const SurveyedTag found = find_tags(surveys, tag.tag.digits).at(0);
    tag.survey = found.survey;
    tag.tag = *found.tag;
  }
  return seen;
}

}  // namespace

TEST_CASE("tags of two surveys in one grid place the vehicle together, a tag of each or more") {
  const Site site = with_four_cameras(site_named("corridor"));
  const VehiclePose truth = pose_at(site, 2.0, 0.0);
  const Observation seen = observation_at(site, truth);
  const Fix whole = localize_jointly(seen, {site.survey}, site.rig);
  int together = 0;
  for (int second_from = 1; second_from < 8; ++second_from) {
    CAPTURE(second_from);
    const auto surveys = in_two_surveys(site, second_from, 0);
    const Fix fix = localize_jointly(by_surveys(seen, surveys), surveys, site.rig);
    CHECK(error_of(fix, site, truth) < 1e-3);
    CHECK(fix.confirmations == whole.confirmations);
    CHECK(*fix.covariance_in_grid == *whole.covariance_in_grid);
    REQUIRE(fix.tags.size() == whole.tags.size());
    for (std::size_t i = 0; i < fix.tags.size(); ++i) {
      const bool is_own = fix.tags[i] == whole.tags[i];
      CHECK((is_own || fix.tags[i] == (fix.survey == "near" ? "far/" : "near/") + whole.tags[i]));
      together += !is_own;
    }
  }
  CHECK(together > 0);
}

TEST_CASE("a survey that is displaced as a whole is outvoted by no number of another one's tags") {
  const Site site = with_four_cameras(site_named("corridor"));
  int one_against_more = 0;
  for (double chainage = 1; chainage < 5; chainage += 0.2) {
    const VehiclePose truth = pose_at(site, chainage, 0.0);
    const Observation seen = observation_at(site, truth);
    for (int second_from = 1; second_from < 8; ++second_from) {
      const auto surveys = in_two_surveys(site, second_from, chainage < 3 ? 0.05 : 0.3);
      const Observation row = by_surveys(seen, surveys);
      const auto far = std::ranges::count(row.tags, std::size_t{1}, &SeenTag::survey);
      const auto near = std::ssize(row.tags) - far;
      if (far == 0 || near == 0) continue;
      CAPTURE(chainage);
      CAPTURE(second_from);
      one_against_more += (far == 1) != (near == 1);
      const Fix fix = localize_jointly(row, surveys, site.rig);
      CHECK_FALSE(fix.position_in_grid.has_value());
      CHECK_MESSAGE(fix.reason.find("contradict each other") != std::string::npos, fix.reason);
    }
  }
  CHECK(one_against_more > 0);
}

TEST_CASE("a position by two surveys covers how far these are apart, or there is none") {
  const Site site = with_four_cameras(site_named("corridor"));
  int located = 0, refused = 0;
  for (double displaced = 0; displaced < 0.05; displaced += 0.002) {
    for (double chainage = 1; chainage < 5; chainage += 0.5) {
      const VehiclePose truth = pose_at(site, chainage, 0.0);
      const Observation seen = observation_at(site, truth);
      for (int second_from = 1; second_from < 8; ++second_from) {
        const auto surveys = in_two_surveys(site, second_from, displaced);
        const Observation row = by_surveys(seen, surveys);
        const auto far = std::ranges::count(row.tags, std::size_t{1}, &SeenTag::survey);
        if (far == 0 || far == std::ssize(row.tags)) continue;
        CAPTURE(displaced);
        CAPTURE(chainage);
        CAPTURE(second_from);
        const Fix fix = localize_jointly(row, surveys, site.rig);
        fix.position_in_grid ? ++located : ++refused;
        if (displaced == 0) REQUIRE(fix.position_in_grid);
        if (displaced > 0.03) CHECK_FALSE(fix.position_in_grid);
        if (!fix.position_in_grid) continue;
        const double off = std::abs(fix.position_in_grid->y() - truth.position.y());
        CHECK(off < 4 * std::sqrt((*fix.covariance_in_grid)(1, 1)));
      }
    }
  }
  CHECK(located > 100);
  CHECK(refused > 100);
}

TEST_CASE("a part of a tag of one survey contradicts or confirms a position by another's") {
  const Site site = with_four_cameras(site_named("corridor"));
  const VehiclePose truth = pose_at(site, 2.0, 0.0);
  for (const double displaced : {0.0, 0.15}) {
    CAPTURE(displaced);
    const auto surveys = in_two_surveys(site, 4, displaced);
    Observation row = by_surveys(observation_at(site, truth), surveys);
    const auto near = std::ranges::find(row.tags, std::size_t{0}, &SeenTag::survey);
    REQUIRE(near != row.tags.end());
    const SeenTag part = *near;
    row.parts.push_back(
        {part.camera, find_tags(surveys, part.tag.digits), *part.seen_corners, 0.5});
    std::erase_if(row.tags, [](const SeenTag& tag) { return tag.survey == 0; });
    REQUIRE_FALSE(row.tags.empty());
    row.tags.resize(1);
    const Fix fix = localize_jointly(row, surveys, site.rig);
    CHECK(fix.position_in_grid.has_value() == (displaced == 0));
    if (fix.position_in_grid) CHECK(fix.confirmations == 1);
  }
}

TEST_CASE("beside the mouth of a drive all tags in sight may be those of that drive") {
  const Site site = with_four_cameras(site_named("corridor"));
  const VehiclePose truth = pose_at(site, 2.0, 0.0);
  auto surveys = in_two_surveys(site, 0, 0);  // all tags are of the second one
  surveys[1].tunnel.height = ChainageProfile(0.05);
  const Observation row = by_surveys(observation_at(site, truth), surveys);
  const Fix fix = localize_jointly(row, surveys, site.rig);
  CHECK(error_of(fix, site, truth) < 1e-3);
  CHECK(fix.survey == "near");
  CHECK(fix.tags.front().find("far/") == 0);
  Observation lone = row;
  lone.tags.resize(1);
  CHECK_FALSE(localize_jointly(lone, surveys, site.rig).position_in_grid);
}

TEST_CASE("of two surveys the one in whose tunnel the vehicle stands names the position") {
  const Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  const Observation seen = observation_at(site, truth);
  REQUIRE(seen.tags.size() >= 2);
  auto surveys = in_two_surveys(site, 0, 0);  // all tags are of the second one
  surveys[0].tags = {surveys[1].tags.front()};
  std::swap(surveys[0].tunnel, surveys[1].tunnel);
  Observation row = by_surveys(seen, surveys);
  CHECK(localize_jointly(row, surveys, site.rig).survey == "far");
  // Two surveys without a position do not stand against each other.
  for (SeenTag& tag : row.tags) tag.seen_corners->corners.fill({100, 100});
  CHECK_FALSE(localize_jointly(row, surveys, site.rig).position_in_grid.has_value());
}

TEST_CASE("a lone tag that lifts the vehicle off its floor is not believed; two are, unconfirmed") {
  Site site = site_named("corridor");
  VehiclePose truth = pose_at(site, 1.0, 0.0);
  truth.position.z() += 4.5 * site.rig.height_sigma;
  Observation seen = observation_at(site, truth);
  REQUIRE(seen.tags.size() == 2);
  const Fix two = localize_jointly(seen, {site.survey}, site.rig);
  CHECK(error_of(two, site, truth) < 1e-3);
  CHECK(two.confirmations == 0);
  seen.tags.pop_back();
  const Fix lone = localize_jointly(seen, {site.survey}, site.rig);
  CHECK_FALSE(lone.position_in_grid.has_value());
  CHECK_MESSAGE(lone.reason.starts_with("by the only tag, "), lone.reason);
}

TEST_CASE("a frontal tag far away that allows two poses is called ambiguous") {
  Site site = site_named("corridor");
  Observation observation;
  // At the height of the frame's middle: else the level vehicle tells the two poses apart.
  site.rig.vehicle_height = 0.4 - site.survey.tag_template.frame_inner_height / 2;
  VehiclePose truth = pose_at(site, 2.0, 0.6);
  truth.position.z() = site.rig.vehicle_height;
  truth.pitch = truth.roll = 0;
  site.rig.cameras.resize(1);
  site.rig.cameras[0].vehicle_from_camera = vehicle_from_camera(radians(80), 0, 0, {0, 0, 0});
  site.rig.cameras[0].camera.fx = site.rig.cameras[0].camera.fy = 250;
  truth.heading += radians(3);
  truth.position.y() = find_tag(site.survey, "002L")->p_in_grid.y() - 0.45;
  observation = observation_at(site, truth);
  std::erase_if(observation.tags, [](const SeenTag& seen) { return seen.tag.name != "002L"; });
  REQUIRE(observation.tags.size() == 1);
  // From sharp to blurred: surely told apart, told apart by neither, and then one broad solution.
  int ambiguous = 0;
  const CornerCovariance unit = CornerCovariance::Identity();
  for (const double sigma : {0.01, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8}) {
    CAPTURE(sigma);
    observation.tags[0].seen_corners->covariance = sigma * sigma * unit;
    const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
    if (sigma == 0.01) CHECK(error_of(fix, site, truth) < 0.01);
    if (fix.position_in_grid) continue;
    ++ambiguous;
    CHECK(fix.reason.find("ambiguous: 002L") != std::string::npos);
  }
  MESSAGE("ambiguous: ", ambiguous);
  CHECK(ambiguous >= 1);
}

TEST_CASE("both poses of a rectangle's picture are found, the right one among them") {
  constexpr unsigned kSeed = 8;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Pose pose{
        rotation_from_yaw_pitch_roll(unit(random), 0.8 * unit(random), 0.8 * unit(random)),
        {0.5 * unit(random), 0.4 * unit(random), 2 + unit(random)}};
    const Vector3d corners[] = {{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.2, 0}, {0, 0.2, 0}};
    std::array<Vector3d, 4> rays;
    for (std::size_t c = 0; c < 4; ++c) {
      const Vector3d point = pose * corners[c];
      rays[c] = point / point.z();
    }
    const auto poses = plate_poses(rays, 0.3, 0.2);
    REQUIRE(poses.has_value());
    double least = 1;
    for (const Pose& found : *poses) {
      least = std::min(least, (found.translation - pose.translation).norm() +
                                  (found.rotation - pose.rotation).norm());
    }
    CHECK(least < 1e-6);
  }
}

TEST_CASE("two tags that agree make no position against two that contradict them, each otherwise") {
  Site site = site_named("corridor");
  for (const double yaw : {25.0, -25.0}) {
    RigCamera ahead = site.rig.cameras[yaw > 0 ? 0 : 1];
    ahead.name += "_ahead";
    ahead.vehicle_from_camera = vehicle_from_camera(radians(yaw), 0, 0, {0, 0, 0});
    site.rig.cameras.push_back(ahead);
  }
  Observation observation = observation_at(site, pose_at(site, 1.0, 0.0));
  std::set<std::string> names;
  for (const SeenTag& seen : observation.tags) names.insert(seen.tag.name);
  while (names.size() > 4) names.erase(std::prev(names.end()));
  REQUIRE(names.size() == 4);
  std::erase_if(observation.tags,
                [&](const SeenTag& seen) { return names.count(seen.tag.name) == 0; });
  const std::string one = *names.begin();
  const std::string other = *std::next(names.begin());
  for (SeenTag& seen : observation.tags) {
    if (seen.tag.name == one) seen.tag.world_from_plate.translation.y() += 0.8;
    if (seen.tag.name == other) seen.tag.world_from_plate.translation.y() -= 0.6;
  }
  const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
  CHECK_FALSE(fix.position_in_grid.has_value());
  CHECK_MESSAGE(fix.reason.find("contradict each other") != std::string::npos, fix.reason);
}

// Everything off by what the survey and the rig state: plates, corners, the range, the vehicle's
// stand. A covariance a quarter too small or too large would fail.
TEST_CASE("the covariance is what noise of the stated size does") {
  double squares = 0;
  int located = 0;
  for (const std::string name : {"corridor", "curved"}) {
    const Site site = site_named(name);
    Draws draws(20261);
    for (int i = 0; i < 300; ++i) {
      VehiclePose truth = pose_at(site, draws.uniform(0, 5), draws.uniform(-0.3, 0.3));
      truth.position.z() = site.rig.vehicle_height + draws.normal(site.rig.height_sigma);
      truth.heading += draws.normal(radians(3));
      truth.pitch = draws.normal(site.rig.pitch_sigma);
      truth.roll = draws.normal(site.rig.roll_sigma);
      Site hung = site;
      for (PlacedTag& tag : hung.survey.tags) {
        tag.world_from_plate.translation += draws.normals(site.survey.sigma);
      }
      Observation observation = observation_at(hung, truth);
      if (observation.tags.empty()) continue;
      for (SeenTag& seen : observation.tags) {
        seen.tag = *find_tag(site.survey, seen.tag.name);
        for (PixelPoint& corner : seen.seen_corners->corners) {
          corner = corner + PixelPoint{draws.normal(0.02), draws.normal(0.02)};
        }
      }
      const Tunnel& tunnel = site.survey.tunnel;
      const RigRange& range = site.rig.ranges.front();
      observation.ranges[range.name] =
          observe_wall(tunnel.centerline, tunnel.left, truth.position).distance +
          draws.normal(range.sigma);
      const Fix fix = localize_jointly(observation, {site.survey}, site.rig);
      if (!fix.position_in_grid) continue;
      const Vector3d error =
          *fix.position_in_grid - grid_from_world(site.survey.grid, truth.position);
      squares += error.dot(fix.covariance_in_grid->ldlt().solve(error)) / 3;
      ++located;
    }
  }
  REQUIRE(located > 400);
  CHECK(squares / located > 0.83);  // its standard deviation is 0.04 at most
  CHECK(squares / located < 1.2);
}
