// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/candidates.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "decoder/feature_frame/regions.hpp"

namespace tagsmith {
namespace {

// The inner edge of a frame whose outer edge this is: strokes are about 4 of 113 modules.
Quad inner_of_outer(const Quad& outer) {
  constexpr double kStroke = 3.95;
  constexpr double kLength = 113 + 2 * kStroke;
  constexpr double kHeight = 55.3 + 2 * kStroke;
  const Homography map = homography_to(outer);
  const bool upright = distance(outer[0], outer[1]) > distance(outer[1], outer[2]);
  const double u = kStroke / (upright ? kLength : kHeight);
  const double v = kStroke / (upright ? kHeight : kLength);
  return {map(u, v), map(1 - u, v), map(1 - u, 1 - v), map(u, 1 - v)};
}

// The quadrilateral around a hull that fills most of it.
std::optional<Quad> quad_filled_by(const std::vector<PixelPoint>& hull) {
  constexpr double kLeastFill = 0.85;
  const std::optional<Quad> quad = enclosing_quad(hull);
  if (!quad || !is_convex(*quad) || area_of(hull) < kLeastFill * area_of(*quad)) {
    return std::nullopt;
  }
  return quad;
}

// A region's hull.
struct Piece {
  bool white = false;
  std::vector<PixelPoint> hull;
  double area = 0;
};

// Quadrilaterals around two pieces of one colour: a cable in front of a frame cuts it in two.
std::vector<Quad> joined_candidates(std::vector<Piece> pieces) {
  constexpr std::size_t kMaxPieces = 32;
  std::ranges::sort(pieces, [](const Piece& a, const Piece& b) { return a.area > b.area; });
  pieces.resize(std::min(pieces.size(), kMaxPieces));
  std::vector<Quad> candidates;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = i + 1; j < pieces.size(); ++j) {
      if (pieces[i].white != pieces[j].white) continue;
      std::vector<PixelPoint> points = pieces[i].hull;
      points.insert(points.end(), pieces[j].hull.begin(), pieces[j].hull.end());
      const std::vector<PixelPoint> hull = convex_hull(std::move(points));
      const double area = area_of(hull);
      const double sum = pieces[i].area + pieces[j].area;
      if (area > 1.3 * sum || area < 1.05 * pieces[i].area) continue;
      const std::optional<Quad> quad = quad_filled_by(hull);
      if (quad) candidates.push_back(pieces[i].white ? *quad : inner_of_outer(*quad));
    }
  }
  return candidates;
}

}  // namespace

Quad to_full(const PyramidLevel& level, const Quad& quad) {
  const double offset = (level.scale - 1) / 2;  // pixel centres of a reduced image
  Quad full = quad;
  for (PixelPoint& corner : full) {
    corner = {corner.x * level.scale + offset, corner.y * level.scale + offset};
  }
  return full;
}

std::vector<Quad> find_candidates(const PyramidLevel& level) {
  RegionOptions region_options;
  region_options.min_contrast = level.min_contrast;
  std::vector<Quad> candidates;
  std::vector<Piece> pieces;
  for (const Region& region : find_regions(level.image, region_options)) {
    Piece piece{region.white, convex_hull(region.outline), 0};
    piece.area = area_of(piece.hull);
    if (const auto quad = quad_filled_by(piece.hull)) {
      candidates.push_back(region.white ? *quad : inner_of_outer(*quad));
    }
    pieces.push_back(std::move(piece));
  }
  for (const Quad& quad : joined_candidates(std::move(pieces))) candidates.push_back(quad);
  return candidates;
}

}  // namespace tagsmith
