// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/ranged_tags.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "decoder/paper/closed_form.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {

Eigen::Matrix3d level_from_vehicle(double grade, const Lean& lean) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(-std::atan(grade), Eigen::Vector3d::UnitY()) *
          AngleAxisd(lean.pitch, Eigen::Vector3d::UnitY()) *
          AngleAxisd(lean.roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

namespace {

// The level camera that the paper assumes, at the place and with the heading of the rig's: x right,
// y down, z forward, in a level vehicle's frame.
Eigen::Matrix3d level_camera(const Eigen::Matrix3d& level_from_camera) {
  constexpr double kVertical = 0.1;  // a camera that looks up or down has no heading of its own
  const Eigen::Vector3d down(0, 0, -1);
  Eigen::Vector3d forward = level_from_camera.col(2);
  forward.z() = 0;
  if (forward.norm() < kVertical) forward = Eigen::Vector3d::UnitX();
  forward.normalize();
  Eigen::Matrix3d axes;
  axes << down.cross(forward), down, forward;
  return axes;
}

// A tag seen by a camera: how D follows from its corners' pixels.
class Sight {
 public:
  Sight(const Camera& camera, const Eigen::Matrix3d& level_from_camera, double edge)
      : camera_(camera),
        ideal_from_camera_(level_camera(level_from_camera).transpose() * level_from_camera),
        edge_(edge) {}

  // The pixel where the level camera, with square pixels, without distortion and with the principal
  // point at (0, 0), would have seen it; nothing behind it, or where the lens model has no ray.
  std::optional<PixelPoint> ideal_pixel(const PixelPoint& pixel) const {
    const std::optional<Eigen::Vector3d> ray = ray_through(camera_, {pixel.x, pixel.y});
    if (!ray) return std::nullopt;
    const Eigen::Vector3d ideal = ideal_from_camera_ * *ray;
    if (ideal.z() <= 0) return std::nullopt;
    return PixelPoint{camera_.fy * ideal.x() / ideal.z(), camera_.fy * ideal.y() / ideal.z()};
  }

  std::optional<double> distance(const PixelPoint& p, const PixelPoint& q) const {
    const std::optional<PixelPoint> ideal_p = ideal_pixel(p);
    const std::optional<PixelPoint> ideal_q = ideal_pixel(q);
    if (!ideal_p || !ideal_q) return std::nullopt;
    return paper_distance(*ideal_p, *ideal_q, {0, 0}, camera_.fy, edge_);
  }

 private:
  Camera camera_;
  Eigen::Matrix3d ideal_from_camera_;
  double edge_ = 0;  // length of PQ, metres
};

// D as a function of all that it depends on, at the values that survey and rig state.
class DistanceModel {
 public:
  DistanceModel(const RigCamera& camera, const SeenCorners& seen, double grade, double edge)
      : camera_(camera), p_(seen.corners[0]), q_(seen.corners[3]), grade_(grade), edge_(edge) {}

  std::optional<double> value() const {
    return Sight(camera_.camera, attitude(), edge_).distance(p_, q_);
  }

  // Half the change of D between both ends of a standard deviation, by:
  std::optional<double> by_pixels(const PixelPoint& shift_p, const PixelPoint& shift_q) const {
    const Sight sight(camera_.camera, attitude(), edge_);
    return half(sight.distance(p_ + shift_p, q_ + shift_q),
                sight.distance(p_ - shift_p, q_ - shift_q));
  }
  std::optional<double> by_camera(const std::function<void(Camera&, double)>& change) const {
    const auto changed = [&](double sign) {
      Camera camera = camera_.camera;
      change(camera, sign);
      return Sight(camera, attitude(), edge_).distance(p_, q_);
    };
    return half(changed(1), changed(-1));
  }
  std::optional<double> by_mounting(const Eigen::Vector3d& turn) const {
    const auto turned = [&](double sign) {
      const Eigen::AngleAxisd by(sign * turn.norm(), turn.normalized());
      return Sight(camera_.camera, attitude() * by, edge_).distance(p_, q_);
    };
    return half(turned(1), turned(-1));
  }
  std::optional<double> by_lean(const Lean& lean) const {
    const auto leaning = [&](double sign) {
      const Lean by{sign * lean.roll, sign * lean.pitch};
      return Sight(camera_.camera, attitude(by), edge_).distance(p_, q_);
    };
    return half(leaning(1), leaning(-1));
  }

  // P in the level camera's image.
  std::optional<PixelPoint> ideal_p() const {
    return Sight(camera_.camera, attitude(), edge_).ideal_pixel(p_);
  }

 private:
  Eigen::Matrix3d attitude(const Lean& lean = {}) const {
    return level_from_vehicle(grade_, lean) * camera_.vehicle_from_camera.rotation;
  }
  static std::optional<double> half(const std::optional<double>& plus,
                                    const std::optional<double>& minus) {
    if (!plus || !minus) return std::nullopt;
    return (*plus - *minus) / 2;
  }

  const RigCamera& camera_;
  PixelPoint p_, q_;
  double grade_ = 0;
  double edge_ = 0;
};

// The changes of one tag's D, each by one standard deviation: pixels of its corners, what the rig
// states of the camera's calibration, and the plate's attitude.
std::vector<std::optional<double>> changes_of_distance(const DistanceModel& model,
                                                       const RigCamera& camera,
                                                       const SeenCorners& seen,
                                                       double plate_angle_sigma) {
  const CalibrationSigma& sigma = camera.calibration_sigma;
  const double px = seen.sigma_px;
  const double focal = std::hypot(sigma.focal, sigma.focal_drift);
  const double center = std::hypot(sigma.center, sigma.center_drift);
  std::vector<std::optional<double>> changes;
  for (const PixelPoint shift : {PixelPoint{px, 0}, PixelPoint{0, px}}) {
    changes.push_back(model.by_pixels(shift, {0, 0}));
    changes.push_back(model.by_pixels({0, 0}, shift));
  }
  const PixelPoint up = seen.corners[0] - seen.corners[3];
  if (const double length = std::hypot(up.x, up.y); length > 0) {
    const PixelPoint outward{sigma.edge * up.x / length, sigma.edge * up.y / length};
    changes.push_back(model.by_pixels(outward, PixelPoint{0, 0} - outward));
  }
  if (focal > 0) {
    changes.push_back(model.by_camera([&](Camera& changed, double sign) {
      changed.fx *= 1 + sign * focal;
      changed.fy *= 1 + sign * focal;
    }));
  }
  if (center > 0) {
    changes.push_back(
        model.by_camera([&](Camera& changed, double s) { changed.cx += s * center; }));
    changes.push_back(
        model.by_camera([&](Camera& changed, double s) { changed.cy += s * center; }));
  }
  for (int axis = 0; sigma.angle > 0 && axis < 3; ++axis) {
    changes.push_back(model.by_mounting(sigma.angle * Eigen::Vector3d::Unit(axis)));
  }
  changes.emplace_back(sigma.position);
  const auto p = model.ideal_p();
  const auto distance = model.value();
  if (p && distance) {
    // A plate that leans foreshortens PQ for a camera that looks up or down at it.
    const double slope = p->y / camera.camera.fy;
    changes.emplace_back(*distance * plate_angle_sigma * std::abs(slope));
  }
  return changes;
}

// D is inversely proportional to |P'Q'|, near the optical axis by f * PQ.
double outline_distance_sigma(const Camera& camera, double distance, double edge) {
  return distance * distance / (camera.fy * edge) * std::numbers::sqrt2 * kOutlineCornerSigmaPx;
}

bool is_surveyed_above(const Survey& survey, const PlacedTag& tag, const Rig& rig,
                       const RigCamera& camera, double grade) {
  const double floor = survey.tunnel.centerline.at(tag.chainage).position.z();
  const Eigen::Vector3d from_o = level_from_vehicle(grade) * camera.vehicle_from_camera.translation;
  return tag.p_in_grid.z() >= floor + rig.vehicle_height + from_o.z();
}

// D by the corners; nothing for a tag at the border of what the camera's lens model covers.
std::optional<RangedTag> ranged_by_corners(const SeenTag& seen, const Survey& survey,
                                           const Rig& rig, const RigCamera& camera, double grade) {
  const DistanceModel model(camera, *seen.seen_corners, grade,
                            survey.tag_template.frame_inner_height);
  const auto p = model.ideal_p();
  const auto distance = model.value();
  const auto by_roll = model.by_lean({rig.roll_sigma, 0});
  const auto by_pitch = model.by_lean({0, rig.pitch_sigma});
  if (!p || !distance || !by_roll || !by_pitch) return std::nullopt;
  double variance = 0;
  for (const auto& change :
       changes_of_distance(model, camera, *seen.seen_corners, survey.angle_sigma)) {
    if (!change) return std::nullopt;
    variance += *change * *change;
  }
  return RangedTag{
      &seen,    &camera,  grade, {*distance, std::sqrt(variance)}, paper_tag_is_above(*p, {0, 0}),
      *by_roll, *by_pitch};
}

std::optional<RangedTag> ranged(const SeenTag& seen, const Survey& survey, const Rig& rig,
                                const RigCamera& camera) {
  const double grade = survey.tunnel.centerline.at(seen.tag.chainage).grade;
  if (seen.seen_corners) return ranged_by_corners(seen, survey, rig, camera, grade);
  const double distance = seen.distance.value_or(0);
  const double edge = survey.tag_template.frame_inner_height;
  return RangedTag{&seen,
                   &camera,
                   grade,
                   {distance, outline_distance_sigma(camera.camera, distance, edge)},
                   is_surveyed_above(survey, seen.tag, rig, camera, grade)};
}

}  // namespace

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

}  // namespace tagsmith::detail
