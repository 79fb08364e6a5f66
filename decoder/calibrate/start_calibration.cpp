// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/start_calibration.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

// A rough camera is wrong by pixels where corners are known to hundredths: with covariances this
// many times wider (in standard deviations), a tag beyond three of them counts linearly.
constexpr double kRoughScale = 30;
constexpr double kRoughHuber = 3 * 2.8;  // eight residuals have the length 2.8

// Points of the board's plane and the directions in which they are seen.
struct PlanePoint {
  Vector2d on_board;
  Vector3d direction;
};

std::optional<std::vector<PlanePoint>> plane_points(const Camera& camera,
                                                    const BoardSighting& sighting) {
  std::vector<PlanePoint> points;
  for (const TagObservation& tag : sighting.tags) {
    for (std::size_t i = 0; i < 4; ++i) {
      const auto ray = ray_through(camera, tag.pixels.segment<2>(static_cast<Eigen::Index>(2 * i)));
      if (!ray) return std::nullopt;
      points.push_back({tag.on_board[i], ray->normalized()});
    }
  }
  return points;
}

// The homography that sends the plane's points along their directions: direction x H (x, y, 1) = 0,
// least squares over directions, which holds up to 90 degrees from the axis. A point counts less
// the worse it fits in the round before, so that a tag at a wrong place does not turn the board.
Matrix3d homography_of(const std::vector<PlanePoint>& points, double size) {
  constexpr int kRounds = 4;
  constexpr double kFine = 1e-3;  // radians; below this all points count alike
  Matrix3d h = Matrix3d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Matrix9 normal = Matrix9::Zero();
    for (const PlanePoint& point : points) {
      const Vector3d on_plane(point.on_board.x() / size, point.on_board.y() / size, 1);
      const Vector3d& d = point.direction;
      const Vector3d predicted = h * on_plane;
      const double off =
          round == 0 ? 0 : d.cross(predicted).norm() / std::max(predicted.norm(), 1e-12);
      Matrix3d across;
      across << 0, -d.z(), d.y(), d.z(), 0, -d.x(), -d.y(), d.x(), 0;
      Eigen::Matrix<double, 3, 9> rows;
      rows << across * on_plane.x(), across * on_plane.y(), across;
      normal += rows.transpose() * rows / (off + kFine);
    }
    const Eigen::Matrix<double, 9, 1> least = principal_axes(normal).vectors.col(0);
    h = Eigen::Map<const Matrix3d>(least.data());
  }
  h.leftCols<2>() /= size;
  return h;
}

// Zhang (2000), 3.1, of a camera whose intrinsics are one.
std::optional<Pose> pose_of(Matrix3d h, const std::vector<PlanePoint>& points) {
  double agreement = 0;
  for (const PlanePoint& point : points) {
    agreement += point.direction.dot(h * Vector3d(point.on_board.x(), point.on_board.y(), 1));
  }
  const double scale = (h.col(0).norm() + h.col(1).norm()) / 2;
  if (!(scale > 0)) return std::nullopt;
  h *= (agreement < 0 ? -1 : 1) / scale;
  Matrix3d turned;
  turned << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  const Eigen::JacobiSVD<Matrix3d> svd(turned, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if (rotation.determinant() < 0 || !rotation.allFinite()) return std::nullopt;
  return Pose{rotation, h.col(2)};
}

AdjustmentOptions rough_options(LensModel lens, int iterations) {
  return {.form = {lens_forms(lens).front(), true},
          .camera_free = false,
          .shapes_free = false,
          .scale = kRoughScale,
          .huber = kRoughHuber,
          .iterations = iterations};
}

// The sightings with the most tags, and some tags of each from all over it: enough to choose a
// start.
CalibrationProblem richest(const CalibrationProblem& problem) {
  constexpr std::size_t kSightings = 10;
  constexpr std::size_t kTags = 10;
  CalibrationProblem some = problem;
  std::ranges::stable_sort(some.sightings, std::ranges::greater{},
                           [](const BoardSighting& sighting) { return sighting.tags.size(); });
  if (some.sightings.size() > kSightings) some.sightings.resize(kSightings);
  for (BoardSighting& sighting : some.sightings) {
    sighting.tags = evenly_taken(std::move(sighting.tags), kTags);
  }
  return some;
}

// The pose of one sighting for a camera that is known: by the homography of its rays. Nothing when
// a corner has no ray or there is no such pose.
std::optional<Pose> start_pose(const CalibrationProblem& problem, const Camera& camera,
                               const BoardSighting& sighting) {
  const auto points = plane_points(camera, sighting);
  if (!points || points->empty()) return std::nullopt;
  const double size = problem.planes[sighting.board].half_size.norm();
  return pose_of(homography_of(*points, size), *points);
}

// A sighting that this camera cannot have made stays at the camera's centre, where nothing of it is
// visible and every tag costs much.
CalibrationState placed(const CalibrationProblem& problem, const Camera& camera) {
  CalibrationState state{camera, std::vector<BoardShape>(problem.planes.size()), {}};
  for (const BoardSighting& sighting : problem.sightings) {
    state.sightings.push_back({start_pose(problem, camera, sighting).value_or(Pose{}), 0});
  }
  return state;
}

// From a rectilinear lens of 150 degrees to a long telephoto lens, and the barrel distortion that
// wide lenses have.
std::vector<Camera> grid_of_cameras(const CalibrationProblem& problem, LensModel lens) {
  constexpr double kShortest = 0.13;  // of the longer side
  constexpr double kLongest = 12;
  constexpr double kStep = 1.3;
  constexpr double kBends[] = {0, -0.15, -0.35};
  const double side = std::max(problem.width, problem.height);
  std::vector<Camera> cameras;
  double focal = kShortest * side;
  while (focal < kLongest * side) {
    for (const double bend : kBends) {
      if (bend != 0 && (lens == LensModel::fisheye || focal > 2 * side)) continue;
      Camera camera{problem.width, problem.height, focal, focal};
      camera.cx = (problem.width - 1) / 2.0;
      camera.cy = (problem.height - 1) / 2.0;
      camera.distortion[0] = bend;
      // A falling cubic and a rising quintic rise together over all of the picture.
      if (bend != 0) camera.distortion[1] = bend * bend;
      camera.lens = lens;
      cameras.push_back(camera);
    }
    focal *= kStep;
  }
  return cameras;
}

struct RoughFit {
  double cost = 0;
  CalibrationState state;
};

// The best few cameras of the grid with the poses that fit them, best first.
std::vector<RoughFit> best_of_grid(const CalibrationProblem& problem, LensModel lens) {
  constexpr std::size_t kTried = 3;
  std::vector<RoughFit> best;
  for (const Camera& camera : grid_of_cameras(problem, lens)) {
    const CalibrationFit fit =
        adjust_calibration(problem, placed(problem, camera), rough_options(lens, 4));
    best.push_back({fit.cost, fit.state});
    std::ranges::stable_sort(best, {}, &RoughFit::cost);
    if (best.size() > kTried) best.pop_back();
  }
  return best;
}

}  // namespace

CalibrationState start_calibration(const CalibrationProblem& problem, LensModel lens) {
  const CalibrationProblem some = richest(problem);
  Camera best;
  double least = std::numeric_limits<double>::infinity();
  for (const RoughFit& rough : best_of_grid(some, lens)) {
    AdjustmentOptions options = rough_options(lens, 30);
    options.form.lens = lens_forms(lens)[lens == LensModel::fisheye ? 1 : 2];
    options.camera_free = true;
    const CalibrationFit fit = adjust_calibration(some, rough.state, options);
    if (fit.cost >= least) continue;
    least = fit.cost;
    best = fit.state.camera;
  }
  return placed(problem, best);
}

}  // namespace tagsmith::detail
