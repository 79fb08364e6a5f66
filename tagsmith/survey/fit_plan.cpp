// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/fit_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

namespace tagsmith {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostGuidePoints = 300;  // the search for breaks takes their square
constexpr std::size_t kMostFitted = 2'000;     // points of the least-squares fit

// ---- A guide: roughly the center line, as points along the drive.

std::vector<Vector2d> thinned(const std::vector<Vector2d>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<Vector2d> result;
  for (std::size_t i = 0; i < most; ++i) {
    result.push_back(points[i * (points.size() - 1) / (most - 1)]);
  }
  return result;
}

double way_of(const std::vector<Vector2d>& points) {
  return points.empty() ? -1 : (points.back() - points.front()).norm();
}

// How far along the polyline the point lies; the polyline goes on straight at its ends.
double way_to(const std::vector<Vector2d>& polyline, const Vector2d& point) {
  double least = kInfinity;
  double nearest = 0;
  double start = 0;
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    const Vector2d along = polyline[i] - polyline[i - 1];
    const double length = along.norm();
    if (length == 0) continue;
    const double reached = (point - polyline[i - 1]).dot(along) / length;
    const double low = i == 1 ? -kInfinity : 0;
    const double high = i + 1 == polyline.size() ? kInfinity : length;
    const double kept = std::clamp(reached, low, high);
    const double away = (point - polyline[i - 1] - kept / length * along).norm();
    if (away < least) {
      least = away;
      nearest = start + kept;
    }
    start += length;
  }
  return nearest;
}

// The points of a side along the drive. Walls and tags are lists of their own, each in order: the
// shorter one is sorted into the longer one.
std::vector<Vector2d> points_of_side(const std::vector<PlanPoint>& points, int side) {
  std::vector<Vector2d> walls;
  std::vector<Vector2d> tags;
  for (const PlanPoint& point : points) {
    if (point.side == side) (point.plate_half > 0 ? tags : walls).push_back(point.p);
  }
  if (way_of(walls) < way_of(tags)) std::swap(walls, tags);
  if (walls.size() < 2 || tags.empty()) return walls;
  std::vector<std::pair<double, Vector2d>> all;
  const std::vector<Vector2d> base = thinned(walls, kMostGuidePoints);
  for (const auto& list : {walls, tags}) {
    for (const Vector2d& point : list) all.emplace_back(way_to(base, point), point);
  }
  std::ranges::stable_sort(all, {}, &std::pair<double, Vector2d>::first);
  std::vector<Vector2d> sorted;
  for (const auto& [way, point] : all) sorted.push_back(point);
  return sorted;
}

// Middles between each left point and the nearest right one.
std::vector<Vector2d> middles(const std::vector<Vector2d>& left,
                              const std::vector<Vector2d>& right) {
  std::vector<Vector2d> result;
  for (const Vector2d& a : left) {
    const auto nearest = std::ranges::min_element(
        right, {}, [&](const Vector2d& b) { return (a - b).squaredNorm(); });
    result.push_back((a + *nearest) / 2);
  }
  return result;
}

double distance_to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - share * along).norm();
}

// Without points that stand far aside from the way between their neighbours, and without steps too
// short to have a direction.
std::vector<Vector2d> without_jumps(const std::vector<Vector2d>& guide, double least_step) {
  std::vector<Vector2d> kept;
  for (std::size_t i = 0; i < guide.size(); ++i) {
    if (i > 0 && i + 1 < guide.size()) {
      const double way = (guide[i + 1] - guide[i - 1]).norm();
      const bool aside =
          way > 0 && distance_to_segment(guide[i], guide[i - 1], guide[i + 1]) > 0.5 * way;
      if (aside) continue;
    }
    if (!kept.empty() && (guide[i] - kept.back()).norm() < least_step) continue;
    kept.push_back(guide[i]);
  }
  return kept;
}

std::vector<Vector2d> make_guide(const std::vector<PlanPoint>& points,
                                 const std::vector<Vector2d>& rough) {
  std::vector<Vector2d> guide = rough.empty() ? points_of_side(points, 0) : rough;
  if (guide.size() < 2) {
    const std::vector<Vector2d> left = points_of_side(points, -1);
    const std::vector<Vector2d> right = points_of_side(points, 1);
    if (left.size() < 2 || right.size() < 2) return {};
    guide = middles(thinned(left, kMostGuidePoints), right);
  }
  constexpr double kLeastStep = 0.05;
  guide = without_jumps(thinned(guide, kMostGuidePoints), kLeastStep);
  if (guide.size() < 2) return {};
  return guide;
}

// ---- Breaks: where the heading, over the way, changes from one straight line to another.

struct HeadingStep {
  double at = 0;       // chainage of its middle
  double heading = 0;  // unwrapped
  double length = 0;
};

std::vector<HeadingStep> heading_steps(const std::vector<Vector2d>& guide) {
  std::vector<HeadingStep> steps;
  double chainage = 0;
  for (std::size_t i = 1; i < guide.size(); ++i) {
    const Vector2d way = guide[i] - guide[i - 1];
    double heading = std::atan2(way.x(), way.y());
    if (!steps.empty()) {
      heading = steps.back().heading +
                std::remainder(heading - steps.back().heading, 2 * std::numbers::pi);
    }
    steps.push_back({chainage + way.norm() / 2, heading, way.norm()});
    chainage += way.norm();
  }
  return steps;
}

// heading = value + slope * (chainage - middle) over some steps, weighted by their length.
struct HeadingLine {
  double value = 0;
  double slope = 0;
  double middle = 0;
  double cost = 0;
};

// Sums that give the line over any run of steps at once.
class HeadingSums {
 public:
  explicit HeadingSums(const std::vector<HeadingStep>& steps)
      : sums_(steps.size() + 1, Sums::Zero()) {
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const auto& [s, h, w] = steps[i];
      sums_[i + 1] = sums_[i] + w * Sums(1, s, h, s * s, s * h, h * h);
    }
  }

  HeadingLine line(std::size_t from, std::size_t to) const {
    const Sums sum = sums_[to] - sums_[from];
    const double w = sum[0];
    HeadingLine line;
    line.middle = sum[1] / w;
    line.value = sum[2] / w;
    const double ss = sum[3] - sum[1] * sum[1] / w;
    const double sh = sum[4] - sum[1] * sum[2] / w;
    const double hh = sum[5] - sum[2] * sum[2] / w;
    line.slope = ss > 1e-9 * w ? sh / ss : 0;
    line.cost = std::max(0.0, hh - line.slope * sh);
    return line;
  }

 private:
  using Sums = Eigen::Array<double, 6, 1>;
  std::vector<Sums> sums_;
};

// The runs of steps, as many as `count`, that lines fit best (dynamic programming): their ends.
std::vector<std::size_t> best_breaks(const HeadingSums& sums, std::size_t steps, int count) {
  const auto rows = static_cast<std::size_t>(count);
  std::vector<std::vector<double>> cost(rows + 1, std::vector<double>(steps + 1, kInfinity));
  std::vector<std::vector<std::size_t>> from(rows + 1, std::vector<std::size_t>(steps + 1, 0));
  cost[0][0] = 0;
  for (std::size_t row = 1; row <= rows; ++row) {
    for (std::size_t end = row; end <= steps; ++end) {
      for (std::size_t start = row - 1; start < end; ++start) {
        if (cost[row - 1][start] == kInfinity) continue;
        const double total = cost[row - 1][start] + sums.line(start, end).cost;
        if (total >= cost[row][end]) continue;
        cost[row][end] = total;
        from[row][end] = start;
      }
    }
  }
  std::vector<std::size_t> ends(rows);
  std::size_t end = steps;
  for (std::size_t row = rows; row > 0; --row) {
    ends[row - 1] = end;
    end = from[row][end];
  }
  return ends;
}

// ---- The fit.

// What is adjusted. The start lies on the cross line through `anchor`, because nothing says where
// along itself a line begins.
struct PlanModel {
  Vector2d anchor{0, 0};
  double anchor_heading = 0;
  double shift = 0;  // of the start, to the right of the anchor
  double heading = 0;
  std::vector<double> lengths;  // the last is given, not adjusted
  std::vector<double> curvatures;
  std::vector<bool> straight;  // the curvature is 0, not adjusted
  double width = 0;
};

Centerline line_of(const PlanModel& model) {
  std::vector<CenterlineElement> elements;
  for (std::size_t i = 0; i < model.lengths.size(); ++i) {
    elements.push_back({model.lengths[i], model.straight[i] ? 0 : model.curvatures[i], 0});
  }
  const Vector2d start = model.anchor + model.shift * right_of(model.anchor_heading).head<2>();
  return {{start.x(), start.y(), 0}, model.heading, elements};
}

VectorXd parameters_of(const PlanModel& model) {
  std::vector<double> values{model.shift, model.heading, model.width};
  for (std::size_t i = 0; i + 1 < model.lengths.size(); ++i) values.push_back(model.lengths[i]);
  for (std::size_t i = 0; i < model.curvatures.size(); ++i) {
    if (!model.straight[i]) values.push_back(model.curvatures[i]);
  }
  return Eigen::Map<VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

PlanModel with_parameters(PlanModel model, const VectorXd& values) {
  Eigen::Index next = 0;
  model.shift = values[next++];
  model.heading = values[next++];
  model.width = values[next++];
  for (std::size_t i = 0; i + 1 < model.lengths.size(); ++i) {
    model.lengths[i] = std::max(0.01, values[next++]);
  }
  for (std::size_t i = 0; i < model.curvatures.size(); ++i) {
    if (!model.straight[i]) model.curvatures[i] = values[next++];
  }
  return model;
}

// The point of a plate that touches its wall: the middle of its frame.
CenterlineAddress touching_address(const Centerline& line, const PlanPoint& point) {
  CenterlineAddress address = line.locate(point.p);
  if (point.plate_half == 0) return address;
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Vector2d along = direction_of(line.at(address.chainage).heading).head<2>();
    address = line.locate(Vector2d(point.p - point.side * point.plate_half * along));
  }
  return address;
}

double residual_of(const Centerline& line, double width, const PlanPoint& point) {
  if (point.offset) return line.locate(point.p).offset - *point.offset;
  return touching_address(line, point).offset - point.side * width / 2;
}

VectorXd residuals_of(const PlanModel& model, const std::vector<PlanPoint>& points) {
  const Centerline line = line_of(model);
  VectorXd residuals(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    residuals[static_cast<Eigen::Index>(i)] = residual_of(line, model.width, points[i]);
  }
  return residuals;
}

// Geman and McClure's weights: a point far off counts for nothing.
VectorXd weights_of(const VectorXd& residuals, double scale) {
  return (1 + (residuals / scale).array().square()).square().inverse();
}

double robust_cost(const VectorXd& residuals, double scale) {
  const auto squares = (residuals / scale).array().square();
  return (squares / (1 + squares)).sum();
}

MatrixXd jacobian_of(const PlanModel& model, const std::vector<PlanPoint>& points,
                     const VectorXd& values, const VectorXd& residuals) {
  MatrixXd jacobian(residuals.size(), values.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double step = i < 3 || std::abs(values[i]) > 1 ? 1e-6 : 1e-8;
    VectorXd moved = values;
    moved[i] += step;
    jacobian.col(i) = (residuals_of(with_parameters(model, moved), points) - residuals) / step;
  }
  return jacobian;
}

// Levenberg-Marquardt on reweighted residuals, the scale of the weights shrinking to `scale`.
PlanModel adjusted(PlanModel model, const std::vector<PlanPoint>& points, double scale) {
  constexpr int kRounds = 5;
  constexpr int kIterations = 15;
  for (int round = 0; round < kRounds; ++round) {
    const double used = scale * std::pow(4, kRounds - 1 - round);
    double damping = 1e-3;
    VectorXd values = parameters_of(model);
    VectorXd residuals = residuals_of(model, points);
    for (int iteration = 0; iteration < kIterations && damping < 1e8; ++iteration) {
      const VectorXd weights = weights_of(residuals, used);
      const MatrixXd jacobian = jacobian_of(model, points, values, residuals);
      const MatrixXd normal = jacobian.transpose() * weights.asDiagonal() * jacobian;
      const VectorXd gradient = jacobian.transpose() * weights.asDiagonal() * residuals;
      MatrixXd damped = normal;
      damped.diagonal() += damping * normal.diagonal() + VectorXd::Constant(values.size(), 1e-12);
      const VectorXd tried = values - damped.ldlt().solve(gradient);
      const PlanModel moved = with_parameters(model, tried);
      const VectorXd left = residuals_of(moved, points);
      const double before = robust_cost(residuals, used);
      const double after = robust_cost(left, used);
      if (!(after < before)) {
        damping *= 10;
        continue;
      }
      damping = std::max(damping / 10, 1e-12);
      model = moved;
      values = parameters_of(model);
      residuals = left;
      if (before - after < 1e-12 * (1 + before)) break;
    }
  }
  return model;
}

// The model that the headings suggest. It starts before the first point and ends after the last.
PlanModel first_model(const std::vector<Vector2d>& guide, const std::vector<HeadingStep>& steps,
                      const HeadingSums& sums, int count, double width) {
  const std::vector<std::size_t> ends = best_breaks(sums, steps.size(), count);
  const double lead = width + 1;
  PlanModel model;
  model.width = width;
  std::size_t from = 0;
  double chainage = -lead;
  for (const std::size_t end : ends) {
    const HeadingLine line = sums.line(from, end);
    const HeadingStep& last = steps[end - 1];
    const double to = last.at + last.length / 2 + (end == steps.size() ? lead : 0);
    if (model.lengths.empty()) model.heading = line.value + line.slope * (0 - line.middle);
    model.lengths.push_back(to - chainage);
    model.curvatures.push_back(line.slope);
    model.straight.push_back(false);
    chainage = to;
    from = end;
  }
  // Back along the first element by `lead`.
  const double turn = -lead * model.curvatures.front();
  model.anchor = guide.front() - lead * direction_of(model.heading + turn / 2).head<2>();
  model.heading += turn;
  model.anchor_heading = model.heading;
  return model;
}

double first_width(const std::vector<PlanPoint>& points, const std::vector<Vector2d>& guide) {
  std::vector<double> halves;
  for (const PlanPoint& point : points) {
    if (point.side == 0) continue;
    double least = kInfinity;
    for (std::size_t i = 1; i < guide.size(); ++i) {
      least = std::min(least, distance_to_segment(point.p, guide[i - 1], guide[i]));
    }
    halves.push_back(least);
  }
  if (halves.empty()) return 0;
  const auto middle = halves.begin() + static_cast<std::ptrdiff_t>(halves.size() / 2);
  std::ranges::nth_element(halves, middle);
  return 2 * *middle;
}

// Arcs that are lines as far as the points can tell become lines, as long as no point leaves the
// tolerance.
PlanModel straightened(PlanModel model, const std::vector<PlanPoint>& points, double tolerance) {
  constexpr double kSurelyArc = 0.5;  // radians: saves the trial
  for (std::size_t i = 0; i < model.curvatures.size(); ++i) {
    if (model.straight[i]) continue;
    if (std::abs(model.curvatures[i]) * model.lengths[i] > kSurelyArc) continue;
    PlanModel tried = model;
    tried.straight[i] = true;
    const double before = residuals_of(model, points).squaredNorm();
    tried = adjusted(tried, points, tolerance);
    const VectorXd left = residuals_of(tried, points);
    // An arc earns its place by a third of the squares.
    const bool as_good =
        left.squaredNorm() < 1.5 * before + 1e-8 * static_cast<double>(left.size());
    if (as_good && left.cwiseAbs().maxCoeff() <= tolerance) model = tried;
  }
  return model;
}

std::vector<PlanPoint> sample_of(const std::vector<PlanPoint>& points) {
  if (points.size() <= kMostFitted) return points;
  std::vector<PlanPoint> sample;
  for (std::size_t i = 0; i < kMostFitted; ++i) {
    sample.push_back(points[i * (points.size() - 1) / (kMostFitted - 1)]);
  }
  return sample;
}

PlanFit finished(const PlanModel& model, const std::vector<PlanPoint>& points) {
  PlanFit fit;
  fit.line = line_of(model);
  fit.width = model.width;
  for (const PlanPoint& point : points) {
    fit.residuals.push_back(residual_of(fit.line, fit.width, point));
    fit.chainages.push_back(fit.line.locate(point.p).chainage);
  }
  return fit;
}

std::ptrdiff_t misfits(const PlanFit& fit, double tolerance) {
  return std::ranges::count_if(fit.residuals, [&](double r) { return std::abs(r) > tolerance; });
}

}  // namespace

std::optional<PlanFit> fit_plan(const std::vector<PlanPoint>& points, double tolerance,
                                int most_elements, const std::vector<Vector2d>& rough) {
  if (points.empty()) return std::nullopt;
  const std::vector<Vector2d> guide = make_guide(points, rough);
  if (guide.empty()) return std::nullopt;
  const std::vector<HeadingStep> steps = heading_steps(guide);
  const HeadingSums sums(steps);
  const double width = first_width(points, guide);
  const std::vector<PlanPoint> sample = sample_of(points);
  std::optional<PlanFit> best;
  const int most = std::min(most_elements, static_cast<int>(steps.size()));
  for (int count = 1; count <= most; ++count) {
    PlanModel model = first_model(guide, steps, sums, count, width);
    model = adjusted(std::move(model), sample, tolerance);
    PlanFit fit = finished(model, points);
    const auto off = misfits(fit, tolerance);
    if (off == 0) return finished(straightened(model, sample, tolerance), points);
    if (!best || off < misfits(*best, tolerance)) best = std::move(fit);
  }
  return best;
}

}  // namespace tagsmith
