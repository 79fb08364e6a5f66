// SPDX-License-Identifier: Apache-2.0
#include "decoder/paper/closed_form.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/survey.hpp"

using namespace tagsmith::detail;

namespace {

// Its x grows to the left of the drive.
constexpr Grid kTable4Grid{true};

struct Table4Row {
  int point = 0;
  Eigen::Vector3d p1, p2, result;  // in the grid
  double d = 0, distance1 = 0, distance2 = 0, d_implied = 0;
};

std::vector<Table4Row> read_table4() {
  std::ifstream file("tests/paper/table4.csv");
  std::string line;
  std::getline(file, line);
  std::vector<Table4Row> rows;
  while (std::getline(file, line)) {
    std::vector<double> f;
    for (const std::string& field : split(line, ',')) f.push_back(parse_number(field).value());
    rows.push_back({static_cast<int>(f.at(0)),
                    {f[1], f[2], f[3]},
                    {f[4], f[5], f[6]},
                    {f[8], f[9], f[10]},
                    f[7],
                    f[16],
                    f[17],
                    f.at(18)});
  }
  return rows;
}

Eigen::Vector3d table4_position(const Table4Row& row, double d) {
  ClosedFormInput input;
  input.p1_in_world = world_from_grid(kTable4Grid, row.p1);
  input.p2_in_world = world_from_grid(kTable4Grid, row.p2);
  input.pair_angle = radians(10.2);
  input.tunnel_width = 1.9;
  input.wall_distance = d;
  input.distance1 = row.distance1;
  input.distance2 = row.distance2;
  const auto position = paper_position(input);
  REQUIRE(position.has_value());
  return grid_from_world(kTable4Grid, *position);
}

// A pair of tags on parallel walls and a vehicle, with everything measured exactly.
struct Scene {
  ClosedFormInput input;
  Eigen::Vector3d vehicle = Eigen::Vector3d::Zero();
};

Scene random_scene(std::mt19937& random) {
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  Scene scene;
  ClosedFormInput& input = scene.input;
  input.heading = between(-3, 3);
  input.tunnel_width = between(1.5, 6);
  const Eigen::Vector3d along = direction_of(input.heading);
  const Eigen::Vector3d right = right_of(input.heading);
  // Of either sign: the right tag may hang ahead of the left one or behind it (Table 4, row 3).
  const double stagger = between(0.2, 1.0) * (between(-1, 1) < 0 ? -1 : 1);
  input.p1_in_world = {between(-50, 50), between(-50, 50), between(-5, 5)};
  input.p2_in_world = input.p1_in_world + input.tunnel_width * right + stagger * along;
  input.pair_angle = std::atan(std::abs(stagger) / input.tunnel_width);
  input.tags_are_above = between(-1, 1) < 0;
  input.wall_distance = between(0.3, input.tunnel_width - 0.3);
  // Behind the line P1P2, which is what "further back" decides on.
  const double abreast = stagger * input.wall_distance / input.tunnel_width;
  scene.vehicle =
      input.p1_in_world + input.wall_distance * right + (abreast - between(0.2, 4)) * along;
  scene.vehicle.z() += (input.tags_are_above ? -1 : 1) * between(0.05, 1.0);
  input.distance1 = (scene.vehicle - input.p1_in_world).norm();
  input.distance2 = (scene.vehicle - input.p2_in_world).norm();
  return scene;
}

}  // namespace

TEST_CASE("Table 4 comes out within 1 mm with the d that its own results imply") {
  const std::vector<Table4Row> rows = read_table4();
  REQUIRE(rows.size() == 10);
  for (const Table4Row& row : rows) {
    CAPTURE(row.point);
    const Eigen::Vector3d error = table4_position(row, row.d_implied) - row.result;
    CHECK(error.cwiseAbs().maxCoeff() < 1e-3);
  }
}

TEST_CASE("Table 4 comes out with the printed d to what its rounding and two odd rows leave") {
  Eigen::Vector3d worst = Eigen::Vector3d::Zero();  // of the eight consistent rows
  std::array<double, 2> odd_y{};                    // of rows 2 and 9
  for (const Table4Row& row : read_table4()) {
    const Eigen::Vector3d error = (table4_position(row, row.d) - row.result).cwiseAbs();
    if (row.point == 2) odd_y[0] = error.y();
    if (row.point == 9) odd_y[1] = error.y();
    if (row.point != 2 && row.point != 9) worst = worst.cwiseMax(error);
  }
  CHECK(std::abs(worst.x() - 0.0029) < 0.0001);
  CHECK(std::abs(worst.y() - 0.0138) < 0.0001);
  CHECK(std::abs(worst.z() - 0.0320) < 0.0001);
  CHECK(std::abs(odd_y[0] - 0.060) < 0.001);
  CHECK(std::abs(odd_y[1] - 0.039) < 0.001);
}

TEST_CASE("Table 4's errors are those of its results against its true positions") {
  double plane = 0;
  double height = 0;
  std::ifstream file("tests/paper/table4.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double> f;
    for (const std::string& field : split(line, ',')) f.push_back(parse_number(field).value());
    plane += std::hypot(f[8] - f[11], f[9] - f[12]) / 10;
    height += std::abs(f[10] - f[13]) / 10;
  }
  CHECK(plane == doctest::Approx(0.142).epsilon(0.005));   // (27)
  CHECK(height == doctest::Approx(0.083).epsilon(0.005));  // (25)
}

TEST_CASE("exact measurements give back the vehicle's position, whatever the drive's direction") {
  constexpr unsigned kSeed = 171012;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 2000; ++i) {
    CAPTURE(i);
    const Scene scene = random_scene(random);
    const auto position = paper_position(scene.input);
    REQUIRE(position.has_value());
    CHECK((*position - scene.vehicle).norm() < 1e-9);
  }
}

TEST_CASE("a mirrored grid gives the mirrored position") {
  constexpr unsigned kSeed = 7;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 200; ++i) {
    CAPTURE(i);
    // The same tunnel written in a grid whose x grows to the left, then brought into the world.
    const Scene scene = random_scene(random);
    const Grid grid{true};
    ClosedFormInput input = scene.input;
    const Eigen::Vector3d p1_in_grid = grid_from_world(grid, input.p1_in_world);
    const Eigen::Vector3d p2_in_grid = grid_from_world(grid, input.p2_in_world);
    const double heading_in_grid = grid_heading_from_world(grid, input.heading);
    input.p1_in_world = world_from_grid(grid, p1_in_grid);
    input.p2_in_world = world_from_grid(grid, p2_in_grid);
    input.heading = world_heading_from_grid(grid, heading_in_grid);
    const auto position = paper_position(input);
    REQUIRE(position.has_value());
    const Eigen::Vector3d mirrored(-scene.vehicle.x(), scene.vehicle.y(), scene.vehicle.z());
    CHECK((grid_from_world(grid, *position) - mirrored).norm() < 1e-9);
  }
}

TEST_CASE("1 cm of d moves the corridor's position 5.6 cm along the tunnel") {
  const Table4Row row = read_table4().at(3);
  const double step = 1e-6;
  const double moved = table4_position(row, row.d_implied + step).y() -
                       table4_position(row, row.d_implied - step).y();
  CHECK(std::abs(moved / (2 * step)) == doctest::Approx(1 / std::tan(radians(10.2))).epsilon(0.05));
}

TEST_CASE("what has no solution says which step has none") {
  std::mt19937 random(3);
  const ClosedFormInput good = random_scene(random).input;
  REQUIRE(paper_position(good).has_value());
  const auto reason = [](const ClosedFormInput& input) {
    const auto position = paper_position(input);
    REQUIRE_FALSE(position.has_value());
    CHECK_FALSE(position.error().message.empty());
    return position.error().reason;
  };
  ClosedFormInput input = good;
  input.wall_distance = std::numeric_limits<double>::quiet_NaN();
  CHECK(reason(input) == NoSolution::not_finite);
  input = good;
  input.distance1 = std::numeric_limits<double>::infinity();
  CHECK(reason(input) == NoSolution::not_finite);
  input = good;
  input.distance2 = 0;
  CHECK(reason(input) == NoSolution::not_finite);
  input = good;
  input.pair_angle = 0;
  CHECK(reason(input) == NoSolution::pair_angle_degenerate);
  input = good;
  input.pair_angle = radians(90);
  CHECK(reason(input) == NoSolution::pair_angle_degenerate);
  input = good;
  input.pair_angle = radians(-10);
  CHECK(reason(input) == NoSolution::pair_angle_degenerate);
  input = good;
  input.distance1 = 0.1;
  input.distance2 = 50;
  CHECK(reason(input) == NoSolution::spheres_do_not_meet);
  input = good;
  input.p2_in_world = input.p1_in_world;
  CHECK(reason(input) == NoSolution::circles_do_not_meet);
  input = good;
  input.p2_in_world = input.p1_in_world + 10 * (good.p2_in_world - good.p1_in_world);
  CHECK(reason(input) == NoSolution::circles_do_not_meet);
}

TEST_CASE("two tags in one place, from which all is symmetric, leave no position either") {
  ClosedFormInput input;
  input.tunnel_width = 2;
  input.pair_angle = radians(10);
  input.wall_distance = 1;
  input.distance1 = input.distance2 = 1.2;
  input.p1_in_world = input.p2_in_world = {3, 4, 0.5};
  const auto position = paper_position(input);
  REQUIRE_FALSE(position.has_value());
  CHECK(position.error().reason == NoSolution::circles_do_not_meet);
}

TEST_CASE("a centimetre of d often leaves no real solution, and then there is no position") {
  ClosedFormInput input;  // the corridor: O 0.16 m below the tags, 0.5 m behind the left one
  input.p1_in_world = {-1.9, 0, 0.4};
  input.p2_in_world = {0, 0.343, 0.4};
  input.pair_angle = std::atan(0.343 / 1.9);
  input.tunnel_width = 1.9;
  const Eigen::Vector3d vehicle(-1.0, -0.5, 0.24);
  input.distance1 = (vehicle - input.p1_in_world).norm();
  input.distance2 = (vehicle - input.p2_in_world).norm();
  input.wall_distance = 0.9;
  REQUIRE(paper_position(input).has_value());
  input.wall_distance = 0.91;
  const auto longer = paper_position(input);
  input.wall_distance = 0.89;
  const auto shorter = paper_position(input);
  const bool longer_fails = !longer && longer.error().reason == NoSolution::no_real_height;
  const bool shorter_fails = !shorter && shorter.error().reason == NoSolution::no_real_height;
  CHECK(longer_fails != shorter_fails);
}

TEST_CASE("distance (10) is exact for a level camera and a vertical edge") {
  constexpr unsigned kSeed = 11;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> sideways(-1, 1);
  std::uniform_real_distribution<double> depth(0.5, 5);
  const double focal_px = 1600;
  const PixelPoint centre{639.5, 479.5};
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d p(sideways(random), sideways(random) / 2, depth(random));
    const Eigen::Vector3d q = p + Eigen::Vector3d(0, 0.168, 0);
    const auto pixel = [&](const Eigen::Vector3d& point) {
      return PixelPoint{centre.x + focal_px * point.x() / point.z(),
                        centre.y + focal_px * point.y() / point.z()};
    };
    CHECK(paper_distance(pixel(p), pixel(q), centre, focal_px, 0.168) ==
          doctest::Approx(p.norm()).epsilon(1e-12));
    CHECK(paper_tag_is_above(pixel(p), centre) == (p.y() < 0));
  }
  CHECK(std::isinf(paper_distance({1, 1}, {1, 1}, centre, focal_px, 0.168)));
}
