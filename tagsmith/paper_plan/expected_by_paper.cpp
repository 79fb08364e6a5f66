// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/paper_plan/expected_by_paper.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "tagsmith/geometry/pair_circle.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The method refuses tags whose heights differ by more, metres (as localize_by_paper).
constexpr double kMostHeightDifference = 0.05;

// Equally likely values of a normal variable, spread to its variance of 1.
constexpr std::array<double, 13> kNormalValues{-1.8576, -1.2586, -0.9131, -0.6460, -0.4156,
                                               -0.2037, 0,       0.2037,  0.4156,  0.6460,
                                               0.9131,  1.2586,  1.8576};

// A sight with its distance D from O to P; the method takes the camera to be at O.
struct RangedSight {
  const PlateSight* sight = nullptr;
  const PlacedTag* tag = nullptr;
  double distance = 0;
};

struct Pair {
  RangedSight left;
  RangedSight right;
};

// Smaller is better, as localize_by_paper ranks.
auto rank_of(const Pair& pair) {
  const PlacedTag& left = *pair.left.tag;
  const PlacedTag& right = *pair.right.tag;
  const bool is_one_pair = left.pair == right.pair;
  const long apart_mm =
      is_one_pair ? 0 : std::lround(1000 * std::abs(left.chainage - right.chainage));
  return std::tuple(!is_one_pair, apart_mm, pair.left.distance + pair.right.distance);
}

bool is_turned(const Survey& survey, const PlateSight& sight) {
  return is_turned_from_wall(survey.tunnel, survey.tag_template, survey.tags[sight.tag]);
}

std::optional<Pair> choose_pair(const Survey& survey, const Vector3d& position,
                                std::span<const PlateSight> sights) {
  const auto ranged = [&](const PlateSight& sight) {
    const PlacedTag& tag = survey.tags[sight.tag];
    return RangedSight{&sight, &tag, (tag.world_from_plate.translation - position).norm()};
  };
  std::optional<Pair> best;
  for (const PlateSight& left : sights) {
    if (survey.tags[left.tag].side != Side::left || is_turned(survey, left)) continue;
    for (const PlateSight& right : sights) {
      if (survey.tags[right.tag].side != Side::right || left.camera == right.camera) continue;
      if (is_turned(survey, right)) continue;
      const Pair pair{ranged(left), ranged(right)};
      if (!best || rank_of(pair) < rank_of(*best)) best = pair;
    }
  }
  return best;
}

const RigRange* left_range(const Rig& rig, double distance) {
  const RigRange* best = nullptr;
  for (const RigRange& range : rig.ranges) {
    const bool usable = range.wall == Side::left && distance >= range.min && distance <= range.max;
    if (usable && (best == nullptr || range.sigma < best->sigma)) best = &range;
  }
  return best;
}

// D by (10) and its standard deviation. As published the camera is taken to be level and at O.
struct MeasuredDistance {
  double value = 0;
  double sigma = 0;
  bool tag_is_above = false;  // P' above the image's centre
};

std::optional<MeasuredDistance> measured_distance(const Survey& survey, const Rig& rig,
                                                  const Pose& world_from_vehicle,
                                                  const RangedSight& ranged,
                                                  const AccuracyOptions& options) {
  const RigCamera& camera = rig.cameras[ranged.sight->camera];
  const Pose camera_from_plate =
      inverse(world_from_vehicle * camera.vehicle_from_camera) * ranged.tag->world_from_plate;
  const double edge = survey.tag_template.frame_inner_height;
  const Vector3d p_in_camera = camera_from_plate.translation;
  const Vector3d q_in_camera = camera_from_plate * Vector3d(0, edge, 0);
  if (p_in_camera.z() <= 0 || q_in_camera.z() <= 0) return std::nullopt;
  const Vector2d p = p_in_camera.head<2>() / p_in_camera.z();
  const Vector2d q = q_in_camera.head<2>() / q_in_camera.z();
  MeasuredDistance measured;
  measured.value = edge * std::hypot(p.norm(), 1.0) / (q - p).norm();
  const double corners_px = camera.camera.fy * (q - p).norm();
  const double corner_sigma = expected_corner_sigma(rig, *ranged.sight, options);
  measured.sigma =
      std::hypot(measured.value * std::sqrt(2.0) * corner_sigma / corners_px, ranged.tag->sigma);
  measured.tag_is_above = p.y() < 0;
  return measured;
}

// A pair of tags as the method sees it.
struct PairGeometry {
  Vector3d p1;
  Vector3d p2;
  Vector2d towards_p2;  // unit vectors, seen from above
  Vector2d rear;
  double spacing = 0;  // of P1 and P2, seen from above
  double pair_angle = 0;
  double width = 0;
  bool tags_are_above = false;
};

PairGeometry geometry_of(const Survey& survey, const Pair& pair, bool tags_are_above) {
  PairGeometry geometry;
  geometry.p1 = pair.left.tag->world_from_plate.translation;
  geometry.p2 = pair.right.tag->world_from_plate.translation;
  geometry.tags_are_above = tags_are_above;
  geometry.width = pair_width(survey.tunnel, *pair.left.tag, *pair.right.tag);
  const Vector3d along = direction_of(heading_between(*pair.left.tag, *pair.right.tag));
  const Vector2d between = (geometry.p2 - geometry.p1).head<2>();
  geometry.spacing = between.norm();
  geometry.towards_p2 = between / geometry.spacing;
  geometry.rear = Vector2d(-geometry.towards_p2.y(), geometry.towards_p2.x());
  if (geometry.rear.dot(along.head<2>()) > 0) geometry.rear = -geometry.rear;
  geometry.pair_angle = pair_angle_for(survey, *pair.left.tag, *pair.right.tag);
  return geometry;
}

// (18)-(23); nothing without a real solution.
std::optional<Vector3d> position_from(const PairGeometry& pair, const PairDistances& distances) {
  const PairCircle circle = pair_circle(distances, pair.width, pair.pair_angle);
  const double height_sq = circle.height_difference_sq();
  if (height_sq < 0) return std::nullopt;
  const double radii = (circle.p1_e - circle.p2_e) * (circle.p1_e + circle.p2_e);
  const double foot = (radii + pair.spacing * pair.spacing) / (2 * pair.spacing);
  const double across_sq = circle.er * circle.er + circle.p1_e * circle.p1_e - foot * foot;
  if (across_sq < 0) return std::nullopt;
  Vector3d position;
  position.head<2>() =
      pair.p1.head<2>() + foot * pair.towards_p2 + std::sqrt(across_sq) * pair.rear;
  const double height = std::sqrt(height_sq);
  position.z() = (pair.p1.z() + pair.p2.z()) / 2 + (pair.tags_are_above ? -height : height);
  return position;
}

// Errors about the true place over the set of draws. Each of D1 and D2 is off by sqrt(2) sigma in a
// quarter of the draws each way, which has their variances.
// Why: docs/decisions/0011-smoothing-and-paper-method.md.
void vary(const PairGeometry& pair, const PairDistances& distances, const Vector3d& sigmas,
          const Vector3d& truth, double floor, PaperExpectation& expectation) {
  const double root2 = std::sqrt(2.0);
  int draws = 0;
  int solved = 0;
  expectation.mean_square.setZero();
  for (const Vector2d& d12 :
       {Vector2d(root2, 0), Vector2d(-root2, 0), Vector2d(0, root2), Vector2d(0, -root2)}) {
    for (const double d : kNormalValues) {
      ++draws;
      const auto position = position_from(pair, {distances.distance1 + d12.x() * sigmas[0],
                                                 distances.distance2 + d12.y() * sigmas[1],
                                                 distances.wall_distance + d * sigmas[2]});
      if (!position || position->z() < floor) continue;
      ++solved;
      const Vector3d error = *position - truth;
      expectation.mean_square += error * error.transpose();
    }
  }
  expectation.no_solution_share = 1 - static_cast<double>(solved) / draws;
  if (solved > 0) {
    expectation.mean_square /= solved;
  } else {
    expectation.mean_square.setConstant(std::numeric_limits<double>::infinity());
  }
}

}  // namespace

std::optional<PaperExpectation> expect_by_paper(const Survey& survey, const Rig& rig,
                                                const VehiclePose& pose,
                                                std::span<const PlateSight> sights,
                                                const AccuracyOptions& options) {
  const std::optional<Pair> pair = choose_pair(survey, pose.position, sights);
  if (!pair) return std::nullopt;
  const double wall =
      observe_wall(survey.tunnel.centerline, survey.tunnel.left, pose.position).distance;
  const RigRange* range = left_range(rig, wall);
  if (range == nullptr) return std::nullopt;
  const Pose from_vehicle = world_from_vehicle(pose);
  const auto d1 = measured_distance(survey, rig, from_vehicle, pair->left, options);
  const auto d2 = measured_distance(survey, rig, from_vehicle, pair->right, options);
  if (!d1 || !d2) return std::nullopt;
  const PairGeometry geometry = geometry_of(survey, *pair, d1->tag_is_above);
  constexpr double kLeastTangent = 1e-6;
  if (std::tan(geometry.pair_angle) < kLeastTangent) return std::nullopt;
  PaperExpectation expectation;
  expectation.magnification = 1 / std::tan(geometry.pair_angle);
  expectation.mean_square.setConstant(std::numeric_limits<double>::infinity());
  if (std::abs(geometry.p1.z() - geometry.p2.z()) > kMostHeightDifference) return expectation;
  vary(geometry, {d1->value, d2->value, wall}, {d1->sigma, d2->sigma, range->sigma}, pose.position,
       pose.position.z() - rig.vehicle_height, expectation);
  return expectation;
}

}  // namespace tagsmith::detail
