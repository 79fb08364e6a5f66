// SPDX-License-Identifier: Apache-2.0
#include "decoder/paper/closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/pair_circle.hpp"

namespace tagsmith::detail {
namespace {

// Squared lengths this little below zero are rounding of an exact zero (1 um), not inconsistency.
constexpr double kRoundingSquared = 1e-12;

// Below this stagger per width the plane of d is parallel to the circle e's plane.
constexpr double kLeastTangent = 1e-6;

tl::unexpected<ClosedFormFailure> no_solution(NoSolution reason, std::string message) {
  return tl::unexpected(ClosedFormFailure{reason, std::move(message)});
}

bool is_usable(const ClosedFormInput& input) {
  const double lengths[] = {input.tunnel_width, input.wall_distance, input.distance1,
                            input.distance2};
  const auto is_positive = [](double length) { return std::isfinite(length) && length > 0; };
  return std::ranges::all_of(lengths, is_positive) && input.p1_in_world.allFinite() &&
         input.p2_in_world.allFinite() && std::isfinite(input.heading) &&
         std::isfinite(input.pair_angle);
}

// The square root of a squared length; nothing when it is below zero by more than rounding.
std::optional<double> real_root(double squared) {
  if (squared < -kRoundingSquared) return std::nullopt;
  return std::sqrt(std::max(squared, 0.0));
}

// The common point, further back along `heading`, of the circles about `centre1` and `centre2`.
std::optional<Eigen::Vector2d> rear_intersection(const Eigen::Vector2d& centre1, double radius1_sq,
                                                 const Eigen::Vector2d& centre2, double radius2_sq,
                                                 double heading) {
  const double spacing = (centre2 - centre1).norm();
  if (!(spacing > 0)) return std::nullopt;
  const Eigen::Vector2d towards2 = (centre2 - centre1) / spacing;
  const double foot = (radius1_sq - radius2_sq + spacing * spacing) / (2 * spacing);
  const std::optional<double> half_chord = real_root(radius1_sq - foot * foot);
  if (!half_chord) return std::nullopt;
  Eigen::Vector2d sideways(-towards2.y(), towards2.x());
  if (sideways.dot(direction_of(heading).head<2>()) > 0) sideways = -sideways;
  return centre1 + foot * towards2 + *half_chord * sideways;
}

// Where O lies relative to the line P1P2: at P1E along it, at ER horizontally across it, and this
// much below or above it.
struct CircleSolution {
  double p1_e = 0;
  double p2_e = 0;
  double er = 0;
  double height_difference = 0;
};

std::optional<ClosedFormFailure> fault_of(const ClosedFormInput& input) {
  if (!is_usable(input)) {
    return ClosedFormFailure{
        NoSolution::not_finite,
        fmt::format("D1 = {:.4g} m, D2 = {:.4g} m, d = {:.4g} m, W_T = {:.4g} m: expected finite "
                    "lengths of more than 0",
                    input.distance1, input.distance2, input.wall_distance, input.tunnel_width)};
  }
  const double tangent = std::tan(input.pair_angle);
  if (tangent < kLeastTangent || tangent > 1 / kLeastTangent) {
    return ClosedFormFailure{
        NoSolution::pair_angle_degenerate,
        fmt::format("theta is {:.4g} degrees, expected more than 0 and less than 90: tags straight "
                    "across from each other leave the position along the tunnel open",
                    degrees(input.pair_angle))};
  }
  return std::nullopt;
}

// (11)-(17): the points of the circle e, on which D1 and D2 put O, at the distance d from the wall.
tl::expected<CircleSolution, ClosedFormFailure> solve_circle(const ClosedFormInput& input) {
  const PairCircle circle = pair_circle({input.distance1, input.distance2, input.wall_distance},
                                        input.tunnel_width, input.pair_angle);
  if (circle.r_sq < -kRoundingSquared) {
    return no_solution(NoSolution::spheres_do_not_meet,
                       fmt::format("D1 = {:.3f} m and D2 = {:.3f} m reach no common point "
                                   "(r^2 = {:.4f} m^2)",
                                   input.distance1, input.distance2, circle.r_sq));
  }
  const std::optional<double> height_difference = real_root(circle.height_difference_sq());
  if (!height_difference) {
    return no_solution(NoSolution::no_real_height,
                       fmt::format("no real solution: r^2 = {:.4f} m^2 is less than "
                                   "(a / tan theta)^2 = {:.4f} m^2 for D1 = {:.3f} m, "
                                   "D2 = {:.3f} m, d = {:.3f} m",
                                   circle.r_sq, circle.er * circle.er, input.distance1,
                                   input.distance2, input.wall_distance));
  }
  return CircleSolution{circle.p1_e, circle.p2_e, circle.er, *height_difference};
}

}  // namespace

double paper_distance(const PixelPoint& p, const PixelPoint& q, const PixelPoint& centre,
                      double focal_px, double edge_length) {
  const double d_pq = distance(p, q);                      // (6)
  const double d_sp = distance(centre, p);                 // (7)
  return edge_length * std::hypot(d_sp, focal_px) / d_pq;  // (10), divided by M/m
}

bool paper_tag_is_above(const PixelPoint& p, const PixelPoint& centre) { return p.y < centre.y; }

tl::expected<Eigen::Vector3d, ClosedFormFailure> paper_position(const ClosedFormInput& input) {
  if (const auto fault = fault_of(input)) return tl::unexpected(*fault);
  const auto solution = solve_circle(input);
  if (!solution) return tl::unexpected(solution.error());
  const double er_sq = solution->er * solution->er;
  const std::optional<Eigen::Vector2d> plane = rear_intersection(
      input.p1_in_world.head<2>(), er_sq + solution->p1_e * solution->p1_e,  // (20), (22)
      input.p2_in_world.head<2>(), er_sq + solution->p2_e * solution->p2_e,  // (21), (23)
      input.heading);
  if (!plane) {
    return no_solution(NoSolution::circles_do_not_meet,
                       fmt::format("the circles of (22) and (23) do not meet for D1 = {:.3f} m, "
                                   "D2 = {:.3f} m, d = {:.3f} m",
                                   input.distance1, input.distance2, input.wall_distance));
  }
  const double tag_height = (input.p1_in_world.z() + input.p2_in_world.z()) / 2;     // H_P
  const double z = input.tags_are_above ? tag_height - solution->height_difference   // (18)
                                        : tag_height + solution->height_difference;  // (19)
  return Eigen::Vector3d(plane->x(), plane->y(), z);
}

}  // namespace tagsmith::detail
