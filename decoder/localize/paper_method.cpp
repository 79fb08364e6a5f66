// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/paper_method.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/localize/ranged_tags.hpp"
#include "decoder/paper/closed_form.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {
namespace {

// The paper gives both tags one height. A difference this large is no noise of a survey, and half
// of it would enter z.
constexpr double kMaxHeightDifference = 0.05;

struct TagPair {
  RangedTag left;
  RangedTag right;
};

bool can_be_paired(const RangedTag& left, const RangedTag& right) {
  return left.seen->survey == right.seen->survey && left.seen->camera != right.seen->camera;
}

// Smaller is better. Chainages are rounded to the millimetre, so that floating-point noise decides
// nothing.
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
  if (best) return *best;
  return fail(
      "no two tags of one survey on the left and right walls were seen by different cameras");
}

// The least of the ranges to the left wall (Xu et al.: of the three sensors), without those outside
// their sensor's limits.
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

// The effect of one uncertain quantity on the input, `step` standard deviations of it.
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
  // Of a pair that is staggered the other way round from there the closed form uses the angle
  // alone.
  input.pair_angle = std::atan2(std::abs(stagger), input.tunnel_width);
  (left ? input.p1_in_world : input.p2_in_world) += shift;
  return input;
}

// Where a camera stands, from O, of a vehicle that faces along the drive (world axes).
Eigen::Vector3d from_o(const RangedTag& tag, double heading, const Lean& lean = {}) {
  const Pose vehicle = world_from_vehicle(Eigen::Vector3d::Zero(), heading);
  return vehicle.rotation *
         (level_from_vehicle(tag.grade, lean) * tag.camera->vehicle_from_camera.translation);
}

// The closed form knows one point. D is measured from a camera that stands `left` and `right` from
// it: seen from O, the tag lies by as much before the place where it hangs.
ClosedFormInput seen_from_o(const ClosedFormInput& input, const Eigen::Vector3d& left,
                            const Eigen::Vector3d& right) {
  ClosedFormInput from = with_tag_moved(with_tag_moved(input, true, -left), false, -right);
  from.wall_distance += left.dot(right_of(input.heading));
  return from;
}

// By how much d differs from the distance to the plane of the left plate where the wall bends, for
// a vehicle as far back as D1 and d allow (the height of the tag above O brings it a little
// nearer).
double wall_bend(const Survey& survey, const PlacedTag& left, const ClosedFormInput& input) {
  const double d = input.wall_distance;
  const double back = std::sqrt(std::max(input.distance1 * input.distance1 - d * d, 0.0));
  const CenterlinePoint abreast = survey.tunnel.centerline.at(left.chainage - back);
  const double wall = survey.tunnel.left.at(left.chainage - back);
  const Eigen::Vector3d o = abreast.position + (wall + d) * right_of(abreast.heading);
  const double to_plane = (input.p1_in_world - o).dot(left.world_from_plate.rotation.col(2));
  return std::abs(to_plane - d);
}

// By how much the position's distance from the left wall differs from the d used to compute it.
double wall_mismatch(const Survey& survey, const ClosedFormInput& input,
                     const Eigen::Vector3d& position_in_world) {
  const ObservedWall wall =
      observe_wall(survey.tunnel.centerline, survey.tunnel.left, position_in_world);
  return std::abs(wall.distance - input.wall_distance);
}

// For a vehicle that does not face along the drive, an angle that nothing states: as large as its
// envelope's, otherwise as its usual lean.
double heading_sigma(const Rig& rig) {
  return std::max({rig.envelope ? rig.envelope->yaw : 0.0, rig.roll_sigma, rig.pitch_sigma});
}

// Disturbances that move both tags, as seen from O, at once.
std::vector<Disturbance> disturbances_of_vehicle(const ClosedFormInput& input, const TagPair& pair,
                                                 const Rig& rig) {
  const Eigen::Vector3d left = from_o(pair.left, input.heading);
  const Eigen::Vector3d right = from_o(pair.right, input.heading);
  // A lean of the vehicle turns what its cameras see, and moves them aside.
  const auto leaning = [&](double RangedTag::*change, Lean lean) {
    return [=](double step) {
      const Lean by{step * lean.roll, step * lean.pitch};
      ClosedFormInput changed = seen_from_o(input, from_o(pair.left, input.heading, by) - left,
                                            from_o(pair.right, input.heading, by) - right);
      changed.distance1 += step * (pair.left.*change);
      changed.distance2 += step * (pair.right.*change);
      return changed;
    };
  };
  std::vector<Disturbance> disturbances{leaning(&RangedTag::by_roll, {rig.roll_sigma, 0}),
                                        leaning(&RangedTag::by_pitch, {0, rig.pitch_sigma})};
  disturbances.push_back([input, left, right, sigma = heading_sigma(rig)](double step) {
    const Eigen::AngleAxisd turn(step * sigma, Eigen::Vector3d::UnitZ());
    return seen_from_o(input, turn * left - left, turn * right - right);
  });
  return disturbances;
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
// than away from it, and beyond the point abreast of the tags the position turns back.
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

// The closed form's input: as survey and sensors have it, and as seen from O.
struct Inputs {
  ClosedFormInput measured;
  ClosedFormInput from_o;
};

// The fix at a solution of the closed form: position, covariance, notes.
Fix with_position(Fix fix, const Eigen::Vector3d& position_in_world, const Inputs& inputs,
                  const TagPair& pair, double d_sigma, const Survey& survey, const Rig& rig) {
  fix.position_in_grid = grid_from_world(survey.grid, position_in_world);
  const double mismatch = std::max(wall_mismatch(survey, inputs.measured, position_in_world),
                                   wall_bend(survey, pair.left.seen->tag, inputs.measured));
  const ClosedFormInput& input = inputs.from_o;
  const double tag_height = (input.p1_in_world.z() + input.p2_in_world.z()) / 2;
  std::vector<Disturbance> disturbances = disturbances_of(input, pair, d_sigma, mismatch);
  std::ranges::move(disturbances_of_vehicle(input, pair, rig), std::back_inserter(disturbances));
  const std::optional<Uncertainty> uncertainty =
      uncertainty_of(position_in_world, std::abs(position_in_world.z() - tag_height), disturbances);
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
  const Inputs inputs{input, seen_from_o(input, from_o(pair->left, input.heading),
                                         from_o(pair->right, input.heading))};
  for (const ClosedFormInput* each : {&inputs.measured, &inputs.from_o}) {
    const std::string broken = broken_assumption(*each);
    if (!broken.empty()) return with_reason(fix, observation, broken);
  }
  const auto position = paper_position(inputs.from_o);
  if (!position) return with_reason(fix, observation, position.error().message);
  const std::string outside = outside_tunnel(survey.tunnel, *position);
  if (!outside.empty()) return with_reason(fix, observation, outside);

  fix.notes = observation.faults;
  return with_position(fix, *position, inputs, *pair, d->sigma, survey, rig);
}

}  // namespace tagsmith::detail
