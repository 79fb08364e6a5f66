// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "decoder/feature_frame/bar_blocks.hpp"
#include "decoder/feature_frame/bar_texture.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/half_size.hpp"
#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/picture_bars.hpp"
#include "decoder/reader/picture_reader.hpp"

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

// A level and what its tiles show.
struct SearchLevel {
  PyramidLevel level;
  TextureGrid texture;
};

// The image at full, half, quarter size and so on, the coarsest first.
class Pyramid {
 public:
  explicit Pyramid(const GrayView& image) {
    // Noise halves from level to level, and with it the contrast that stands out from it.
    constexpr std::array<int, 3> kContrasts{20, 12, 7};
    constexpr int kLeastSize = 160;
    add({image, 1, kContrasts[0]});
    while (levels_.size() < 3 || std::min(coarsest().width, coarsest().height) >= 2 * kLeastSize) {
      const double scale = 2 * levels_.front().level.scale;
      reduced_.push_back(half_size(coarsest()));
      add({reduced_.back().view(), scale, kContrasts[std::min<std::size_t>(levels_.size(), 2)]});
    }
  }

  const std::deque<SearchLevel>& levels() const { return levels_; }

  // The level of a half (2) or a quarter (4) of the size.
  const SearchLevel& scaled_down(int times) const {
    return levels_[levels_.size() - (times == 2 ? 2 : 3)];
  }

 private:
  const GrayView& coarsest() const { return levels_.front().level.image; }

  void add(const PyramidLevel& level) { levels_.push_front({level, texture_of(level.image)}); }

  std::deque<GrayImage> reduced_;
  std::deque<SearchLevel> levels_;
};

// Tries the regions of a level, and pairs of them, that look like frames; those near bars alone
// where a mask says where these are.
void search_regions(PictureReader& reader, const PyramidLevel& level, const TileMask* near_bars,
                    bool join_pieces) {
  CandidateOptions search;
  search.searched = near_bars;
  search.known = reader.known_in(level);
  if (level.scale == 1 && !join_pieces) search.max_size = kMaxFinestSize;
  search.max_changes = max_changes(level);
  search.join_pieces = join_pieces;
  for (const Quad& candidate : find_candidates(level, search)) {
    reader.try_candidate(level, candidate);
  }
}

// Searches all levels, the coarsest first, the others near bars alone. In the coarsest the bars of
// a large tag are wider than a tile's texture shows; what it does not hold is smaller.
// Why: docs/decisions/0008-search-and-its-cost.md.
void search_near_bars(PictureReader& reader, const Pyramid& pyramid) {
  for (const SearchLevel& at : pyramid.levels()) {
    if (&at == &pyramid.levels().front()) {
      search_regions(reader, at.level, nullptr, false);
    } else {
      const TileMask near_bars = tiles_near_bars(at.texture, reader.known_in(at.level));
      search_regions(reader, at.level, &near_bars, false);
    }
  }
}

// Looks for frames whose outline is in pieces, by the bars inside: around the blocks of bars of a
// level that no reading explains. Returns those blocks that are like symbols, in pixels of the full
// image. Bars that run off the picture are part of a symbol: not looked at where others are read.
std::vector<BarBlock> search_around_bars(PictureReader& reader, const SearchLevel& coarse,
                                         const PyramidLevel& fine) {
  std::vector<BarBlock> symbols;
  for (const BarBlock& found : find_bar_blocks(coarse.texture, reader.known_in(coarse.level))) {
    if (reader.has_read_any() && runs_off(coarse.level.image, found)) continue;
    const BarBlock block = scaled(found, coarse.level.scale / fine.scale);
    if (!is_symbol_like(fine.image, block)) continue;
    symbols.push_back(scaled(found, coarse.level.scale));
    if (const auto quad = frame_around(fine.image, block)) reader.try_candidate(fine, *quad);
  }
  return symbols;
}

// The tiles of a level around these blocks, as far as a frame reaches. Blocks as long as those that
// the next coarser level shows well are left to it.
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

// Looks for an expected tag where it should be: fits its frame from there in the finest level that
// reaches as far as the expectation may be off, and searches the surroundings when that fails.
void look_for(PictureReader& reader, const GrayView& image, const ExpectedTag& expected) {
  PyramidLevel level = surroundings(image, expected);
  constexpr int kLeastSize = 16;
  if (level.image.width < kLeastSize || level.image.height < kLeastSize ||
      !is_convex(expected.corners)) {
    return;
  }
  std::deque<GrayImage> reduced;
  std::vector<PyramidLevel> levels{level};
  while (levels.size() < 3 &&
         expected.uncertainty_px > settling_reach(expected.corners, level.scale) &&
         std::min(level.image.width, level.image.height) >= 4 * kLeastSize) {
    reduced.push_back(half_size(level.image));
    level.image = reduced.back().view();
    level.scale *= 2;
    level.min_contrast = 12;
    levels.push_back(level);
  }
  reader.try_frame(level, to_level(level, expected.corners));
  if (reader.has_read(expected)) return;
  std::ranges::reverse(levels);
  for (const PyramidLevel& part : levels) search_regions(reader, part, nullptr, false);
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

// The largest fields of bars that no reading explains.
std::vector<BarRegion> unexplained_bars(const PictureReader& reader, PictureBars& all,
                                        const PyramidLevel& half) {
  constexpr std::size_t kLooked = 24;
  constexpr std::size_t kMost = 3;
  constexpr double kLeastProportion = 0.6, kMostProportion = 6;
  const GrayView& image = all.light.image();
  const PyramidLevel full{image, 1};
  const std::vector<Quad> known = reader.known_in(full);
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

// The largest of the blocks of bars that no reading explains.
std::vector<BarRegion> largest_of(const PictureReader& reader, SampledLight& image,
                                  std::vector<BarBlock> blocks) {
  constexpr std::size_t kMost = 1;
  std::ranges::stable_sort(blocks, std::ranges::greater{}, &BarBlock::half_width);
  std::vector<BarRegion> regions;
  for (const BarBlock& block : blocks) {
    if (regions.size() == kMost) break;
    const BarRegion region{block.centre, block.across, 2 * block.half_width, 2 * block.half_height};
    if (region.length < kLeastBarsLength || reader.has_reading_at(region.centre) ||
        reader.was_looked_at(region) || is_cut_off(image.image(), region)) {
      continue;
    }
    if (has_bars(image, region)) regions.push_back(region);
  }
  return regions;
}

// Whether covered tags are looked for around all bars that no reading explains: where nothing was
// read, or something was in the way.
// Why: docs/decisions/0008-search-and-its-cost.md.
bool is_worth_care(const PictureReader& reader) {
  return !reader.has_read_any() || reader.has_met_covers();
}

// Reads carefully what may be covered tags, which takes longer than all the rest: in frames that
// did not convince, and around bars, where is_worth_care() does not say so those alone that were
// found to be much like a symbol (`symbols`).
void read_covered(PictureReader& reader, PictureBars& all, const PyramidLevel& half,
                  const std::vector<BarBlock>& symbols) {
  const bool everywhere = is_worth_care(reader);
  reader.try_covered(half.image);
  const std::vector<BarRegion> bars =
      everywhere ? unexplained_bars(reader, all, half) : largest_of(reader, all.light, symbols);
  for (const BarRegion& region : bars) reader.try_bars(half.image, region);
}

// Bars that no reading explains, or a picture without any reading, are worth a closer look.
void search_closer(PictureReader& reader, PictureBars& bars, const Pyramid& pyramid) {
  const SearchLevel& half = pyramid.scaled_down(2);
  std::vector<BarBlock> symbols = search_around_bars(reader, pyramid.scaled_down(4), half.level);
  if (symbols.empty() && reader.has_read_any()) {
    return read_covered(reader, bars, half.level, symbols);
  }
  const std::vector<BarBlock> small = search_around_bars(reader, half, half.level);
  symbols.insert(symbols.end(), small.begin(), small.end());
  const bool everywhere = !reader.has_read_any();
  for (const SearchLevel& at : pyramid.levels()) {
    const TileMask around = tiles_around(symbols, at);
    if (!everywhere && std::ranges::count(around.tiles, 1) == 0) continue;
    search_regions(reader, at.level, everywhere ? nullptr : &around, true);
  }
  read_covered(reader, bars, half.level, symbols);
}

}  // namespace

struct TagSearch::State {
  State(const GrayView& image, const ReadOptions& how)
      : options(how), bars(image), reader(image, bars, options) {}

  ReadOptions options;
  PictureBars bars;
  PictureReader reader;
  std::optional<Pyramid> pyramid;  // while a closer look may find more
};

TagSearch::TagSearch(const GrayView& image, const ReadOptions& options)
    : state_(std::make_unique<State>(image, options)) {
  PictureReader& reader = state_->reader;
  for (const ExpectedTag& tag : options.expected) look_for(reader, image, tag);
  const auto is_missing = [&](const ExpectedTag& tag) { return !reader.has_read(tag); };
  const bool missing =
      options.expected.empty() || std::ranges::any_of(options.expected, is_missing);
  if (options.search == Search::always || (options.search == Search::when_missing && missing)) {
    state_->pyramid.emplace(image);
    search_near_bars(reader, *state_->pyramid);
  }
  reader.try_doubtful();
}

TagSearch::TagSearch(TagSearch&&) noexcept = default;
TagSearch& TagSearch::operator=(TagSearch&&) noexcept = default;
TagSearch::~TagSearch() = default;

void TagSearch::look_closer() {
  if (!state_->pyramid) return;
  search_closer(state_->reader, state_->bars, *state_->pyramid);
  state_->reader.try_doubtful();
  state_->pyramid.reset();
}

const std::vector<Reading>& TagSearch::tags() const { return state_->reader.tags(); }

ReadResult TagSearch::result() const {
  return with_frameless(state_->bars, state_->options, state_->reader.result());
}

ReadResult read_tags(const GrayView& image, const ReadOptions& options) {
  TagSearch search(image, options);
  search.look_closer();
  return search.result();
}

}  // namespace tagsmith
