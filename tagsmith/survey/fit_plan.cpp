// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/fit_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/survey/expected_place.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostGuidePoints = 300;  // the search for breaks takes their square
constexpr std::size_t kMostFitted = 600;       // points of the least-squares fit

// ---- A guide: roughly the center line, as points along the drive.

// At most so many of the values, evenly from the first to the last.
template <class Value>
std::vector<Value> thinned(const std::vector<Value>& values, std::size_t most) {
  if (values.size() <= most) return values;
  std::vector<Value> result;
  for (std::size_t i = 0; i < most; ++i) {
    result.push_back(values[i * (values.size() - 1) / (most - 1)]);
  }
  return result;
}

// The place in the list where the point lengthens the way least.
std::size_t place_on_way(const std::vector<PlanPoint>& way, const PlanPoint& point) {
  double least = kInfinity;
  std::size_t best = 0;
  for (std::size_t i = 0; i <= way.size(); ++i) {
    const bool inside = i > 0 && i < way.size();
    const double to = i > 0 ? (way[i - 1].p - point.p).norm() : 0;
    const double from = i < way.size() ? (way[i].p - point.p).norm() : 0;
    const double detour = to + from - (inside ? (way[i].p - way[i - 1].p).norm() : 0);
    if (detour >= least) continue;
    least = detour;
    best = i;
  }
  return best;
}

// The points of a side along the drive. Walls and tags are separate lists, each in order: those of
// the shorter one are inserted into the way of the longer one.
std::vector<PlanPoint> points_of_side(const std::vector<PlanPoint>& points, int side) {
  std::vector<PlanPoint> walls;
  std::vector<PlanPoint> tags;
  for (const PlanPoint& point : points) {
    if (point.side == side) (point.plate_half > 0 ? tags : walls).push_back(point);
  }
  const auto way_of = [](const std::vector<PlanPoint>& list) {
    return list.empty() ? -1 : (list.back().p - list.front().p).norm();
  };
  if (way_of(walls) < way_of(tags)) std::swap(walls, tags);
  std::vector<PlanPoint> way = thinned(walls, kMostGuidePoints);
  for (const PlanPoint& point : thinned(tags, kMostGuidePoints)) {
    way.insert(way.begin() + static_cast<std::ptrdiff_t>(place_on_way(way, point)), point);
  }
  return way;
}

// Between each left point and the nearest right one: in the middle, or divided by their offsets
// where these are known.
std::vector<Vector2d> line_between(const std::vector<PlanPoint>& left,
                                   const std::vector<PlanPoint>& right) {
  std::vector<Vector2d> result;
  for (const PlanPoint& a : left) {
    const PlanPoint& b = *std::ranges::min_element(
        right, {}, [&](const PlanPoint& other) { return (a.p - other.p).squaredNorm(); });
    const double apart = a.offset && b.offset ? std::abs(*a.offset - *b.offset) : 0;
    const double share = apart > 0 ? std::abs(*a.offset) / apart : 0.5;
    result.push_back(a.p + share * (b.p - a.p));
  }
  return result;
}

double distance_to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - share * along).norm();
}

// Without points that lie far aside from the way between their neighbours, and without steps too
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

std::vector<Vector2d> make_guide(const std::vector<PlanPoint>& points) {
  std::vector<Vector2d> guide;
  for (const PlanPoint& point : points_of_side(points, 0)) guide.push_back(point.p);
  if (guide.size() < 2) {
    const std::vector<PlanPoint> left = points_of_side(points, -1);
    const std::vector<PlanPoint> right = points_of_side(points, 1);
    if (left.size() < 2 || right.size() < 2) return {};
    guide = line_between(left, right);
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

// A line to adjust. Its start lies on the cross line through `anchor`, because nothing says where
// along itself a line begins.
struct PlanModel {
  Vector2d anchor{0, 0};
  double anchor_heading = 0;
  double last_length = 0;
  std::vector<bool> straight;  // by element: its curvature is 0, not adjusted
  // Shift of the start to the right of the anchor, heading, width; the elements' lengths but the
  // last one's; their curvatures.
  VectorXd values;

  Eigen::Index count() const { return static_cast<Eigen::Index>(straight.size()); }
  double width() const { return values[2]; }
  double length(Eigen::Index i) const {
    constexpr double kLeast = 0.01;
    return i + 1 == count() ? last_length : std::max(kLeast, values[3 + i]);
  }
  double curvature(Eigen::Index i) const {
    return straight[static_cast<std::size_t>(i)] ? 0 : values[2 + count() + i];
  }
};

Centerline line_of(const PlanModel& model) {
  std::vector<CenterlineElement> elements;
  for (Eigen::Index i = 0; i < model.count(); ++i) {
    elements.push_back({model.length(i), model.curvature(i), 0});
  }
  const Vector2d start = model.anchor + model.values[0] * right_of(model.anchor_heading).head<2>();
  return {{start.x(), start.y(), 0}, model.values[1], elements};
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
    residuals[static_cast<Eigen::Index>(i)] = residual_of(line, model.width(), points[i]);
  }
  return residuals;
}

double robust_cost(const VectorXd& residuals, double scale) {
  const auto squares = (residuals / scale).array().square();
  return (squares / (1 + squares)).sum();
}

MatrixXd jacobian_of(const PlanModel& model, const std::vector<PlanPoint>& points,
                     const VectorXd& residuals) {
  MatrixXd jacobian(residuals.size(), model.values.size());
  for (Eigen::Index i = 0; i < model.values.size(); ++i) {
    const double step = i < 3 || std::abs(model.values[i]) > 1 ? 1e-6 : 1e-8;
    PlanModel moved = model;
    moved.values[i] += step;
    jacobian.col(i) = (residuals_of(moved, points) - residuals) / step;
  }
  return jacobian;
}

// Levenberg-Marquardt on residuals with Geman and McClure's weights, for which a point far off
// counts for nothing; the scale of the weights shrinks to `scale`.
PlanModel adjusted(PlanModel model, const std::vector<PlanPoint>& points, double scale) {
  constexpr int kRounds = 5;
  constexpr int kIterations = 15;
  VectorXd residuals = residuals_of(model, points);
  for (int round = 0; round < kRounds; ++round) {
    const double used = scale * std::pow(4, kRounds - 1 - round);
    double damping = 1e-3;
    for (int iteration = 0; iteration < kIterations && damping < 1e8; ++iteration) {
      const VectorXd weights = (1 + (residuals / used).array().square()).square().inverse();
      const MatrixXd jacobian = jacobian_of(model, points, residuals);
      MatrixXd normal = jacobian.transpose() * weights.asDiagonal() * jacobian;
      normal.diagonal() += damping * normal.diagonal() + VectorXd::Constant(normal.rows(), 1e-12);
      PlanModel moved = model;
      moved.values -= solve_symmetric(
          normal, jacobian.transpose() * (weights.array() * residuals.array()).matrix());
      const VectorXd left = residuals_of(moved, points);
      const double before = robust_cost(residuals, used);
      const double after = robust_cost(left, used);
      if (!(after < before)) {
        damping *= 10;
        continue;
      }
      damping = std::max(damping / 10, 1e-12);
      model = moved;
      residuals = left;
      if (before - after < 1e-12 * (1 + before)) break;
    }
  }
  return model;
}

// How far the points lie from the guide, as a median.
double reach_of(const std::vector<PlanPoint>& points, const std::vector<Vector2d>& guide) {
  std::vector<double> distances;
  for (const PlanPoint& point : points) {
    double least = kInfinity;
    for (const Vector2d& p : guide) least = std::min(least, (point.p - p).norm());
    if (point.side != 0) distances.push_back(least);
  }
  return distances.empty() ? 0 : median(std::move(distances));
}

// The model that the headings suggest. It starts before the first point and ends `lead` after the
// last.
PlanModel first_model(const std::vector<PlanPoint>& points, const std::vector<Vector2d>& guide,
                      const std::vector<HeadingStep>& steps, const HeadingSums& sums, int count) {
  const double width = 2 * reach_of(points, guide);
  const double lead = width + 1;
  PlanModel model;
  model.straight.resize(static_cast<std::size_t>(count), false);
  model.values = VectorXd::Zero(2 + 2 * count);
  std::size_t from = 0;
  double chainage = -lead;
  Eigen::Index i = 0;
  for (const std::size_t end : best_breaks(sums, steps.size(), count)) {
    const HeadingLine line = sums.line(from, end);
    const HeadingStep& last = steps[end - 1];
    const double to = last.at + last.length / 2 + (end == steps.size() ? lead : 0);
    if (i == 0) model.values[1] = line.value - line.slope * line.middle;
    (i + 1 == count ? model.last_length : model.values[3 + i]) = to - chainage;
    model.values[2 + count + i++] = line.slope;
    chainage = to;
    from = end;
  }
  // Back along the first element by `lead`.
  const double turn = -lead * model.curvature(0);
  model.anchor = guide.front() - lead * direction_of(model.values[1] + turn / 2).head<2>();
  model.values[1] += turn;
  model.values[2] = width;
  model.anchor_heading = model.values[1];
  return model;
}

// Arcs that the points do not distinguish from lines become lines, as long as no point leaves the
// tolerance.
PlanModel straightened(PlanModel model, const std::vector<PlanPoint>& points, double tolerance) {
  constexpr double kSurelyArc = 0.5;  // radians: no trial is needed
  for (Eigen::Index i = 0; i < model.count(); ++i) {
    if (std::abs(model.curvature(i)) * model.length(i) > kSurelyArc) continue;
    PlanModel tried = model;
    tried.straight[static_cast<std::size_t>(i)] = true;
    tried = adjusted(tried, points, tolerance);
    const VectorXd left = residuals_of(tried, points);
    const double before = residuals_of(model, points).squaredNorm();
    // An arc must lower the squares by a third.
    const bool as_good =
        left.squaredNorm() < 1.5 * before + 1e-8 * static_cast<double>(left.size());
    if (as_good && left.cwiseAbs().maxCoeff() <= tolerance) model = tried;
  }
  return model;
}

PlanFit seen_along(Centerline line, double width, const std::vector<PlanPoint>& points) {
  PlanFit fit;
  fit.line = std::move(line);
  fit.width = width;
  for (const PlanPoint& point : points) {
    fit.residuals.push_back(residual_of(fit.line, fit.width, point));
    fit.chainages.push_back(fit.line.locate(point.p).chainage);
  }
  return fit;
}

PlanFit finished(const PlanModel& model, const std::vector<PlanPoint>& points) {
  return seen_along(line_of(model), model.width(), points);
}

std::ptrdiff_t misfits(const PlanFit& fit, double tolerance) {
  return std::ranges::count_if(fit.residuals, [&](double r) { return std::abs(r) > tolerance; });
}

}  // namespace

std::optional<PlanFit> fit_plan(const std::vector<PlanPoint>& points, double tolerance,
                                int most_elements) {
  const std::vector<Vector2d> guide = make_guide(points);
  if (guide.empty()) return std::nullopt;
  const std::vector<HeadingStep> steps = heading_steps(guide);
  const HeadingSums sums(steps);
  const std::vector<PlanPoint> sample = thinned(points, kMostFitted);
  std::optional<PlanFit> best;
  const int most = std::min(most_elements, static_cast<int>(steps.size()));
  for (int count = 1; count <= most; ++count) {
    const PlanModel model =
        adjusted(first_model(sample, guide, steps, sums, count), sample, tolerance);
    PlanFit fit = finished(model, points);
    const auto off = misfits(fit, tolerance);
    if (off == 0) return finished(straightened(model, sample, tolerance), points);
    if (!best || off < misfits(*best, tolerance)) best = std::move(fit);
  }
  return best;
}

PlanFit plan_along(const Centerline& line, const std::vector<PlanPoint>& points) {
  std::vector<double> widths;
  for (const PlanPoint& point : points) {
    if (point.side == 0 || point.offset) continue;
    widths.push_back(2 * point.side * touching_address(line, point).offset);
  }
  return seen_along(line, widths.empty() ? 0 : median(std::move(widths)), points);
}

}  // namespace tagsmith::detail
