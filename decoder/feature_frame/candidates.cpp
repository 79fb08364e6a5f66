// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/candidates.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "decoder/feature_frame/tuning.hpp"

namespace tagsmith::detail {

// ---- Regions.

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The extent of a region while it grows.
struct Extent {
  int left = 0;
  int right = 0;  // exclusive
  int top = 0;
  int bottom = 0;  // inclusive
  bool white = false;
};

// The runs of all rows. Those of a row alternate in colour and begin with a white one, which may be
// empty: run i of row y lies from begins[first_of_row[y] + i] to the next entry, the last of which
// is the width.
struct RunMap {
  std::vector<int> begins;
  std::vector<std::uint32_t> labels;  // beside `begins`
  std::vector<std::size_t> first_of_row;
  // Labels form trees by their parents, which precede them; a root's extent is that of its region.
  std::vector<std::uint32_t> parents;
  std::vector<Extent> extents;
};

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t label) {
  while (parents[label] != label) {
    parents[label] = parents[parents[label]];
    label = parents[label];
  }
  return label;
}

// The root of both regions, the first of which is given by its root.
std::uint32_t join(RunMap& map, std::uint32_t a, std::uint32_t b) {
  b = root_of(map.parents, b);
  if (a == b) return a;
  if (b < a) std::swap(a, b);
  Extent& kept = map.extents[a];
  const Extent& gone = map.extents[b];
  kept.left = std::min(kept.left, gone.left);
  kept.right = std::max(kept.right, gone.right);
  kept.top = std::min(kept.top, gone.top);
  map.parents[b] = a;
  return a;
}

// Appends where the colour changes along a row of bits, which begin at pixel `offset`: all beside
// them is white. `row` has room for all changes.
void append_runs(std::span<const std::uint64_t> bits, int offset, int width, std::vector<int>& row,
                 std::vector<int>& begins) {
  int* next = row.data();
  *next++ = 0;
  std::uint64_t before = 0;
  for (const std::uint64_t word : bits) {
    for (std::uint64_t changes = word ^ (word << 1U | before); changes != 0;
         changes &= changes - 1) {
      *next++ = offset + std::countr_zero(changes);
    }
    before = word >> 63U;
    offset += 64;
  }
  if (before != 0 && offset < width) *next++ = offset;
  if (next[-1] == width) --next;  // the end of a dark run at the end of the row
  *next++ = width;
  begins.insert(begins.end(), row.data(), next);
}

// Labels the runs of the last row by those of the row above that they touch; dark runs touch
// diagonally too.
void label_row(RunMap& map, std::size_t y) {
  const int row = static_cast<int>(y);
  const std::size_t first = map.first_of_row[y];
  const std::size_t first_above = y > 0 ? map.first_of_row[y - 1] : 0;
  const std::size_t count = map.begins.size() - first - 1;
  const std::size_t count_above = y > 0 ? first - first_above - 1 : 0;
  map.labels.resize(map.begins.size());
  const int* here = map.begins.data() + first;
  const int* above = map.begins.data() + first_above;
  const std::uint32_t* labels_above = map.labels.data() + first_above;
  std::uint32_t* labels = map.labels.data() + first;
  labels[0] = kNone;
  std::size_t j = 0;
  for (std::size_t i = here[1] == 0 ? 1 : 0; i < count; ++i) {
    const std::size_t dark = i & 1U;
    const int slack = static_cast<int>(dark);
    const int begin = here[i];
    const int end = here[i + 1];
    while (j < count_above && above[j + 1] <= begin - slack) ++j;
    std::size_t k = j + ((j ^ dark) & 1U);  // an empty white run above cannot be reached
    if (k < count_above && above[k] < end + slack) {
      std::uint32_t label = root_of(map.parents, labels_above[k]);
      for (k += 2; k < count_above && above[k] < end + slack; k += 2) {
        label = join(map, label, labels_above[k]);
      }
      Extent& extent = map.extents[label];
      extent.left = std::min(extent.left, begin);
      extent.right = std::max(extent.right, end);
      extent.bottom = row;
      labels[i] = label;
    } else {
      labels[i] = static_cast<std::uint32_t>(map.parents.size());
      map.parents.push_back(labels[i]);
      map.extents.push_back({begin, end, row, row, dark == 0});
    }
  }
}

RunMap find_runs(const GrayView& image, const RegionOptions& options) {
  TileThresholds thresholds =
      tile_thresholds(tile_extremes(image, options.searched), options.min_contrast);
  if (options.searched != nullptr) keep_tiles(*options.searched, thresholds);
  for (const Quad& quad : options.known) clear_tiles(quad, thresholds);
  const DarkPixels dark = mark_dark(image, std::move(thresholds), options.max_changes);
  RunMap map;
  const auto width = static_cast<std::size_t>(image.width);
  map.begins.reserve((1U << 15U) + width);
  map.labels.reserve((1U << 15U) + width);
  map.parents.reserve(1U << 12U);
  map.extents.reserve(1U << 12U);
  map.first_of_row.reserve(static_cast<std::size_t>(image.height) + 1);
  std::vector<int> row(width + 2);
  for (int y = 0; y < image.height; ++y) {
    map.first_of_row.push_back(map.begins.size());
    const auto [begin, end] = dark.used[static_cast<std::size_t>(y / kTile)];
    append_runs({dark.row(y) + begin, end - begin}, static_cast<int>(begin) * 64, image.width, row,
                map.begins);
    label_row(map, static_cast<std::size_t>(y));
  }
  map.first_of_row.push_back(map.begins.size());
  return map;
}

// The border may cut off a corner of a frame and leave the symbol whole: its white inside touches
// the border then, but not all four sides of it. Dark regions there are walls and shadows.
bool is_kept(const Extent& extent, const GrayView& image, const RegionOptions& options) {
  const int width = extent.right - extent.left;
  const int height = extent.bottom - extent.top + 1;
  const int sides = (extent.left == 0 ? 1 : 0) + (extent.top == 0 ? 1 : 0) +
                    (extent.right == image.width ? 1 : 0) +
                    (extent.bottom + 1 == image.height ? 1 : 0);
  return width >= options.min_width && height >= options.min_height &&
         std::max(width, height) <= options.max_size && sides <= (extent.white ? 3 : 0);
}

// The ends of a region's extent on each of its rows.
struct RowExtents {
  int top = 0;
  std::vector<std::array<int, 2>> ends;  // first and last pixel
};

std::vector<PixelPoint> hull_of(const RowExtents& extents) {
  std::vector<PixelPoint> left;
  std::vector<PixelPoint> right;
  const auto extend = [](std::vector<PixelPoint>& chain, PixelPoint point, double turn) {
    while (chain.size() >= 2 &&
           turn * cross(chain.back() - chain[chain.size() - 2], point - chain.back()) <= 0) {
      chain.pop_back();
    }
    chain.push_back(point);
  };
  for (std::size_t i = 0; i < extents.ends.size(); ++i) {
    const double y = extents.top + static_cast<double>(i);
    extend(left, {static_cast<double>(extents.ends[i][0]), y}, -1);
    extend(right, {static_cast<double>(extents.ends[i][1]), y}, 1);
  }
  // Down the right side, up the left one; ends that are one pixel are added once.
  std::vector<PixelPoint> hull = right;
  if (left.back().x == right.back().x) left.pop_back();
  std::reverse(left.begin(), left.end());
  if (!left.empty() && left.back().x == right.front().x && left.back().y == right.front().y) {
    left.pop_back();
  }
  hull.insert(hull.end(), left.begin(), left.end());
  return hull;
}

// The rows' extents of the regions that `kept_index` numbers.
std::vector<RowExtents> row_extents(RunMap& map, const std::vector<std::uint32_t>& kept_index,
                                    const std::vector<Region>& kept) {
  std::vector<RowExtents> extents(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    extents[i].top = kept[i].top;
    extents[i].ends.assign(static_cast<std::size_t>(kept[i].bottom - kept[i].top) + 1,
                           {std::numeric_limits<int>::max(), -1});
  }
  for (std::size_t y = 0; y + 1 < map.first_of_row.size(); ++y) {
    for (std::size_t i = map.first_of_row[y]; i + 1 < map.first_of_row[y + 1]; ++i) {
      if (map.labels[i] == kNone) continue;
      const std::uint32_t index = kept_index[map.labels[i]];
      if (index == kNone) continue;
      std::array<int, 2>& ends =
          extents[index].ends[y - static_cast<std::size_t>(extents[index].top)];
      ends[0] = std::min(ends[0], map.begins[i]);
      ends[1] = map.begins[i + 1] - 1;
    }
  }
  return extents;
}

}  // namespace

std::vector<Region> find_regions(const GrayView& image, const RegionOptions& options) {
  if (image.width < options.min_width || image.height < options.min_height) return {};
  RunMap map = find_runs(image, options);
  std::vector<Region> kept;
  std::vector<std::uint32_t> kept_index(map.parents.size(), kNone);
  for (std::size_t i = 0; i < map.parents.size(); ++i) {
    const Extent& extent = map.extents[i];
    if (map.parents[i] != i) {
      kept_index[i] = kept_index[map.parents[i]];
    } else if (is_kept(extent, image, options)) {
      kept_index[i] = static_cast<std::uint32_t>(kept.size());
      kept.push_back({extent.white, extent.left, extent.top, extent.right - 1, extent.bottom, {}});
    }
  }
  const std::vector<RowExtents> extents = row_extents(map, kept_index, kept);
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i].hull = hull_of(extents[i]);
  return kept;
}

// ---- Candidates.

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
};

// Quadrilaterals around two pieces of one colour: a cable in front of a frame cuts it in two.
std::vector<Quad> joined_candidates(std::vector<Piece> pieces, const FrameShape& shape) {
  std::ranges::sort(pieces, [](const Piece& a, const Piece& b) { return a.area > b.area; });
  pieces.resize(std::min(pieces.size(), kCandidate.most_pieces));
  std::vector<Quad> candidates;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = i + 1; j < pieces.size(); ++j) {
      if (pieces[i].white != pieces[j].white) continue;
      const double sum = pieces[i].area + pieces[j].area;
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
    pieces.push_back({region.white, std::move(region.hull), area});
  }
  std::ranges::move(joined_candidates(std::move(pieces), options.shape),
                    std::back_inserter(candidates));
  return candidates;
}

}  // namespace tagsmith::detail
