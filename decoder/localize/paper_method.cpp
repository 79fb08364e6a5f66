// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/paper_method.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/paper/closed_form.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {
namespace {

// The paper gives both tags one height. A difference this large comes from no survey's noise, and
// would enter z by half.
constexpr double kMaxHeightDifference = 0.05;

// A length and its standard deviation, metres.
struct Length {
  double value = 0;
  double sigma = 0;
};

// A seen tag with its distance D from the camera.
struct RangedTag {
  const SeenTag* seen = nullptr;
  Length distance;
  bool is_above = false;  // its P, of O
};

// The pixel where a square-pixel camera without distortion, with the principal point at (0, 0),
// would have seen it; nothing where the lens model has no ray.
std::optional<PixelPoint> ideal_pixel(const Camera& camera, const PixelPoint& pixel) {
  const std::optional<Eigen::Vector3d> ray = ray_through(camera, {pixel.x, pixel.y});
  if (!ray) return std::nullopt;
  return PixelPoint{camera.fy * ray->x(), camera.fy * ray->y()};
}

std::optional<double> distance_to(const Camera& camera, const PixelPoint& p, const PixelPoint& q,
                                  double edge) {
  const std::optional<PixelPoint> ideal_p = ideal_pixel(camera, p);
  const std::optional<PixelPoint> ideal_q = ideal_pixel(camera, q);
  if (!ideal_p || !ideal_q) return std::nullopt;
  return paper_distance(*ideal_p, *ideal_q, {0, 0}, camera.fy, edge);
}

std::optional<Length> distance_by_corners(const Camera& camera, const SeenCorners& seen,
                                          double edge) {
  const PixelPoint p = seen.corners[0];
  const PixelPoint q = seen.corners[3];
  const std::optional<double> distance = distance_to(camera, p, q, edge);
  if (!distance) return std::nullopt;
  const double step = seen.sigma_px;
  double variance = 0;
  for (const PixelPoint shift : {PixelPoint{step, 0}, PixelPoint{0, step}}) {
    const auto p_plus = distance_to(camera, p + shift, q, edge);
    const auto p_minus = distance_to(camera, p - shift, q, edge);
    const auto q_plus = distance_to(camera, p, q + shift, edge);
    const auto q_minus = distance_to(camera, p, q - shift, edge);
    if (!p_plus || !p_minus || !q_plus || !q_minus) return std::nullopt;
    const double by_p = *p_plus - *p_minus;
    const double by_q = *q_plus - *q_minus;
    variance += (by_p * by_p + by_q * by_q) / 4;
  }
  return Length{*distance, std::sqrt(variance)};
}

// D is inversely proportional to |P'Q'|, near the optical axis by f * PQ.
double outline_distance_sigma(const Camera& camera, double distance, double edge) {
  return distance * distance / (camera.fy * edge) * std::numbers::sqrt2 * kOutlineCornerSigmaPx;
}

bool survey_says_above(const Survey& survey, const PlacedTag& tag, const Rig& rig) {
  const double floor = survey.tunnel.centerline.at(tag.chainage).position.z();
  return tag.p_in_grid.z() >= floor + rig.vehicle_height;
}

// Nothing for a tag at the border of what the camera's lens model covers.
std::optional<RangedTag> ranged(const SeenTag& seen, const Survey& survey, const Rig& rig,
                                const RigCamera& rig_camera) {
  const Camera& camera = rig_camera.camera;
  const double edge = survey.tag_template.frame_inner_height;
  if (seen.seen_corners) {
    const auto p = ideal_pixel(camera, seen.seen_corners->corners[0]);
    const auto measured = distance_by_corners(camera, *seen.seen_corners, edge);
    if (!p || !measured) return std::nullopt;
    return RangedTag{&seen, *measured, paper_tag_is_above(*p, {0, 0})};
  }
  const double distance = seen.distance.value_or(0);
  return RangedTag{&seen,
                   {distance, outline_distance_sigma(camera, distance, edge)},
                   survey_says_above(survey, seen.tag, rig)};
}

std::vector<RangedTag> ranged_tags(const Observation& observation,
                                   const std::vector<Survey>& surveys, const Rig& rig, Side side) {
  std::vector<RangedTag> tags;
  for (const SeenTag& seen : observation.tags) {
    const RigCamera* camera = find_camera(rig, seen.camera);
    if (camera == nullptr || seen.tag.side != side) continue;
    const Survey& survey = surveys.at(seen.survey);
    if (is_turned_from_wall(survey.tunnel, survey.tag_template, seen.tag)) continue;
    if (auto tag = ranged(seen, survey, rig, *camera)) tags.push_back(*tag);
  }
  return tags;
}

struct TagPair {
  RangedTag left;
  RangedTag right;
};

bool can_be_paired(const RangedTag& left, const RangedTag& right) {
  return left.seen->survey == right.seen->survey && left.seen->camera != right.seen->camera;
}

// Smaller is better. Chainages count to the millimetre, so that rounding decides nothing.
auto rank_of(const TagPair& pair) {
  const PlacedTag& left = pair.left.seen->tag;
  const PlacedTag& right = pair.right.seen->tag;
  const bool is_one_pair = left.pair == right.pair;
  const long apart_mm =
      is_one_pair ? 0 : std::lround(1000 * std::abs(left.chainage - right.chainage));
  return std::tuple(!is_one_pair, apart_mm, pair.left.distance.value + pair.right.distance.value);
}

Result<TagPair> choose_pair(const std::vector<RangedTag>& lefts,
                            const std::vector<RangedTag>& rights) {
  if (lefts.empty() && rights.empty()) return fail("no tag was seen");
  if (lefts.empty()) return fail("no tag on the left wall was seen");
  if (rights.empty()) return fail("no tag on the right wall was seen");
  std::optional<TagPair> best;
  for (const RangedTag& left : lefts) {
    for (const RangedTag& right : rights) {
      const TagPair pair{left, right};
      if (can_be_paired(left, right) && (!best || rank_of(pair) < rank_of(*best))) best = pair;
    }
  }
  if (!best) return fail("the tags on the left and right walls were not seen by different cameras");
  return *best;
}

// The least of the ranges to the left wall (Xu et al.: of the three sensors), those out of their
// sensor's limits apart.
Result<Length> wall_distance(const Observation& observation, const Rig& rig) {
  std::optional<Length> least;
  std::string out_of_limits;
  for (const RigRange& range : rig.ranges) {
    const auto measured = observation.ranges.find(range.name);
    if (range.wall != Side::left || measured == observation.ranges.end()) continue;
    const double value = measured->second;
    if (!(value >= range.min && value <= range.max)) {
      out_of_limits += fmt::format("{} is {:.4g} m, expected {:.4g} to {:.4g} m", range.name, value,
                                   range.min, range.max);
      continue;
    }
    if (!least || value < least->value) least = Length{value, range.sigma};
  }
  if (least) return *least;
  if (!out_of_limits.empty()) return fail(std::move(out_of_limits));
  return fail("no range to the left wall was measured");
}

ClosedFormInput closed_form_input(const TagPair& pair, const Survey& survey, double d) {
  const PlacedTag& left = pair.left.seen->tag;
  const PlacedTag& right = pair.right.seen->tag;
  ClosedFormInput input;
  input.p1_in_world = world_from_grid(survey.grid, left.p_in_grid);
  input.p2_in_world = world_from_grid(survey.grid, right.p_in_grid);
  input.pair_angle = pair_angle_for(survey, left, right);
  input.tunnel_width = pair_width(survey.tunnel, left, right);
  input.wall_distance = d;
  input.distance1 = pair.left.distance.value;
  input.distance2 = pair.right.distance.value;
  input.heading = heading_between(left, right);
  input.tags_are_above = pair.left.is_above;
  return input;
}

// What the paper's assumptions exclude; empty when they hold.
std::string broken_assumption(const ClosedFormInput& input) {
  const double z1 = input.p1_in_world.z();
  const double z2 = input.p2_in_world.z();
  if (std::abs(z1 - z2) > kMaxHeightDifference) {
    return fmt::format("the tags hang at different heights, {:.3f} and {:.3f} m, expected one H_P",
                       z1, z2);
  }
  if (input.wall_distance >= input.tunnel_width) {
    return fmt::format("d is {:.4g} m, expected less than the {:.4g} m between the walls",
                       input.wall_distance, input.tunnel_width);
  }
  return {};
}

// What one uncertain quantity does to the input, `step` standard deviations of it.
using Disturbance = std::function<ClosedFormInput(double step)>;

// The input when a tag really hangs `shift` (world) from where the survey has it: the angle and the
// width between the tags follow.
ClosedFormInput with_tag_moved(ClosedFormInput input, bool left, const Eigen::Vector3d& shift) {
  const Eigen::Vector3d along = direction_of(input.heading);
  const double ahead = (input.p2_in_world - input.p1_in_world).dot(along) >= 0 ? 1 : -1;
  const Eigen::Vector3d opening = left ? Eigen::Vector3d(-shift) : shift;
  const double stagger =
      input.tunnel_width * std::tan(input.pair_angle) + ahead * opening.dot(along);
  input.tunnel_width += opening.dot(right_of(input.heading));
  input.pair_angle = std::atan2(stagger, input.tunnel_width);
  (left ? input.p1_in_world : input.p2_in_world) += shift;
  return input;
}

// By how much d is not the distance to the plane of the left plate where the wall bends, for a
// vehicle as far back as D1 and d allow (the height of the tag above O brings it a little nearer).
double wall_bend(const Survey& survey, const PlacedTag& left, const ClosedFormInput& input) {
  const double d = input.wall_distance;
  const double back = std::sqrt(std::max(input.distance1 * input.distance1 - d * d, 0.0));
  const CenterlinePoint abreast = survey.tunnel.centerline.at(left.chainage - back);
  const double wall = survey.tunnel.left.at(left.chainage - back);
  const Eigen::Vector3d o = abreast.position + (wall + d) * right_of(abreast.heading);
  const double to_plane = (input.p1_in_world - o).dot(left.world_from_plate.rotation.col(2));
  return std::abs(to_plane - d);
}

// By how much the position's distance from the left wall is not the d that it was computed with.
double wall_mismatch(const Survey& survey, const ClosedFormInput& input,
                     const Eigen::Vector3d& position_in_world) {
  const ObservedWall wall =
      observe_wall(survey.tunnel.centerline, survey.tunnel.left, position_in_world);
  return std::abs(wall.distance - input.wall_distance);
}

std::vector<Disturbance> disturbances_of(const ClosedFormInput& input, const TagPair& pair,
                                         double d_sigma, double mismatch) {
  const auto length_changed = [&input](double ClosedFormInput::*length, double sigma) {
    return [input, length, sigma](double step) {
      ClosedFormInput changed = input;
      changed.*length += step * sigma;
      return changed;
    };
  };
  std::vector<Disturbance> disturbances{
      length_changed(&ClosedFormInput::wall_distance, d_sigma),
      length_changed(&ClosedFormInput::wall_distance, mismatch),
      length_changed(&ClosedFormInput::distance1, pair.left.distance.sigma),
      length_changed(&ClosedFormInput::distance2, pair.right.distance.sigma)};
  for (const bool left : {true, false}) {
    const double sigma = (left ? pair.left : pair.right).seen->tag.sigma;
    for (const Eigen::Vector3d& axis :
         {direction_of(input.heading), right_of(input.heading), Eigen::Vector3d(0, 0, 1)}) {
      disturbances.push_back([input, left, shift = Eigen::Vector3d(sigma * axis)](double step) {
        return with_tag_moved(input, left, step * shift);
      });
    }
  }
  return disturbances;
}

struct Effect {
  Eigen::Vector3d per_sigma = Eigen::Vector3d::Zero();
  bool is_complete = true;  // a whole sigma each way has a solution
};

// By how much one standard deviation one way (`sign`) moves the position: the whole step, or the
// largest of its halves that has a solution, scaled up; z at most to the height of the tags, beyond
// which no solution lies.
std::optional<Effect> effect_one_way(const Disturbance& disturbed, double sign,
                                     const Eigen::Vector3d& position, double below_tags) {
  constexpr int kHalvings = 19;  // to two millionths of a sigma
  for (int halvings = 0; halvings <= kHalvings; ++halvings) {
    const double step = std::ldexp(1.0, -halvings);
    const auto moved = paper_position(disturbed(sign * step));
    if (!moved) continue;
    Effect effect{(*moved - position) / (sign * step), halvings == 0};
    double& z = effect.per_sigma.z();
    if (!effect.is_complete) z = std::clamp(z, -below_tags, below_tags);
    return effect;
  }
  return std::nullopt;
}

// The larger of both ways: towards the edge of having a solution the square root moves z farther
// than away from it, and beyond abreast of the tags the position turns back.
std::optional<Effect> effect_of(const Disturbance& disturbed, const Eigen::Vector3d& position,
                                double below_tags) {
  const auto plus = effect_one_way(disturbed, 1, position, below_tags);
  const auto minus = effect_one_way(disturbed, -1, position, below_tags);
  if (!plus && !minus) return std::nullopt;
  const bool is_complete = plus && minus && plus->is_complete && minus->is_complete;
  const bool minus_is_larger = minus && (!plus || minus->per_sigma.norm() > plus->per_sigma.norm());
  return Effect{(minus_is_larger ? minus : plus)->per_sigma, is_complete};
}

struct Uncertainty {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // world axes
  bool is_complete = true;
};

std::optional<Uncertainty> uncertainty_of(const Eigen::Vector3d& position, double below_tags,
                                          const std::vector<Disturbance>& disturbances) {
  Uncertainty uncertainty;
  for (const Disturbance& disturbance : disturbances) {
    const std::optional<Effect> effect = effect_of(disturbance, position, below_tags);
    if (!effect) return std::nullopt;
    uncertainty.covariance += effect->per_sigma * effect->per_sigma.transpose();
    uncertainty.is_complete = uncertainty.is_complete && effect->is_complete;
  }
  return uncertainty;
}

// A covariance in the grid's axes.
Eigen::Matrix3d grid_covariance(const Grid& grid, const Eigen::Matrix3d& covariance_in_world) {
  const Eigen::Vector3d signs = grid_from_world(grid, Eigen::Vector3d::Ones());
  return signs.asDiagonal() * covariance_in_world * signs.asDiagonal();
}

// The fix at a solution of the closed form: position, covariance, notes.
Fix with_position(Fix fix, const Eigen::Vector3d& position_in_world, const ClosedFormInput& input,
                  const TagPair& pair, double d_sigma, const Survey& survey) {
  fix.position_in_grid = grid_from_world(survey.grid, position_in_world);
  const double mismatch = std::max(wall_mismatch(survey, input, position_in_world),
                                   wall_bend(survey, pair.left.seen->tag, input));
  const double tag_height = (input.p1_in_world.z() + input.p2_in_world.z()) / 2;
  const std::optional<Uncertainty> uncertainty =
      uncertainty_of(position_in_world, std::abs(position_in_world.z() - tag_height),
                     disturbances_of(input, pair, d_sigma, mismatch));
  if (uncertainty) fix.covariance_in_grid = grid_covariance(survey.grid, uncertainty->covariance);
  if (mismatch > d_sigma) {
    fix.notes.emplace_back(
        "the wall bends, or the tags' positions contradict theta, by more than the range's sigma: "
        "the method takes neither into account, the covariance does");
  }
  if (!uncertainty || !uncertainty->is_complete) {
    fix.notes.emplace_back(
        "less than one standard deviation from having no solution: the covariance is rough");
  }
  return fix;
}

Fix with_reason(Fix fix, const Observation& observation, const std::string& reason) {
  std::vector<std::string> reasons = observation.faults;
  reasons.push_back(reason);
  fix.reason = fmt::format("{}", fmt::join(reasons, "; "));
  return fix;
}

std::vector<std::string> names_of(const std::vector<SeenTag>& seen) {
  std::vector<std::string> names;
  names.reserve(seen.size());
  for (const SeenTag& tag : seen) names.push_back(tag.tag.name);
  return names;
}

}  // namespace

Fix localize_by_paper(const Observation& observation, const std::vector<Survey>& surveys,
                      const Rig& rig) {
  Fix fix;
  fix.id = observation.id;
  fix.method = "paper";
  fix.tags = names_of(observation.tags);
  const Result<TagPair> pair = choose_pair(ranged_tags(observation, surveys, rig, Side::left),
                                           ranged_tags(observation, surveys, rig, Side::right));
  if (!pair) return with_reason(fix, observation, pair.error().message);
  const Survey& survey = surveys.at(pair->left.seen->survey);
  fix.survey = survey.name;
  fix.tags = {pair->left.seen->tag.name, pair->right.seen->tag.name};
  const Result<Length> d = wall_distance(observation, rig);
  if (!d) return with_reason(fix, observation, d.error().message);
  const ClosedFormInput input = closed_form_input(*pair, survey, d->value);
  const std::string broken = broken_assumption(input);
  if (!broken.empty()) return with_reason(fix, observation, broken);
  const auto position = paper_position(input);
  if (!position) return with_reason(fix, observation, position.error().message);
  const std::string outside = outside_tunnel(survey.tunnel, *position);
  if (!outside.empty()) return with_reason(fix, observation, outside);

  fix.notes = observation.faults;
  return with_position(fix, *position, input, *pair, d->sigma, survey);
}

}  // namespace tagsmith::detail
