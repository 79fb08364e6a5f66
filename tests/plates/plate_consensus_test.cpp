// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_consensus.hpp"

#include <random>
#include <utility>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "decoder/localize/observation.hpp"
#include "decoder/plates/attitude_scatter.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/support/wide_corridor.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

struct CorridorHungByEye : test::WideCorridor {
  // Hangs all plates by eye, `sigma` radians off about each axis.
  void tilt_all(double sigma, std::mt19937_64& random) {
    std::normal_distribution<double> angle(0, sigma);
    for (Pose& pose : hung) {
      const Vector3d turn(angle(random), angle(random), angle(random));
      pose.rotation *= Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    }
  }

  // Moves a plate in its own axes: right, down, into the wall.
  void move(std::string_view name, const Vector3d& shift, double turn = 0) {
    Pose& pose = hung[index(name)];
    pose.translation += pose.rotation * shift;
    pose.rotation *= Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
  }
};

// What the cameras see of the named plates from this chainage, corners to 0.1 px.
Station seen_from(const CorridorHungByEye& site, double y, const std::vector<std::string>& names,
                  std::mt19937_64& random) {
  std::normal_distribution<double> noise(0, 0.1);
  Station station{std::to_string(y), {}};
  VehiclePose vehicle;
  vehicle.position = world_from_grid(site.survey.grid, {0.95, y, 0.24});
  vehicle.heading = world_heading_from_grid(site.survey.grid, 0);
  for (const std::string& name : names) {
    const std::size_t i = site.index(name);
    SightedPlate plate = sighted_plate(site.survey.tags[i], site.survey);
    plate.world_from_plate = site.hung[i];
    Sighting sighting;
    sighting.camera = name.ends_with('L') ? 0 : 1;
    sighting.plate = i;
    const auto rows = sighting_rows(site.rig, calibration_layout(site.rig), {},
                                    vehicle_frame(vehicle), plate, sighting.camera);
    REQUIRE(rows);
    sighting.pixels = rows->predicted;
    for (double& value : sighting.pixels) value += noise(random);
    sighting.covariance = 0.01 * CornerCovariance::Identity();
    station.sightings.push_back(sighting);
  }
  return station;
}

AdjustmentProblem problem_of(const CorridorHungByEye& site) {
  AdjustmentProblem problem{&site.rig, {}, {}};
  for (const PlacedTag& tag : site.survey.tags) {
    problem.plates.push_back(sighted_plate(tag, site.survey));
    problem.plates.back().survey_variance << 4e-6, 4e-6, 4e-6, 1e-6, 1e-6, 1e-6;
  }
  return problem;
}

// Three places, each of which sees two pairs.
AdjustmentProblem drive(const CorridorHungByEye& site, std::uint64_t seed = 7) {
  std::mt19937_64 random(seed);
  AdjustmentProblem problem = problem_of(site);
  problem.stations = {seen_from(site, -0.5, {"000L", "000R", "001L", "001R"}, random),
                      seen_from(site, 0.3, {"001L", "001R", "002L", "002R"}, random),
                      seen_from(site, 1.1, {"002L", "002R", "003L", "003R"}, random)};
  return problem;
}

// Six places, each of which sees two pairs.
AdjustmentProblem long_drive(const CorridorHungByEye& site) {
  std::mt19937_64 random(7);
  AdjustmentProblem problem = problem_of(site);
  for (int pair = 0; pair < 6; ++pair) {
    const std::string near = "00" + std::to_string(pair), far = "00" + std::to_string(pair + 1);
    problem.stations.push_back(
        seen_from(site, 0.8 * pair - 0.5, {near + "L", near + "R", far + "L", far + "R"}, random));
  }
  return problem;
}

void exchange_photos(Station& one, Station& other, std::size_t camera) {
  for (std::size_t i = 0; i < one.sightings.size(); ++i) {
    if (one.sightings[i].camera == camera) std::swap(one.sightings[i], other.sightings[i]);
  }
}

// Pictures of a plate at another size: those of the whole one, its corners drawn towards its
// middle.
void print_small(const CorridorHungByEye& site, std::size_t small, AdjustmentProblem& problem,
                 double size = 0.97) {
  for (Station& station : problem.stations) {
    for (Sighting& sighting : station.sightings) {
      if (sighting.plate != small) continue;
      SightedPlate plate = problem.plates[small];
      plate.length *= size;
      plate.height *= size;
      plate.world_from_plate.translation +=
          plate.world_from_plate.rotation *
          ((1 - size) / 2 *
           Vector3d(problem.plates[small].length, problem.plates[small].height, 0));
      VehiclePose vehicle;
      vehicle.position = world_from_grid(site.survey.grid, {0.95, std::stod(station.name), 0.24});
      sighting.pixels = sighting_rows(site.rig, calibration_layout(site.rig), {},
                                      vehicle_frame(vehicle), plate, sighting.camera)
                            ->predicted;
    }
  }
}

}  // namespace

TEST_CASE("plates that hang as surveyed fit, those not seen are not checked") {
  const CorridorHungByEye site;
  const Consensus consensus = find_consensus(drive(site));
  for (std::size_t i = 0; i < consensus.plates.size(); ++i) {
    CAPTURE(site.survey.tags[i].name);
    CHECK(consensus.plates[i].verdict == (i < 8 ? HangVerdict::fits : HangVerdict::unchecked));
  }
  CHECK(consensus.left_out.empty());
}

TEST_CASE("a displaced plate is found, and by how much to its standard deviation") {
  const std::vector<Vector3d> shifts{{0.03, 0, 0}, {0, -0.03, 0}, {0, 0, 0.03}, {0.4, 0.2, -0.1}};
  for (const char* name : {"000L", "001R", "002L", "003R"}) {
    for (const Vector3d& shift : shifts) {
      CAPTURE(name);
      CAPTURE(shift.transpose());
      CorridorHungByEye site;
      site.move(name, shift, radians(4));
      const Consensus consensus = find_consensus(drive(site));
      for (std::size_t i = 0; i < 8; ++i) {
        CAPTURE(site.survey.tags[i].name);
        const bool moved = site.survey.tags[i].name == name;
        CHECK(consensus.plates[i].verdict == (moved ? HangVerdict::off : HangVerdict::fits));
      }
      const PlateOffset& offset = *consensus.plates[site.index(name)].offset;
      const Eigen::Matrix3d& rotation =
          site.survey.tags[site.index(name)].world_from_plate.rotation;
      Eigen::Matrix<double, 6, 1> error;
      error << offset.shift - rotation * shift, offset.turn - Vector3d(0, 0, radians(4));
      CHECK(error.dot(offset.covariance.ldlt().solve(error)) < 30);  // chi-square of six
      CHECK(std::sqrt(offset.covariance.topLeftCorner<3, 3>().trace()) < 0.01);
    }
  }
}

TEST_CASE("how sure it is that a plate is off does not depend on one that is off far from it") {
  CorridorHungByEye one;
  one.move("000L", {0.02, 0, 0});
  CorridorHungByEye two = one;
  two.move("003R", {0, 0.05, 0});
  const PlateCheck alone = find_consensus(drive(one)).plates[one.index("000L")];
  const PlateCheck beside = find_consensus(drive(two)).plates[one.index("000L")];
  CHECK(alone.verdict == HangVerdict::off);
  CHECK(beside.verdict == HangVerdict::off);
  CHECK(beside.log_odds == doctest::Approx(alone.log_odds).epsilon(0.05));
}

TEST_CASE("how sure it is that a plate is off does not depend on photos that were mixed up") {
  CorridorHungByEye site;
  site.move("001L", {0.02, 0, 0});
  const AdjustmentProblem right = long_drive(site);
  const PlateCheck alone = find_consensus(right).plates[site.index("001L")];
  CHECK(alone.verdict == HangVerdict::off);
  for (const std::size_t near : {1U, 4U}) {
    CAPTURE(near);
    AdjustmentProblem problem = right;
    exchange_photos(problem.stations[near], problem.stations[near + 1], 1);
    const Consensus found = find_consensus(problem);
    CHECK(found.mixed.size() == 1);
    const PlateCheck& beside = found.plates[site.index("001L")];
    CHECK(beside.verdict == HangVerdict::off);
    CHECK(beside.log_odds == doctest::Approx(alone.log_odds).epsilon(0.1));
  }
}

TEST_CASE("how sure it is that a plate is off does not depend on a second copy far from it") {
  CorridorHungByEye site;
  site.move("001L", {0.02, 0, 0});
  const PlateCheck alone = find_consensus(long_drive(site)).plates[site.index("001L")];
  AdjustmentProblem problem = long_drive(site);
  CorridorHungByEye copied = site;
  copied.hung[site.index("004R")] = site.hung[site.index("006R")];
  std::mt19937_64 random(9);
  problem.stations[5] = seen_from(copied, 3.5, {"005L", "005R", "006L", "004R"}, random);
  problem.unseen = {problem.plates[site.index("006R")]};
  const Consensus found = find_consensus(problem);
  REQUIRE(found.copies.size() == 1);
  CHECK(found.copies[0].place == "006R");
  const PlateCheck& beside = found.plates[site.index("001L")];
  CHECK(beside.verdict == HangVerdict::off);
  CHECK(beside.log_odds == doctest::Approx(alone.log_odds).epsilon(0.05));
}

TEST_CASE("no row is left out for what one plate explains, however far it is moved") {
  for (const double by : {0.1, 0.13, 0.16, 0.19, 0.22, 0.25, 0.3}) {
    for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0, 0.6, 0.8), Vector3d(0.6, 0, -0.8)}) {
      CAPTURE(by);
      CAPTURE(way.transpose());
      CorridorHungByEye site;
      site.move("002R", by * way);
      std::mt19937_64 random(5);
      AdjustmentProblem problem = problem_of(site);
      problem.stations = {seen_from(site, -0.4, {"000L", "000R", "001L", "001R", "002R"}, random),
                          seen_from(site, 0.3, {"001L", "001R", "002L", "002R"}, random),
                          seen_from(site, 0.7, {"001R", "002R"}, random),
                          seen_from(site, 1.1, {"002L", "002R", "003L", "003R"}, random)};
      const Consensus consensus = find_consensus(problem);
      CHECK(consensus.left_out.empty());
      for (std::size_t i = 0; i < 8; ++i) {
        CAPTURE(site.survey.tags[i].name);
        const bool moved = site.survey.tags[i].name == "002R";
        CHECK(consensus.plates[i].verdict == (moved ? HangVerdict::off : HangVerdict::fits));
      }
    }
  }
}

TEST_CASE("of two plates seen together nothing tells which is off, of three the others do") {
  std::mt19937_64 random(3);
  CorridorHungByEye site;
  site.move("001L", {0, 0.03, 0});
  AdjustmentProblem pair = problem_of(site);
  pair.stations = {seen_from(site, 0.3, {"001L", "001R"}, random)};
  const Consensus doubtful = find_consensus(pair);
  for (const char* name : {"001L", "001R"}) {
    const PlateCheck& check = doubtful.plates[site.index(name)];
    CHECK(check.verdict == HangVerdict::doubtful);
    REQUIRE(check.rivals.size() == 1);
    CHECK(check.rivals[0] == site.index(name[3] == 'L' ? "001R" : "001L"));
    CHECK(farthest_corner(pair.plates[0], *check.offset) == doctest::Approx(0.03).epsilon(0.2));
  }
  pair.stations.push_back(seen_from(site, 0.3, {"001R", "002L"}, random));
  const Consensus told = find_consensus(pair);
  CHECK(told.plates[site.index("001L")].verdict == HangVerdict::off);
  CHECK(told.plates[site.index("001R")].verdict == HangVerdict::fits);
}

TEST_CASE("a plate that hangs elsewhere is told though another's place and size explain it") {
  for (const double by : {-0.03, 0.0, 0.03}) {
    for (const double y : {-0.3, 0.3, 0.9}) {
      for (const double other_y : {0.0, 0.6, 1.2}) {
        CAPTURE(by);
        CAPTURE(y);
        CAPTURE(other_y);
        CorridorHungByEye site;
        site.move("002L", {by, 0, 0});
        std::mt19937_64 random(4);
        AdjustmentProblem problem = problem_of(site);
        problem.stations = {seen_from(site, y, {"002L", "002R"}, random),
                            seen_from(site, other_y, {"001R", "002R"}, random)};
        const PlateCheck check = find_consensus(problem).plates[site.index("002L")];
        CHECK((check.verdict == HangVerdict::fits) == (by == 0));
      }
    }
  }
}

TEST_CASE("a plate off by less than the tolerance fits") {
  CorridorHungByEye site;
  site.move("001L", {0.007, 0, 0});
  AdjustmentProblem problem = drive(site);
  for (SightedPlate& plate : problem.plates) plate.survey_variance.head<3>().setConstant(1e-7);
  CHECK(find_consensus(problem).plates[site.index("001L")].verdict == HangVerdict::fits);
  CHECK(find_consensus(problem, 0.004).plates[site.index("001L")].verdict == HangVerdict::off);
}

TEST_CASE("how plates are tilted is told by their pictures, by custom where these tell nothing") {
  std::mt19937_64 random(11);
  const CorridorHungByEye straight;
  AdjustmentProblem one = problem_of(straight);
  one.stations = {seen_from(straight, 0.3, {"001L"}, random)};
  CHECK(degrees(attitude_scatter(one)) == doctest::Approx(0.7).epsilon(0.1));
  AdjustmentProblem two = problem_of(straight);
  two.stations = {seen_from(straight, 0.3, {"001L", "001R"}, random)};
  CHECK(degrees(attitude_scatter(two)) < 0.3);
  CHECK(degrees(attitude_scatter(drive(straight))) < 0.15);
  int below = 0;
  for (int draw = 0; draw < 20; ++draw) {
    CorridorHungByEye by_eye;
    by_eye.tilt_all(radians(0.5), random);
    const double scatter = degrees(attitude_scatter(drive(by_eye)));
    CHECK(scatter < 1.2);
    below += scatter < 0.5 ? 1 : 0;
  }
  CHECK(below <= 2);
}

TEST_CASE("a plate that hangs wrong altogether does not make the others look tilted") {
  CorridorHungByEye site;
  site.move("001L", {0.03, 0, 0}, radians(5));
  site.move("002R", {0, 0.1, 0});
  CHECK(degrees(attitude_scatter(drive(site))) < 0.25);
}

TEST_CASE("exchanged plates are told as such") {
  CorridorHungByEye site;
  std::swap(site.hung[site.index("001L")], site.hung[site.index("002L")]);
  const Consensus consensus = find_consensus(drive(site));
  CHECK(consensus.plates[site.index("001L")].swapped_with == site.index("002L"));
  CHECK(consensus.plates[site.index("002L")].swapped_with == site.index("001L"));
  for (const char* name : {"000L", "000R", "001R", "002R", "003L"}) {
    CHECK(consensus.plates[site.index(name)].verdict == HangVerdict::fits);
  }
}

TEST_CASE("a shift among plates hung by eye is more than their tilts where they turn alike") {
  std::mt19937_64 random(21);
  int found = 0;
  int accused = 0;
  for (int draw = 0; draw < 40; ++draw) {
    for (const bool moved : {true, false}) {
      CorridorHungByEye site;
      site.tilt_all(radians(0.5), random);
      if (moved) site.move("001L", {0, -0.03, 0});
      AdjustmentProblem pair = problem_of(site);
      pair.stations = {seen_from(site, 0.3, {"001L", "002L"}, random)};
      const double sigma = attitude_scatter(pair);
      for (SightedPlate& plate : pair.plates) {
        plate.survey_variance.tail<3>().setConstant(sigma * sigma);
      }
      const bool fits =
          find_consensus(pair).plates[site.index("001L")].verdict == HangVerdict::fits;
      (moved ? found : accused) += fits ? 0 : 1;
    }
  }
  CHECK(found >= 30);
  CHECK(accused <= 1);
}

TEST_CASE("a frame of another size in its place is told from one that hangs elsewhere") {
  const CorridorHungByEye site;
  AdjustmentProblem problem = drive(site);
  const std::size_t small = site.index("001L");
  print_small(site, small, problem);
  const PlateCheck check = find_consensus(problem).plates[small];
  CHECK(check.verdict == HangVerdict::off);
  REQUIRE(check.scale);
  CHECK(check.scale->share == doctest::Approx(0.97).epsilon(0.003));
  CHECK(check.scale->least > 0.001);
  CHECK(check.scale->least < 0.02);
  CorridorHungByEye moved;
  moved.move("001L", {0.03, 0, 0});
  CHECK_FALSE(find_consensus(drive(moved)).plates[small].scale);
}

TEST_CASE("the least error of a size that is told would be seen, however loose the survey is") {
  constexpr double kSigma = 0.0045;  // of surveyed places
  std::mt19937_64 random(3);
  std::normal_distribution<double> off_place(0, kSigma), noise(0, 0.1);
  // What becomes of a frame that is printed small, among plates that hang where such a survey says.
  const auto check_of = [&](double size) {
    CorridorHungByEye site;
    const std::size_t small = site.index("001L");
    for (Pose& pose : site.hung) {
      pose.translation += Vector3d(off_place(random), off_place(random), off_place(random));
    }
    AdjustmentProblem problem = drive(site, random());
    for (SightedPlate& plate : problem.plates) {
      plate.survey_variance.head<3>().setConstant(kSigma * kSigma);
    }
    SightedPlate& plate = problem.plates[small];
    const Pose surveyed = std::exchange(plate.world_from_plate, site.hung[small]);
    print_small(site, small, problem, size);
    plate.world_from_plate = surveyed;
    for (Station& station : problem.stations) {
      for (Sighting& sighting : station.sightings) {
        if (sighting.plate != small) continue;
        for (double& value : sighting.pixels) value += noise(random);
      }
    }
    return find_consensus(problem).plates[small];
  };
  const PlateCheck told = check_of(0.97);
  REQUIRE(told.scale);
  CHECK(told.scale->least < 0.03);
  int seen = 0;
  for (int draw = 0; draw < 12; ++draw) {
    if (check_of(1 - told.scale->least).verdict != HangVerdict::fits) ++seen;
  }
  CHECK(seen >= 10);
}

TEST_CASE("of two plates that contradict each other the size that explains it is told") {
  std::mt19937_64 random(5);
  CorridorHungByEye site;
  const std::size_t small = site.index("001L");
  AdjustmentProblem pair = problem_of(site);
  pair.stations = {seen_from(site, 0.3, {"001L", "001R"}, random)};
  print_small(site, small, pair);
  const PlateCheck check = find_consensus(pair).plates[small];
  CHECK(check.verdict == HangVerdict::doubtful);
  REQUIRE(check.scale);
  CHECK(check.scale->share == doctest::Approx(0.97).epsilon(0.01));
  site.move("001L", {0, 0.03, 0});
  pair.stations = {seen_from(site, 0.3, {"001L", "001R"}, random)};
  const PlateCheck lower = find_consensus(pair).plates[small];
  CHECK(lower.verdict == HangVerdict::doubtful);
  CHECK_FALSE(lower.scale);
}

TEST_CASE("pictures that were not taken together accuse no plate") {
  std::mt19937_64 random(9);
  const CorridorHungByEye site;
  AdjustmentProblem problem = drive(site);
  Station mixed = seen_from(site, 0.3, {"001L", "002L"}, random);
  const Station other = seen_from(site, 0.9, {"001R", "002R"}, random);
  mixed.sightings.insert(mixed.sightings.end(), other.sightings.begin(), other.sightings.end());
  mixed.name = "mixed";
  problem.stations.push_back(mixed);
  const Consensus consensus = find_consensus(problem);
  for (std::size_t i = 0; i < 8; ++i) CHECK(consensus.plates[i].verdict == HangVerdict::fits);
  REQUIRE(consensus.left_out.size() == 1);
  CHECK(consensus.left_out[0].name == "mixed");
  // Those of each camera were, and tell by themselves.
  for (const char* name : {"001L", "002L", "001R", "002R"}) {
    CHECK(consensus.plates[site.index(name)].stations == 3);
  }
}

TEST_CASE("chi-square counts by how much the calibration has to depart from the rig's") {
  const CorridorHungByEye site;
  AdjustmentProblem problem = drive(site);
  for (SightedPlate& plate : problem.plates) plate.survey_variance.setConstant(1e-14);
  Rig other = site.rig;
  const double sigma = radians(0.2);
  for (RigCamera& camera : other.cameras) camera.calibration_sigma.angle = sigma;
  other.cameras[0].vehicle_from_camera.rotation *=
      Eigen::AngleAxisd(radians(0.5), Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  problem.rig = &other;
  const std::vector<PlateFreedom> freed(problem.plates.size(), PlateFreedom::none);
  const auto fit = adjust_plates(problem, freed);
  REQUIRE(fit);
  double of_corners = 0;
  for (const double chi_square : fit->station_chi_square) of_corners += chi_square;
  const double of_calibration = fit->calibration.squaredNorm() / (sigma * sigma);
  CHECK(of_calibration > 1);
  CHECK(fit->chi_square - of_corners == doctest::Approx(of_calibration).epsilon(0.01));
}

TEST_CASE("a plate's shift and turn are each weighed by their own part of the covariance") {
  CorridorHungByEye site;
  site.move("001L", {0.01, 0, 0}, radians(1));
  const AdjustmentProblem problem = drive(site);
  std::vector<PlateFreedom> freed(problem.plates.size(), PlateFreedom::none);
  const std::size_t moved = site.index("001L");
  freed[moved] = PlateFreedom::place;
  const auto fit = adjust_plates(problem, freed);
  REQUIRE(fit);
  REQUIRE(fit->offsets[moved]);
  const PlateOffset& offset = *fit->offsets[moved];
  Eigen::Matrix<double, 6, 6> spread = offset.covariance;
  spread.diagonal() += problem.plates[moved].survey_variance;
  const auto distance2 = [&](Eigen::Index first, const Vector3d& part) {
    return part.dot(spread.block<3, 3>(first, first).inverse() * part);
  };
  CHECK(offset.shift_chi_square == doctest::Approx(distance2(0, offset.shift)));
  CHECK(offset.turn_chi_square == doctest::Approx(distance2(3, offset.turn)));
  CHECK(offset.turn_chi_square > 10);  // the turn alone is beyond chance
}

TEST_CASE("a plate of another size, seen from near and far, accuses none that hang beside it") {
  const CorridorHungByEye site;
  AdjustmentProblem problem = drive(site);
  std::mt19937_64 random(15);
  problem.stations.push_back(seen_from(site, -0.1, {"000R", "001L", "001R", "002L"}, random));
  problem.stations.push_back(seen_from(site, 0.8, {"001R", "002L", "002R", "003R"}, random));
  const std::size_t small = site.index("002L");
  print_small(site, small, problem, 0.95);
  const Consensus consensus = find_consensus(problem);
  for (std::size_t i = 0; i < 8; ++i) {
    CAPTURE(site.survey.tags[i].name);
    CHECK(consensus.plates[i].verdict == (i == small ? HangVerdict::off : HangVerdict::fits));
  }
  REQUIRE(consensus.plates[small].scale);
  CHECK(consensus.plates[small].scale->cause == FrameScale::Cause::size);
  CHECK(consensus.plates[small].scale->share == doctest::Approx(0.95).epsilon(0.001));
}

TEST_CASE("a second copy of a plate is suspected where it hangs, and none is accused surely") {
  const CorridorHungByEye site;
  AdjustmentProblem problem = drive(site);
  std::mt19937_64 random(16);
  CorridorHungByEye copied = site;
  copied.hung[site.index("001R")] = site.hung[site.index("002R")];
  problem.stations[1] = seen_from(copied, 0.3, {"001L", "001R", "002L"}, random);
  problem.stations[2] = seen_from(site, 1.1, {"002L", "003L", "003R"}, random);
  const Consensus consensus = find_consensus(problem);
  for (const PlateCheck& check : consensus.plates) CHECK(check.verdict != HangVerdict::off);
  REQUIRE(consensus.left_out.size() == 1);
  CHECK(consensus.left_out[0].name == problem.stations[1].name);
  const auto& suspects = consensus.left_out[0].suspects;
  REQUIRE(suspects.size() == 3);
  CHECK_FALSE(suspects[0].world_from_plate);
  REQUIRE(suspects[1].plate == site.index("001R"));
  REQUIRE(suspects[1].world_from_plate);
  const Vector3d there = site.hung[site.index("002R")].translation;
  CHECK((suspects[1].world_from_plate->translation - there).norm() < 0.02);
}

TEST_CASE("a plate is not surely off when pictures that were not taken together explain it") {
  const CorridorHungByEye site;
  std::mt19937_64 random(17);
  AdjustmentProblem problem = problem_of(site);
  Station mixed = seen_from(site, 0.3, {"001L", "002L"}, random);
  const Station later = seen_from(site, 0.8, {"002R"}, random);
  mixed.sightings.push_back(later.sightings[0]);
  problem.stations = {mixed};
  const PlateCheck check = find_consensus(problem).plates[site.index("002R")];
  CHECK(check.verdict == HangVerdict::doubtful);
  CHECK(check.doubt == HangDoubt::row);
}

TEST_CASE("three plates that another mounting of their camera explains are not accused") {
  const CorridorHungByEye site;
  AdjustmentProblem problem = drive(site);
  std::mt19937_64 random(18);
  problem.stations[2] = seen_from(site, 1.1, {"002L", "002R", "003R"}, random);
  Rig other = site.rig;
  other.cameras[0].vehicle_from_camera.translation += Vector3d(0.05, 0, 0);
  problem.rig = &other;
  const Consensus consensus = find_consensus(problem);
  CHECK(consensus.nothing_fits);
  for (const PlateCheck& check : consensus.plates) CHECK(check.verdict == HangVerdict::unchecked);
}

TEST_CASE("another rig, or a template of another size, accuses no plate surely") {
  const CorridorHungByEye site;
  const std::vector<std::pair<double, double>> worlds{{3, 1}, {0, 0.95}, {0, 1.05}};
  for (const auto& [turn_deg, focal] : worlds) {
    CAPTURE(turn_deg);
    CAPTURE(focal);
    AdjustmentProblem problem = drive(site);
    Rig other = site.rig;
    other.cameras[0].vehicle_from_camera.rotation *=
        Eigen::AngleAxisd(radians(turn_deg), Vector3d::UnitY()).toRotationMatrix();
    for (RigCamera& camera : other.cameras) {
      camera.camera.fx *= focal;
      camera.camera.fy *= focal;
    }
    problem.rig = &other;
    const Consensus consensus = find_consensus(problem);
    bool is_told = consensus.nothing_fits || !consensus.left_out.empty();
    for (const PlateCheck& check : consensus.plates) {
      CHECK(check.verdict != HangVerdict::off);
      is_told = is_told || check.verdict == HangVerdict::doubtful;
    }
    CHECK(is_told);
  }
}

TEST_CASE("when nothing fits, the rig or the survey is wrong and no plate is accused") {
  CorridorHungByEye site;
  for (const char* name : {"000L", "001L", "002L", "003L", "000R", "002R"}) {
    site.move(name, {0.05 * (name[2] - '0') - 0.1, 0.07, 0.03 * (name[2] - '0')});
  }
  const Consensus consensus = find_consensus(drive(site));
  CHECK(consensus.nothing_fits);
  for (const PlateCheck& check : consensus.plates) CHECK(check.verdict == HangVerdict::unchecked);
}

TEST_CASE("a camera that is mounted or centred a little otherwise is told as the rig's fault") {
  const CorridorHungByEye site;
  const auto with_camera = [&](const Vector3d& moved, double centre_px) {
    Rig rig = site.rig;
    rig.cameras[0].vehicle_from_camera.translation += moved;
    rig.cameras[0].camera.cx += centre_px;
    return rig;
  };
  for (const Rig& other : {with_camera({0.02, 0, 0}, 0), with_camera({0, 0.02, 0}, 0),
                           with_camera({0, 0, -0.02}, 0), with_camera({0, 0, 0}, 10)}) {
    AdjustmentProblem problem = drive(site);
    problem.rig = &other;
    CHECK(find_consensus(problem).nothing_fits);
  }
  // Where few plates are seen, one looks moved.
  std::mt19937_64 random(3);
  AdjustmentProblem few = problem_of(site);
  few.stations = {seen_from(site, 0.3, {"001L", "002L", "001R", "002R"}, random)};
  for (const Rig& other :
       {with_camera({0.02, 0, 0}, 0), with_camera({0, 0.02, 0}, 0), with_camera({0, 0, 0}, 10)}) {
    few.rig = &other;
    const Consensus consensus = find_consensus(few);
    int doubted = 0;
    for (const PlateCheck& check : consensus.plates) {
      CHECK(check.verdict != HangVerdict::off);
      if (check.verdict != HangVerdict::doubtful) continue;
      CHECK(check.doubt == HangDoubt::rig);
      ++doubted;
    }
    CHECK(doubted > 0);
  }
}

TEST_CASE(
    "a row of which one camera's pictures were taken 6 cm later is left out, all plates fit") {
  const CorridorHungByEye site;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    AdjustmentProblem problem = drive(site);
    Station& row = problem.stations[0];
    const Station later = seen_from(site, -0.44, {"000L", "001L"}, random);
    for (Sighting& seen : row.sightings) {
      for (const Sighting& again : later.sightings) {
        if (seen.plate == again.plate) seen = again;
      }
    }
    const Consensus consensus = find_consensus(problem);
    REQUIRE(consensus.left_out.size() == 1);
    CHECK(consensus.left_out[0].name == row.name);
    CHECK(consensus.left_out[0].fits_apart);
    for (std::size_t i = 0; i < 8; ++i) CHECK(consensus.plates[i].verdict == HangVerdict::fits);
  }
}

TEST_CASE("where three of four plates contradict the survey none is accused") {
  CorridorHungByEye site;
  site.move("001R", {0.05, 0.02, 0});
  site.move("002L", {-0.03, 0.06, 0});
  site.move("002R", {0.04, -0.05, 0.02});
  std::mt19937_64 random(4);
  AdjustmentProblem problem = problem_of(site);
  problem.stations = {seen_from(site, 0.3, {"001L", "001R", "002L", "002R"}, random)};
  const Consensus consensus = find_consensus(problem);
  CHECK(consensus.nothing_fits);
  for (const PlateCheck& check : consensus.plates) CHECK(check.verdict == HangVerdict::unchecked);
}

TEST_CASE("a plate of another size that is seen from two places is told to hang in its place") {
  const CorridorHungByEye site;
  AdjustmentProblem problem = drive(site);
  const std::size_t small = site.index("002R");
  print_small(site, small, problem, 0.95);
  const PlateCheck check = find_consensus(problem).plates[small];
  CHECK(check.verdict == HangVerdict::off);
  REQUIRE(check.offset);
  CHECK(farthest_corner(problem.plates[small], *check.offset) < 0.005);
}

TEST_CASE("a plate in the place of another makes no copy of the plate that it is seen with") {
  const CorridorHungByEye site;
  std::mt19937_64 random(19);
  AdjustmentProblem problem = drive(site);
  problem.stations.push_back(seen_from(site, -0.6, {"001L", "001R"}, random));
  const std::size_t stray = site.index("006L");
  for (Station& station : problem.stations) {
    for (Sighting& sighting : station.sightings) {
      if (sighting.plate == site.index("001L")) sighting.plate = stray;
    }
  }
  problem.unseen = {problem.plates[site.index("001L")], problem.plates[site.index("006R")]};
  const Consensus consensus = find_consensus(problem);
  CHECK_FALSE(consensus.nothing_fits);
  CHECK(consensus.copies.empty());
  CHECK(consensus.left_out.empty());
  CHECK(consensus.plates[stray].verdict == HangVerdict::off);
}

}  // namespace tagsmith::detail
