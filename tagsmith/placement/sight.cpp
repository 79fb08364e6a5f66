// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/sight.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNearest = 1e-3;  // metres before the camera's centre plane, as in project()

Vector2d pinhole(const Camera& camera, const Vector3d& point) {
  return {camera.fx * point.x() / point.z() + camera.cx,
          camera.fy * point.y() / point.z() + camera.cy};
}

// The most pixels that a radian takes in this direction from the camera.
double px_per_radian(const Camera& camera, const Vector3d& direction) {
  const std::optional<Projection> projection =
      project_with_derivative(camera, direction.normalized());
  if (!projection) return 0;
  const Eigen::Matrix2d square = projection->by_point * projection->by_point.transpose();
  const double half_trace = square.trace() / 2;  // of a symmetric matrix: its greatest eigenvalue
  return std::sqrt(half_trace + std::hypot((square(0, 0) - square(1, 1)) / 2, square(0, 1)));
}

// The same over the image and, where the lens shows less than the image, over the lens's rim.
double greatest_px_per_radian(const Camera& camera) {
  constexpr int kSteps = 16;
  double most = 0;
  for (int y = 0; y <= kSteps; ++y) {
    for (int x = 0; x <= kSteps; ++x) {
      const Vector2d pixel((camera.width - 1) * x / static_cast<double>(kSteps),
                           (camera.height - 1) * y / static_cast<double>(kSteps));
      const std::optional<Vector3d> ray = ray_through(camera, pixel);
      if (ray) most = std::max(most, px_per_radian(camera, *ray));
    }
  }
  const double rim = reach(camera);
  for (int i = 0; std::isfinite(rim) && i < kSteps; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSteps;
    const Vector3d ray(rim * std::cos(angle), rim * std::sin(angle), 1);
    const std::optional<Vector2d> pixel = project(camera, ray);
    if (pixel && in_image(camera, *pixel)) most = std::max(most, px_per_radian(camera, ray));
  }
  return most;
}

// The derivative of a point's picture by the point, pixels a metre.
std::optional<Eigen::Matrix<double, 2, 3>> picture_by_point(const Camera& camera, bool is_pinhole,
                                                            const Vector3d& point) {
  if (!is_pinhole) {
    const std::optional<Projection> projection = project_with_derivative(camera, point);
    if (!projection) return std::nullopt;
    return projection->by_point;
  }
  const double inverse_depth = 1 / point.z();
  const double by_x = camera.fx * inverse_depth;
  const double by_y = camera.fy * inverse_depth;
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << by_x, 0, -by_x * point.x() * inverse_depth, 0, by_y,
      -by_y * point.y() * inverse_depth;
  return by_point;
}

// Whether a pixel is so far within the image that a corner of the frame may lie there.
bool is_inside(const Camera& camera, const Vector2d& pixel) {
  return pixel.x() >= kBorderPx && pixel.x() <= camera.width - 1 - kBorderPx &&
         pixel.y() >= kBorderPx && pixel.y() <= camera.height - 1 - kBorderPx;
}

// An even path of m pixels has a standard deviation of m / sqrt(12). The limits, measured with
// normal blur, apply to it while it is short: a path of some modules has gaps in its spectrum that
// no normal blur has (4 modules are not read), and one longer than a stroke leaves none of its
// black.
constexpr double kMostModules = 3;
constexpr double kMostStrokes = 1;

// Metres that the vehicle may move during the exposure; negative when the plate is not read
// standing still.
double greatest_travel(const PlateSight& sight, const BlurLimits& limits) {
  const double most = limits.greatest_blur_px(sight.cosine, sight.effective_px);
  const double left = most * most - sight.blur_px * sight.blur_px;
  if (most < 0 || left < 0) return -1;
  const double path = std::min(std::sqrt(12 * left), kMostModules * sight.module_px);
  return std::min(path / std::max(sight.smear_px, 1e-9),
                  kMostStrokes / std::max(sight.smear_down, 1e-9));
}

}  // namespace

double arm_length(const Rig& rig) {
  double longest = 0;
  for (const RigCamera& camera : rig.cameras) {
    longest = std::max(longest, camera.vehicle_from_camera.translation.norm());
  }
  return longest;
}

SightModel::SightModel(const Survey& survey, const Rig& rig, ReadShare share)
    : survey_(&survey), rig_(&rig), plain_(false, share), book_(true, share) {
  const TagTemplate& tag = survey.tag_template;
  module_ = module_width(tag);
  half_length_ = tag.frame_inner_length / 2;
  half_height_ = tag.frame_inner_height / 2;
  for (const PlacedTag& placed : survey.tags) plates_.push_back(make_plate(placed));
  order_.resize(plates_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return survey.tags[i].chainage; });
  for (const RigCamera& camera : rig.cameras) {
    lenses_.push_back(make_lens(camera));
    reach_ = std::max(reach_, lenses_.back().magnification * module_ / book_.least_module_px());
  }
  reach_ = std::min(reach_, kFarthestSight);
}

SightModel::Plate SightModel::make_plate(const PlacedTag& placed) const {
  // A plate whose corner is farther before its wall than plates on even walls are may hide others.
  constexpr double kStandsOut = 0.03;  // metres
  const TagTemplate& tag = survey_->tag_template;
  const Pose& pose = placed.world_from_plate;
  Plate plate;
  plate.middle = pose * Vector3d(half_length_, half_height_, 0);
  plate.right = pose.rotation.col(0);
  plate.down = pose.rotation.col(1);
  plate.normal = pose.rotation.col(2);
  plate.centre =
      plate.middle - tag.frame_offset_right * plate.right + tag.frame_offset_up * plate.down;
  const auto behind = [&](const Vector3d& point) {
    return behind_wall(survey_->tunnel, placed.side,
                       survey_->tunnel.centerline.locate(point.head<2>()));
  };
  for (const double x : {-0.5, 0.5}) {
    const Vector3d end = plate.centre + x * tag.plate_length * plate.right;
    plate.depth =
        std::max(plate.depth, behind(end + (pose.translation - end).dot(plate.down) * plate.down));
    for (const double y : {-0.5, 0.5}) {
      plate.stands_out =
          plate.stands_out || behind(end + y * tag.plate_height * plate.down) < -kStandsOut;
    }
  }
  return plate;
}

SightModel::Lens SightModel::make_lens(const RigCamera& rig_camera) const {
  const Camera& camera = rig_camera.camera;
  Lens lens;
  lens.is_pinhole = is_rectilinear(camera);
  const Pose camera_from_vehicle = inverse(rig_camera.vehicle_from_camera);
  lens.camera_from_vehicle = camera_from_vehicle.rotation;
  lens.vehicle_in_camera = camera_from_vehicle.translation;
  lens.forward_in_camera = camera_from_vehicle.rotation.col(0);
  lens.blur_px = rig_camera.blur_px.value_or(kUsualBlurPx);
  // A pinhole has its greatest in a corner; for other lenses 10 % more than was found.
  lens.magnification = greatest_px_per_radian(camera) * (lens.is_pinhole ? 1 : 1.1);
  lens.left = lens.top = 1e9;
  lens.right = lens.bottom = -1e9;
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = (camera.width - 1) * i / static_cast<double>(kSteps);
    const double y = (camera.height - 1) * i / static_cast<double>(kSteps);
    for (const Vector2d& pixel : {Vector2d(x, 0), Vector2d(x, camera.height - 1), Vector2d(0, y),
                                  Vector2d(camera.width - 1, y)}) {
      // Where the border has no ray, the picture extends as far as the lens does.
      constexpr double kFar = 1e3;
      const std::optional<Vector3d> found = ray_through(camera, pixel);
      const Vector3d ray = found.value_or(Vector3d(kFar, kFar, 1));
      lens.left = std::min(lens.left, found ? ray.x() : -kFar);
      lens.right = std::max(lens.right, ray.x());
      lens.top = std::min(lens.top, found ? ray.y() : -kFar);
      lens.bottom = std::max(lens.bottom, ray.y());
    }
  }
  return lens;
}

CameraStand SightModel::stand(std::size_t camera, const Pose& world_from_vehicle,
                              double curvature) const {
  const Lens& lens = lenses_[camera];
  CameraStand stand;
  stand.camera_from_world.rotation =
      lens.camera_from_vehicle * world_from_vehicle.rotation.transpose();
  stand.camera_from_world.translation =
      lens.vehicle_in_camera - stand.camera_from_world.rotation * world_from_vehicle.translation;
  stand.centre =
      -(stand.camera_from_world.rotation.transpose() * stand.camera_from_world.translation);
  stand.turn = -curvature * lens.camera_from_vehicle.col(2);
  // The camera's own velocity: the vehicle's, and that of its arm in the turn.
  stand.travel = lens.forward_in_camera - stand.turn.cross(lens.vehicle_in_camera);
  return stand;
}

std::span<const std::size_t> SightModel::tags_between(double low, double high) const {
  const auto chainage = [&](std::size_t tag) { return survey_->tags[tag].chainage; };
  const auto begin = std::ranges::lower_bound(order_, low, {}, chainage);
  return {begin, std::ranges::upper_bound(begin, order_.end(), high, {}, chainage)};
}

// True when a wall may hide a tag: the center line bends there, or the walls do not run straight
// beside it.
bool SightModel::may_be_hidden_between(double low, double high) const {
  if (!survey_->tunnel.left.is_constant() || !survey_->tunnel.right.is_constant()) return true;
  double start = 0;
  for (const CenterlineElement& element : survey_->tunnel.centerline.elements()) {
    if (element.curvature != 0 && start <= high && start + element.length >= low) return true;
    start += element.length;
  }
  return false;
}

// How far behind the plates' planes the walls stand there, as wall_standoff.
double SightModel::standoff_between(double low, double high) const {
  double farthest = 0;
  for (const std::size_t tag : tags_between(low, high)) {
    farthest = std::max(farthest, plates_[tag].depth);
  }
  return standoff_behind(farthest);
}

Surroundings SightModel::surroundings(double first, double last) const {
  const double reach = reach_ + arm_length(*rig_) + (last - first);
  const double middle = (first + last) / 2;
  Surroundings around;
  if (may_be_hidden_between(first - reach, last + reach)) {
    around.walls.emplace(survey_->tunnel, standoff_between(first - reach, last + reach), middle,
                         reach);
  }
  const FloorAndRoof floor_and_roof(survey_->tunnel, middle, reach);
  if (!floor_and_roof.is_even()) around.floor_and_roof = floor_and_roof;
  std::ranges::copy_if(tags_between(first - reach, last + reach),
                       std::back_inserter(around.standing_out),
                       [&](std::size_t tag) { return plates_[tag].stands_out; });
  return around;
}

bool SightModel::may_see(std::size_t camera, const CameraStand& stand, std::size_t tag,
                         double slack, double turn) const {
  const Plate& plate = plates_[tag];
  const Lens& lens = lenses_[camera];
  const Vector3d way = plate.middle - stand.centre;
  const double distance = way.norm();
  const double nearest = std::max(distance - slack, 1e-6);
  const double before = plate.normal.dot(way) + slack;
  if (before <= 0) return false;
  const double cosine = std::min(1.0, before / nearest);
  if (lens.magnification * module_ * cosine / nearest < book_.least_module_px()) return false;
  if (distance <= 2 * slack) return true;
  // The middle must lie in the image: its pyramid, widened by the effect of slack and turn.
  const Vector3d middle = stand.camera_from_world.rotation * way;
  const double room = slack + (distance + slack) * turn;
  const auto inside = [&](double side, double across) {
    return across <= side * middle.z() + room * std::sqrt(1 + side * side);
  };
  return middle.z() > -room && inside(lens.right, middle.x()) && inside(-lens.left, -middle.x()) &&
         inside(lens.bottom, middle.y()) && inside(-lens.top, -middle.y());
}

bool SightModel::fits_in_image(std::size_t camera, const InView& view, double from,
                               double to) const {
  const Camera& lens = rig_->cameras[camera].camera;
  const Vector3d along = half_height_ * view.down;
  for (const double place : {from, to}) {
    const Vector3d edge = view.middle + place * half_length_ * view.right;
    for (const Vector3d& corner : {Vector3d(edge + along), Vector3d(edge - along)}) {
      if (corner.z() < kNearest || !is_inside(lens, pinhole(lens, corner))) return false;
    }
  }
  return true;
}

bool SightModel::fits_in_image(std::size_t camera, const InView& view) const {
  if (lenses_[camera].is_pinhole) return fits_in_image(camera, view, -1, 1);
  const Camera& lens = rig_->cameras[camera].camera;
  const Vector3d across = half_length_ * view.right;
  const Vector3d along = half_height_ * view.down;
  // Sides bend: their middles, too, must be in the image.
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      if (x == 0 && y == 0) continue;
      const std::optional<Vector2d> pixel = project(lens, view.middle + x * across + y * along);
      if (!pixel || !is_inside(lens, *pixel)) return false;
    }
  }
  return true;
}

bool SightModel::is_behind(const TunnelWalls& walls, const CameraStand& stand,
                           const Plate& plate) const {
  const Vector2d origin = stand.centre.head<2>();
  for (const double side : {-half_length_, half_length_}) {
    const Vector2d way = (plate.middle + side * plate.right).head<2>() - origin;
    const std::optional<WallHit> hit = walls.first_hit(origin, way);
    if (hit && hit->way < 1) return true;
  }
  return false;
}

bool SightModel::is_behind(const FloorAndRoof& floor_and_roof, const CameraStand& stand,
                           const Plate& plate) const {
  for (const double side : {-half_length_, half_length_}) {
    for (const double edge : {-half_height_, half_height_}) {
      const Vector3d way = plate.middle + side * plate.right + edge * plate.down - stand.centre;
      if (floor_and_roof.first_exit(stand.centre, way, 1)) return true;
    }
  }
  return false;
}

// The lines of sight to the frame's corners, to its middle and to places between them.
bool SightModel::is_behind(const Plate& other, const CameraStand& stand, const Plate& plate) const {
  const TagTemplate& tag = survey_->tag_template;
  const double before = other.normal.dot(other.centre - stand.centre);
  for (const double x : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      const Vector3d way = plate.middle + x * half_length_ * plate.right +
                           y * half_height_ * plate.down - stand.centre;
      const double share = before / other.normal.dot(way);
      if (!(share > 0 && share < 1 - 1e-6)) continue;
      const Vector3d hit = stand.centre + share * way - other.centre;
      if (std::abs(hit.dot(other.right)) < tag.plate_length / 2 &&
          std::abs(hit.dot(other.down)) < tag.plate_height / 2) {
        return true;
      }
    }
  }
  return false;
}

bool SightModel::is_hidden(const Surroundings& around, const CameraStand& stand,
                           std::size_t tag) const {
  const Plate& plate = plates_[tag];
  return (around.walls && is_behind(*around.walls, stand, plate)) ||
         (around.floor_and_roof && is_behind(*around.floor_and_roof, stand, plate)) ||
         std::ranges::any_of(around.standing_out, [&](std::size_t other) {
           return other != tag && is_behind(plates_[other], stand, plate);
         });
}

// The effective width of the modules: those at the farther end of the frame, by its strokes and
// heights. `right` and `down` are the pictures of a metre at the middle.
double SightModel::effective_px(std::size_t camera, const InView& view, const Vector2d& right,
                                const Vector2d& down) const {
  const RigCamera& rig_camera = rig_->cameras[camera];
  double least = right.norm();
  for (const double end : {-half_length_, half_length_}) {
    const Vector3d point = view.middle + end * view.right;
    if (point.z() < kNearest) return 0;
    const auto by_point = picture_by_point(rig_camera.camera, lenses_[camera].is_pinhole, point);
    if (!by_point) return 0;
    least = std::min(least, (*by_point * view.right).norm());
  }
  const double foreshortening = std::abs(cross(right, down)) / right.squaredNorm();
  return module_ * least * frame_share(survey_->tag_template, foreshortening);
}

std::optional<SightModel::InView> SightModel::in_view(std::size_t camera, const CameraStand& stand,
                                                      std::size_t tag) const {
  const Plate& plate = plates_[tag];
  const Lens& lens = lenses_[camera];
  const RigCamera& rig_camera = rig_->cameras[camera];
  const Vector3d way = plate.middle - stand.centre;
  const double before = plate.normal.dot(way);
  if (before <= 0) return std::nullopt;
  const Eigen::Matrix3d& rotation = stand.camera_from_world.rotation;
  const Vector3d middle = rotation * way;
  if (middle.z() < kNearest) return std::nullopt;
  InView view{{}, middle, rotation * plate.right, rotation * plate.down};
  const auto by_point = picture_by_point(rig_camera.camera, lens.is_pinhole, middle);
  if (!by_point) return std::nullopt;
  const Vector2d right = *by_point * view.right;
  const Vector2d down = *by_point * view.down;
  PlateSight& sight = view.sight;
  sight.module_px = module_ * right.norm();
  if (sight.module_px < book_.least_module_px()) return std::nullopt;
  sight.effective_px = effective_px(camera, view, right, down);
  if (sight.effective_px < book_.least_module_px()) return std::nullopt;
  sight.camera = camera;
  sight.tag = tag;
  sight.distance = way.norm();
  sight.cosine = before / sight.distance;
  sight.blur_px = lens.blur_px;
  if (rig_camera.focus && rig_camera.aperture) {
    // Circle of confusion of a thin lens; a disc's standard deviation is a quarter of its diameter.
    const double circle = rig_camera.camera.fx * *rig_camera.aperture *
                          std::abs(1 / *rig_camera.focus - 1 / middle.z());
    sight.blur_px = std::hypot(sight.blur_px, circle / 4);
  }
  const Vector2d motion = *by_point * (-stand.travel - stand.turn.cross(middle));
  sight.smear_px = std::abs(motion.dot(right)) / right.norm();
  sight.smear_down =
      std::abs(cross(motion, right)) /
      std::max(survey_->tag_template.frame_stroke * std::abs(cross(down, right)), 1e-12);
  return view;
}

std::optional<PlateSight> SightModel::look(std::size_t camera, const CameraStand& stand,
                                           std::size_t tag, const Surroundings& around) const {
  const std::optional<InView> view = in_view(camera, stand, tag);
  if (!view || !fits_in_image(camera, *view) || is_hidden(around, stand, tag)) return std::nullopt;
  PlateSight sight = view->sight;
  sight.travel_plain = greatest_travel(sight, plain_);
  sight.travel_book = greatest_travel(sight, book_);
  return sight;
}

bool SightModel::shows_part(std::size_t camera, const CameraStand& stand, std::size_t tag,
                            const Surroundings& around, double moved) const {
  constexpr double kEnd = 2 * kPartInSight - 1;
  if (!lenses_[camera].is_pinhole) return false;
  const std::optional<InView> view = in_view(camera, stand, tag);
  return view && greatest_travel(view->sight, parts_) >= moved &&
         (fits_in_image(camera, *view, -1, kEnd) || fits_in_image(camera, *view, -kEnd, 1)) &&
         !is_hidden(around, stand, tag);
}

}  // namespace tagsmith::detail
