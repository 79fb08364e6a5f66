// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/propose.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <ranges>
#include <vector>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

// Colour changes that are followed in a level: enough that a tag's own are not missed in a small
// picture, and one per so many of its pixels in a large one. Coarse levels are searched whole; what
// they show is left out of the finer ones.
std::size_t max_changes(const PyramidLevel& level) {
  const std::size_t per_change = level.scale == 1 ? 60 : level.scale == 2 ? 20 : 3;
  const auto pixels =
      static_cast<std::size_t>(level.image.width) * static_cast<std::size_t>(level.image.height);
  return std::max(kSearch.least_changes, pixels / per_change);
}

// The part of the image around an expected tag.
PyramidLevel surroundings(const GrayView& image, const ExpectedTag& expected) {
  const double margin = expected.uncertainty_px + 16 + 0.1 * extent_of(expected.corners);
  const PixelBox box = box_around(expected.corners, margin, image);
  return {part_of(image, box), 1, 20, box.first()};
}

// How far off a side of the frame may be for it to be settled in a level, pixels of the full image.
double settling_reach(const Quad& quad, double scale, const FrameShape& shape) {
  double reach = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) {
    Quad reduced = quad;
    for (PixelPoint& corner : reduced) corner = 1 / scale * corner;
    reach = std::min(reach, scale * (side_of(reduced, i, shape).reach + 1));
  }
  return reach;
}

// The surroundings of an expected tag in the full size of the image and halved, until the fit of a
// frame reaches as far as the expectation may be off. None where the corners do not run clockwise
// around a convex shape, or where less than two tiles are in the image.
class ExpectedSurroundings {
 public:
  ExpectedSurroundings(const GrayView& image, const ExpectedTag& expected,
                       const FrameShape& shape) {
    PyramidLevel level = surroundings(image, expected);
    if (level.image.width < 2 * kTile || level.image.height < 2 * kTile ||
        !is_convex(expected.corners)) {
      return;
    }
    levels_.push_back(level);
    while (levels_.size() < 3 &&
           expected.uncertainty_px > settling_reach(expected.corners, level.scale, shape) &&
           std::min(level.image.width, level.image.height) >= 8 * kTile) {
      reduced_.push_back(half_size(level.image));
      level.image = reduced_.back().view();
      level.scale *= 2;
      level.min_contrast = 12;
      levels_.push_back(level);
    }
  }

  const std::vector<PyramidLevel>& levels() const { return levels_; }

 private:
  std::deque<GrayImage> reduced_;
  std::vector<PyramidLevel> levels_;
};

// The outlines of a level, or, with `join_pieces`, also of pairs of its regions, that may be
// feature frames; only those in the tiles `searched` where these are given (null = all).
void propose_outlines(const SearchContext& search, const PyramidLevel& level,
                      const TileMask* searched, bool join_pieces) {
  CandidateOptions options;
  options.searched = searched;
  options.known = search.found.known_in(level);
  if (level.scale == 1 && !join_pieces) options.max_size = kSearch.largest_frame;
  options.max_changes = max_changes(level);
  options.join_pieces = join_pieces;
  options.shape = typical_layout(search.options.layouts).frame;
  for (const Quad& quad : find_candidates(level, options)) search.consider(Outline{level, quad});
}

// A frame around bars, in pixels of the full image, as a level shows it.
void propose_frame_around(SearchContext& search, const PyramidLevel& level, const BarRegion& bars) {
  const BarRegion region = scaled(bars, 1 / level.scale);
  if (!has_bars(search.picture.image(), bars, kBarLines.least_bars)) return;
  if (const auto quad = frame_around(level.image, region)) search.consider(Outline{level, *quad});
}

// Frames around the bars of a level that no reading explains. Bars that the picture's border cuts
// are part of a symbol: they are not used where others are read.
void propose_frames_around(SearchContext& search, const SearchLevel& coarse) {
  const PyramidLevel& fine = search.picture.pyramid().scaled_down(2).level;
  for (const BarRegion& found :
       find_bar_regions(coarse.texture, search.found.known_in(coarse.level))) {
    if (search.found.has_read_any() && runs_off(coarse.level.image, found)) continue;
    propose_frame_around(search, fine, scaled(found, coarse.level.scale));
  }
}

// Whether the whole picture is to be searched.
bool is_wanted(const SearchContext& search) {
  const auto is_missing = [&](const ExpectedTag& tag) { return !search.found.has_read(tag); };
  const std::vector<ExpectedTag>& expected = search.options.expected;
  const bool missing = expected.empty() || std::ranges::any_of(expected, is_missing);
  const Search when = search.options.search;
  return when == Search::always || (when == Search::when_missing && missing);
}

// Proposes to follow bars without a frame, if they show enough of them and none was read there.
// Returns whether it did.
bool follow(SearchContext& search, const BarRegion& region) {
  if (search.found.has_reading_at(region.centre) ||
      !has_bars(search.picture.image(), region, 2 * kBarLines.least_bars)) {
    return false;
  }
  search.consider(region);
  return true;
}

}  // namespace

// Fits the frame in the finest level that reaches as far as the expectation may be off, and
// searches the surroundings when that fails.
void propose_expected(SearchContext& search) {
  for (const ExpectedTag& expected : search.options.expected) {
    const ExpectedSurroundings around(search.picture.image(), expected,
                                      typical_layout(search.options.layouts).frame);
    if (around.levels().empty()) continue;
    const PyramidLevel& coarsest = around.levels().back();
    search.consider(RoughFrame{coarsest, to_level(coarsest, expected.corners)});
    for (const PyramidLevel& part : std::views::reverse(around.levels())) {
      if (search.found.has_read(expected)) break;
      propose_outlines(search, part, nullptr, false);
    }
  }
}

// All levels, the coarsest first, the others near bars alone. In the coarsest the bars of
// a large tag are wider than a tile's texture shows; what it does not hold is smaller.
// Why: docs/decisions/0008-search-and-its-cost.md.
void propose_near_bars(SearchContext& search) {
  if (!is_wanted(search)) return;
  search.is_searched = true;
  const std::deque<SearchLevel>& levels = search.picture.pyramid().levels();
  propose_outlines(search, levels.front().level, nullptr, false);
  for (const SearchLevel& at : levels | std::views::drop(1)) {
    const TileMask near_bars = tiles_near_bars(at.texture, search.found.known_in(at.level));
    propose_outlines(search, at.level, &near_bars, false);
  }
}

void propose_around_bars(SearchContext& search) {
  const Pyramid& pyramid = search.picture.pyramid();
  propose_frames_around(search, pyramid.scaled_down(4));
  if (search.found.has_read_any()) return;
  propose_frames_around(search, pyramid.scaled_down(2));
  if (search.found.has_read_any()) return;
  // Bars with modules of about one pixel are visible only at full size.
  for (const BarRegion& region : search.picture.bars()) {
    if (region.length > kSearch.largest_frame) continue;
    propose_frame_around(search, pyramid.levels().back().level, region);
  }
}

void propose_pieces(SearchContext& search) {
  if (search.found.has_read_any()) return;
  for (const SearchLevel& at : search.picture.pyramid().levels()) {
    propose_outlines(search, at.level, nullptr, true);
  }
}

void propose_refused(SearchContext& search) {
  for (const std::size_t index : search.found.covered_frames())
    search.consider(RefusedFrame{index});
  std::vector<BarRegion> followed;
  for (const BarRegion& region : search.found.odd_bars()) {
    const auto same = [&](const BarRegion& other) { return same_bars(other, region); };
    if (std::ranges::none_of(followed, same) && follow(search, region)) followed.push_back(region);
  }
}

// Why: docs/decisions/0008-search-and-its-cost.md.
void propose_bars(SearchContext& search) {
  if (search.found.has_read_any() && !search.found.has_met_covers()) return;
  std::size_t followed = 0;
  for (const BarRegion& region : search.picture.bars()) {
    if (follow(search, region) && ++followed == kSearch.most_tries) break;
  }
}

}  // namespace tagsmith::detail
