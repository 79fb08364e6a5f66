// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "decoder/feature_frame/regions.hpp"
#include "decoder/feature_frame/tuning.hpp"

namespace tagsmith::detail {
namespace {

// The inner edge of a frame whose outer edge this is.
Quad inner_of_outer(const Quad& outer, const FrameShape& shape) {
  const double length = shape.length + 2 * shape.stroke;
  const double height = shape.height + 2 * shape.stroke;
  const Homography map = homography_to(outer);
  const bool is_wide = distance(outer[0], outer[1]) > distance(outer[1], outer[2]);
  const bool upright = is_wide == (length > height);
  const double u = shape.stroke / (upright ? length : height);
  const double v = shape.stroke / (upright ? height : length);
  return {map(u, v), map(1 - u, v), map(1 - u, 1 - v), map(u, 1 - v)};
}

// Whether four of the hull's points span most of it: those of a large triangle, and the one that
// adds most to it. A quick test that the outlines of walls and lamps fail.
bool is_four_cornered(const std::vector<PixelPoint>& hull, double area) {
  const auto farthest_from = [&](PixelPoint from) {
    return *std::ranges::max_element(
        hull, {}, [&](PixelPoint point) { return dot(point - from, point - from); });
  };
  const PixelPoint a = farthest_from(hull.front());
  const PixelPoint b = farthest_from(a);
  const PixelPoint c = *std::ranges::max_element(
      hull, {}, [&](PixelPoint point) { return std::abs(cross(b - a, point - a)); });
  const double triangle = cross(b - a, c - a);
  const double turn = triangle < 0 ? -1 : 1;
  double added = 0;
  for (const PixelPoint& point : hull) {
    added = std::max({added, turn * cross(point - a, b - a), turn * cross(point - b, c - b),
                      turn * cross(point - c, a - c)});
  }
  return (std::abs(triangle) + added) / 2 >= kCandidate.least_spanned * area;
}

// The quadrilateral around a hull that fills most of it.
std::optional<Quad> quad_filled_by(const std::vector<PixelPoint>& hull) {
  if (hull.size() < 4) return std::nullopt;
  const double area = area_of(hull);
  if (!is_four_cornered(hull, area)) return std::nullopt;
  const std::optional<Quad> quad = enclosing_quad(hull);
  if (!quad || !is_convex(*quad) || area < kCandidate.least_filled * area_of(*quad))
    return std::nullopt;
  return quad;
}

// A region's hull.
struct Piece {
  bool white = false;
  std::vector<PixelPoint> hull;
  double area = 0;
  PixelPoint middle;  // of its extent
};

// An area that the hull of two pieces has at least: that between their points which lie farthest to
// either side of the line through their middles.
double least_area_around(const Piece& a, const Piece& b) {
  const PixelPoint way = b.middle - a.middle;
  const auto across = [&](const PixelPoint& point) { return cross(way, point); };
  const auto [right_a, left_a] = std::ranges::minmax_element(a.hull, {}, across);
  const auto [right_b, left_b] = std::ranges::minmax_element(b.hull, {}, across);
  return std::abs(cross(*left_b - *right_a, *left_a - *right_b)) / 2;
}

// Quadrilaterals around two pieces of one colour: a cable in front of a frame cuts it in two.
std::vector<Quad> joined_candidates(std::vector<Piece> pieces, const FrameShape& shape) {
  std::ranges::sort(pieces, [](const Piece& a, const Piece& b) { return a.area > b.area; });
  pieces.resize(std::min(pieces.size(), kCandidate.most_pieces));
  std::vector<Quad> candidates;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = i + 1; j < pieces.size(); ++j) {
      if (pieces[i].white != pieces[j].white) continue;
      const double sum = pieces[i].area + pieces[j].area;
      // Most are too far apart, which a look at four points tells as surely as the hull does.
      constexpr double kRounding = 1 + 1e-9;
      if (least_area_around(pieces[i], pieces[j]) > kCandidate.most_empty * sum * kRounding)
        continue;
      std::vector<PixelPoint> points = pieces[i].hull;
      points.insert(points.end(), pieces[j].hull.begin(), pieces[j].hull.end());
      const std::vector<PixelPoint> hull = convex_hull(std::move(points));
      const double area = area_of(hull);
      if (area > kCandidate.most_empty * sum || area < 1.05 * pieces[i].area) continue;
      const std::optional<Quad> quad = quad_filled_by(hull);
      if (quad) candidates.push_back(pieces[i].white ? *quad : inner_of_outer(*quad, shape));
    }
  }
  return candidates;
}

}  // namespace

Quad to_full(const PyramidLevel& level, const Quad& quad) {
  const double offset = (level.scale - 1) / 2;  // pixel centres of a reduced image
  Quad full = quad;
  for (PixelPoint& corner : full) {
    corner = level.scale * corner + PixelPoint{offset, offset} + level.origin;
  }
  return full;
}

Quad to_level(const PyramidLevel& level, const Quad& quad) {
  const double offset = (level.scale - 1) / 2;
  Quad reduced = quad;
  for (PixelPoint& corner : reduced) {
    corner = 1 / level.scale * (corner - PixelPoint{offset, offset} - level.origin);
  }
  return reduced;
}

std::vector<Quad> find_candidates(const PyramidLevel& level, const CandidateOptions& options) {
  RegionOptions region_options;
  region_options.min_contrast = level.min_contrast;
  region_options.max_size = options.max_size;
  region_options.max_changes = options.max_changes;
  region_options.searched = options.searched;
  region_options.known = options.known;
  std::vector<Quad> candidates;
  std::vector<Piece> pieces;
  for (Region& region : find_regions(level.image, region_options)) {
    if (const auto quad = quad_filled_by(region.hull)) {
      candidates.push_back(region.white ? *quad : inner_of_outer(*quad, options.shape));
    }
    if (!options.join_pieces) continue;
    const double area = area_of(region.hull);
    const PixelPoint middle{(region.left + region.right) / 2.0, (region.top + region.bottom) / 2.0};
    pieces.push_back({region.white, std::move(region.hull), area, middle});
  }
  std::ranges::move(joined_candidates(std::move(pieces), options.shape),
                    std::back_inserter(candidates));
  return candidates;
}

}  // namespace tagsmith::detail
