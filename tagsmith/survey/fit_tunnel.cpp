// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/fit_tunnel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/QR>
#include <fmt/format.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/fit_plan.hpp"

namespace tagsmith {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

bool is_tag(PointKind kind) { return kind == PointKind::left_tag || kind == PointKind::right_tag; }

// -1 left, 1 right, 0 middle; nothing for points that are anywhere across.
std::optional<int> side_of(PointKind kind) {
  switch (kind) {
    case PointKind::left_tag:
    case PointKind::left_wall:
      return -1;
    case PointKind::right_tag:
    case PointKind::right_wall:
      return 1;
    case PointKind::centerline:
      return 0;
    default:
      return std::nullopt;
  }
}

std::string point_text(const SurveyedPoint& point) {
  return fmt::format("line {}: point {} ({})", point.line, point.name, to_string(point.kind));
}

// ---- Floor and roof: heights over the chainage.

struct HeightPoint {
  double chainage = 0;
  double z = 0;
  std::size_t index = 0;  // of the point
};

std::vector<HeightPoint> floor_points(const std::vector<SurveyedPoint>& points,
                                      const std::vector<double>& chainages,
                                      const std::optional<double>& mount_height) {
  std::vector<HeightPoint> floor;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurveyedPoint& point = points[i];
    const double z = point.in_grid.z();
    if (point.kind == PointKind::floor || point.kind == PointKind::centerline) {
      floor.push_back({chainages[i], z, i});
    } else if (is_tag(point.kind) && (point.height || mount_height)) {
      floor.push_back({chainages[i], z - point.height.value_or(mount_height.value_or(0)), i});
    }
  }
  return floor;
}

// The floor's height at the start, and a grade for each element.
struct Profile {
  double start = 0;
  std::vector<double> grades;
};

// Length of each element before the chainage.
VectorXd lengths_before(const std::vector<CenterlineElement>& elements, double chainage) {
  VectorXd lengths = VectorXd::Zero(static_cast<Eigen::Index>(elements.size()));
  double start = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const bool first = i == 0;
    const bool last = i + 1 == elements.size();
    const double low = first ? chainage : std::max(chainage, start);
    const double within = low - start;
    lengths[static_cast<Eigen::Index>(i)] = last ? within : std::min(within, elements[i].length);
    start += elements[i].length;
  }
  return lengths;
}

Profile fit_profile(const std::vector<CenterlineElement>& elements,
                    const std::vector<HeightPoint>& floor) {
  const auto rows = static_cast<Eigen::Index>(floor.size());
  const auto columns = static_cast<Eigen::Index>(elements.size()) + 1;
  constexpr double kSmooth = 1e-6;  // elements without floor points go on as their neighbours do
  MatrixXd a = MatrixXd::Zero(rows + columns - 1, columns);
  VectorXd b = VectorXd::Zero(a.rows());
  for (Eigen::Index i = 0; i < rows; ++i) {
    const HeightPoint& point = floor[static_cast<std::size_t>(i)];
    a(i, 0) = 1;
    a.row(i).tail(columns - 1) = lengths_before(elements, point.chainage).transpose();
    b[i] = point.z;
  }
  for (Eigen::Index i = 1; i < columns; ++i) {
    a(rows + i - 1, i) = kSmooth;
    if (i > 1) a(rows + i - 1, i - 1) = -kSmooth;
  }
  const VectorXd solution = a.colPivHouseholderQr().solve(b);
  return {solution[0], {solution.data() + 1, solution.data() + solution.size()}};
}

double floor_at(const std::vector<CenterlineElement>& elements, const Profile& profile,
                double chainage) {
  const VectorXd lengths = lengths_before(elements, chainage);
  return profile.start +
         std::inner_product(profile.grades.begin(), profile.grades.end(), lengths.data(), 0.0);
}

double squares(const std::vector<CenterlineElement>& elements,
               const std::vector<HeightPoint>& floor, const Profile& profile) {
  return std::accumulate(floor.begin(), floor.end(), 0.0,
                         [&](double sum, const HeightPoint& point) {
                           const double up = point.z - floor_at(elements, profile, point.chainage);
                           return sum + up * up;
                         });
}

double worst(const std::vector<CenterlineElement>& elements, const std::vector<HeightPoint>& floor,
             const Profile& profile) {
  double most = 0;
  for (const HeightPoint& point : floor) {
    most = std::max(most, std::abs(point.z - floor_at(elements, profile, point.chainage)));
  }
  return most;
}

std::vector<CenterlineElement> split_at(const std::vector<CenterlineElement>& elements,
                                        double chainage) {
  std::vector<CenterlineElement> result;
  double start = 0;
  for (const CenterlineElement& element : elements) {
    const double before = chainage - start;
    start += element.length;
    if (before <= 0.01 || before >= element.length - 0.01) {
      result.push_back(element);
      continue;
    }
    result.push_back({before, element.curvature, 0});
    result.push_back({element.length - before, element.curvature, 0});
  }
  return result;
}

// Every element between two cuts has three floor points or more: one wrong height is no hump.
bool supported(const std::vector<CenterlineElement>& elements,
               const std::vector<HeightPoint>& floor, double cut) {
  constexpr double kSlack = 1e-6;
  double start = 0;
  for (const CenterlineElement& element : elements) {
    const double end = start + element.length;
    const bool beside = std::abs(start - cut) < kSlack || std::abs(end - cut) < kSlack;
    const auto count = std::ranges::count_if(floor, [&](const HeightPoint& point) {
      return point.chainage > start - kSlack && point.chainage < end + kSlack;
    });
    if (beside && count < 3) return false;
    start = end;
  }
  return true;
}

// Elements are cut where the grade changes, at one of at most 60 chainages of floor points, while
// the floor is further off than the tolerance.
std::vector<CenterlineElement> cut_for_grades(std::vector<CenterlineElement> elements,
                                              const std::vector<HeightPoint>& floor,
                                              double tolerance) {
  constexpr std::size_t kMostTried = 60;
  for (int cut = 0; cut < kMostFittedElements; ++cut) {
    const Profile profile = fit_profile(elements, floor);
    if (worst(elements, floor, profile) <= tolerance) break;
    double least = squares(elements, floor, profile);
    std::vector<CenterlineElement> best = elements;
    const std::size_t step = std::max<std::size_t>(1, floor.size() / kMostTried);
    for (std::size_t i = 0; i < floor.size(); i += step) {
      std::vector<CenterlineElement> tried = split_at(elements, floor[i].chainage);
      if (tried.size() == elements.size()) continue;
      if (!supported(tried, floor, floor[i].chainage)) continue;
      const double left = squares(tried, floor, fit_profile(tried, floor));
      if (left >= least) continue;
      least = left;
      best = std::move(tried);
    }
    if (best.size() == elements.size()) break;
    elements = std::move(best);
  }
  return elements;
}

// ---- Ends of the line.

// Elements between two chainages; a line before the first element's start prolongs it.
std::vector<CenterlineElement> trimmed(const std::vector<CenterlineElement>& elements, double from,
                                       double to) {
  std::vector<CenterlineElement> result;
  double start = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const double end = start + elements[i].length;
    const double low = i == 0 ? from : std::max(from, start);
    const double high = i + 1 == elements.size() ? to : std::min(to, end);
    start = end;
    if (high - low > 1e-6) {
      result.push_back(elements[i]);
      result.back().length = high - low;
    }
  }
  return result;
}

// Where the list has its chainage 0, in the fitted line's chainage.
std::optional<double> listed_start(const std::vector<SurveyedPoint>& points,
                                   const std::vector<double>& chainages) {
  std::vector<double> starts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].chainage) starts.push_back(chainages[i] - *points[i].chainage);
  }
  if (starts.empty()) return std::nullopt;
  const auto middle = starts.begin() + static_cast<std::ptrdiff_t>(starts.size() / 2);
  std::ranges::nth_element(starts, middle);
  return *middle;
}

// The same line from a plate's length before the first point to as much beyond the last.
Centerline with_ends(const PlanFit& fit, const std::vector<SurveyedPoint>& points, double margin) {
  const auto [least, most] = std::ranges::minmax(fit.chainages);
  const bool straight = fit.line.elements().front().curvature == 0;
  double from = least - margin;
  if (const auto listed = listed_start(points, fit.chainages)) {
    if (*listed >= 0 || straight) from = std::min(*listed, most - margin);
  }
  if (!straight) from = std::max(from, 0.0);
  const CenterlinePoint start = fit.line.at(from);
  return {start.position, start.heading, trimmed(fit.line.elements(), from, most + margin)};
}

// ---- What is said when it does not work.

Error misfit_error(const std::vector<SurveyedPoint>& points, const PlanFit& fit, double tolerance) {
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::size_t> off;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(fit.residuals[i]) > tolerance) off.push_back(i);
  }
  std::ranges::sort(off, std::greater{}, [&](std::size_t i) { return std::abs(fit.residuals[i]); });
  std::string text = fmt::format(
      "{} of {} points are more than {:.3f} m off the best fit of at most {} lines and arcs, "
      "a tunnel {:.3f} m wide:",
      off.size(), points.size(), tolerance, kMostFittedElements, fit.width);
  for (std::size_t i = 0; i < std::min(kMostNamed, off.size()); ++i) {
    text += fmt::format("\n  {}: {:+.3f} m", point_text(points[off[i]]), fit.residuals[off[i]]);
  }
  if (off.size() > kMostNamed) text += fmt::format("\n  and {} more", off.size() - kMostNamed);
  text += off.size() * 4 <= points.size()
              ? "\nmeasure these again, or take them out"
              : "\nlist the points of each kind along the drive; check their descriptions, the "
                "order of the columns (--order) and the grid's handedness (--x-axis); rough walls "
                "need a larger --tolerance";
  return {text};
}

Result<void> check_sides(const std::vector<PlanPoint>& points, const PlanFit& fit) {
  if (std::ranges::none_of(points, [](const PlanPoint& point) { return point.side != 0; })) {
    return {};
  }
  double apart = 0;  // right minus left
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = points[i].offset.value_or(points[i].side * fit.width / 2);
    apart += points[i].side * (fit.residuals[i] + expected);
  }
  if (apart > 0) return {};
  return fail(
      "the left points lie to the right of the right ones, along the order of the list: are left "
      "and right exchanged, the points listed against the drive, east and north exchanged "
      "(--order), "
      "or does the grid's x grow to the left (--x-axis left)?");
}

double rms(const std::vector<double>& values) {
  if (values.empty()) return 0;
  const double sum = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// Points with a place across the tunnel, in the world, and which of the list they are.
struct PlanInput {
  std::vector<PlanPoint> points;
  std::vector<SurveyedPoint> sources;
  std::vector<std::size_t> indices;
  std::vector<Eigen::Vector2d> rough;  // center line; empty = not known
};

// Between each left point and the right one nearest in chainage, as their listed offsets divide the
// way; in the order of the points.
std::vector<Eigen::Vector2d> rough_center(const std::vector<PlanPoint>& points,
                                          const std::vector<SurveyedPoint>& sources) {
  std::vector<std::size_t> lefts;
  std::vector<std::size_t> rights;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].side != 0) (points[i].side < 0 ? lefts : rights).push_back(i);
  }
  std::vector<Eigen::Vector2d> center;
  if (rights.empty()) return center;
  const auto chainage = [&](std::size_t i) { return sources[i].chainage.value_or(0); };
  std::size_t next = 0;  // both lists go along the drive
  for (const std::size_t left : lefts) {
    while (next + 1 < rights.size() && std::abs(chainage(rights[next + 1]) - chainage(left)) <=
                                           std::abs(chainage(rights[next]) - chainage(left))) {
      ++next;
    }
    const double a = std::abs(*points[left].offset);
    const double b = std::abs(*points[rights[next]].offset);
    if (a + b <= 0) continue;
    center.emplace_back(points[left].p + a / (a + b) * (points[rights[next]].p - points[left].p));
  }
  return center;
}

bool has_offsets(const std::vector<SurveyedPoint>& points) {
  return std::ranges::all_of(points, [](const SurveyedPoint& p) { return p.offset.has_value(); });
}

// `measured_walls`: only what does not depend on where the walls are.
PlanInput plan_input(const std::vector<SurveyedPoint>& points, const Grid& grid,
                     const TagTemplate& tag, bool measured_walls) {
  // Where the list says chainages, its order need not be that of the drive.
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {},
                           [&](std::size_t i) { return points[i].chainage.value_or(0); });
  PlanInput input;
  for (const std::size_t i : order) {
    const std::optional<int> side = side_of(points[i].kind);
    if (!side || (measured_walls && *side != 0 && !points[i].offset)) continue;
    const Vector3d p = world_from_grid(grid, points[i].in_grid);
    const double half = is_tag(points[i].kind) ? tag.frame_inner_length / 2 : 0;
    const auto offset = measured_walls ? points[i].offset : std::nullopt;
    input.points.push_back({p.head<2>(), *side, half, offset});
    input.sources.push_back(points[i]);
    input.indices.push_back(i);
  }
  if (measured_walls && has_offsets(input.sources)) {
    input.rough = rough_center(input.points, input.sources);
  }
  return input;
}

Result<void> check_has_walls(const std::vector<SurveyedPoint>& points) {
  const auto on_side = [&](int side) {
    return std::ranges::any_of(points,
                               [&](const SurveyedPoint& p) { return side_of(p.kind) == side; });
  };
  if (on_side(-1) && on_side(1)) return {};
  return fail(std::string("no points on the ") + (on_side(-1) ? "right" : "left") +
              " wall (TL, TR, WL, WR or names of tags): the width cannot be known");
}

Result<PlanFit> fit_input(PlanInput input, double tolerance) {
  if (input.points.empty()) return fail("no points of walls, center line or tags");
  // National coordinates are long; near zero nothing of them is lost.
  const Eigen::Vector2d shift = input.points.front().p;
  for (PlanPoint& point : input.points) point.p -= shift;
  for (Eigen::Vector2d& point : input.rough) point -= shift;
  std::optional<PlanFit> fit = fit_plan(input.points, tolerance, kMostFittedElements, input.rough);
  if (!fit) {
    return fail("too few points: expected two along the center line (CL), or two on either wall");
  }
  if (auto sides = check_sides(input.points, *fit); !sides) return fail(sides.error().message);
  const bool fits =
      std::ranges::all_of(fit->residuals, [&](double r) { return std::abs(r) <= tolerance; });
  if (!fits) return tl::unexpected(misfit_error(input.sources, *fit, tolerance));
  const CenterlinePoint start = fit->line.at(0);
  const Vector3d back(shift.x(), shift.y(), 0);
  fit->line = Centerline(start.position + back, start.heading, fit->line.elements());
  return *fit;
}

// Without the stations that lie on the line between those kept, to half a millimetre.
std::vector<ProfileStation> simplified(const std::vector<ProfileStation>& stations) {
  constexpr double kSame = 5e-4;
  constexpr std::size_t kMostLeftOut = 200;  // in a row: keeps the work linear
  std::vector<ProfileStation> kept{stations.front()};
  std::size_t start = 0;
  while (start + 1 < stations.size()) {
    std::size_t end = start + 1;
    const auto fits = [&](std::size_t next) {
      const ProfileStation& a = stations[start];
      const ProfileStation& b = stations[next];
      for (std::size_t i = start + 1; i < next; ++i) {
        const double share = (stations[i].chainage - a.chainage) / (b.chainage - a.chainage);
        if (std::abs(a.value + share * (b.value - a.value) - stations[i].value) > kSame) {
          return false;
        }
      }
      return true;
    };
    while (end + 1 < stations.size() && end - start < kMostLeftOut && fits(end + 1)) ++end;
    kept.push_back(stations[end]);
    start = end;
  }
  return kept;
}

// The profile through the stations. Those within 5 cm of each other along the drive become one:
// their mean, or the farthest where they contradict each other (rock is behind what stands before
// it).
ChainageProfile through(std::vector<ProfileStation> stations) {
  constexpr double kOne = 0.05;
  constexpr double kContradict = 0.1;
  std::ranges::sort(stations, {}, &ProfileStation::chainage);
  std::vector<ProfileStation> merged;
  for (std::size_t i = 0; i < stations.size();) {
    ProfileStation sum;
    double least = stations[i].value;
    double most = least;
    std::size_t end = i;
    for (; end < stations.size() && stations[end].chainage - stations[i].chainage < kOne; ++end) {
      sum.chainage += stations[end].chainage;
      sum.value += stations[end].value;
      least = std::min(least, stations[end].value);
      most = std::max(most, stations[end].value);
    }
    const auto count = static_cast<double>(end - i);
    const double farthest = std::abs(least) > std::abs(most) ? least : most;
    const double value = most - least > kContradict ? farthest : sum.value / count;
    const auto rounded = [](double length) { return std::round(length * 1e6) / 1e6; };
    merged.push_back({rounded(sum.chainage / count), rounded(value)});
    i = end;
  }
  return ChainageProfile(simplified(merged));
}

// A plate that looks along the drive rather than across it hangs on no wall.
bool hangs_on_wall(const SurveyedPoint& point, const Grid& grid, double drive_heading) {
  constexpr double kMostTurned = radians(20);
  if (!point.attitude || !point.attitude->facing) return true;
  const double away = side_of(point.kind) == -1 ? radians(90) : radians(-90);
  const double facing = world_heading_from_grid(grid, *point.attitude->facing);
  return std::abs(std::remainder(facing - drive_heading - away, 2 * std::numbers::pi)) <
         kMostTurned;
}

// The wall through the points of one side of the center line.
Result<ChainageProfile> wall_through(const std::vector<SurveyedPoint>& points, const Grid& grid,
                                     const Centerline& line, Side side) {
  const int wanted = side == Side::left ? -1 : 1;
  std::vector<ProfileStation> stations;
  for (const SurveyedPoint& point : points) {
    if (side_of(point.kind) != wanted) continue;
    const CenterlineAddress address = line.locate(world_from_grid(grid, point.in_grid).head<2>());
    if (wanted * address.offset <= 0) {
      return fail(point_text(point) + " lies on the other side of the center line");
    }
    if (!hangs_on_wall(point, grid, line.at(address.chainage).heading)) continue;
    stations.push_back({address.chainage, address.offset});
  }
  if (stations.empty()) {
    return fail("no points on the " + to_string(side) + " wall: tags there look along the drive");
  }
  return through(std::move(stations));
}

// A roof through its points (RF), or through the heights that the list says.
std::optional<ChainageProfile> roof_through(const std::vector<SurveyedPoint>& points,
                                            const Grid& grid, const Centerline& line) {
  std::vector<ProfileStation> stations;
  for (const SurveyedPoint& point : points) {
    const Vector3d p = world_from_grid(grid, point.in_grid);
    const double chainage = line.locate(p.head<2>()).chainage;
    if (point.tunnel_height) stations.push_back({chainage, *point.tunnel_height});
    if (point.kind != PointKind::roof) continue;
    stations.push_back({chainage, p.z() - line.at(chainage).position.z()});
  }
  if (stations.empty()) return std::nullopt;
  ChainageProfile roof = through(std::move(stations));
  if (roof.least() == roof.greatest()) return ChainageProfile(roof.least());
  return roof;
}

Result<void> measure_walls(Tunnel& tunnel, const std::vector<SurveyedPoint>& points,
                           const Grid& grid) {
  const auto left = wall_through(points, grid, tunnel.centerline, Side::left);
  const auto right = wall_through(points, grid, tunnel.centerline, Side::right);
  if (!left) return tl::unexpected(left.error());
  if (!right) return tl::unexpected(right.error());
  tunnel.left = *left;
  tunnel.right = *right;
  return {};
}

Result<double> roof_height(const std::vector<SurveyedPoint>& points, const Grid& grid,
                           const Centerline& line, const TunnelFitOptions& options) {
  std::vector<double> heights;
  for (const SurveyedPoint& point : points) {
    if (point.kind != PointKind::roof) continue;
    const Vector3d p = world_from_grid(grid, point.in_grid);
    heights.push_back(p.z() - line.at(line.locate(p.head<2>()).chainage).position.z());
  }
  if (heights.empty() && options.roof_height) return *options.roof_height;
  if (heights.empty()) return fail("no points of the roof (RF): give its height, --tunnel-height");
  const double mean =
      std::accumulate(heights.begin(), heights.end(), 0.0) / static_cast<double>(heights.size());
  if (mean > 0) return std::round(mean * 1000) / 1000;
  return fail("the points of the roof (RF) lie below the floor");
}

// The plan through the walls' points, and whether the walls were measured beside it.
struct WallPlan {
  PlanInput input;
  PlanFit fit;
  bool measured_walls = false;
};

// Walls that are measured at offsets of their own are taken so where no even width fits.
Result<WallPlan> plan_of_walls(const std::vector<SurveyedPoint>& points, const Grid& grid,
                               const TagTemplate& tag, const TunnelFitOptions& options) {
  PlanInput input = plan_input(points, grid, tag, options.measured_walls);
  Result<PlanFit> plan = fit_input(input, options.tolerance);
  if (plan) return WallPlan{std::move(input), std::move(*plan), options.measured_walls};
  if (options.measured_walls || !has_offsets(points)) return tl::unexpected(plan.error());
  PlanInput by_offsets = plan_input(points, grid, tag, true);
  Result<PlanFit> other = fit_input(by_offsets, options.tolerance);
  if (!other) return tl::unexpected(plan.error());
  return WallPlan{std::move(by_offsets), std::move(*other), true};
}

Result<void> fit_roof(Tunnel& tunnel, const std::vector<SurveyedPoint>& points, const Grid& grid,
                      bool measured_walls, const TunnelFitOptions& options) {
  const bool heights_listed = std::ranges::any_of(
      points, [](const SurveyedPoint& point) { return point.tunnel_height.has_value(); });
  std::optional<ChainageProfile> roof;
  if (measured_walls || heights_listed) roof = roof_through(points, grid, tunnel.centerline);
  if (!roof) {
    const Result<double> height = roof_height(points, grid, tunnel.centerline, options);
    if (!height) return tl::unexpected(height.error());
    roof = *height;
  }
  tunnel.height = *roof;
  return {};
}

// Where the points lie along the tunnel, across the plan and above the floor.
Result<void> add_residuals(TunnelFit& fit, const std::vector<SurveyedPoint>& points,
                           const std::vector<double>& chainages, const WallPlan& plan,
                           const std::vector<HeightPoint>& floor, const Profile& profile,
                           double floor_tolerance) {
  fit.residuals.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) fit.residuals[i].chainage = chainages[i];
  for (std::size_t i = 0; i < plan.input.indices.size(); ++i) {
    fit.residuals[plan.input.indices[i]].across = plan.fit.residuals[i];
  }
  std::vector<double> ups;
  for (const HeightPoint& point : floor) {
    const double up = point.z - floor_at(fit.tunnel.centerline.elements(), profile, point.chainage);
    fit.residuals[point.index].up = up;
    ups.push_back(up);
  }
  const auto most = std::ranges::max_element(ups, {}, [](double up) { return std::abs(up); });
  if (std::abs(*most) > floor_tolerance) {
    const HeightPoint& point = floor[static_cast<std::size_t>(most - ups.begin())];
    return fail(fmt::format("{} is {:+.3f} m above the fitted floor, expected at most {:.3f} m",
                            point_text(points[point.index]), *most, floor_tolerance));
  }
  fit.rms_across = rms(plan.fit.residuals);
  fit.rms_up = rms(ups);
  return {};
}

}  // namespace

Result<TunnelFit> fit_tunnel(const std::vector<SurveyedPoint>& points, const Grid& grid,
                             const TagTemplate& tag, const TunnelFitOptions& options) {
  if (auto walls = check_has_walls(points); !walls) return tl::unexpected(walls.error());
  const Result<WallPlan> plan = plan_of_walls(points, grid, tag, options);
  if (!plan) return tl::unexpected(plan.error());
  const Centerline level = with_ends(plan->fit, plan->input.sources, tag.plate_length);

  std::vector<double> chainages;
  chainages.reserve(points.size());
  for (const SurveyedPoint& point : points) {
    chainages.push_back(level.locate(world_from_grid(grid, point.in_grid).head<2>()).chainage);
  }
  const std::vector<HeightPoint> floor = floor_points(points, chainages, options.mount_height);
  if (floor.empty()) {
    return fail("no points of the floor (CL, FL): give the height of P above it, --mount-height");
  }
  std::vector<CenterlineElement> elements =
      cut_for_grades(level.elements(), floor, options.tolerance);
  const Profile profile = fit_profile(elements, floor);
  constexpr double kLevel = 1e-6;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    elements[i].grade = std::abs(profile.grades[i]) > kLevel ? profile.grades[i] : 0;
  }
  Vector3d start = level.at(0).position;
  start.z() = profile.start;

  TunnelFit fit;
  fit.tunnel = plain_tunnel(plan->fit.width, 0, Centerline(start, level.at(0).heading, elements));
  Result<void> done;
  if (plan->measured_walls) done = measure_walls(fit.tunnel, points, grid);
  if (done) done = fit_roof(fit.tunnel, points, grid, plan->measured_walls, options);
  if (done) {
    done = add_residuals(fit, points, chainages, *plan, floor, profile, options.floor_tolerance);
  }
  if (!done) return tl::unexpected(done.error());
  return fit;
}

}  // namespace tagsmith
