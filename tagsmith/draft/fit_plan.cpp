// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/fit_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/draft/point_order.hpp"
#include "tagsmith/geometry/angle.hpp"
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
constexpr int kAhead = 4;  // elements: a bend, or two that are opposite, show as a whole only

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

double extent_of(const std::vector<PlanPoint>& way) {
  return way.empty() ? -1 : (way.back().p - way.front().p).norm();
}

// The points of a side along the drive. Walls and tags are separate lists, each in order: those of
// the shorter one are inserted into the way of the longer one.
std::vector<PlanPoint> points_of_side(const std::vector<PlanPoint>& points, int side) {
  std::vector<PlanPoint> walls;
  std::vector<PlanPoint> tags;
  for (const PlanPoint& point : points) {
    if (point.side == side) (point.plate_half > 0 ? tags : walls).push_back(point);
  }
  if (extent_of(walls) < extent_of(tags)) std::swap(walls, tags);
  std::vector<PlanPoint> way = thinned(walls, kMostGuidePoints);
  for (const PlanPoint& point : thinned(tags, kMostGuidePoints)) {
    way.insert(way.begin() + static_cast<std::ptrdiff_t>(place_on_way(way, point)), point);
  }
  return way;
}

const PlanPoint& nearest_to(const PlanPoint& point, const std::vector<PlanPoint>& others) {
  return *std::ranges::min_element(
      others, {}, [&](const PlanPoint& other) { return (point.p - other.p).squaredNorm(); });
}

// From each point of the wall that reaches farther to the middle between it and the nearest one of
// the other wall, or to the place that their offsets say. Where that one does not lie across, or
// much farther than usual, the other wall has a gap: then as far across as usual.
std::vector<Vector2d> line_between(const std::vector<PlanPoint>& wall,
                                   const std::vector<PlanPoint>& other) {
  constexpr double kAcross = 0.9;  // cosine
  constexpr double kMostApart = 1.5;
  std::vector<Vector2d> inward;
  std::vector<Vector2d> across;
  std::vector<double> distances;
  for (std::size_t i = 0; i < wall.size(); ++i) {
    const std::size_t next = std::min(i + 1, wall.size() - 1);
    const Vector2d along = wall[next].p - wall[i - std::min<std::size_t>(i, 1)].p;
    inward.push_back(wall[i].side * Vector2d(-along.y(), along.x()).normalized());
    across.push_back(nearest_to(wall[i], other).p - wall[i].p);
    if (across[i].dot(inward[i]) > kAcross * across[i].norm())
      distances.push_back(across[i].norm());
  }
  const double usual = distances.empty() ? 0 : median(distances);
  std::vector<Vector2d> result;
  for (std::size_t i = 0; i < wall.size(); ++i) {
    const PlanPoint& b = nearest_to(wall[i], other);
    const double offsets = wall[i].offset && b.offset ? std::abs(*wall[i].offset - *b.offset) : 0;
    const double share = offsets > 0 ? std::abs(*wall[i].offset) / offsets : 0.5;
    const double apart = across[i].norm();
    const bool gap =
        usual > 0 && (across[i].dot(inward[i]) < kAcross * apart || apart > kMostApart * usual);
    result.push_back(wall[i].p + share * (gap ? Vector2d(usual * inward[i]) : across[i]));
  }
  return result;
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
    std::vector<PlanPoint> wall = points_of_side(points, -1);
    std::vector<PlanPoint> other = points_of_side(points, 1);
    if (wall.size() < 2 || other.size() < 2) return {};
    if (extent_of(wall) < extent_of(other)) std::swap(wall, other);
    guide = line_between(wall, other);
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
      heading = steps.back().heading + wrapped_angle(heading - steps.back().heading);
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
  double lead = 0;  // the line begins so far before the first point, and ends so far after the last
  double total = 0;            // length of the line
  std::vector<bool> straight;  // by element: its curvature is 0, not adjusted
  // Shift of the start to the right of the anchor, heading, width; the elements' lengths but the
  // last one's; their curvatures.
  VectorXd values;

  Eigen::Index count() const { return static_cast<Eigen::Index>(straight.size()); }
  double width() const { return values[2]; }
  // Breaks lie between the first and the last point.
  double length(Eigen::Index i) const {
    constexpr double kLeast = 0.01;
    if (count() == 1) return total;
    if (i == 0) return std::max(lead, values[3]);
    if (i + 1 < count()) return std::max(kLeast, values[3 + i]);
    double left = total - length(0);
    for (Eigen::Index before = 1; before < i; ++before) left -= length(before);
    return std::max(lead, left);
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

Eigen::ArrayXd robust_costs(const VectorXd& residuals, double scale) {
  const auto squares = (residuals / scale).array().square();
  return squares / (1 + squares);
}

// How the values change with each of the model's numbers.
template <class Values>
MatrixXd jacobian_of(const PlanModel& model, const Values& values_of) {
  const VectorXd values = values_of(model);
  MatrixXd jacobian(values.size(), model.values.size());
  for (Eigen::Index i = 0; i < model.values.size(); ++i) {
    const double step = i < 3 || std::abs(model.values[i]) > 1 ? 1e-6 : 1e-8;
    PlanModel moved = model;
    moved.values[i] += step;
    jacobian.col(i) = (values_of(moved) - values) / step;
  }
  return jacobian;
}

// Levenberg-Marquardt on residuals with Geman and McClure's weights, for which a point far off
// counts for nothing; the scale of the weights shrinks to `scale`.
PlanModel adjusted(PlanModel model, const std::vector<PlanPoint>& points, double scale) {
  constexpr int kRounds = 5;
  constexpr double kConverged = 1e-7;  // of the cost
  constexpr double kLeast = 1e-8;  // where both sides of a break bend alike, it may lie anywhere
  VectorXd residuals = residuals_of(model, points);
  double damping = 1e-3;
  for (int round = 0; round < kRounds; ++round) {
    const double used = scale * std::pow(4, kRounds - 1 - round);
    damping = std::min(damping, 1e-3);
    const int iterations = round + 1 < kRounds ? 10 : 40;
    for (int iteration = 0; iteration < iterations && damping < 1e8; ++iteration) {
      const VectorXd weights = (1 + (residuals / used).array().square()).square().inverse();
      const MatrixXd jacobian =
          jacobian_of(model, [&](const PlanModel& at) { return residuals_of(at, points); });
      MatrixXd normal = jacobian.transpose() * weights.asDiagonal() * jacobian;
      normal.diagonal() += damping * normal.diagonal() + VectorXd::Constant(normal.rows(), kLeast);
      PlanModel moved = model;
      moved.values -= solve_symmetric(
          normal, jacobian.transpose() * (weights.array() * residuals.array()).matrix());
      const VectorXd left = residuals_of(moved, points);
      const double before = robust_costs(residuals, used).sum();
      const double after = robust_costs(left, used).sum();
      if (!(after < before)) {
        damping *= 10;
        continue;
      }
      damping = std::max(damping / 10, 1e-12);
      model = moved;
      residuals = left;
      if (before - after < kConverged * before) break;
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

// What is fitted, and what the guide says of it.
struct PlanTask {
  const std::vector<PlanPoint>& points;
  std::vector<Vector2d> guide;
  double tolerance;
  std::vector<PlanPoint> sample = thinned(points, kMostFitted);
  std::vector<HeadingStep> steps = heading_steps(guide);
  HeadingSums sums{steps};
  double width = 2 * reach_of(sample, guide);

  // How far a model begins before the first point, and ends after the last.
  double lead() const { return width + 1; }
};

// The model that the headings suggest.
PlanModel first_model(const PlanTask& task, int count) {
  const auto& steps = task.steps;
  const double lead = task.lead();
  PlanModel model;
  model.straight.resize(static_cast<std::size_t>(count), false);
  model.values = VectorXd::Zero(2 + 2 * count);
  std::size_t from = 0;
  double chainage = -lead;
  Eigen::Index i = 0;
  for (const std::size_t end : best_breaks(task.sums, steps.size(), count)) {
    const HeadingLine line = task.sums.line(from, end);
    const HeadingStep& last = steps[end - 1];
    const double to = last.at + last.length / 2 + (end == steps.size() ? lead : 0);
    if (i == 0) model.values[1] = line.value - line.slope * line.middle;
    if (i + 1 < count) model.values[3 + i] = to - chainage;
    model.values[2 + count + i++] = line.slope;
    chainage = to;
    from = end;
  }
  // Back along the first element by `lead`.
  const double turn = -lead * model.curvature(0);
  model.anchor = task.guide.front() - lead * direction_of(model.values[1] + turn / 2).head<2>();
  model.values[1] += turn;
  model.values[2] = task.width;
  model.lead = lead;
  model.total = chainage + lead;
  model.anchor_heading = model.values[1];
  return model;
}

// Degrees of freedom that are left to the points.
double freedom_of(const PlanModel& model, std::size_t points) {
  const auto straight = std::ranges::count(model.straight, true);
  return static_cast<double>(points) - static_cast<double>(model.values.size() - straight);
}

// The residual from which on a point counts for less and less: eight times the scatter, but no more
// than the tolerance.
double scale_of(const PlanModel& model, const std::vector<PlanPoint>& points, double tolerance) {
  constexpr double kTimes = 8;
  const VectorXd residuals = residuals_of(model, points);
  const double sigma = scatter_of({residuals.begin(), residuals.end()}) *
                       std::sqrt(static_cast<double>(points.size()) /
                                 std::max(1.0, freedom_of(model, points.size())));
  return std::min(tolerance, kTimes * std::max(kFinest, sigma));
}

// Squares of the residuals, of which each counts at most `scale`; points are no better than their
// digits.
double squares_of(const PlanModel& model, const std::vector<PlanPoint>& points, double scale) {
  return scale * scale * robust_costs(residuals_of(model, points), scale).sum() +
         kFinest * kFinest * static_cast<double>(points.size());
}

// What is known of the scatter before a point is seen: as if so many degrees of freedom had shown
// that of a survey that does not state its sigma.
constexpr double kUsual = 0.003;  // metres
constexpr double kFreedomOfUsual = 4;

// Of another shape to fit the points so well by noise alone, as chance_of.
double chance_of_shape(const PlanModel& model, const PlanModel& other,
                       const std::vector<PlanPoint>& points, double scale) {
  const double usual = kUsual * kUsual * kFreedomOfUsual;
  const double freedom = std::max(0.0, freedom_of(other, points.size())) + kFreedomOfUsual;
  const auto more = static_cast<int>(other.count() - model.count());
  return chance_of(squares_of(model, points, scale) + usual,
                   squares_of(other, points, scale) + usual, freedom, std::max(1, more),
                   more > 0 ? static_cast<double>(points.size()) : 1);
}

// The same line with the element at a chainage cut in two.
PlanModel with_cut(const PlanModel& model, double chainage) {
  const Eigen::Index count = model.count();
  std::vector<double> lengths;
  std::vector<double> curvatures;
  double start = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double end = start + model.length(i);
    const bool inside = chainage > start && chainage <= end;
    if (inside) lengths.push_back(chainage - start);
    if (inside) curvatures.push_back(model.curvature(i));
    lengths.push_back(inside ? end - chainage : end - start);
    curvatures.push_back(model.curvature(i));
    start = end;
  }
  PlanModel cut = model;
  cut.straight.assign(lengths.size(), false);
  lengths.pop_back();  // the last one follows from the others
  cut.values.resize(3 + static_cast<Eigen::Index>(lengths.size() + curvatures.size()));
  cut.values << model.values.head<3>(),
      Eigen::Map<VectorXd>(lengths.data(), static_cast<Eigen::Index>(lengths.size())),
      Eigen::Map<VectorXd>(curvatures.data(), static_cast<Eigen::Index>(curvatures.size()));
  return cut;
}

// Whether a model with more elements has less scatter than chance gives it, also without the point
// that gains most: one slip at an end would bend the drive.
bool is_better(const PlanModel& model, const PlanModel& than, const std::vector<PlanPoint>& points,
               double scale) {
  constexpr double kLeastFreedom = 4;
  const double freedom = freedom_of(model, points.size()) - 1;
  if (freedom < kLeastFreedom) return false;
  const PlanModel shorter = adjusted(than, points, scale);
  double before = squares_of(shorter, points, scale), after = squares_of(model, points, scale);
  const Eigen::ArrayXd without = robust_costs(residuals_of(shorter, points), scale);
  const Eigen::ArrayXd with = robust_costs(residuals_of(model, points), scale);
  Eigen::Index most = 0;
  (without - with).maxCoeff(&most);
  before -= scale * scale * without[most];
  after -= scale * scale * with[most];
  const auto more = static_cast<int>(model.count() - than.count());
  return chance_of(before, after, freedom, more, static_cast<double>(points.size())) < kChance;
}

VectorXd headings_of(const PlanModel& model, const std::vector<PlanPoint>& points) {
  const Centerline line = line_of(model);
  VectorXd headings(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    headings[static_cast<Eigen::Index>(i)] =
        line.at(touching_address(line, points[i]).chainage).heading;
  }
  return headings;
}

// The scatter that the points may have, one standard deviation: with 95 % at most so much. What few
// points cannot tell of it is taken as usual.
double greatest_scatter(double squares, double freedom) {
  constexpr double k95Percent = -1.645;
  if (freedom < 1) return kUsual;
  const double least = std::max(0.0, chi_square_limit(static_cast<int>(freedom), k95Percent));
  return std::min(std::sqrt(squares / least), std::max(kUsual, std::sqrt(squares / freedom)));
}

// Variances of the headings beside points by the scatter of all.
VectorXd heading_variances(const PlanModel& model, const std::vector<PlanPoint>& points,
                           const std::vector<PlanPoint>& beside, double squares) {
  const double scatter = greatest_scatter(squares, freedom_of(model, points.size()));
  const MatrixXd of_residuals =
      jacobian_of(model, [&](const PlanModel& at) { return residuals_of(at, points); });
  const MatrixXd of_headings =
      jacobian_of(model, [&](const PlanModel& at) { return headings_of(at, beside); });
  MatrixXd normal = gram(of_residuals);
  normal.diagonal().array() += 1e-12;
  const MatrixXd spread = solve_symmetric(normal, of_headings.transpose());
  return scatter * scatter *
         (of_headings.array() * spread.transpose().array()).rowwise().sum().max(0).matrix();
}

// The greatest standard deviation of the heading beside plates, or beside all points where no plate
// hangs: by the points' scatter, and by how far other shapes differ, as far as the points do not
// rule them out.
double heading_sigma_of(const PlanModel& model, const std::vector<PlanModel>& others,
                        const std::vector<PlanPoint>& points, double tolerance) {
  std::vector<PlanPoint> beside;
  std::ranges::copy_if(points, std::back_inserter(beside),
                       [](const PlanPoint& point) { return point.plate_half > 0; });
  if (beside.empty()) beside = points;
  const double scale = scale_of(model, points, tolerance);
  const auto count = static_cast<double>(points.size());
  const double squares = squares_of(model, points, scale);
  const VectorXd headings = headings_of(model, beside);
  VectorXd variances = heading_variances(model, points, beside, squares);
  for (const PlanModel& other : others) {
    if (squares_of(other, points, scale) > squares) continue;  // no better for all its numbers
    const double chance = chance_of_shape(model, other, points, scale);
    // The odds as by Schwarz's criterion (1978), which asks for more the more points there are.
    const double probability = 1 / (1 + std::sqrt(count) * chance);
    const VectorXd apart = (headings_of(other, beside) - headings).unaryExpr(&wrapped_angle);
    variances += probability * apart.cwiseAbs2();
  }
  return std::sqrt(variances.maxCoeff());
}

// The points whose redundancy number (Baarda) says that the others do not check them.
std::vector<std::size_t> unchecked(const PlanModel& model, const std::vector<PlanPoint>& points,
                                   double tolerance) {
  constexpr double kSlip = 1;  // metres
  const MatrixXd of_residuals =
      jacobian_of(model, [&](const PlanModel& at) { return residuals_of(at, points); });
  MatrixXd normal = gram(of_residuals);
  normal.diagonal().array() += 1e-12;
  const MatrixXd spread = solve_symmetric(normal, of_residuals.transpose());
  const VectorXd followed = (of_residuals.array() * spread.transpose().array()).rowwise().sum();
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double redundancy = 1 - followed[static_cast<Eigen::Index>(i)];
    if (redundancy * kSlip < tolerance) found.push_back(points[i].index);
  }
  return found;
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

// Whether a line runs along the guide once, with elements that are more than a point and arcs whose
// inner wall turns as the line does.
bool is_drive(const PlanTask& task, const PlanModel& model) {
  constexpr double kLonger = 1.2;
  constexpr double kLeastLength = 0.05;  // metres
  double length = 0;
  for (Eigen::Index i = 0; i < model.count(); ++i) {
    const bool turns_within = std::abs(model.curvature(i)) * model.width() / 2 >= 1;
    if (model.length(i) < kLeastLength || turns_within) return false;
    length += model.length(i);
  }
  const HeadingStep& last = task.steps.back();
  return length <= kLonger * (last.at + last.length / 2) + 2 * task.lead();
}

bool fits_all(const PlanTask& task, const PlanModel& model) {
  return is_drive(task, model) && misfits(finished(model, task.points), task.tolerance) == 0;
}

// A model, or a better one that begins as a shorter one with an element cut, anywhere along it: the
// guide says little of the ends, and of breaks between few points.
PlanModel with_better_breaks(const PlanTask& task, const PlanModel& model, const PlanModel& shorter,
                             double scale) {
  constexpr std::size_t kMostTried = 100;  // points that choose the place
  const auto misfit_of = [&](const PlanModel& at, const std::vector<PlanPoint>& points) {
    return std::pair(misfits(finished(at, points), task.tolerance), squares_of(at, points, scale));
  };
  const std::vector<PlanPoint> few = thinned(task.sample, kMostTried);
  PlanModel best = model;
  const Eigen::Index cuts = shorter.count() + 1;
  for (Eigen::Index i = 0; i < cuts; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(cuts);
    const double chainage = shorter.lead + share * (shorter.total - 2 * shorter.lead);
    const PlanModel cut = adjusted(with_cut(shorter, chainage), few, scale);
    if (is_drive(task, cut) && misfit_of(cut, few) < misfit_of(best, few)) best = cut;
  }
  if (few.size() < task.sample.size()) best = adjusted(best, task.sample, scale);
  return misfit_of(best, task.sample) < misfit_of(model, task.sample) ? best : model;
}

// Arcs that the points do not distinguish from lines become lines, as long as no point leaves the
// tolerance.
PlanModel straightened(const PlanTask& task, PlanModel model) {
  const std::vector<PlanPoint>& points = task.sample;
  const double tolerance = task.tolerance;
  constexpr double kMostWorse = 1.5;  // of the squares: few points show no more by chance
  for (Eigen::Index i = 0; i < model.count(); ++i) {
    const double scale = scale_of(model, points, tolerance);
    PlanModel tried = model;
    tried.straight[static_cast<std::size_t>(i)] = true;
    tried.values[2 + model.count() + i] = 0;
    tried = adjusted(tried, points, scale);
    const double before = squares_of(tried, points, scale);
    const double after = squares_of(model, points, scale);
    const double chance = chance_of(before, after, freedom_of(model, points.size()), 1, 1);
    if (chance < kChance || before > kMostWorse * after) continue;
    if (fits_all(task, tried)) model = tried;
  }
  return model;
}

// A shape within the tolerance, and others that the points do not ask for.
struct PlanShapes {
  PlanModel shown;
  std::vector<PlanModel> others;
};

// The model with as many more elements as improve it by more than chance.
PlanShapes grown(const PlanTask& task, PlanModel model, int most) {
  constexpr int kTried = 2;  // elements: one alone may not begin and end a bend
  const std::vector<PlanPoint>& sample = task.sample;
  std::vector<PlanModel> others;
  for (int count = static_cast<int>(model.count()) + 1;
       count <= std::min(most, static_cast<int>(model.count()) + kTried); ++count) {
    const double scale = scale_of(model, sample, task.tolerance);
    PlanModel longer =
        adjusted(adjusted(first_model(task, count), sample, task.tolerance), sample, scale);
    if (count == model.count() + 1) longer = with_better_breaks(task, longer, model, scale);
    if (!fits_all(task, longer)) continue;
    if (!is_better(longer, model, sample, scale)) {
      others.push_back(longer);
      continue;
    }
    model = longer;
    others.clear();
  }
  const PlanModel sharper = adjusted(model, sample, scale_of(model, sample, task.tolerance));
  if (fits_all(task, sharper)) model = sharper;
  const PlanModel shown = straightened(task, model);
  PlanModel bent = shown;  // its lines as arcs
  bent.straight.assign(bent.straight.size(), false);
  others.push_back(adjusted(bent, sample, scale_of(shown, sample, task.tolerance)));
  return {shown, others};
}

PlanFit fit_of(const PlanTask& task, const PlanShapes& shapes) {
  PlanFit fit = finished(shapes.shown, task.points);
  fit.heading_sigma = heading_sigma_of(shapes.shown, shapes.others, task.sample, task.tolerance);
  if (task.sample.size() == task.points.size()) {  // else the others check the sample
    fit.unchecked = unchecked(shapes.shown, task.points, task.tolerance);
  }
  return fit;
}

}  // namespace

double chance_of(double before, double after, double freedom, int pieces, double places) {
  // The tail of the F distribution with an even number of degrees of freedom in its numerator.
  const double share = freedom > 0 ? std::min(1.0, after / before) : 1;
  double term = 1;
  double sum = 0;
  for (int i = 0; i < pieces; ++i) {
    sum += term;
    term *= (freedom / 2 + i) / (i + 1) * (1 - share);
  }
  return std::pow(places, pieces) * std::pow(share, std::max(0.0, freedom) / 2) * sum;
}

std::optional<PlanFit> fit_plan(const std::vector<PlanPoint>& points, double tolerance,
                                int most_elements) {
  std::vector<Vector2d> guide = make_guide(points);
  if (guide.empty()) return std::nullopt;
  const PlanTask task{points, std::move(guide), tolerance};
  const int most = std::min(most_elements, static_cast<int>(task.steps.size()));
  std::optional<PlanFit> closest;
  std::optional<PlanModel> shorter;
  std::optional<PlanModel> best;  // what is off by more than the tolerance is hardly noise
  for (int count = 1; count <= most && (!best || count <= best->count() + kAhead); ++count) {
    PlanModel model = adjusted(first_model(task, count), task.sample, tolerance);
    if (shorter) model = with_better_breaks(task, model, *shorter, tolerance);
    shorter = model;
    if (best && chance_of_shape(*best, model, task.sample, tolerance) >= 1) continue;
    best = model;
    if (closest && !is_drive(task, model)) continue;
    PlanFit fit = finished(model, points);
    const auto off = misfits(fit, tolerance);
    if (off == 0 && is_drive(task, model)) return fit_of(task, grown(task, model, most));
    if (!closest || off < misfits(*closest, tolerance)) closest = std::move(fit);
  }
  return closest;
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
