// SPDX-License-Identifier: Apache-2.0
// Positions where rig, survey or template are not what the pictures were taken with.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <regex>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/localize/joint_method.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/localize/runs.hpp"
#include "tests/localize/site.hpp"
#include "tests/support/draws.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;
using nlohmann::json;
using test::error_of;
using test::file_with;
using test::json_lines;
using test::observation_at;
using test::pose_at;
using test::run_tagsmith;
using test::Site;
using test::site_named;
using test::TemporaryFolder;

namespace {

// The text of a shipped file with each occurrence of the expression replaced.
std::string changed(const std::string& file, const std::string& expression,
                    const std::string& replacement) {
  const auto text = read_file(file);
  REQUIRE(text.has_value());
  const std::string result = std::regex_replace(*text, std::regex(expression), replacement);
  REQUIRE(result != *text);
  return result;
}

// Rows that say `ok` and are more than five standard deviations from the truth.
int sure_and_wrong(const std::string& arguments) {
  int wrong = 0;
  for (const json& line : json_lines(run_tagsmith(arguments + " --json").out)) {
    if (!line.contains("status") || line.at("status") != "ok") continue;
    const json& covariance = line.at("covariance");
    const double plane = std::sqrt(covariance.at(0).get<double>() + covariance.at(4).get<double>());
    const double height = std::sqrt(covariance.at(8).get<double>());
    wrong += line.at("error_plane") > 5 * plane || line.at("error_z") > 5 * height ? 1 : 0;
  }
  return wrong;
}

std::string localize(const std::string& survey, const std::string& rig, const std::string& run) {
  return "localize " + survey + " --rig " + rig + " --run " + run;
}

bool lists(const Fix& fix, Unchecked::Kind kind) {
  return std::ranges::find(fix.unchecked, kind, &Unchecked::kind) != fix.unchecked.end();
}

// How far the worst mistake that would go unnoticed could move the position, metres.
double most_unchecked(const Fix& fix) {
  double most = 0;
  for (const Unchecked& unchecked : fix.unchecked) most = std::max(most, unchecked.metres);
  return most;
}

double greatest_sigmas(const Fix& fix, const Site& site, const VehiclePose& truth) {
  const Vector3d error = *fix.position_in_grid - grid_from_world(site.survey.grid, truth.position);
  const Vector3d sigmas = fix.covariance_in_grid->diagonal().cwiseSqrt();
  return error.cwiseAbs().cwiseQuotient(sigmas).maxCoeff();
}

}  // namespace

TEST_CASE("through lenses that bend straight lines a rig by data sheet says what it knows") {
  for (const char* name : {"corridor", "curved"}) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "rig.yaml";
    const std::string rig = "surveys/" + std::string(name) + "/rig.yaml";
    REQUIRE(write_file(file, changed(rig, ", sigma: 0 \\}", " }")));
    Site site = site_named(name);
    const Rig by_sheet = load_rig(file.string()).value();
    for (const double k1 : {-0.12, -0.04, 0.04}) {
      for (RigCamera& camera : site.rig.cameras) camera.camera.distortion[0] = k1;
      for (const double chainage : {0.5, 1.6, 2.4, 3.3}) {
        CAPTURE(std::string(name));
        CAPTURE(k1);
        CAPTURE(chainage);
        const VehiclePose truth = pose_at(site, chainage, 0.05);
        const Fix fix = localize_jointly(observation_at(site, truth), {site.survey}, by_sheet);
        REQUIRE(fix.position_in_grid);
        CHECK(greatest_sigmas(fix, site, truth) < 3);
      }
    }
  }
}

TEST_CASE("photos of the corridor with another height in the rig: no row is sure and wrong") {
  const TemporaryFolder folder;
  const std::string rig =
      file_with(folder.path() / "rig.yaml",
                changed("surveys/corridor/rig.yaml", "height: 0.24", "height: 0.6"));
  CHECK(sure_and_wrong(localize("surveys/corridor/survey.yaml", rig, "surveys/corridor/run.csv")) ==
        0);
}

TEST_CASE("photos of the bend with other focal lengths in the rig: no row is sure and wrong") {
  const TemporaryFolder folder;
  for (const char* focal : {"5.4", "5.88", "6.12", "6.6"}) {
    CAPTURE(focal);
    const std::string rig = file_with(folder.path() / "rig.yaml",
                                      changed("surveys/curved/rig.yaml", "focal_length_mm: 6.0",
                                              std::string("focal_length_mm: ") + focal));
    CHECK(sure_and_wrong(localize("surveys/curved/survey.yaml", rig, "surveys/curved/run.csv")) ==
          0);
  }
}

TEST_CASE("photos of plates of another size than the template: no row is sure and wrong") {
  const TemporaryFolder folder;
  const std::string corridor =
      file_with(folder.path() / "corridor.yaml",
                changed("surveys/corridor/survey.yaml", "tag-400x300", "tag-800x430"));
  CHECK(sure_and_wrong(
            localize(corridor, "surveys/corridor/rig.yaml", "surveys/corridor/run.csv")) == 0);
  const std::string curved =
      file_with(folder.path() / "curved.yaml",
                changed("surveys/curved/survey.yaml", "tag-800x430", "tag-400x300"));
  CHECK(sure_and_wrong(localize(curved, "surveys/curved/rig.yaml", "surveys/curved/run.csv")) == 0);
}

TEST_CASE("a range that contradicts a lone tag withholds the position, one against two does not") {
  const Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  Observation seen = observation_at(site, truth);
  REQUIRE(seen.tags.size() == 2);
  seen.ranges["d"] = 1.5;  // 0.95 m is right
  const Fix two = localize_jointly(seen, {site.survey}, site.rig);
  CHECK(error_of(two, site, truth) < 1e-3);
  CHECK(two.ranges.empty());
  seen.tags.pop_back();
  CHECK_FALSE(localize_jointly(seen, {site.survey}, site.rig).position_in_grid.has_value());
  seen.ranges["d"] = 0.95;
  CHECK(error_of(localize_jointly(seen, {site.survey}, site.rig), site, truth) < 5e-3);
}

TEST_CASE("tags that fit no pose by themselves still count against the one that does") {
  Site site = site_named("corridor");
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  Observation seen = observation_at(site, truth);
  REQUIRE(seen.tags.size() == 2);
  for (PixelPoint& corner : seen.tags[1].seen_corners->corners) corner.x *= 1.3;
  CHECK_FALSE(localize_jointly(seen, {site.survey}, site.rig).position_in_grid.has_value());
}

TEST_CASE("tags that contradict each other a little widen the covariance, by more none") {
  Site site = site_named("corridor");
  site.survey.sigma = 0.001;
  for (PlacedTag& tag : site.survey.tags) tag.sigma = site.survey.sigma;
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  const auto fix_with = [&](double shift) {
    Observation seen = observation_at(site, truth);
    REQUIRE(seen.tags.size() == 2);
    seen.tags[0].tag.world_from_plate.translation.y() += shift;
    return localize_jointly(seen, {site.survey}, site.rig);
  };
  const Fix right = fix_with(0);
  CHECK(right.variance_factor == 1);
  const Fix off = fix_with(0.008);  // 5.7 standard deviations of the difference of two plates
  REQUIRE_MESSAGE(off.position_in_grid.has_value(), off.reason);
  CHECK(off.variance_factor > 1.5);
  CHECK((*off.covariance_in_grid)(1, 1) > 1.5 * (*right.covariance_in_grid)(1, 1));
  CHECK(greatest_sigmas(off, site, truth) < 5);
  CHECK_FALSE(fix_with(0.03).position_in_grid.has_value());
}

TEST_CASE("edges that a camera moves outward contradict nothing where the rig allows for it") {
  Site site = site_named("corridor");
  for (PlacedTag& tag : site.survey.tags) tag.sigma = 0;
  const VehiclePose truth = pose_at(site, 1.0, 0.0);
  const Observation exact = observation_at(site, truth);
  REQUIRE(exact.tags.size() == 2);
  Observation sharpened = exact;
  for (SeenTag& seen : sharpened.tags) {
    const Sighting sighting = sighting_of(*seen.seen_corners, site.rig, 0, 0);
    const Eigen::Matrix<double, 8, 1> moved = 0.15 * by_outward_edges(sighting.pixels);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      seen.seen_corners->corners[i].x += moved[row];
      seen.seen_corners->corners[i].y += moved[row + 1];
    }
  }
  const Fix stated = localize_jointly(exact, {site.survey}, site.rig);
  CHECK_FALSE(localize_jointly(sharpened, {site.survey}, site.rig).position_in_grid.has_value());
  for (RigCamera& camera : site.rig.cameras) camera.calibration_sigma.edge = 0.1;
  const Fix allowed = localize_jointly(sharpened, {site.survey}, site.rig);
  REQUIRE_MESSAGE(allowed.position_in_grid.has_value(), allowed.reason);
  CHECK(greatest_sigmas(allowed, site, truth) < 3);
  // Exact corners give the same position as before, less surely.
  const Fix unsure = localize_jointly(exact, {site.survey}, site.rig);
  CHECK((*unsure.position_in_grid - *stated.position_in_grid).norm() < 1e-6);
  CHECK(unsure.covariance_in_grid->trace() > 2 * stated.covariance_in_grid->trace());
  CHECK(unsure.budget->edges.trace() > 0);
}

TEST_CASE("an outward shift of a rectangle's edges moves its corners along the diagonals") {
  Eigen::Matrix<double, 8, 1> corners;
  corners << 10, 20, 110, 20, 110, 80, 10, 80;
  Eigen::Matrix<double, 8, 1> expected;
  expected << -1, -1, 1, -1, 1, 1, -1, 1;
  CHECK((by_outward_edges(corners) - expected).norm() < 1e-12);
}

TEST_CASE("a position names what nothing measured would reveal") {
  Site wide = site_named("corridor");  // two further cameras see more tags
  for (const double yaw : {25.0, -25.0}) {
    RigCamera ahead = wide.rig.cameras[yaw > 0 ? 0 : 1];
    ahead.name += "_ahead";
    ahead.vehicle_from_camera = vehicle_from_camera(radians(yaw), 0, 0, {0, 0, 0});
    wide.rig.cameras.push_back(ahead);
  }
  const Observation many = observation_at(wide, pose_at(wide, 1.0, 0.0));
  REQUIRE(many.tags.size() >= 4);
  const Fix checked = localize_jointly(many, {wide.survey}, wide.rig);
  CHECK_FALSE(lists(checked, Unchecked::Kind::plate_place));
  Observation one = many;
  one.tags.resize(1);
  const Fix lone = localize_jointly(one, {wide.survey}, wide.rig);
  REQUIRE_MESSAGE(lone.position_in_grid.has_value(), lone.reason);
  CHECK(lists(lone, Unchecked::Kind::plate_place));
  CHECK(lists(lone, Unchecked::Kind::mounting));
  CHECK(lists(lone, Unchecked::Kind::plate_size));
  CHECK(lists(lone, Unchecked::Kind::wall_turn));
  CHECK(to_string(Unchecked{Unchecked::Kind::wall_turn, "left", 1}) ==
        "a common lean or slope of the plates of one wall: left");
  CHECK(lists(lone, Unchecked::Kind::rolling_shutter));
  for (RigCamera& camera : wide.rig.cameras) camera.readout = 0;
  const Fix global = localize_jointly(one, {wide.survey}, wide.rig);
  CHECK_FALSE(lists(global, Unchecked::Kind::rolling_shutter));
  CHECK(global.unchecked.size() + 1 == lone.unchecked.size());
  for (const Fix& fix : {checked, lone}) {
    CHECK(lists(fix, Unchecked::Kind::all_mountings));
    CHECK(lists(fix, Unchecked::Kind::moment));
    CHECK(lists(fix, Unchecked::Kind::survey_frame));
  }
  CHECK(most_unchecked(checked) > 0);
  CHECK(most_unchecked(lone) > 10 * most_unchecked(checked));
}

TEST_CASE("what nothing measured would reveal does not depend on where the grid begins") {
  const Site site = site_named("corridor");
  Site moved = site;
  const Vector3d shift(900, -1400, 0);
  const CenterlinePoint start = site.survey.tunnel.centerline.at(0);
  moved.survey.tunnel.centerline =
      Centerline(start.position + shift, start.heading, site.survey.tunnel.centerline.elements());
  for (PlacedTag& tag : moved.survey.tags) {
    tag.world_from_plate.translation += shift;
    tag.p_in_grid = grid_from_world(site.survey.grid, tag.world_from_plate.translation);
  }
  const auto lone_fix = [](const Site& at) {
    Observation seen = observation_at(at, pose_at(at, 1.0, 0.0));
    seen.tags.resize(1);
    return localize_jointly(seen, {at.survey}, at.rig);
  };
  const Fix here = lone_fix(site);
  const Fix there = lone_fix(moved);
  CHECK(lists(here, Unchecked::Kind::wall_places));
  REQUIRE(here.unchecked.size() == there.unchecked.size());
  for (std::size_t i = 0; i < here.unchecked.size(); ++i) {
    CAPTURE(to_string(here.unchecked[i]));
    CHECK(here.unchecked[i].kind == there.unchecked[i].kind);
    CHECK(here.unchecked[i].metres == doctest::Approx(there.unchecked[i].metres).epsilon(1e-3));
  }
}

// The same draws as `bench wrong_world`, fewer of them: mistakes of the rig and of the plates, each
// from small to gross. What is sure and wrong must at least be named as unchecked.
TEST_CASE("a position that a mistake made wrong is refused or names the mistake as unchecked") {
  struct Mistake {
    std::vector<Unchecked::Kind> kinds;
    std::function<void(Site&, double)> make;  // of what is believed; size from 0 to 1
  };
  using enum Unchecked::Kind;
  const std::vector<Mistake> mistakes{
      {{vehicle_height}, [](Site& s, double size) { s.rig.vehicle_height += 0.6 * size; }},
      {{lens, all_lenses},
       [](Site& s, double size) {
         for (RigCamera& camera : s.rig.cameras) {
           camera.camera.fx *= 1 + 0.2 * size;
           camera.camera.fy *= 1 + 0.2 * size;
         }
       }},
      {{mounting},
       [](Site& s, double size) {
         s.rig.cameras[0].vehicle_from_camera.rotation *=
             Eigen::AngleAxisd(0.5 * size, Vector3d(0.3, 0.8, 0.5).normalized()).toRotationMatrix();
       }},
      {{plate_size},
       [](Site& s, double size) { s.survey.tag_template.frame_inner_length *= 1 + 0.2 * size; }},
      {{plate_place, wall_turn},
       [](Site& s, double size) {
         for (PlacedTag& tag : s.survey.tags) {
           const double slope = tag.side == Side::left ? 0.1 * size : -0.1 * size;
           tag.world_from_plate.rotation *=
               Eigen::AngleAxisd(slope, Vector3d::UnitZ()).toRotationMatrix();
         }
       }},
      {{plate_place, wall_turn},
       [](Site& s, double size) {
         for (PlacedTag& tag : s.survey.tags) {
           tag.world_from_plate.rotation *=
               Eigen::AngleAxisd(0.1 * size, Vector3d::UnitX()).toRotationMatrix();
         }
       }},
      {{plate_place}, [](Site& s, double size) {
         for (PlacedTag& tag : s.survey.tags) {
           if (tag.name == "001L") tag.world_from_plate.translation.y() += size;
         }
       }}};
  test::Draws draws(7);
  int located = 0;
  int refused = 0;
  for (int i = 0; i < 1500; ++i) {
    CAPTURE(i);
    const Site site = site_named(i % 2 == 0 ? "corridor" : "curved");
    const VehiclePose truth = pose_at(site, draws.uniform(0, 5), draws.uniform(-0.3, 0.3));
    Observation seen = observation_at(site, truth);
    if (seen.tags.empty()) continue;
    const Mistake& mistake = mistakes[draws.index(mistakes.size())];
    Site believed = site;
    mistake.make(believed, std::pow(10, draws.uniform(-2, 0)) * (draws.chance(0.5) ? 1 : -1));
    for (SeenTag& tag : seen.tags) tag.tag = *find_tag(believed.survey, tag.tag.name);
    const Fix fix = localize_jointly(seen, {believed.survey}, believed.rig);
    fix.position_in_grid ? ++located : ++refused;
    if (!fix.position_in_grid || greatest_sigmas(fix, site, truth) < 5) continue;
    const bool named =
        std::ranges::any_of(mistake.kinds, [&](Unchecked::Kind kind) { return lists(fix, kind); });
    CHECK_MESSAGE(named, to_string(mistake.kinds.front()));
  }
  CHECK(located > 200);
  CHECK(refused > 200);
}
