// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/candidates.hpp"

#include <algorithm>
#include <cmath>
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

// The inner edge of the frame that a hull of this colour may be.
std::optional<Quad> candidate_of(const std::vector<PixelPoint>& hull, bool white,
                                 const FrameShape& shape) {
  const std::optional<Quad> quad = enclosing_quad(hull);
  if (!quad || !is_convex(*quad)) return std::nullopt;
  return white ? *quad : inner_of_outer(*quad, shape);
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
      const std::optional<Quad> quad = candidate_of(hull, pieces[i].white, shape);
      if (quad) candidates.push_back(*quad);
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
    if (const auto quad = candidate_of(region.hull, region.white, options.shape)) {
      candidates.push_back(*quad);
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
