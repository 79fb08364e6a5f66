// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/quad.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tagsmith::detail {
namespace {

// Where the lines a->b and c->d meet; nothing when they are parallel.
std::optional<PixelPoint> meeting_point(PixelPoint a, PixelPoint b, PixelPoint c, PixelPoint d) {
  const PixelPoint ab = b - a;
  const PixelPoint cd = d - c;
  const double determinant = cross(ab, cd);
  if (std::abs(determinant) < 1e-9 * (length(ab) * length(cd) + 1e-12)) return std::nullopt;
  return a + cross(c - a, cd) / determinant * ab;
}

// Dropping side i (from corner i to i+1): where its neighbours meet and the area that adds.
struct Removal {
  PixelPoint corner;
  double added_area = std::numeric_limits<double>::infinity();
};

Removal remove_side(const std::vector<PixelPoint>& polygon, std::size_t i) {
  const std::size_t n = polygon.size();
  const PixelPoint& before = polygon[(i + n - 1) % n];
  const PixelPoint& begin = polygon[i];
  const PixelPoint& end = polygon[(i + 1) % n];
  const PixelPoint& after = polygon[(i + 2) % n];
  const std::optional<PixelPoint> corner = meeting_point(before, begin, end, after);
  // The neighbours must meet outside, beyond this side.
  if (!corner || dot(*corner - begin, begin - before) < 0 || dot(*corner - end, end - after) < 0) {
    return {};
  }
  return {*corner, std::abs(cross(end - begin, *corner - begin)) / 2};
}

}  // namespace

double area_of(const std::vector<PixelPoint>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
  return std::abs(twice) / 2;
}

double area_of(const Quad& quad) {
  return std::abs(cross(quad[2] - quad[0], quad[3] - quad[1])) / 2;
}

double length_of(const Quad& quad) {
  return (distance(quad[0], quad[1]) + distance(quad[3], quad[2])) / 2;
}

double height_of(const Quad& quad) {
  return (distance(quad[0], quad[3]) + distance(quad[1], quad[2])) / 2;
}

bool is_convex(const Quad& quad) {
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint in = quad[(i + 1) % 4] - quad[i];
    const PixelPoint out = quad[(i + 2) % 4] - quad[(i + 1) % 4];
    if (!(cross(in, out) > 0)) return false;
  }
  return true;
}

// Andrew's monotone chain; y grows downwards, so the usual counter-clockwise order appears
// clockwise.
std::vector<PixelPoint> convex_hull(std::vector<PixelPoint> points) {
  if (points.size() < 3) return points;
  std::sort(points.begin(), points.end(), [](const PixelPoint& a, const PixelPoint& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  });
  std::vector<PixelPoint> hull;
  const auto extend = [&](const PixelPoint& point, std::size_t least) {
    while (hull.size() >= least + 2 &&
           cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const PixelPoint& point : points) extend(point, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) extend(*point, lower);
  hull.pop_back();
  return hull;
}

std::optional<Quad> enclosing_quad(const std::vector<PixelPoint>& hull) {
  if (hull.size() < 4) return std::nullopt;
  std::vector<PixelPoint> polygon = hull;
  std::vector<Removal> removals(polygon.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) removals[i] = remove_side(polygon, i);
  while (polygon.size() > 4) {
    const auto least = std::ranges::min_element(removals, {}, &Removal::added_area);
    if (!std::isfinite(least->added_area)) return std::nullopt;
    std::size_t side = static_cast<std::size_t>(least - removals.begin());
    const std::size_t gone = (side + 1) % polygon.size();
    polygon[side] = least->corner;
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(gone));
    removals.erase(removals.begin() + static_cast<std::ptrdiff_t>(gone));
    if (gone < side) --side;
    // Only the sides that end in the new corner, and their neighbours, have changed.
    const std::size_t n = polygon.size();
    for (const std::size_t back : {2U, 1U, 0U}) {
      const std::size_t changed = (side + n - back) % n;
      removals[changed] = remove_side(polygon, changed);
    }
    removals[(side + 1) % n] = remove_side(polygon, (side + 1) % n);
  }
  Quad quad{polygon[0], polygon[1], polygon[2], polygon[3]};
  std::ranges::rotate(quad, std::ranges::min_element(
                                quad, {}, [](PixelPoint corner) { return corner.x + corner.y; }));
  return quad;
}

Quad widened(const Quad& quad, double pixels) {
  const auto shift_of = [&](std::size_t i) {
    const PixelPoint side = quad[(i + 1) % 4] - quad[i];
    return pixels / std::max(length(side), 1e-9) * PixelPoint{side.y, -side.x};
  };
  Quad moved = quad;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t before = (i + 3) % 4;
    const PixelPoint first = shift_of(before);
    const PixelPoint second = shift_of(i);
    const auto corner = meeting_point(quad[before] + first, quad[i] + first, quad[i] + second,
                                      quad[(i + 1) % 4] + second);
    if (corner) moved[i] = *corner;
  }
  return moved;
}

bool contains(const Quad& quad, PixelPoint point) {
  int right = 0;
  int left = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double side = cross(quad[(i + 1) % 4] - quad[i], point - quad[i]);
    if (side > 0) ++right;
    if (side < 0) ++left;
  }
  return left == 0 || right == 0;
}

bool overlap(const Quad& a, const Quad& b) {
  return contains(a, centre_of(b)) || contains(b, centre_of(a));
}

PixelPoint centre_of(const Quad& quad) { return 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]); }

bool nearly_equal(const Quad& a, const Quad& b, double pixels) {
  for (std::size_t turn = 0; turn < 4; ++turn) {
    double farthest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      farthest = std::max(farthest, distance(a[i], b[(i + turn) % 4]));
    }
    if (farthest < pixels) return true;
  }
  return false;
}

// Heckbert 1989, "Fundamentals of texture mapping and image warping", section 2.2.3.
Homography homography_to(const Quad& quad) {
  const PixelPoint d1 = quad[1] - quad[2];
  const PixelPoint d2 = quad[3] - quad[2];
  const PixelPoint sum = (quad[0] - quad[1]) + (quad[2] - quad[3]);
  const double determinant = cross(d1, d2);
  const double g = cross(sum, d2) / determinant;
  const double k = cross(d1, sum) / determinant;
  return {{quad[1].x - quad[0].x + g * quad[1].x, quad[3].x - quad[0].x + k * quad[3].x, quad[0].x,
           quad[1].y - quad[0].y + g * quad[1].y, quad[3].y - quad[0].y + k * quad[3].y, quad[0].y,
           g, k, 1.0}};
}

Homography inverse(const Homography& homography) {
  const auto& m = homography.h;
  return {{m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
           m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
           m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]}};
}

}  // namespace tagsmith::detail
