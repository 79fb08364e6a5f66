// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/fit_tunnel.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/draft/fit_plan.hpp"
#include "tagsmith/draft/point_order.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/survey/expected_place.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// -1 left, 1 right, 0 middle; nothing for points that may lie anywhere across.
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

// ---- The floor: its height over the chainage.

double rms(const VectorXd& values) {
  return values.size() == 0 ? 0
                            : std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

std::vector<HeightStation> floor_points(const std::vector<SurveyedPoint>& points,
                                        const std::vector<double>& chainages,
                                        const std::optional<double>& mount_height) {
  std::vector<HeightStation> floor;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurveyedPoint& point = points[i];
    if (!point.has_height) continue;
    const double z = point.in_grid.z();
    const std::optional<double> above = point.height ? point.height : mount_height;
    if (point.kind == PointKind::floor || point.kind == PointKind::centerline) {
      floor.push_back({chainages[i], z, i});
    } else if (is_tag(point) && above) {
      floor.push_back({chainages[i], z - *above, i});
    }
  }
  return floor;
}

// The center line's elements with the grades that fit the floor's points best.
struct Floor {
  std::vector<CenterlineElement> elements;
  double start = 0;  // height at the first element's start
  VectorXd ups;      // how far each point lies above
};

// Of each element: which grade it has. The arcs of a clothoid share one, and elements with fewer
// floor points than `least` have their neighbour's.
std::vector<Eigen::Index> grades_of(const std::vector<CenterlineElement>& elements,
                                    const std::vector<HeightStation>& floor, std::size_t least) {
  std::vector<Eigen::Index> grades;
  std::size_t points = least;  // of the latest grade
  double start = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const double end = start + elements[i].length;
    const auto within =
        static_cast<std::size_t>(std::ranges::count_if(floor, [&](const HeightStation& point) {
          return (i == 0 || point.chainage >= start) &&
                 (i + 1 == elements.size() || point.chainage <= end);
        }));
    const bool clothoid =
        i > 0 && elements[i].clothoid != 0 && elements[i].clothoid == elements[i - 1].clothoid;
    const bool shared = clothoid || within < least || points < least;
    grades.push_back(i == 0 ? 0 : grades.back() + (shared ? 0 : 1));
    points = shared && i > 0 ? points + within : within;
    start = end;
  }
  return grades;
}

// Length with each grade before the chainage; the first and the last element continue beyond their
// ends.
VectorXd lengths_before(const std::vector<CenterlineElement>& elements,
                        const std::vector<Eigen::Index>& grades, double chainage) {
  VectorXd lengths = VectorXd::Zero(grades.back() + 1);
  double start = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const double within = (i == 0 ? chainage : std::max(chainage, start)) - start;
    const bool is_last = i + 1 == elements.size();
    lengths[grades[i]] += is_last ? within : std::min(within, elements[i].length);
    start += elements[i].length;
  }
  return lengths;
}

Floor fit_floor(const std::vector<CenterlineElement>& elements,
                const std::vector<HeightStation>& points, std::size_t least) {
  const auto rows = static_cast<Eigen::Index>(points.size());
  const std::vector<Eigen::Index> grade_of = grades_of(elements, points, least);
  const Eigen::Index grades = grade_of.back() + 1;
  constexpr double kSmooth = 1e-6;  // elements without floor points continue like their neighbours
  constexpr double kLevel = 1e-6;
  MatrixXd a = MatrixXd::Zero(rows + grades, 1 + grades);
  VectorXd b = VectorXd::Zero(rows + grades);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const HeightStation& point = points[static_cast<std::size_t>(i)];
    a(i, 0) = 1;
    a.row(i).tail(grades) = lengths_before(elements, grade_of, point.chainage).transpose();
    b[i] = point.height;
  }
  for (Eigen::Index i = 0; i < grades; ++i) {
    a(rows + i, 1 + i) = kSmooth;
    if (i > 0) a(rows + i, i) = -kSmooth;
  }
  const VectorXd solution = least_squares(a, b);
  Floor floor{elements, solution[0], (b - a * solution).head(rows)};
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const double grade = solution[1 + grade_of[i]];
    floor.elements[i].grade = std::abs(grade) > kLevel ? grade : 0;
  }
  return floor;
}

// The elements with the one at the chainage cut in two; nothing where it would be cut at its end,
// where a part would have fewer than three floor points (one wrong height is no hump), or in a
// clothoid.
std::optional<std::vector<CenterlineElement>> cut_at(std::vector<CenterlineElement> elements,
                                                     double chainage,
                                                     const std::vector<HeightStation>& floor) {
  constexpr double kSlack = 1e-6;
  const auto points_within = [&](double from, double to) {
    return std::ranges::count_if(floor, [&](const HeightStation& point) {
      return point.chainage > from - kSlack && point.chainage < to + kSlack;
    });
  };
  double start = 0;
  for (auto element = elements.begin(); element != elements.end(); ++element) {
    const double before = chainage - start;
    const double after = element->length - before;
    if (before > 0.01 && after > 0.01) {
      if (element->clothoid != 0) return std::nullopt;
      if (points_within(start, chainage) < 3 || points_within(chainage, chainage + after) < 3) {
        return std::nullopt;
      }
      element->length = after;
      elements.insert(element, {before, element->curvature, 0});
      return elements;
    }
    start += element->length;
  }
  return std::nullopt;
}

// Of a floor with one more element to have less scatter by noise alone.
double chance_of_floor(const Floor& floor, const Floor& cut) {
  const auto points = static_cast<double>(cut.ups.size());
  const double digits = kFinest * kFinest * points;
  const auto numbers = static_cast<double>(1 + cut.elements.size());
  return chance_of(floor.ups.squaredNorm() + digits, cut.ups.squaredNorm() + digits,
                   points - numbers, 1, points);
}

// Elements are cut where the grade changes, at one of at most 60 chainages of floor points, while
// that lowers the scatter by more than chance. What is off by more than the tolerance is hardly
// noise: it needs less proof.
Floor fit_grades(const std::vector<CenterlineElement>& elements,
                 const std::vector<HeightStation>& points, double tolerance) {
  constexpr std::size_t kMostTried = 60;
  std::size_t least = 2;  // points that tell a grade
  Floor floor = fit_floor(elements, points, least);
  if (floor.ups.cwiseAbs().maxCoeff() > tolerance) floor = fit_floor(elements, points, least = 0);
  for (int cut = 0; cut < kMostFittedElements; ++cut) {
    Floor best = floor;
    const std::size_t step = std::max<std::size_t>(1, points.size() / kMostTried);
    for (std::size_t i = 0; i < points.size(); i += step) {
      const auto tried = cut_at(floor.elements, points[i].chainage, points);
      if (!tried) continue;
      Floor other = fit_floor(*tried, points, least);
      if (other.ups.squaredNorm() < best.ups.squaredNorm()) best = std::move(other);
    }
    const bool off = floor.ups.cwiseAbs().maxCoeff() > tolerance;
    if (chance_of_floor(floor, best) >= (off ? 1 : kChance)) break;
    floor = std::move(best);
  }
  return floor;
}

// How far the floor lies below each of the points.
VectorXd ups_of(const Floor& floor, const std::vector<HeightStation>& points) {
  const Centerline line({0, 0, floor.start}, 0, floor.elements);
  VectorXd ups(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    ups[static_cast<Eigen::Index>(i)] = points[i].height - line.at(points[i].chainage).position.z();
  }
  return ups;
}

// The points' places in the order of how far they are off their neighbours, the farthest first.
std::vector<std::size_t> likely_slips(const std::vector<HeightStation>& points) {
  constexpr std::size_t kMost = 4;
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return points[i].chainage; });
  std::vector<HeightStation> sorted;
  for (const std::size_t i : order) sorted.push_back(points[i]);
  const std::vector<NeighbourOff> offs = offs_from_neighbours(sorted);
  std::vector<std::size_t> places(offs.size());
  std::iota(places.begin(), places.end(), 0U);
  std::ranges::stable_sort(places, std::greater{}, [&](std::size_t i) {
    return std::abs(offs[i].off) / offs[i].uncertainty;
  });
  places.resize(std::min(kMost, places.size()));
  for (std::size_t& place : places) place = order[place];
  return places;
}

// As fit_grades, without one to three points whose removal makes the rest fit three times as well:
// grades would follow a slip of the staff. The floor's `ups` are those of all points.
Floor fit_floor_without_slips(const std::vector<CenterlineElement>& elements,
                              const std::vector<HeightStation>& points, double tolerance) {
  constexpr int kMostSlips = 3;
  constexpr double kBetter = 3;
  constexpr std::size_t kMostPoints = 2'000;  // of more, a few have too little effect to try
  Floor floor = fit_grades(elements, points, tolerance);
  std::vector<HeightStation> kept = points;
  for (int slip = 0; slip < kMostSlips && points.size() <= kMostPoints; ++slip) {
    const bool suspect =
        floor.elements.size() > elements.size() || floor.ups.cwiseAbs().maxCoeff() > tolerance;
    if (!suspect) break;
    std::optional<Floor> best;
    std::vector<HeightStation> rest;
    for (const std::size_t i : likely_slips(kept)) {
      std::vector<HeightStation> tried = kept;
      tried.erase(tried.begin() + static_cast<std::ptrdiff_t>(i));
      Floor without = fit_grades(elements, tried, tolerance);
      const double rms_without = rms(without.ups);
      if (kBetter * rms_without > rms(floor.ups) || (best && rms_without >= rms(best->ups)))
        continue;
      best = std::move(without);
      rest = std::move(tried);
    }
    if (!best) break;
    floor = std::move(*best);
    kept = std::move(rest);
  }
  floor.ups = ups_of(floor, points);
  return floor;
}

// ---- Messages when the fit fails.

bool says_offsets(const std::vector<SurveyedPoint>& points) {
  return std::ranges::all_of(points,
                             [](const SurveyedPoint& point) { return point.offset.has_value(); });
}

// Walls of rock that no line follows within the tolerance.
struct Roughness {
  double rms = 0;
  double tolerance = 0;  // that takes them, whole centimetres
};

// The least tolerance, in steps of a third from the residuals of the best fit, with which the
// points fit a tunnel; nothing where even a quarter of its width is not enough.
std::optional<Roughness> roughness_of(const std::vector<PlanPoint>& all, const PlanFit& best,
                                      double tolerance) {
  constexpr std::size_t kMostPoints = 2'000;  // enough to determine the scatter
  constexpr double kStep = 1.33;
  constexpr double kOfWidth = 0.25;
  constexpr double kGreatest = 2;
  std::vector<PlanPoint> points;
  const std::size_t step = 1 + all.size() / kMostPoints;
  for (std::size_t i = 0; i < all.size(); i += step) points.push_back(all[i]);
  std::vector<double> sizes;
  for (const double residual : best.residuals) sizes.push_back(std::abs(residual));
  double tried = std::max(kStep * tolerance, 2 * median(std::move(sizes)));
  while (tried < kGreatest) {
    const double rounded = std::ceil(100 * tried) / 100;
    const std::optional<PlanFit> fit = fit_plan(points, rounded, kMostFittedElements);
    if (!fit || rounded > kOfWidth * fit->width) return std::nullopt;
    const auto residuals = Eigen::Map<const VectorXd>(
        fit->residuals.data(), static_cast<Eigen::Index>(fit->residuals.size()));
    if (residuals.cwiseAbs().maxCoeff() <= rounded) return Roughness{rms(residuals), rounded};
    tried *= kStep;
  }
  return std::nullopt;
}

// Whether most tags lie at points of the other wall, nearer to them than to the middle.
bool tags_are_exchanged(const std::vector<PlanPoint>& fitted, double width) {
  constexpr std::size_t kMostPoints = 500;
  std::vector<PlanPoint> walls;
  std::vector<PlanPoint> tags;
  for (const PlanPoint& point : fitted) {
    if (point.side != 0) (point.plate_half > 0 ? tags : walls).push_back(point);
  }
  walls = evenly_taken(std::move(walls), kMostPoints);
  tags = evenly_taken(std::move(tags), kMostPoints);
  const auto at_other_wall = std::ranges::count_if(tags, [&](const PlanPoint& tag) {
    const auto nearest = std::ranges::min_element(
        walls, {}, [&](const PlanPoint& wall) { return (wall.p - tag.p).squaredNorm(); });
    return nearest != walls.end() && nearest->side != tag.side &&
           (nearest->p - tag.p).norm() < width / 2;
  });
  return 5 * at_other_wall > 4 * std::ssize(tags);
}

// Whether points of a side lie farther apart than the drive is wide: a bend between two of them
// hardly shows.
bool are_sparse(const PlanFit& fit) {
  const auto [first, last] = std::ranges::minmax(fit.chainages);
  return 2 * (last - first) > fit.width * static_cast<double>(fit.chainages.size());
}

// Plates, whose offsets the list states, are not rough.
std::string advice_on(const std::vector<PlanPoint>& fitted, const PlanFit& fit, std::size_t off,
                      double tolerance, bool says_offsets) {
  if (tags_are_exchanged(fitted, fit.width)) {
    return "\nthe tags lie at points of the other wall: "
           "are left and right exchanged in their names, or in WL and WR?";
  }
  const std::string bends =
      are_sparse(fit) ? "\nwhere the drive bends, list more points of its walls or its middle (CL)"
                      : "";
  if (off * 4 <= fitted.size()) return "\nmeasure these again, or take them out" + bends;
  const auto rough = says_offsets ? std::nullopt : roughness_of(fitted, fit, tolerance);
  std::string text;
  if (rough) {
    text = fmt::format(
        "\nthe points scatter by {:.0f} mm rms across the best tunnel that takes them all: for "
        "walls as rough as that, --tolerance {:.0f}; --walls measured then lets the walls run "
        "through their points",
        1000 * rough->rms, 1000 * rough->tolerance);
  }
  return text + bends +
         "\nlist the points of each kind along the drive; check their descriptions, the order of "
         "the columns (--order) and the grid's handedness (--x-axis)";
}

Error misfit_error(const std::vector<SurveyedPoint>& points, const std::vector<PlanPoint>& fitted,
                   const PlanFit& fit, double tolerance, bool along_alignment) {
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::size_t> off;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    if (std::abs(fit.residuals[i]) > tolerance) off.push_back(i);
  }
  std::ranges::sort(off, std::greater{}, [&](std::size_t i) { return std::abs(fit.residuals[i]); });
  std::string text = fmt::format(
      "{} of {} points are more than {:.3f} m off {}, a tunnel {:.3f} m wide:", off.size(),
      fitted.size(), tolerance,
      along_alignment
          ? "the walls beside the file's alignment"
          : fmt::format("the best fit of at most {} lines and arcs", kMostFittedElements),
      fit.width);
  for (std::size_t i = 0; i < std::min(kMostNamed, off.size()); ++i) {
    text += fmt::format("\n  {}: {:+.3f} m", in_words(points[fitted[off[i]].index]),
                        fit.residuals[off[i]]);
  }
  if (off.size() > kMostNamed) text += fmt::format("\n  and {} more", off.size() - kMostNamed);
  return {text + advice_on(fitted, fit, off.size(), tolerance, says_offsets(points))};
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

// The points with a place across the tunnel, in the world; with `measured_walls` only those that do
// not depend on where the walls are.
std::vector<PlanPoint> plan_points(const std::vector<SurveyedPoint>& points, const Grid& grid,
                                   const TagTemplate& tag, bool measured_walls) {
  std::vector<PlanPoint> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurveyedPoint& point = points[i];
    const std::optional<int> side = side_of(point.kind);
    if (!side || (measured_walls && *side != 0 && !point.offset)) continue;
    const double half = is_tag(point) ? tag.frame_inner_length / 2 : 0;
    result.push_back({world_from_grid(grid, point.in_grid).head<2>(), *side, half,
                      measured_walls ? point.offset : std::nullopt, i});
  }
  // Where the list states chainages, its order need not be that of the drive.
  std::ranges::stable_sort(
      result, {}, [&](const PlanPoint& point) { return points[point.index].chainage.value_or(0); });
  return result;
}

Result<void> check_has_walls(const std::vector<SurveyedPoint>& points) {
  const auto on_side = [&](int side) {
    return std::ranges::any_of(points,
                               [&](const SurveyedPoint& p) { return side_of(p.kind) == side; });
  };
  if (on_side(-1) && on_side(1)) return {};
  return fail(std::string("no points on the ") + (on_side(-1) ? "right" : "left") +
              " wall (TL, TR, WL, WR or names of tags): the width cannot be known\n"
              "list some points of that wall, or of the center line (CL) and give --width");
}

Centerline moved_by(const Centerline& line, const Eigen::Vector2d& shift) {
  const CenterlinePoint start = line.at(0);
  return {start.position + Vector3d(shift.x(), shift.y(), 0), start.heading, line.elements()};
}

// A plan through the points whose place across the tunnel is known.
struct WallPlan {
  std::vector<PlanPoint> points;
  PlanFit fit;
  bool measured_walls = false;  // were not fitted
};

Result<WallPlan> fit_walls(const std::vector<SurveyedPoint>& points, const Grid& grid,
                           const TagTemplate& tag, const TunnelFitOptions& options,
                           bool measured_walls) {
  const double tolerance = options.tolerance;
  WallPlan plan{plan_points(points, grid, tag, measured_walls), {}, measured_walls};
  if (plan.points.empty()) return fail("no points of walls, center line or tags");
  // National coordinates are long; near zero they lose no digits.
  const Eigen::Vector2d shift = plan.points.front().p;
  for (PlanPoint& point : plan.points) point.p -= shift;
  std::optional<PlanFit> fit = options.alignment
                                   ? plan_along(moved_by(*options.alignment, -shift), plan.points)
                                   : fit_plan(plan.points, tolerance, kMostFittedElements);
  if (!fit) {
    return fail("too few points: expected two along the center line (CL), or two on either wall");
  }
  plan.fit = std::move(*fit);
  if (auto sides = check_sides(plan.points, plan.fit); !sides) return fail(sides);
  const bool fits =
      std::ranges::all_of(plan.fit.residuals, [&](double r) { return std::abs(r) <= tolerance; });
  if (!fits)
    return tl::unexpected(
        misfit_error(points, plan.points, plan.fit, tolerance, options.alignment.has_value()));
  plan.fit.line = moved_by(plan.fit.line, shift);
  return plan;
}

// Walls that are measured at separate offsets are used so where no even width fits.
Result<WallPlan> plan_of_walls(const std::vector<SurveyedPoint>& points, const Grid& grid,
                               const TagTemplate& tag, const TunnelFitOptions& options) {
  const auto fit = [&](bool measured) { return fit_walls(points, grid, tag, options, measured); };
  // Without points of its own the center line runs between the walls.
  const bool has_line = std::ranges::any_of(points, [](const SurveyedPoint& point) {
    return point.kind == PointKind::centerline || point.offset;
  });
  Result<WallPlan> plan = fit(options.measured_walls && has_line);
  if (!plan && options.measured_walls && !has_line && !options.alignment) {
    return fail(plan.error().message +
                "\nor list points CL of the center line: then walls of any shape run through their "
                "points");
  }
  if (plan) plan->measured_walls = options.measured_walls;
  if (plan || options.measured_walls || !says_offsets(points)) return plan;
  Result<WallPlan> by_offsets = fit(true);
  return by_offsets ? by_offsets : plan;
}

// ---- Ends of the line.

// Where the list has its chainage 0, in the fitted line's chainage.
std::optional<double> listed_start(const WallPlan& plan, const std::vector<SurveyedPoint>& points) {
  std::vector<double> starts;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const std::optional<double>& listed = points[plan.points[i].index].chainage;
    if (listed) starts.push_back(plan.fit.chainages[i] - *listed);
  }
  if (starts.empty()) return std::nullopt;
  return median(std::move(starts));
}

// A point of the line, or of its first element prolonged backwards.
CenterlinePoint point_before(const Centerline& line, double chainage) {
  const double curvature = line.elements().front().curvature;
  if (chainage >= 0 || curvature == 0) return line.at(chainage);
  CenterlinePoint point = line.at(0);
  const Vector3d right = right_of(point.heading);
  point.heading += chainage * curvature;
  point.position += (right - right_of(point.heading)) / curvature;
  return point;
}

// Where points lie beyond an arc at an end of the line, the fit has them along its tangent: the
// line with these tangents, and how much longer it is at its begin.
struct WithTangents {
  std::vector<CenterlineElement> elements;
  double before = 0;
};

WithTangents with_tangents(const Centerline& line, double least, double most) {
  constexpr double kOff = 0.001;  // of the arc, metres
  WithTangents result{line.elements()};
  const auto leaves = [&](double beyond, const CenterlineElement& end) {
    return beyond > 0 && std::abs(end.curvature) * beyond * beyond / 2 > kOff;
  };
  const double behind = most - line.length();
  if (leaves(behind, line.elements().back())) result.elements.push_back({behind, 0, 0});
  if (!leaves(-least, line.elements().front())) return result;
  result.before = -least;
  result.elements.insert(result.elements.begin(), {-least, 0, 0});
  return result;
}

// The same line from a plate's length before the first point to as much beyond the last.
Centerline with_ends(const WallPlan& plan, const std::vector<SurveyedPoint>& points,
                     double margin) {
  const Centerline& line = plan.fit.line;
  const auto [least, most] = std::ranges::minmax(plan.fit.chainages);
  const auto [elements, before] = with_tangents(line, least, most);
  const bool straight = elements.front().curvature == 0;
  double from = least - margin;
  const std::optional<double> listed = listed_start(plan, points);
  if (listed) from = std::min(*listed, most - margin);
  if (!listed && !straight) from = std::max(from, 0.0);
  const CenterlinePoint start = straight ? line.at(from) : point_before(line, from);
  return {start.position, start.heading,
          elements_between(elements, from + before, most + margin + before)};
}

// The whole alignment, with a margin only where points lie beyond a straight end.
Centerline prolonged(const WallPlan& plan, double margin) {
  constexpr double kBeyond = 0.01;
  const Centerline& line = plan.fit.line;
  const auto [least, most] = std::ranges::minmax(plan.fit.chainages);
  const std::vector<CenterlineElement>& elements = line.elements();
  const bool before = least < -kBeyond && elements.front().curvature == 0;
  const bool behind = most > line.length() + kBeyond && elements.back().curvature == 0;
  const double from = before ? least - margin : 0;
  const CenterlinePoint start = line.at(from);
  return {start.position, start.heading,
          elements_between(elements, from, behind ? most + margin : line.length())};
}

// ---- Walls and roof through their points.

// Without the stations that lie on the line between those kept, to half a millimetre.
std::vector<ProfileStation> simplified(const std::vector<ProfileStation>& stations) {
  constexpr double kSame = 5e-4;
  constexpr std::size_t kMostLeftOut = 200;  // in a row: limits the work
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
// their mean, or the farthest where they contradict each other (objects stand before the rock, not
// behind it).
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

// Where the wall is behind a point of it or behind a plate: at both ends of a plate whose facing is
// stated, so that a step before the next plate leaves this one on its wall. A plate that faces
// along the drive rather than across it hangs on no wall.
std::vector<ProfileStation> stations_of(const SurveyedPoint& point, const Vector3d& p,
                                        const CenterlineAddress& address, const Grid& grid,
                                        const Centerline& line, const TagTemplate& tag) {
  constexpr double kMostTurned = radians(20);
  if (!point.attitude || !point.attitude->facing) return {{address.chainage, address.offset}};
  const double away = side_of(point.kind) == -1 ? radians(90) : radians(-90);
  const double facing = world_heading_from_grid(grid, *point.attitude->facing);
  const double turned = wrapped_angle(facing - line.at(address.chainage).heading - away);
  if (std::abs(turned) >= kMostTurned) return {};
  const Vector3d along = -right_of(facing);  // as a viewer sees the plate, to the right
  const Vector3d middle = p + along * tag.frame_inner_length / 2;
  std::vector<ProfileStation> stations;
  for (const double right : {-tag.plate_length / 2, tag.plate_length / 2}) {
    const CenterlineAddress end = line.locate((middle + along * right).head<2>());
    stations.push_back({end.chainage, end.offset});
  }
  return stations;
}

// The wall through the points of one side of the center line.
Result<ChainageProfile> wall_through(const std::vector<SurveyedPoint>& points, const Grid& grid,
                                     const TagTemplate& tag, const Centerline& line, Side side) {
  const int wanted = side == Side::left ? -1 : 1;
  std::vector<ProfileStation> stations;
  for (const SurveyedPoint& point : points) {
    if (side_of(point.kind) != wanted) continue;
    const Vector3d p = world_from_grid(grid, point.in_grid);
    const CenterlineAddress address = line.locate(p.head<2>());
    if (wanted * address.offset <= 0) {
      return fail(in_words(point) + " lies on the other side of the center line");
    }
    std::ranges::copy(stations_of(point, p, address, grid, line, tag),
                      std::back_inserter(stations));
  }
  if (stations.empty()) {
    return fail("no points on the " + to_string(side) + " wall: tags there look along the drive");
  }
  return through(std::move(stations));
}

Result<void> measure_walls(Tunnel& tunnel, const std::vector<SurveyedPoint>& points,
                           const Grid& grid, const TagTemplate& tag) {
  const auto left = wall_through(points, grid, tag, tunnel.centerline, Side::left);
  const auto right = wall_through(points, grid, tag, tunnel.centerline, Side::right);
  if (!left) return fail(left);
  if (!right) return fail(right);
  tunnel.left = *left;
  tunnel.right = *right;
  return {};
}

// Where only the floor is known, nothing tells how the drive bends: the reason, in words.
std::string beyond_walls(const WallPlan& plan, const std::vector<double>& chainages,
                         const HeightStation& station) {
  std::vector<double> known;
  for (const PlanPoint& point : plan.points) known.push_back(chainages[point.index]);
  const auto [first, last] = std::ranges::minmax(known);
  const double beyond = std::max(first - station.chainage, station.chainage - last);
  if (beyond < 1) return "";
  return fmt::format(
      "; it lies {:.0f} m beyond the points of walls, tags and center line: list some there, or "
      "leave such floor points out",
      beyond);
}

// The height of the roof above the floor: at its points (RF), or as the list states it.
Result<ChainageProfile> fit_roof(const Centerline& line, const std::vector<SurveyedPoint>& points,
                                 const Grid& grid, bool measured_walls,
                                 const TunnelFitOptions& options) {
  std::vector<ProfileStation> stations;
  bool is_listed = false;
  for (const SurveyedPoint& point : points) {
    const Vector3d p = world_from_grid(grid, point.in_grid);
    const double chainage = line.locate(p.head<2>()).chainage;
    is_listed = is_listed || point.tunnel_height;
    if (point.tunnel_height) stations.push_back({chainage, *point.tunnel_height});
    if (point.kind != PointKind::roof) continue;
    stations.push_back({chainage, p.z() - line.at(chainage).position.z()});
  }
  if (stations.empty() && options.roof_height) return *options.roof_height;
  if (stations.empty()) return fail("no points of the roof (RF): give its height, --tunnel-height");
  std::vector<double> heights;
  for (const ProfileStation& station : stations) heights.push_back(station.value);
  const double usual = median(std::move(heights));
  if (usual <= 0) return fail("the points of the roof (RF) lie below the floor");
  if (!measured_walls && !is_listed) return std::round(usual * 1000) / 1000;
  const ChainageProfile roof = through(std::move(stations));
  return roof.least() == roof.greatest() ? ChainageProfile(roof.least()) : roof;
}

}  // namespace

std::vector<CenterlineElement> elements_between(const std::vector<CenterlineElement>& elements,
                                                double from, double to) {
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

Result<TunnelFit> fit_tunnel(const std::vector<SurveyedPoint>& points, const Grid& grid,
                             const TagTemplate& tag, const TunnelFitOptions& options) {
  if (auto walls = check_has_walls(points); !walls) return fail(walls);
  if (auto ordered = check_order(points); !ordered) return fail(ordered);
  const Result<WallPlan> plan = plan_of_walls(points, grid, tag, options);
  if (!plan) return fail(plan);
  const Centerline level = options.alignment ? prolonged(*plan, tag.plate_length)
                                             : with_ends(*plan, points, tag.plate_length);

  std::vector<double> chainages;
  chainages.reserve(points.size());
  for (const SurveyedPoint& point : points) {
    chainages.push_back(level.locate(world_from_grid(grid, point.in_grid).head<2>()).chainage);
  }
  const std::vector<HeightStation> on_floor = floor_points(points, chainages, options.mount_height);
  if (on_floor.empty()) {
    return fail("no points of the floor (CL, FL): give the height of P above it, --mount-height");
  }
  const Floor floor = fit_floor_without_slips(level.elements(), on_floor, options.tolerance);
  Vector3d start = level.at(0).position;
  start.z() = floor.start;

  TunnelFit fit;
  fit.tunnel =
      plain_tunnel(plan->fit.width, 0, Centerline(start, level.at(0).heading, floor.elements));
  if (plan->measured_walls) {
    if (auto done = measure_walls(fit.tunnel, points, grid, tag); !done) {
      return fail(done);
    }
  }
  const Result<ChainageProfile> roof =
      fit_roof(fit.tunnel.centerline, points, grid, plan->measured_walls, options);
  if (!roof) return fail(roof);
  fit.tunnel.height = *roof;

  fit.residuals.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) fit.residuals[i].chainage = chainages[i];
  for (std::size_t i = 0; i < plan->points.size(); ++i) {
    fit.residuals[plan->points[i].index].across = plan->fit.residuals[i];
  }
  for (std::size_t i = 0; i < on_floor.size(); ++i) {
    fit.residuals[on_floor[i].index].up = floor.ups[static_cast<Eigen::Index>(i)];
  }
  Eigen::Index worst = 0;
  if (floor.ups.cwiseAbs().maxCoeff(&worst) > options.floor_tolerance) {
    const HeightStation& station = on_floor[static_cast<std::size_t>(worst)];
    return fail(fmt::format("{} is {:+.3f} m above the fitted floor, expected at most {:.3f} m{}",
                            in_words(points[station.index]), floor.ups[worst],
                            options.floor_tolerance, beyond_walls(*plan, chainages, station)));
  }
  fit.rms_across = rms(Eigen::Map<const VectorXd>(
      plan->fit.residuals.data(), static_cast<Eigen::Index>(plan->fit.residuals.size())));
  fit.rms_up = rms(floor.ups);
  fit.heading_sigma = plan->fit.heading_sigma;
  fit.unchecked = plan->fit.unchecked;
  return fit;
}

}  // namespace tagsmith::detail
