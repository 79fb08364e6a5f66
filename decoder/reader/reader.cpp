// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "decoder/feature_frame/bar_blocks.hpp"
#include "decoder/feature_frame/bar_direction.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/settle_frame.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/half_size.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/symbol_profile.hpp"
#include "decoder/scan/decode.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

PixelPoint centre_of(const Quad& quad) { return 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]); }

// True when both frames are the same one seen twice.
bool same_frame(const Quad& a, const Quad& b) {
  const double size = std::sqrt(std::min(area_of(a), area_of(b)));
  const double ratio = area_of(a) / std::max(area_of(b), 1e-9);
  return distance(centre_of(a), centre_of(b)) < 0.1 * size && ratio > 0.7 && ratio < 1.4;
}

// True when the corners of two quadrilaterals are less than this many pixels apart, in any turn.
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

// The corners that may be P's: the symbol runs the way in which the grey level changes; both ways
// when that is not clear. Upside down is left to the symbol.
std::vector<std::size_t> possible_first_corners(const GrayView& image, const Quad& quad) {
  constexpr double kClear = 1.5;
  const BarSteps steps = bar_steps(image, quad);
  if (steps.along > kClear * steps.across) return {0};
  if (steps.across > kClear * steps.along) return {1};
  return {0, 1};
}

struct Attempt {
  Decoding decoding;
  std::size_t first_corner = 0;
  SymbolProfile profile;
};

// The best explained attempt along the symbol direction(s) that are possible.
std::optional<Attempt> best_attempt(const GrayView& image, const RefinedFrame& frame,
                                    const ReadOptions& options) {
  const DecodeOptions decode_options{options.check, options.code_book};
  std::optional<Attempt> best;
  const auto attempt = [&](std::size_t first_corner, const SymbolLayout& layout) {
    const SymbolProfile profile = profile_symbol(image, frame, first_corner, layout);
    SymbolImage start;
    start.blur = std::clamp(profile.blur, 0.1, 3.0);
    const auto decoding = decode_profile(profile.bins, start, decode_options);
    if (!decoding) return;
    if (best && decoding->fit.explained <= best->decoding.fit.explained) return;
    best = Attempt{*decoding, (first_corner + (decoding->upside_down ? 2 : 0)) % 4, profile};
  };
  for (const std::size_t first_corner : possible_first_corners(image, frame.corners)) {
    for (const SymbolLayout& layout : options.layouts) attempt(first_corner, layout);
  }
  return best;
}

// The frame's corners from P on. Whatever widens the bars, ink or a tone curve that is not sRGB,
// moves the frame's inner edge inwards by as much.
FrameCorners corners_of(const RefinedFrame& frame, const Attempt& attempt) {
  const double growth_px = attempt.decoding.fit.image.growth * attempt.profile.module_px;
  const Quad quad = widened(frame.corners, growth_px / 2);
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = quad[(attempt.first_corner + i) % 4];
  return corners;
}

// What speaks against believing the attempt, or nothing.
std::optional<std::string> objection(const Attempt& attempt, const ReadOptions& options) {
  // A symbol of ours explains 95 % and more of its profile when it can be read at all; the product
  // codes and random stripes of the test pictures reach 88 %.
  constexpr double kLeastExplained = 0.9;
  // Right digits on the ray-traced photos: 0.82 and more; digits with an edge a module off: 0.5.
  constexpr double kLeastDigit = 0.75;
  constexpr double kLeastGuards = 0.8;
  constexpr double kLeastKept = 0.7;
  constexpr double kMostGrowth = 0.7;  // modules; beyond, narrow elements vanish
  // Modules; beyond, digits differ by what is left in the tails of the point spread, of which
  // nothing is known.
  constexpr double kMostBlur = 2.2;
  const Decoding& decoding = attempt.decoding;
  const bool with_book = !options.code_book.empty();
  if (decoding.guards < kLeastGuards) return "guard pattern";
  if (decoding.fit.explained < kLeastExplained || decoding.worst_digit < kLeastDigit) {
    return "element widths";
  }
  if (decoding.fit.kept < kLeastKept) return "bars covered";
  if (std::abs(decoding.fit.image.growth) > kMostGrowth) return "bars grown or shrunk";
  if (!with_book && decoding.fit.image.blur > kMostBlur) return "too blurred";
  const double sure = with_book ? kSureWithBook : kSureAlone;
  if (decoding.confidence < options.min_confidence.value_or(sure)) return "not certain enough";
  return std::nullopt;
}

// Why a symbol that no code of the book explains is none of them, where it is read for certain
// without the book.
std::optional<std::string> stranger_to_book(const GrayView& image, const RefinedFrame& frame,
                                            const ReadOptions& options) {
  ReadOptions alone;
  alone.check = options.check;
  alone.layouts = options.layouts;
  const auto attempt = best_attempt(image, frame, alone);
  if (!attempt || objection(*attempt, alone)) return std::nullopt;
  const Digits& digits = attempt->decoding.digits;
  if (std::ranges::find(options.code_book, digits) != options.code_book.end()) return std::nullopt;
  return "the digits " + to_string(digits) + " are in none of the given surveys";
}

Reading reading_from(const RefinedFrame& frame, const Attempt& attempt,
                     const FrameCorners& corners) {
  Reading reading;
  reading.digits = attempt.decoding.digits;
  reading.sum10_holds = has_check_digit(CheckDigit::sum10, reading.digits);
  reading.gs1_holds = has_check_digit(CheckDigit::gs1, reading.digits);
  reading.corners = corners;
  reading.corner_covariance = turned(corner_covariance(frame), attempt.first_corner);
  reading.module_px = attempt.profile.module_px;
  reading.confidence = attempt.decoding.confidence;
  reading.method = "frame";
  return reading;
}

// Reads one picture: keeps what was found and what was tried, so that a frame seen at several
// levels is read once.
class PictureReader {
 public:
  PictureReader(const GrayView& image, const ReadOptions& options)
      : image_(image), options_(options) {}

  // Looks at a candidate found in a level of the pyramid.
  void try_candidate(const PyramidLevel& level, const Quad& candidate) {
    if (is_read(to_full(level, candidate))) return;
    if (!looks_framed(level.image, candidate)) {
      return pass_over(to_full(level, candidate), kNotFramedReason);
    }
    try_frame(level, candidate);
  }

  // Reads what stands in a frame that is known to a few pixels of the level.
  void try_frame(const PyramidLevel& level, const Quad& rough) {
    const Result<Quad> settled = settle_frame(level.image, rough);
    if (!settled) return pass_over(to_full(level, rough), settled.error().message);
    const Quad quad = to_full(level, *settled);
    if (is_read(quad)) return;
    if (was_tried(settled_, quad, 0.4)) return;
    settled_.push_back(quad);
    const Result<RefinedFrame> frame = refine_frame(image_, quad);
    if (!frame) return pass_over(quad, frame.error().message);
    if (was_tried(refined_, frame->corners, 0.1)) return;
    refined_.push_back(frame->corners);
    const auto attempt = best_attempt(image_, *frame, options_);
    if (!attempt) return pass_over(quad, "no guard patterns inside");
    judge(*frame, *attempt);
  }

  // The plates read so far, in pixels of a level.
  std::vector<Quad> known_in(const PyramidLevel& level) const {
    constexpr double kStroke = 0.04;  // of the frame's length: the frame and a little more
    std::vector<Quad> known;
    for (const Reading& tag : result_.tags) {
      const double stroke = kStroke * distance(tag.corners[0], tag.corners[1]);
      known.push_back(to_level(level, widened(tag.corners, stroke)));
    }
    return known;
  }

  bool has_read_any() const { return !result_.tags.empty(); }

  // Whether an expected tag has been read where it should be.
  bool has_read(const ExpectedTag& expected) const {
    const auto fits = [&](const Reading& tag) {
      for (std::size_t i = 0; i < 4; ++i) {
        const double off = distance(tag.corners[i], expected.corners[i]);
        if (off > expected.uncertainty_px + 1) return false;
      }
      return true;
    };
    return std::ranges::any_of(result_.tags, fits);
  }

  ReadResult take_result() {
    // A frame that was read after all is no refusal, and one refused twice is one.
    std::vector<Rejection> kept;
    for (const Rejection& rejection : result_.rejected) {
      const auto same = [&](const auto& other) {
        return same_frame(other.corners, rejection.corners);
      };
      if (std::ranges::any_of(result_.tags, same) || std::ranges::any_of(kept, same)) continue;
      kept.push_back(rejection);
    }
    result_.rejected = std::move(kept);
    return std::move(result_);
  }

 private:
  bool is_read(const Quad& quad) const {
    const auto same = [&](const Reading& tag) { return same_frame(tag.corners, quad); };
    return std::ranges::any_of(result_.tags, same);
  }

  static bool was_tried(const std::vector<Quad>& tried, const Quad& quad, double pixels) {
    return std::ranges::any_of(
        tried, [&](const Quad& other) { return nearly_equal(other, quad, pixels); });
  }

  void pass_over(const Quad& quad, const std::string& reason) {
    if (options_.tell_passed_over) result_.passed_over.push_back({reason, quad});
  }

  void judge(const RefinedFrame& frame, const Attempt& attempt) {
    const FrameCorners corners = corners_of(frame, attempt);
    if (const auto reason = objection(attempt, options_)) {
      const auto stranger =
          options_.code_book.empty() ? std::nullopt : stranger_to_book(image_, frame, options_);
      result_.rejected.push_back({stranger.value_or(*reason), corners});
    } else {
      result_.tags.push_back(reading_from(frame, attempt, corners));
    }
  }

  GrayView image_;
  const ReadOptions& options_;
  ReadResult result_;
  std::vector<Quad> settled_;  // frames tried, before and after the fine fit
  std::vector<Quad> refined_;
};

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

// The image at full, half, quarter size and so on, the coarsest first.
class Pyramid {
 public:
  explicit Pyramid(const GrayView& image) {
    // Noise halves from level to level, and with it the contrast that stands out from it.
    constexpr std::array<int, 3> kContrasts{20, 12, 7};
    constexpr int kLeastSize = 160;
    levels_.push_back({image, 1, kContrasts[0]});
    while (levels_.size() < 3 ||
           std::min(levels_.back().image.width, levels_.back().image.height) >= 2 * kLeastSize) {
      const PyramidLevel& finer = levels_.back();
      reduced_.push_back(half_size(finer.image));
      const int contrast = kContrasts[std::min<std::size_t>(levels_.size(), 2)];
      levels_.push_back({reduced_.back().view(), 2 * finer.scale, contrast});
    }
    std::ranges::reverse(levels_);
  }

  const std::vector<PyramidLevel>& levels() const { return levels_; }

  // The level of a half (2) or a quarter (4) of the size.
  const PyramidLevel& scaled_down(int times) const {
    return levels_[levels_.size() - (times == 2 ? 2 : 3)];
  }

 private:
  std::deque<GrayImage> reduced_;
  std::vector<PyramidLevel> levels_;
};

// Tries the regions of a level, and pairs of them, that look like frames.
void search_regions(PictureReader& reader, const PyramidLevel& level, bool join_pieces) {
  CandidateOptions search;
  search.known = reader.known_in(level);
  if (level.scale == 1 && !join_pieces) search.max_size = kMaxFinestSize;
  search.max_changes = max_changes(level);
  search.join_pieces = join_pieces;
  for (const Quad& candidate : find_candidates(level, search)) {
    reader.try_candidate(level, candidate);
  }
}

// Looks for frames whose outline is in pieces, by the bars inside: in the blocks of bars of a
// coarse level that no reading explains. Returns whether there were any.
bool search_around_bars(PictureReader& reader, const PyramidLevel& coarse,
                        const PyramidLevel& fine) {
  bool any = false;
  for (const BarBlock& coarse_block : find_bar_blocks(coarse.image, reader.known_in(coarse))) {
    const BarBlock block = scaled(coarse_block, coarse.scale / fine.scale);
    if (!is_symbol_like(fine.image, block)) continue;
    any = true;
    if (const auto quad = frame_around(fine.image, block)) reader.try_candidate(fine, *quad);
  }
  return any;
}

// The part of the image around an expected tag.
PyramidLevel surroundings(const GrayView& image, const ExpectedTag& expected) {
  const FrameCorners& c = expected.corners;
  const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x, c[3].x});
  const auto [top, bottom] = std::minmax({c[0].y, c[1].y, c[2].y, c[3].y});
  const double margin = expected.uncertainty_px + 16 + 0.1 * std::max(right - left, bottom - top);
  const auto pixel = [](double at, int end) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(end)));
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
  for (const PyramidLevel& part : levels) search_regions(reader, part, false);
}

void search(PictureReader& reader, const GrayView& image) {
  const Pyramid pyramid(image);
  for (const PyramidLevel& level : pyramid.levels()) search_regions(reader, level, false);
  // Bars that no reading explains, or a picture without any reading, are worth a closer look.
  const PyramidLevel& half = pyramid.scaled_down(2);
  const bool bars = search_around_bars(reader, pyramid.scaled_down(4), half);
  if (!bars && reader.has_read_any()) return;
  search_around_bars(reader, half, half);
  for (const PyramidLevel& level : pyramid.levels()) search_regions(reader, level, true);
}

}  // namespace

ReadResult read_tags(const GrayView& image, const ReadOptions& options) {
  PictureReader reader(image, options);
  for (const ExpectedTag& tag : options.expected) look_for(reader, image, tag);
  const auto is_missing = [&](const ExpectedTag& tag) { return !reader.has_read(tag); };
  const bool missing =
      options.expected.empty() || std::ranges::any_of(options.expected, is_missing);
  if (options.search == Search::always || (options.search == Search::when_missing && missing)) {
    search(reader, image);
  }
  return with_frameless(image, options, reader.take_result());
}

}  // namespace tagsmith
