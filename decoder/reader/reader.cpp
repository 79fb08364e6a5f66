// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <ranges>
#include <vector>

#include "decoder/feature_frame/bar_blocks.hpp"
#include "decoder/feature_frame/bar_texture.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/detector.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/picture_bars.hpp"
#include "decoder/reader/propose.hpp"
#include "decoder/reader/pyramid.hpp"

namespace tagsmith {
namespace {

void try_outlines(Detector& detector, const PyramidLevel& level, const TileMask* searched,
                  bool join_pieces) {
  for (const Quad& outline :
       propose_outlines(level, detector.known_in(level), searched, join_pieces)) {
    detector.try_outline(level, outline);
  }
}

// Looks for an expected tag where it should be: fits its frame from there in the finest level that
// reaches as far as the expectation may be off, and searches the surroundings when that fails.
void try_expected(Detector& detector, const GrayView& image, const ExpectedTag& expected) {
  const ExpectedSurroundings around(image, expected);
  if (around.levels().empty()) return;
  const PyramidLevel& coarsest = around.levels().back();
  detector.try_frame(coarsest, to_level(coarsest, expected.corners));
  if (detector.has_read(expected)) return;
  for (const PyramidLevel& part : std::views::reverse(around.levels())) {
    try_outlines(detector, part, nullptr, false);
  }
}

// Searches all levels, the coarsest first, the others near bars alone. In the coarsest the bars of
// a large tag are wider than a tile's texture shows; what it does not hold is smaller.
// Why: docs/decisions/0008-search-and-its-cost.md.
void try_near_bars(Detector& detector, const Pyramid& pyramid) {
  for (const SearchLevel& at : pyramid.levels()) {
    if (&at == &pyramid.levels().front()) {
      try_outlines(detector, at.level, nullptr, false);
    } else {
      const TileMask near_bars = tiles_near_bars(at.texture, detector.known_in(at.level));
      try_outlines(detector, at.level, &near_bars, false);
    }
  }
}

// Looks for frames whose outline is in pieces, by the bars inside: around the blocks of bars of a
// level that no reading explains. Returns those blocks that are like symbols, in pixels of the full
// image. Bars that run off the picture are part of a symbol: not looked at where others are read.
std::vector<BarBlock> try_around_bars(Detector& detector, const SearchLevel& coarse,
                                      const PyramidLevel& fine) {
  std::vector<BarBlock> symbols;
  for (const BarBlock& found : find_bar_blocks(coarse.texture, detector.known_in(coarse.level))) {
    if (detector.has_read_any() && runs_off(coarse.level.image, found)) continue;
    const BarBlock block = scaled(found, coarse.level.scale / fine.scale);
    if (!is_symbol_like(fine.image, block)) continue;
    symbols.push_back(scaled(found, coarse.level.scale));
    if (const auto quad = frame_around(fine.image, block)) detector.try_outline(fine, *quad);
  }
  return symbols;
}

// Looks for frames whose outline is in pieces around these blocks, or, where nothing was read,
// everywhere.
void try_pieces(Detector& detector, const Pyramid& pyramid, const std::vector<BarBlock>& symbols) {
  const bool everywhere = !detector.has_read_any();
  for (const SearchLevel& at : pyramid.levels()) {
    const TileMask around = tiles_around(symbols, at);
    if (!everywhere && std::ranges::count(around.tiles, 1) == 0) continue;
    try_outlines(detector, at.level, everywhere ? nullptr : &around, true);
  }
}

// The largest of the blocks of bars that no reading explains.
std::optional<BarRegion> largest_of(const Detector& detector, PictureBars& bars,
                                    std::vector<BarBlock> blocks) {
  std::ranges::stable_sort(blocks, std::ranges::greater{}, &BarBlock::half_width);
  for (const BarBlock& block : blocks) {
    const BarRegion region{block.centre, block.across, 2 * block.half_width, 2 * block.half_height};
    if (detector.has_reading_at(region.centre) || detector.was_looked_at(region)) continue;
    if (may_be_followed(bars, region)) return region;
  }
  return std::nullopt;
}

// Reads carefully what may be covered tags, which takes longer than all the rest: in frames that
// did not convince, and around bars; where something was read and nothing was in the way, around
// those alone that were found to be much like a symbol.
// Why: docs/decisions/0008-search-and-its-cost.md.
void try_covered(Detector& detector, PictureBars& bars, const PyramidLevel& half,
                 const std::vector<BarBlock>& symbols) {
  const bool everywhere = !detector.has_read_any() || detector.has_met_covers();
  detector.try_covered(half.image);
  if (!everywhere) {
    const auto largest = largest_of(detector, bars, symbols);
    if (largest) detector.try_bars(half.image, *largest);
    return;
  }
  const std::vector<Quad> known = detector.known_in({bars.light.image(), 1});
  for (const BarRegion& region : propose_bars(bars, half, known)) {
    detector.try_bars(half.image, region);
  }
}

// Bars that no reading explains, or a picture without any reading, are worth a closer look.
void try_closer(Detector& detector, PictureBars& bars, const Pyramid& pyramid) {
  const SearchLevel& half = pyramid.scaled_down(2);
  std::vector<BarBlock> symbols = try_around_bars(detector, pyramid.scaled_down(4), half.level);
  if (!symbols.empty() || !detector.has_read_any()) {
    const std::vector<BarBlock> small = try_around_bars(detector, half, half.level);
    symbols.insert(symbols.end(), small.begin(), small.end());
    try_pieces(detector, pyramid, symbols);
  }
  try_covered(detector, bars, half.level, symbols);
}

}  // namespace

struct TagSearch::State {
  State(const GrayView& image, const ReadOptions& how)
      : options(how), bars(image), detector(image, bars, options) {}

  ReadOptions options;
  PictureBars bars;
  Detector detector;
  std::optional<Pyramid> pyramid;  // while a closer look may find more
  std::vector<Reading> tags;       // after each of the two steps
};

TagSearch::TagSearch(const GrayView& image, const ReadOptions& options)
    : state_(std::make_unique<State>(image, options)) {
  Detector& detector = state_->detector;
  for (const ExpectedTag& tag : options.expected) try_expected(detector, image, tag);
  const auto is_missing = [&](const ExpectedTag& tag) { return !detector.has_read(tag); };
  const bool missing =
      options.expected.empty() || std::ranges::any_of(options.expected, is_missing);
  if (options.search == Search::always || (options.search == Search::when_missing && missing)) {
    state_->pyramid.emplace(image);
    try_near_bars(detector, *state_->pyramid);
  }
  detector.try_doubtful();
  state_->tags = detector.tags();
}

TagSearch::TagSearch(TagSearch&&) noexcept = default;
TagSearch& TagSearch::operator=(TagSearch&&) noexcept = default;
TagSearch::~TagSearch() = default;

void TagSearch::look_closer() {
  if (!state_->pyramid) return;
  try_closer(state_->detector, state_->bars, *state_->pyramid);
  state_->detector.try_doubtful();
  state_->detector.try_likely_codes();
  state_->tags = state_->detector.tags();
  state_->pyramid.reset();
}

const std::vector<Reading>& TagSearch::tags() const { return state_->tags; }

ReadResult TagSearch::result() const {
  return with_frameless(state_->bars, state_->options, state_->detector.result());
}

ReadResult read_tags(const GrayView& image, const ReadOptions& options) {
  TagSearch search(image, options);
  search.look_closer();
  return search.result();
}

}  // namespace tagsmith
