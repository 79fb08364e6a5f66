// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/board_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kUnseen = 1e10;                                         // chi-square
constexpr Index kMostShared = kCameraParameters + kShapeParameters + 1;  // of one sighting's rows

using SharedRows = Eigen::Matrix<double, 8, Eigen::Dynamic, Eigen::ColMajor, 8, kMostShared>;
using OwnRows = Eigen::Matrix<double, 8, kSightingParameters>;
using OwnVector = Eigen::Matrix<double, kSightingParameters, 1>;
using OwnByShared = Eigen::Matrix<double, kSightingParameters, Eigen::Dynamic, Eigen::ColMajor,
                                  kSightingParameters, kMostShared>;
using Columns = Eigen::Array<Index, Eigen::Dynamic, 1>;

Matrix3d across(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// --- what is known before anything is measured ---

// Standard deviation of edge_px: it is that of an infinitely thick stroke, up to 0.7 pixels where
// strokes of usual thickness move by 0.13.
constexpr double kEdgeSigma = 1;

// Of a board's shape: usual values of it. The stretch follows from the board's scale_sigma. Ink
// grows by some hundredths of a millimetre, 0.1 on poor paper; the bow of half a percent of a side
// is that of a sheet that is taped to a wall; strong sharpening moves the sides of a stroke of 2.5
// pixels by 0.15 pixels less than those of thick ones.
Eigen::Matrix<double, kShapeParameters, 1> shape_sigmas(const BoardPlane& plane) {
  constexpr double kGrowth = 1e-4;
  constexpr double kBow = 0.005;
  constexpr double kLeastStretch = 1e-6;  // of a board that is exact: small, and can be inverted
  constexpr double kThinStroke = 1;
  const double bow = kBow * 2 * plane.half_size.maxCoeff();
  Eigen::Matrix<double, kShapeParameters, 1> sigmas;
  sigmas << std::max(std::sqrt(2.0) * plane.scale_sigma, kLeastStretch), kGrowth, bow, bow, bow,
      kThinStroke;
  return sigmas;
}

// --- one tag ---

// The direction in which ink grows over the inner corners P, F, lower right, Q.
Vector2d inward(std::size_t corner) {
  return {corner == 0 || corner == 3 ? 1.0 : -1.0, corner < 2 ? 1.0 : -1.0};
}

// A corner on a board of this shape, and how it moves with the shape.
struct ShapedPoint {
  Vector3d point;
  Eigen::Matrix<double, 3, 5> by_shape;  // stretch, growth, bow
};

ShapedPoint shaped(const BoardPlane& plane, const BoardShape& shape, const Vector2d& drawn,
                   std::size_t corner) {
  const Vector2d at = drawn.cwiseQuotient(plane.half_size);
  const Vector2d grown = inward(corner);
  ShapedPoint result;
  result.by_shape << drawn.x() / 2, grown.x(), 0, 0, 0,  //
      -drawn.y() / 2, grown.y(), 0, 0, 0,                //
      0, 0, at.x() * at.x(), at.y() * at.y(), at.x() * at.y();
  Eigen::Matrix<double, 5, 1> values;
  values << shape.stretch, shape.growth, shape.bow;
  result.point = Vector3d(drawn.x(), drawn.y(), 0) + result.by_shape * values;
  return result;
}

// How a corner moves when both sides that meet there move outward: by one pixel, and by one divided
// by the thickness of their strokes in pixels.
struct EdgeMotion {
  Vector2d by_edge;
  Vector2d by_thin_stroke;
};

// Pixels a metre across the left and right sides, and across the upper and lower ones.
Vector2d px_across(const Vector2d& right, const Vector2d& down) {
  const double area = std::abs(right.x() * down.y() - right.y() * down.x());
  return {area / down.norm(), area / right.norm()};
}

// `right` and `down`: the images of the board's directions at the corner, pixels a metre.
EdgeMotion edge_motion(const Vector2d& right, const Vector2d& down, double stroke,
                       std::size_t corner) {
  const double area = right.x() * down.y() - right.y() * down.x();
  const double turn = area > 0 ? 1.0 : -1.0;
  Eigen::Matrix2d normals;  // of the left or right side, and of the upper or lower one
  normals << turn * down.y() / down.norm(), -turn * down.x() / down.norm(),
      -turn * right.y() / right.norm(), turn * right.x() / right.norm();
  const Vector2d out = -inward(corner);
  const Vector2d per_stroke = (stroke * px_across(right, down)).cwiseInverse();
  const Eigen::Matrix2d by_sides = normals.inverse();
  return {by_sides * out, by_sides * out.cwiseProduct(per_stroke)};
}

// Predicted minus seen, and its derivatives by the sighting's own parameters, the camera's and the
// shape's; not whitened.
struct TagRows {
  CornerPixels residual;
  OwnRows own;
  Eigen::Matrix<double, 8, kCameraParameters> by_camera;
  Eigen::Matrix<double, 8, kShapeParameters> by_shape;
};

std::optional<TagRows> tag_rows(const Camera& camera, const BoardPlane& plane,
                                const BoardShape& shape, const SightingState& sighting,
                                const TagObservation& tag, bool derivatives) {
  TagRows rows;
  const Pose& pose = sighting.camera_from_middle;
  for (std::size_t i = 0; i < 4; ++i) {
    const ShapedPoint corner = shaped(plane, shape, tag.on_board[i], i);
    const Vector3d turned = pose.rotation * corner.point;
    const Vector3d point = turned + pose.translation;
    const auto seen = project_with_derivative(camera, point);
    if (!seen) return std::nullopt;
    const auto row = static_cast<Index>(2 * i);
    const Eigen::Matrix<double, 2, 3> by_board = seen->by_point * pose.rotation;
    const EdgeMotion edges = edge_motion(by_board.col(0), by_board.col(1), plane.stroke, i);
    rows.residual.segment<2>(row) = seen->pixel + sighting.edge_px * edges.by_edge +
                                    shape.thin_stroke * edges.by_thin_stroke -
                                    tag.pixels.segment<2>(row);
    if (!derivatives) continue;
    rows.own.middleRows<2>(row) << seen->by_point, -seen->by_point * across(turned), edges.by_edge;
    rows.by_camera.middleRows<2>(row) = by_parameters(camera, point);
    rows.by_shape.middleRows<2>(row) << by_board * corner.by_shape, edges.by_thin_stroke;
  }
  return rows;
}

// --- one linearisation ---

// A sighting's normal equations. Columns: its own, and the shared ones that it depends on.
struct SightingNormal {
  SightingMatrix own = SightingMatrix::Zero();
  OwnByShared cross;
  MatrixXd shared;
  OwnVector own_gradient = OwnVector::Zero();
  VectorXd shared_gradient;
};

class Adjuster {
 public:
  Adjuster(const CalibrationProblem& problem, const AdjustmentOptions& options,
           const CalibrationState& start)
      : problem_(problem), options_(options), basis_(free_parameters(options.form)) {
    if (!options.camera_free) basis_.resize(kCameraParameters, 0);
    prior_mean_ << start.camera.fx, start.camera.fy, (problem.width - 1) / 2.0,
        (problem.height - 1) / 2.0, CameraVector::Zero().tail<8>();
    prior_sigma_ = prior_sigmas(start.camera, outermost(start));
  }

  Index size() const {
    return basis_.cols() + (options_.shapes_free
                                ? kShapeParameters * static_cast<Index>(problem_.planes.size())
                                : 0);
  }

  double cost(const CalibrationState& state) const {
    double sum = prior_cost(state);
    for (std::size_t i = 0; i < problem_.sightings.size(); ++i) {
      if (!problem_.sightings[i].used) continue;
      for (const TagObservation& tag : problem_.sightings[i].tags) {
        if (tag.used) sum += robust(tag_chi_square(problem_, state, i, tag));
      }
    }
    return sum;
  }

  void linearise(const CalibrationState& state) {
    normals_.clear();
    for (std::size_t i = 0; i < problem_.sightings.size(); ++i) {
      normals_.push_back(normal_of(state, i));
    }
    shared_ = MatrixXd::Zero(size(), size());
    gradient_ = VectorXd::Zero(size());
    add_priors(state);
  }

  // The reduced system of the shared parameters, damped by `damping` of the diagonal.
  std::pair<MatrixXd, VectorXd> reduced(double damping) {
    MatrixXd system = shared_;
    VectorXd right = -gradient_;
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      if (!problem_.sightings[i].used) continue;
      const SightingNormal& normal = normals_[i];
      const Columns columns = columns_of(problem_.sightings[i].board);
      const MatrixXd solved = solve_symmetric(damped(normal.own, damping), normal.cross);
      const MatrixXd own_part = normal.cross.transpose() * solved;
      const VectorXd gradient = normal.shared_gradient - solved.transpose() * normal.own_gradient;
      right(columns) -= gradient;
      system(columns, columns) += normal.shared - own_part;
      system.diagonal()(columns) += damping * normal.shared.diagonal();
    }
    return {system, right};
  }

  // The state after the step that this damping makes; nothing when the system is singular.
  std::optional<CalibrationState> stepped(const CalibrationState& state, double damping) {
    VectorXd step(0);
    if (size() > 0) {
      const auto [system, right] = reduced(damping);
      const VectorXd scale = system.diagonal().cwiseSqrt().cwiseInverse();
      if (!scale.allFinite()) return std::nullopt;
      const MatrixXd scaled = scale.asDiagonal() * system * scale.asDiagonal();
      step = scale.cwiseProduct(solve_symmetric(scaled, scale.cwiseProduct(right)).col(0));
      if (!step.allFinite()) return std::nullopt;
    }
    CalibrationState next = state;
    next.camera = with_parameters(state.camera,
                                  parameters_of(state.camera) + basis_ * step.head(basis_.cols()));
    if (!(next.camera.fx > 0) || !(next.camera.fy > 0)) return std::nullopt;
    step_shapes(next, step);
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      if (problem_.sightings[i].used) step_sighting(next.sightings[i], i, step, damping);
    }
    return next;
  }

  const std::vector<SightingNormal>& normals() const { return normals_; }

  // Columns of the shared parameters that sightings of this board depend on.
  Columns columns_of(std::size_t board) const {
    Columns columns(basis_.cols() + (options_.shapes_free ? kShapeParameters : 0));
    for (Index i = 0; i < columns.size(); ++i) {
      columns[i] = i < basis_.cols() ? i : first_of(board) + i - basis_.cols();
    }
    return columns;
  }

  static SightingMatrix damped(SightingMatrix own, double damping) {
    own.diagonal() *= 1 + damping;
    return own;
  }

  // Whitened rows of a tag as weighted by the robust cost; nothing where it cannot be seen.
  std::optional<TagRows> whitened(const CalibrationState& state, std::size_t index,
                                  const TagObservation& tag) const {
    const BoardSighting& sighting = problem_.sightings[index];
    auto rows = tag_rows(state.camera, problem_.planes[sighting.board],
                         state.shapes[sighting.board], state.sightings[index], tag, true);
    if (!rows) return std::nullopt;
    rows->residual = tag.whitening * rows->residual;
    const double weight = root_weight(rows->residual.squaredNorm()) / options_.scale;
    const CornerCovariance whitening = weight * tag.whitening;
    rows->residual *= weight;
    rows->own = whitening * rows->own;
    rows->by_camera = whitening * rows->by_camera;
    rows->by_shape = whitening * rows->by_shape;
    return rows;
  }

 private:
  // The first column of a board's shape.
  Index first_of(std::size_t board) const {
    return basis_.cols() + kShapeParameters * static_cast<Index>(board);
  }

  // The radius (of a fisheye the angle) of the outermost corner seen, in the plane z = 1 of a
  // camera without distortion.
  double outermost(const CalibrationState& start) const {
    const Vector2d center(start.camera.cx, start.camera.cy);
    double radius = 0.1;  // so that a coefficient of a long lens stays a number
    for (const BoardSighting& sighting : problem_.sightings) {
      for (const TagObservation& tag : sighting.tags) {
        for (Index i = 0; i < 4; ++i) {
          const double r = (tag.pixels.segment<2>(2 * i) - center).norm() / start.camera.fx;
          radius = std::max(radius, r);
        }
      }
    }
    return radius;
  }

  double robust(double chi_square) const {
    const double s = chi_square / (options_.scale * options_.scale);
    if (options_.huber == 0 || s <= options_.huber * options_.huber) return s;
    return options_.huber * (2 * std::sqrt(s) - options_.huber);
  }

  double root_weight(double chi_square) const {
    const double s = std::sqrt(chi_square) / options_.scale;
    return options_.huber == 0 || s <= options_.huber ? 1 : std::sqrt(options_.huber / s);
  }

  CameraVector camera_prior(const CalibrationState& state) const {
    return (parameters_of(state.camera) - prior_mean_).cwiseQuotient(prior_sigma_);
  }

  double prior_cost(const CalibrationState& state) const {
    double sum = camera_prior(state).squaredNorm();
    for (std::size_t b = 0; b < problem_.planes.size(); ++b) {
      sum += shape_prior(state, b).squaredNorm();
    }
    for (const SightingState& sighting : state.sightings) {
      sum += std::pow(sighting.edge_px / kEdgeSigma, 2);
    }
    return sum;
  }

  Eigen::Matrix<double, kShapeParameters, 1> shape_prior(const CalibrationState& state,
                                                         std::size_t board) const {
    const BoardShape& shape = state.shapes[board];
    Eigen::Matrix<double, kShapeParameters, 1> values;
    values << shape.stretch, shape.growth, shape.bow, shape.thin_stroke;
    return values.cwiseQuotient(shape_sigmas(problem_.planes[board]));
  }

  void add_priors(const CalibrationState& state) {
    const auto by_prior = prior_sigma_.cwiseInverse().asDiagonal() * basis_;
    const Index camera = basis_.cols();
    if (camera > 0) {
      shared_.topLeftCorner(camera, camera) = by_prior.transpose() * MatrixXd(by_prior);
      gradient_.head(camera) = by_prior.transpose() * camera_prior(state);
    }
    if (!options_.shapes_free) return;
    for (std::size_t b = 0; b < problem_.planes.size(); ++b) {
      const auto sigma = shape_sigmas(problem_.planes[b]);
      shared_.diagonal().segment<kShapeParameters>(first_of(b)) += sigma.cwiseAbs2().cwiseInverse();
      gradient_.segment<kShapeParameters>(first_of(b)) +=
          shape_prior(state, b).cwiseQuotient(sigma);
    }
  }

  SightingNormal normal_of(const CalibrationState& state, std::size_t index) const {
    const BoardSighting& sighting = problem_.sightings[index];
    const Index count = basis_.cols() + (options_.shapes_free ? kShapeParameters : 0);
    SightingNormal normal;
    normal.cross = OwnByShared::Zero(kSightingParameters, count);
    normal.shared = MatrixXd::Zero(count, count);
    normal.shared_gradient = VectorXd::Zero(count);
    const double edge = state.sightings[index].edge_px;
    normal.own(6, 6) = 1 / (kEdgeSigma * kEdgeSigma);
    normal.own_gradient[6] = edge / (kEdgeSigma * kEdgeSigma);
    for (const TagObservation& tag : sighting.tags) {
      if (!tag.used) continue;
      const auto rows = whitened(state, index, tag);
      if (!rows) continue;
      SharedRows shared(8, count);
      shared.leftCols(basis_.cols()) = rows->by_camera.lazyProduct(basis_);
      if (options_.shapes_free) shared.rightCols<kShapeParameters>() = rows->by_shape;
      // Eigen's blocked products cost more than they save at these sizes.
      normal.own += rows->own.transpose().lazyProduct(rows->own);
      normal.cross += rows->own.transpose().lazyProduct(shared);
      normal.shared += shared.transpose().lazyProduct(shared);
      normal.own_gradient += rows->own.transpose() * rows->residual;
      normal.shared_gradient += shared.transpose() * rows->residual;
    }
    return normal;
  }

  void step_shapes(CalibrationState& next, const VectorXd& step) const {
    if (!options_.shapes_free) return;
    for (std::size_t b = 0; b < next.shapes.size(); ++b) {
      const auto own = step.segment<kShapeParameters>(first_of(b));
      next.shapes[b].stretch += own[0];
      next.shapes[b].growth += own[1];
      next.shapes[b].bow += own.segment<3>(2);
      next.shapes[b].thin_stroke += own[5];
    }
  }

  void step_sighting(SightingState& next, std::size_t index, const VectorXd& step,
                     double damping) const {
    const SightingNormal& normal = normals_[index];
    const VectorXd shared = step(columns_of(problem_.sightings[index].board));
    const OwnVector own =
        solve_symmetric(damped(normal.own, damping), -normal.own_gradient - normal.cross * shared);
    next.camera_from_middle.translation += own.head<3>();
    next.camera_from_middle.rotation =
        rotation_of(own.segment<3>(3)) * next.camera_from_middle.rotation;
    next.edge_px += own[6];
  }

  const CalibrationProblem& problem_;
  AdjustmentOptions options_;
  Eigen::Matrix<double, kCameraParameters, Eigen::Dynamic> basis_;
  CameraVector prior_mean_;
  CameraVector prior_sigma_;
  std::vector<SightingNormal> normals_;
  MatrixXd shared_;
  VectorXd gradient_;
};

// The inverse of a symmetric matrix whose rows differ widely in size; nothing when it is singular.
std::optional<MatrixXd> inverse_of(const MatrixXd& matrix) {
  const VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const auto inverse = inverse_of_positive(scale.asDiagonal() * matrix * scale.asDiagonal());
  if (!inverse) return std::nullopt;
  return MatrixXd(scale.asDiagonal() * *inverse * scale.asDiagonal());
}

// One sighting with a separate camera, its pose adapting.
OwnCamera own_camera(const Adjuster& adjuster, const CalibrationProblem& problem,
                     const CalibrationState& state, std::size_t index) {
  using Three = Eigen::Matrix<double, 8, 3>;  // by focal length, cx, cy
  Eigen::Matrix<double, kSightingParameters, 3> cross =
      Eigen::Matrix<double, kSightingParameters, 3>::Zero();
  OwnVector own_gradient = OwnVector::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  for (const TagObservation& tag : problem.sightings[index].tags) {
    if (!tag.used) continue;
    const auto rows = adjuster.whitened(state, index, tag);
    if (!rows) continue;
    Three by;
    by << state.camera.fx * rows->by_camera.col(0) + state.camera.fy * rows->by_camera.col(1),
        rows->by_camera.col(2), rows->by_camera.col(3);
    cross += rows->own.transpose() * by;
    own_gradient += rows->own.transpose() * rows->residual;
    square += by.transpose() * by;
    gradient += by.transpose() * rows->residual;
  }
  const MatrixXd solved = solve_symmetric(adjuster.normals()[index].own, cross);
  const Eigen::Matrix3d left = square - cross.transpose() * solved;
  const Vector3d right = gradient - solved.transpose() * own_gradient;
  OwnCamera own;
  if (left(0, 0) > 1e-9 * square(0, 0)) {
    own.focal_change = -right[0] / left(0, 0);
    own.focal_sigma = 1 / std::sqrt(left(0, 0));
  }
  // In units in which the diagonal is 1: what the photo does not determine has no effect.
  const Vector3d scale = left.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const PrincipalAxes axes = principal_axes(scale.asDiagonal() * left * scale.asDiagonal());
  const Vector3d along = axes.vectors.transpose() * scale.cwiseProduct(right);
  for (Index i = 0; i < 3; ++i) {
    if (!(axes.values[i] > 1e-6)) continue;
    own.chi_square += along[i] * along[i] / axes.values[i];
    ++own.degrees;
  }
  return own;
}

std::optional<TagObservation> observation_of(const Board& board, const BoardPlane& plane,
                                             const SeenBoardTag& seen) {
  MatrixXd whitening = CornerCovariance::Identity();
  if (!seen.pixels.allFinite() || !whiten(whitening, seen.covariance)) return std::nullopt;
  TagObservation tag;
  tag.tag = seen.tag;
  const std::array<PlatePoint, 4> corners = corners_of(board, board.tags[seen.tag]);
  for (std::size_t i = 0; i < 4; ++i) {
    tag.on_board[i] = Vector2d(corners[i].x, corners[i].y) - plane.middle;
  }
  tag.pixels = seen.pixels;
  tag.whitening = whitening;
  return tag;
}

}  // namespace

CalibrationProblem calibration_problem(std::span<const BoardView> views,
                                       std::span<const Board> boards) {
  CalibrationProblem problem;
  for (const Board& board : boards) {
    const Vector2d half(board.scale[0] * board.width / 2, board.scale[1] * board.height / 2);
    problem.planes.push_back({half, half, board.scale_sigma, board.tag.frame_stroke});
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    problem.width = views[v].width;
    problem.height = views[v].height;
    std::map<std::size_t, BoardSighting> by_board;
    for (const SeenBoardTag& seen : views[v].tags) {
      auto tag = observation_of(boards[seen.board], problem.planes[seen.board], seen);
      if (!tag) continue;
      BoardSighting& sighting = by_board[seen.board];
      sighting.view = v;
      sighting.board = seen.board;
      sighting.tags.push_back(std::move(*tag));
    }
    for (auto& entry : by_board) problem.sightings.push_back(std::move(entry.second));
  }
  return problem;
}

std::optional<CornerPixels> residual_of(const CalibrationProblem& problem,
                                        const CalibrationState& state, std::size_t sighting,
                                        const TagObservation& tag) {
  const std::size_t board = problem.sightings[sighting].board;
  const auto rows = tag_rows(state.camera, problem.planes[board], state.shapes[board],
                             state.sightings[sighting], tag, false);
  if (!rows) return std::nullopt;
  return CornerPixels(-rows->residual);
}

double mean_edge(const CalibrationProblem& problem, const CalibrationState& state,
                 std::size_t sighting) {
  const std::size_t board = problem.sightings[sighting].board;
  const BoardPlane& plane = problem.planes[board];
  const BoardShape& shape = state.shapes[board];
  const Pose& pose = state.sightings[sighting].camera_from_middle;
  double sum = 0;
  double count = 0;
  for (const TagObservation& tag : problem.sightings[sighting].tags) {
    const Vector3d corner(tag.on_board[0].x(), tag.on_board[0].y(), 0);
    const auto seen = project_with_derivative(state.camera, pose * corner);
    if (!seen || !tag.used) continue;
    const Eigen::Matrix<double, 2, 3> by_board = seen->by_point * pose.rotation;
    const Vector2d per_meter = px_across(by_board.col(0), by_board.col(1));
    const Vector2d strokes = plane.stroke * per_meter;
    sum += (shape.thin_stroke * strokes.cwiseInverse() - shape.growth * per_meter).mean();
    count += 1;
  }
  return state.sightings[sighting].edge_px + (count > 0 ? sum / count : 0);
}

double tag_chi_square(const CalibrationProblem& problem, const CalibrationState& state,
                      std::size_t sighting, const TagObservation& tag) {
  const auto residual = residual_of(problem, state, sighting, tag);
  return residual ? std::min((tag.whitening * *residual).squaredNorm(), kUnseen) : kUnseen;
}

CalibrationFit adjust_calibration(const CalibrationProblem& problem, const CalibrationState& start,
                                  const AdjustmentOptions& options) {
  constexpr double kConverged = 1e-7;  // of the cost: hundredths of a standard deviation
  constexpr double kMostDamping = 1e8;
  constexpr double kFree = 0.01;  // damping that leaves a step almost unshortened
  Adjuster adjuster(problem, options, start);
  CalibrationFit fit{start, adjuster.cost(start)};
  double damping = 1e-3;
  for (int iteration = 0; iteration < options.iterations && !fit.converged; ++iteration) {
    adjuster.linearise(fit.state);
    for (bool better = false; !better && !fit.converged;) {
      const auto next = adjuster.stepped(fit.state, damping);
      const double cost = next ? adjuster.cost(*next) : std::numeric_limits<double>::infinity();
      better = cost <= fit.cost;
      if (better) {
        // A short step along the border of what the lens can see does not mean convergence.
        fit.converged = damping < kFree && fit.cost - cost < kConverged * fit.cost + 1e-9;
        fit.cost = cost;
        fit.state = *next;
        damping = std::max(damping / 10, 1e-12);
      } else {
        damping *= 10;
        fit.converged = damping > kMostDamping;  // no step is better: only rounding is left
      }
    }
  }
  return fit;
}

std::optional<CalibrationPrecision> precision_of(const CalibrationProblem& problem,
                                                 const CalibrationState& state,
                                                 const CameraForm& form) {
  Adjuster adjuster(problem, {form}, state);
  adjuster.linearise(state);
  const auto shared = inverse_of(adjuster.reduced(0).first);
  if (!shared) return std::nullopt;
  CalibrationPrecision precision{*shared, {}, {}};
  for (std::size_t i = 0; i < problem.sightings.size(); ++i) {
    const Columns columns = adjuster.columns_of(problem.sightings[i].board);
    const SightingNormal& normal = adjuster.normals()[i];
    const MatrixXd by_shared = solve_symmetric(normal.own, normal.cross);
    SightingMatrix own = solve_symmetric(normal.own, SightingMatrix::Identity());
    own += propagated(by_shared, (*shared)(columns, columns));
    precision.sightings.push_back(own);
    precision.own_cameras.push_back(own_camera(adjuster, problem, state, i));
  }
  return precision;
}

Pose camera_from_board(const BoardPlane& plane, const SightingState& state) {
  const Pose& pose = state.camera_from_middle;
  const Vector3d middle(plane.middle.x(), plane.middle.y(), 0);
  return {pose.rotation, pose.translation - pose.rotation * middle};
}

}  // namespace tagsmith::detail
