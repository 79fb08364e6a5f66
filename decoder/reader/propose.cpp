// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/propose.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "decoder/feature_frame/bar_texture.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/half_size.hpp"
#include "decoder/reader/bar_lines.hpp"

namespace tagsmith {
namespace {

// Frames larger than this are seen in the image at half its size, pixels.
constexpr int kMaxFinestSize = 240;

// Changes of colour that are followed in a level: so many that a tag's own are not missed in a
// small picture, and one for so many of its pixels in a large one. Coarse levels are searched
// whole; what they show is left out of the finer ones.
std::size_t max_changes(const PyramidLevel& level) {
  constexpr std::size_t kLeast = 20'000;
  const std::size_t per_change = level.scale == 1 ? 60 : level.scale == 2 ? 20 : 3;
  const auto pixels =
      static_cast<std::size_t>(level.image.width) * static_cast<std::size_t>(level.image.height);
  return std::max(kLeast, pixels / per_change);
}

// The part of the image around an expected tag.
PyramidLevel surroundings(const GrayView& image, const ExpectedTag& expected) {
  const FrameCorners& c = expected.corners;
  const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x, c[3].x});
  const auto [top, bottom] = std::minmax({c[0].y, c[1].y, c[2].y, c[3].y});
  const double margin = expected.uncertainty_px + 16 + 0.1 * std::max(right - left, bottom - top);
  const auto pixel = [](double at, int end) {  // 0 for what is no number
    return at > 0 ? static_cast<int>(std::min(at, static_cast<double>(end))) : 0;
  };
  const int first_x = pixel(left - margin, image.width);
  const int first_y = pixel(top - margin, image.height);
  PyramidLevel part{image, 1, 20, {static_cast<double>(first_x), static_cast<double>(first_y)}};
  part.image.data = image.row(first_y) + first_x;
  part.image.width = pixel(right + margin, image.width) - first_x;
  part.image.height = pixel(bottom + margin, image.height) - first_y;
  return part;
}

// How far off a side of the frame may be for it to be settled in a level, pixels of the full image.
double settling_reach(const Quad& quad, double scale) {
  double reach = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) {
    Quad reduced = quad;
    for (PixelPoint& corner : reduced) corner = 1 / scale * corner;
    reach = std::min(reach, scale * (side_of(reduced, i).reach + 1));
  }
  return reach;
}

// Whether bars reach the border of the image: part of the symbol is out of sight.
bool is_cut_off(const GrayView& image, const BarRegion& region) {
  constexpr double kNear = 0.08;   // of the length: their quiet zone is longer
  constexpr double kBlurred = 12;  // pixels by which a region may be too short
  const PixelPoint half = ((0.5 + kNear) * region.length + kBlurred) * region.across;
  const auto outside = [&](PixelPoint at) {
    return at.x < 0 || at.y < 0 || at.x > image.width - 1 || at.y > image.height - 1;
  };
  return outside(region.centre - half) || outside(region.centre + half);
}

constexpr double kLeastBarsLength = 90;  // pixels: a symbol of about a pixel a module

// Whether two regions are the same bars.
bool overlap(const BarRegion& a, const BarRegion& b) {
  return distance(a.centre, b.centre) < 0.25 * b.length && b.length > 0.75 * a.length &&
         b.length < 1.33 * a.length;
}

}  // namespace

std::vector<Quad> propose_outlines(const PyramidLevel& level, std::vector<Quad> known,
                                   const TileMask* searched, bool join_pieces) {
  CandidateOptions search;
  search.searched = searched;
  search.known = std::move(known);
  if (level.scale == 1 && !join_pieces) search.max_size = kMaxFinestSize;
  search.max_changes = max_changes(level);
  search.join_pieces = join_pieces;
  return find_candidates(level, search);
}

TileMask tiles_around(const std::vector<BarBlock>& blocks, const SearchLevel& at) {
  constexpr double kWider = 1.4, kHigher = 2;
  constexpr double kLongest = 1.5 * kMaxFinestSize;
  TileMask mask{at.texture.columns, at.texture.rows,
                std::vector<std::uint8_t>(at.texture.tiles.size())};
  for (BarBlock block : blocks) {
    block = scaled(block, 1 / at.level.scale);
    if (at.level.scale == 1 && 2 * block.half_width > kLongest) continue;
    const PixelPoint right = (kWider * block.half_width + 2 * kTile) * block.across;
    const PixelPoint down = (kHigher * block.half_height + 2 * kTile) * block.along;
    const PixelPoint& c = block.centre;
    const Quad around{c - right - down, c + right - down, c + right + down, c - right + down};
    for (int row = 0; row < mask.rows; ++row) {
      const auto [begin, end] = tiles_in_row(around, row, mask.columns);
      const auto first = mask.tiles.begin() + static_cast<std::ptrdiff_t>(row) * mask.columns;
      std::fill(first + begin, first + end, std::uint8_t{1});
    }
  }
  return mask;
}

ExpectedSurroundings::ExpectedSurroundings(const GrayView& image, const ExpectedTag& expected) {
  PyramidLevel level = surroundings(image, expected);
  constexpr int kLeastSize = 16;
  if (level.image.width < kLeastSize || level.image.height < kLeastSize ||
      !is_convex(expected.corners)) {
    return;
  }
  levels_.push_back(level);
  while (levels_.size() < 3 &&
         expected.uncertainty_px > settling_reach(expected.corners, level.scale) &&
         std::min(level.image.width, level.image.height) >= 4 * kLeastSize) {
    reduced_.push_back(half_size(level.image));
    level.image = reduced_.back().view();
    level.scale *= 2;
    level.min_contrast = 12;
    levels_.push_back(level);
  }
}

std::vector<BarRegion> propose_bars(PictureBars& all, const PyramidLevel& half,
                                    const std::vector<Quad>& known) {
  constexpr std::size_t kLooked = 24;
  constexpr std::size_t kMost = 3;
  constexpr double kLeastProportion = 0.6, kMostProportion = 6;
  const GrayView& image = all.light.image();
  std::vector<BarRegion> bars;
  const auto add = [&](const BarRegion& region) {
    const double proportion = region.length / std::max(region.height, 1.0);
    if (region.length < kLeastBarsLength || proportion < kLeastProportion ||
        proportion > kMostProportion) {
      return;
    }
    const auto holds = [&](const Quad& quad) { return contains(quad, region.centre); };
    if (std::ranges::any_of(known, holds) || is_cut_off(image, region)) return;
    const auto same = [&](const BarRegion& other) { return overlap(other, region); };
    if (std::ranges::any_of(bars, same)) return;
    const BarBlock block{region.centre,
                         region.across,
                         {-region.across.y, region.across.x},
                         region.length / 2,
                         region.height / 2};
    if (is_symbol_like(half.image, scaled(block, 1 / half.scale)) && has_bars(all.light, region)) {
      bars.push_back(region);
    }
  };
  for (const BarRegion& region : all.regions.apart(kLooked)) {
    if (bars.size() < kMost) add(region);
  }
  if (bars.size() == kMost) return bars;
  for (const BarRegion& region : all.regions.whole(kLooked)) {
    if (bars.size() < kMost) add(region);
  }
  return bars;
}

bool may_be_followed(PictureBars& bars, const BarRegion& region) {
  return region.length >= kLeastBarsLength && !is_cut_off(bars.light.image(), region) &&
         has_bars(bars.light, region);
}

}  // namespace tagsmith
