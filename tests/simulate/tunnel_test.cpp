// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/placement/tunnel_surfaces.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Straight, a bend to the right, a bend to the left, straight.
Survey winding() {
  Survey survey;
  survey.tunnel.left = -1.5;
  survey.tunnel.right = 1.5;
  survey.tunnel.height = 2.8;
  survey.tunnel.centerline =
      Centerline({5, -2, 1}, 0.4, {{4, 0, 0}, {6, 1 / 5.0, 0}, {7, -1 / 6.0, 0}, {5, 0, 0}});
  survey.tag_template.plate_length = 0.8;
  survey.tag_template.plate_height = 0.43;
  survey.tag_template.frame_inner_length = 0.665;
  survey.tag_template.frame_inner_height = 0.325;
  survey.tag_template.frame_stroke = 0.02;
  for (int pair = 0; pair < 9; ++pair) {
    const CenterlinePoint foot = survey.tunnel.centerline.at(1.5 + 2.2 * pair);
    for (const Side side : {Side::left, Side::right}) {
      const double to_right = side == Side::left ? -1 : 1;
      PlacedTag tag;
      tag.name = std::to_string(pair) + to_string(side);
      tag.side = side;
      tag.pair = pair;
      tag.chainage = 1.5 + 2.2 * pair;
      tag.digits = *parse_digits("012345678905");
      const Vector3d p = foot.position + to_right * 1.5 * right_of(foot.heading) +
                         to_right * 0.665 / 2 * direction_of(foot.heading) + Vector3d(0, 0, 1);
      tag.world_from_plate = plate_on_wall(survey.tunnel, survey.tag_template, side, p);
      survey.tags.push_back(tag);
    }
  }
  return survey;
}

// The way to the wall in small steps, by the center line's own addresses.
double marched_way(const Survey& survey, double half_width, const Vector2d& origin,
                   const Vector2d& direction) {
  constexpr double kStep = 0.002;
  for (double way = 0; way < 40; way += kStep) {
    const Vector2d point = origin + way * direction;
    if (std::abs(survey.tunnel.centerline.locate(point).offset) >= half_width) return way;
  }
  return 40;
}

TEST_CASE("Rays meet the walls where marching along them does") {
  const Survey survey = winding();
  const TunnelWalls walls(survey.tunnel, 0.02, 8);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> chainage(0.5, 21);
  std::uniform_real_distribution<double> offset(-1.3, 1.3);
  std::uniform_real_distribution<double> turn(-3.1, 3.1);
  for (int i = 0; i < 300; ++i) {
    const CenterlinePoint foot = survey.tunnel.centerline.at(chainage(random));
    const Vector2d origin = (foot.position + offset(random) * right_of(foot.heading)).head<2>();
    const Vector2d direction = direction_of(turn(random)).head<2>();
    const double expected = marched_way(survey, 1.52, origin, direction);
    if (expected >= 40) continue;
    const auto hit = walls.first_hit(origin, direction);
    CAPTURE(i);
    REQUIRE(hit);
    // A step of way is more across the wall than along it.
    CHECK(std::abs(hit->way - expected) < 0.0021 / std::max(hit->cosine, 0.02));
    const Vector2d point = origin + hit->way * direction;
    const CenterlineAddress address = survey.tunnel.centerline.locate(point);
    CHECK(address.chainage == doctest::Approx(hit->chainage).epsilon(1e-4));
    CHECK((address.offset < 0) == (hit->side == Side::left));
  }
}

TEST_CASE("Rays meet walls that change, and their steps, where marching along them does") {
  Survey survey = winding();
  survey.tunnel.left = ChainageProfile({{0, -1.5}, {5, -1.2}, {9, -1.9}, {14, -1.9}, {20, -1.4}});
  survey.tunnel.right = ChainageProfile({{6, 1.3}, {6, 2.4}, {12, 2.2}, {12, 1.4}});
  survey.tunnel.stand_off = 0.05;
  const TunnelWalls walls(survey.tunnel, 0.02, 8);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> chainage(0.5, 21);
  std::uniform_real_distribution<double> offset(-1.1, 1.1);
  std::uniform_real_distribution<double> turn(-3.1, 3.1);
  const auto in_rock = [&](const Vector2d& point) {
    const CenterlineAddress address = survey.tunnel.centerline.locate(point);
    return behind_wall(survey.tunnel, Side::left, address) >= 0.05 ||
           behind_wall(survey.tunnel, Side::right, address) >= 0.05;
  };
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const CenterlinePoint foot = survey.tunnel.centerline.at(chainage(random));
    const Vector2d origin = (foot.position + offset(random) * right_of(foot.heading)).head<2>();
    const Vector2d direction = direction_of(turn(random)).head<2>();
    double expected = 0;
    while (expected < 40 && !in_rock(origin + expected * direction)) expected += 0.002;
    if (expected >= 40) continue;
    ++compared;
    CAPTURE(i);
    const auto hit = walls.first_hit(origin, direction);
    REQUIRE(hit);
    // Straight pieces miss the bends by 2 mm.
    CHECK(std::abs(hit->way - expected) < 0.0045 / std::max(hit->cosine, 0.03));
    const Vector2d point = origin + hit->way * direction;
    CHECK(std::abs(survey.tunnel.centerline.locate(point).chainage - hit->chainage) < 0.01);
  }
  CHECK(compared > 200);
}

TEST_CASE("The walls stand clear of flat plates on both sides of a bend") {
  const Survey survey = winding();
  // The plate's ends at an outer radius of 7.5 m lie 0.4^2 / 15 m further out.
  CHECK(wall_standoff(survey, 8) == doctest::Approx(0.010 + 0.16 / (2 * 6.5)).epsilon(0.2));
}

RigCamera forward_camera() {
  RigCamera camera;
  camera.name = "front";
  camera.camera = camera_from_sensor(320, 240, 0.003, 0.0048, 0.0036);
  camera.vehicle_from_camera = vehicle_from_camera(0, 0, 0, Vector3d::Zero());
  return camera;
}

std::map<std::string, double> fractions_seen(const Survey& survey, double chainage) {
  const CenterlinePoint foot = survey.tunnel.centerline.at(chainage);
  const Pose pose = world_from_vehicle(foot.position + Vector3d(0, 0, 1), foot.heading);
  const SurveyView seen = render_survey_view(survey, forward_camera(), pose, ViewOptions{}, 1);
  std::map<std::string, double> fractions;
  for (std::size_t i = 0; i < seen.tags.size(); ++i) {
    fractions.emplace(survey.tags[seen.tags[i]].name, seen.view.plates[i].visible_fraction);
  }
  return fractions;
}

// Plates whose middle can be seen past the walls, by marching; independent of the renderer.
bool middle_in_sight(const Survey& survey, const PlacedTag& tag, const Vector2d& origin) {
  const Vector3d middle = tag.world_from_plate * Vector3d(0.665 / 2, 0.325 / 2, 0);
  const Vector2d towards = middle.head<2>() - origin;
  return marched_way(survey, 1.52, origin, towards.normalized()) >= towards.norm();
}

TEST_CASE("Bends hide the plates behind them and show the others") {
  const Survey survey = winding();
  int hidden = 0;
  for (double chainage = 1; chainage < 17; chainage += 0.8) {
    const CenterlinePoint foot = survey.tunnel.centerline.at(chainage);
    const Vector2d origin = foot.position.head<2>();
    const std::map<std::string, double> seen = fractions_seen(survey, chainage);
    CHECK(seen.size() >= 2);
    for (const PlacedTag& tag : survey.tags) {
      const Vector3d middle = tag.world_from_plate * Vector3d(0.665 / 2, 0.325 / 2, 0);
      const Vector3d from_camera = middle - foot.position;
      const double ahead = from_camera.dot(direction_of(foot.heading));
      const double across = from_camera.dot(right_of(foot.heading));
      if (ahead < 1 || std::abs(across) > 0.7 * ahead) continue;  // outside of the image
      if (tag.world_from_plate.rotation.col(2).dot(from_camera) <= 0) continue;
      CAPTURE(chainage);
      CAPTURE(tag.name);
      const bool visible = middle_in_sight(survey, tag, origin);
      const auto found = seen.find(tag.name);
      const double fraction = found == seen.end() ? 0.0 : found->second;
      if (visible) {
        CHECK(fraction > 0.3);
      } else {
        CHECK(fraction < 0.7);
        ++hidden;
      }
    }
  }
  CHECK(hidden >= 4);
}

TEST_CASE("The backdrop's depths are those of walls, floor and roof") {
  Survey survey;
  survey.tunnel.left = -1.0;
  survey.tunnel.right = 1.0;
  survey.tunnel.height = 3;
  survey.tunnel.centerline = Centerline({0, 0, 0}, 0, {{10, 0, 0}});
  const RigCamera camera = forward_camera();
  const Pose world_from_camera = world_from_vehicle({0.2, 1, 1.25}, 0) * camera.vehicle_from_camera;
  const Backdrop backdrop =
      tunnel_backdrop(survey.tunnel, 0.01, camera.camera, world_from_camera, {}, 1);
  const auto depth = [&](double x, double y) {
    const Vector2d pixel = *project(camera.camera, {x, y, 1});
    const auto column = static_cast<int>(std::lround(pixel.x()));
    const auto row = static_cast<int>(std::lround(pixel.y()));
    const Vector3d ray = *ray_through(camera.camera, {column, row});
    return std::pair{static_cast<double>(backdrop.depth.row(row)[column]), ray};
  };
  const auto [left, left_ray] = depth(-0.6, 0);
  CHECK(left == doctest::Approx(-1.21 / left_ray.x()));
  const auto [right, right_ray] = depth(0.6, 0);
  CHECK(right == doctest::Approx(0.81 / right_ray.x()));
  const auto [floor, floor_ray] = depth(0, 0.5);
  CHECK(floor == doctest::Approx(1.25 / floor_ray.y()));
  const auto [roof, roof_ray] = depth(0, -0.5);
  CHECK(roof == doctest::Approx(-1.75 / roof_ray.y()));
}

TEST_CASE("The floor is rougher where a pixel shows less of it") {
  Survey survey;
  survey.tunnel.left = -3.0;
  survey.tunnel.right = 3.0;
  survey.tunnel.height = 3;
  survey.tunnel.centerline = Centerline({0, 0, 0}, 0, {{60, 0, 0}});
  const RigCamera camera = forward_camera();
  const Pose world_from_camera = world_from_vehicle({0, 1, 1.25}, 0) * camera.vehicle_from_camera;
  const Backdrop backdrop =
      tunnel_backdrop(survey.tunnel, 0.01, camera.camera, world_from_camera, {}, 1);
  // Of neighbouring pixels' light, as a share of it, along the row that shows the floor so far
  // away.
  const auto roughness = [&](double away) {
    const Vector2d middle = *project(camera.camera, {0, 1.25, away});
    const float* row = backdrop.light.row(static_cast<int>(std::lround(middle.y())));
    double sum = 0, differences = 0;
    for (int x = camera.camera.width / 2 - 20; x < camera.camera.width / 2 + 20; ++x) {
      sum += static_cast<double>(row[x]);
      differences += std::abs(static_cast<double>(row[x + 1] - row[x]));
    }
    return differences / sum;
  };
  CHECK(roughness(2.5) > 0.02);
  CHECK(roughness(15) < 0.6 * roughness(2.5));
}

TEST_CASE("On a grade the floor is met where the center line puts it") {
  Survey survey;
  survey.tunnel.left = -2.0;
  survey.tunnel.right = 2.0;
  survey.tunnel.height = 3;
  survey.tunnel.centerline = Centerline({0, 0, 0}, 0, {{10, 0, 0}, {30, 0, 0.1}});
  const RigCamera camera = forward_camera();
  const Pose world_from_camera = world_from_vehicle({0, 5, 1.0}, 0) * camera.vehicle_from_camera;
  const Backdrop backdrop =
      tunnel_backdrop(survey.tunnel, 0.01, camera.camera, world_from_camera, {}, 1);
  // Level ahead the rising floor is met 10 m beyond the foot of the ramp.
  const int row = camera.camera.height / 2;
  const Vector3d ray = *ray_through(camera.camera, {159, static_cast<double>(row)});
  const double expected = (1.0 + 0.1 * 5) / (0.1 + ray.y());
  CHECK(static_cast<double>(backdrop.depth.row(row)[159]) ==
        doctest::Approx(expected).epsilon(1e-3));
}

TEST_CASE("Ranges are the least horizontal distance to the plates' surface") {
  const Survey survey = winding();
  RigRange range{"d", Side::left, 0.25, 5, 0.01};
  const CenterlinePoint foot = survey.tunnel.centerline.at(7);
  const Vector3d position = foot.position + 0.4 * right_of(foot.heading) + Vector3d(0, 0, 0.5);
  CHECK(distance_to_wall(survey, Side::left, position) == doctest::Approx(1.9));
  CHECK(distance_to_wall(survey, Side::right, position) == doctest::Approx(1.1));
  double sum = 0;
  double squares = 0;
  constexpr int kCount = 4000;
  for (std::uint64_t seed = 0; seed < kCount; ++seed) {
    const double error = *measured_range(survey, range, position, seed) - 1.9;
    sum += error;
    squares += error * error;
  }
  CHECK(std::abs(sum / kCount) < 0.001);
  CHECK(std::sqrt(squares / kCount) == doctest::Approx(0.01).epsilon(0.05));
  range.max = 1.5;
  CHECK_FALSE(measured_range(survey, range, position, 1));
}

TEST_CASE("Places outside of the tunnel are told from those inside") {
  const Survey survey = winding();
  const CenterlinePoint foot = survey.tunnel.centerline.at(7);
  const Vector3d up(0, 0, 1);
  CHECK(check_in_tunnel(survey.tunnel, foot.position + up));
  const auto left =
      check_in_tunnel(survey.tunnel, foot.position - 1.6 * right_of(foot.heading) + up);
  REQUIRE_FALSE(left);
  CHECK(left.error().message.find("1.6 m left of the center line") != std::string::npos);
  CHECK_FALSE(check_in_tunnel(survey.tunnel, foot.position - 0.1 * up));
  CHECK_FALSE(check_in_tunnel(survey.tunnel, foot.position + 2.9 * up));
}

}  // namespace
}  // namespace tagsmith::detail
