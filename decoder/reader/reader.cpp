// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "decoder/feature_frame/bar_blocks.hpp"
#include "decoder/feature_frame/bar_direction.hpp"
#include "decoder/feature_frame/bar_texture.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/lens_bend.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/settle_frame.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/half_size.hpp"
#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/cover_strips.hpp"
#include "decoder/reader/covered_profile.hpp"
#include "decoder/reader/frame_by_bars.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/symbol_profile.hpp"
#include "decoder/scan/decode.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

bool contains(const Quad& quad, PixelPoint point) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (cross(quad[(i + 1) % 4] - quad[i], point - quad[i]) < 0) return false;
  }
  return true;
}

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

// Where the bars are in a frame of which a side may be something else's edge.
BarRegion bars_inside(const GrayView& image, const Quad& quad) {
  const std::size_t first = possible_first_corners(image, quad).front();
  const Homography map =
      homography_to({quad[first], quad[first + 1], quad[(first + 2) % 4], quad[(first + 3) % 4]});
  const SymbolLayout layout;
  const double margin = layout.quiet_zone_modules / (kModuleCount + 2 * layout.quiet_zone_modules);
  const PixelPoint left = map(margin, 0.5), right = map(1 - margin, 0.5);
  BarRegion region;
  region.centre = 0.5 * (left + right);
  region.length = distance(left, right);
  region.across = 1 / region.length * (right - left);
  region.height = distance(map(0.5, layout.bars_top), map(0.5, layout.bars_bottom));
  return region;
}

struct Attempt {
  Decoding decoding;
  std::size_t first_corner = 0;
  SymbolProfile profile;
  SymbolLayout layout;
};

// The best explained attempt along the symbol direction(s) that are possible. `to_profile` is
// profile_symbol or profile_covered_symbol.
template <class ToProfile>
std::optional<Attempt> best_attempt(const GrayView& image, const RefinedFrame& frame,
                                    const ReadOptions& options, const ToProfile& to_profile) {
  const DecodeOptions decode_options{options.check, options.code_book};
  std::optional<Attempt> best;
  const auto attempt = [&](std::size_t first_corner, const SymbolLayout& layout) {
    const SymbolProfile profile = to_profile(image, frame, first_corner, layout);
    SymbolImage start;
    start.blur = std::clamp(profile.blur, 0.1, 3.0);
    const auto decoding = decode_profile(profile.bins, start, decode_options);
    if (!decoding) return;
    if (best && decoding->fit.explained <= best->decoding.fit.explained) return;
    best =
        Attempt{*decoding, (first_corner + (decoding->upside_down ? 2 : 0)) % 4, profile, layout};
  };
  for (const std::size_t first_corner : possible_first_corners(image, frame.corners)) {
    for (const SymbolLayout& layout : options.layouts) attempt(first_corner, layout);
  }
  return best;
}

// Where the bars put the frame's corners, from P on: along the symbol by its modules, across by the
// frame's own sides.
FrameCorners corners_by_bars(const RefinedFrame& frame, const Attempt& attempt) {
  const FrameCorners corners = turned_to(frame, attempt.first_corner).corners;
  const SymbolImage& image = attempt.decoding.fit.image;
  const double quiet = attempt.layout.quiet_zone_modules;
  const auto u_of = [&](double module) {
    const double from_middle = module - kModuleCount / 2.0;
    const double t = 2 * from_middle / kModuleCount;
    const double seen = module + image.shift + image.stretch * from_middle + image.bend * t * t;
    return (quiet + seen) / (kModuleCount + 2 * quiet);
  };
  const double left = u_of(-quiet), right = u_of(kModuleCount + quiet);
  const FrameMap map(corners, frame.lens);
  return {map(left, 0), map(right, 0), map(right, 1), map(left, 1)};
}

// The frame's corners from P on. Whatever widens the bars, ink or a tone curve that is not sRGB,
// moves the frame's inner edge inwards by as much.
FrameCorners corners_of(const RefinedFrame& frame, const Attempt& attempt) {
  const double growth_px = attempt.decoding.fit.image.growth * attempt.profile.module_px;
  const Quad quad = widened(frame.corners, growth_px / 2);
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = quad[(attempt.first_corner + i) % 4];
  // The bars say better where a hidden side is than what said it before.
  const FrameCorners by_bars = corners_by_bars(frame, attempt);
  if (!frame.shown[(attempt.first_corner + 1) % 4]) {
    corners[1] = by_bars[1];
    corners[2] = by_bars[2];
  }
  if (!frame.shown[(attempt.first_corner + 3) % 4]) {
    corners[3] = by_bars[3];
    corners[0] = by_bars[0];
  }
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
  if (decoding.fit.kept < kLeastKept) return kCoveredReason;
  if (std::abs(decoding.fit.image.growth) > kMostGrowth) return "bars grown or shrunk";
  if (!with_book && decoding.fit.image.blur > kMostBlur) return "too blurred";
  const double sure = with_book || options.check ? kSureInFrame : kSureEitherCheck;
  if (decoding.confidence < options.min_confidence.value_or(sure)) return kDoubtfulReason;
  return std::nullopt;
}

// Whether the quick profile shows so much of a symbol that a careful one may read it. Covered tags
// that were read carefully showed more: 0.8 and 0.7 (`./dev bench troubled`); other plates less, or
// no guard patterns at all.
bool is_symbol_like(const Attempt& attempt) {
  constexpr double kLeastExplained = 0.6;
  constexpr double kLeastGuards = 0.5;
  return attempt.decoding.fit.explained > kLeastExplained && attempt.decoding.guards > kLeastGuards;
}

// Whether a symbol shows too little for its covered digits to be more than guesses.
bool too_little_shown(const SymbolProfile& profile) {
  constexpr double kMostHidden = 0.25;  // of the places
  constexpr double kSaysNothing = 1;    // variance
  const auto hidden = std::ranges::count_if(
      profile.bins, [](const ScanBin& bin) { return bin.variance > kSaysNothing; });
  return static_cast<double>(hidden) > kMostHidden * static_cast<double>(profile.bins.size());
}

// Width of a module of a symbol along the frame's longer sides, pixels; roughly.
double module_across(const Quad& frame) {
  const double one = (distance(frame[0], frame[1]) + distance(frame[2], frame[3])) / 2;
  const double other = (distance(frame[1], frame[2]) + distance(frame[3], frame[0])) / 2;
  return std::max(one, other) / (kModuleCount + 2 * SymbolLayout{}.quiet_zone_modules);
}

// Why a symbol that no code of the book explains is none of them, where it is read for certain
// without the book.
std::optional<std::string> stranger_to_book(const GrayView& image, const RefinedFrame& frame,
                                            const ReadOptions& options) {
  ReadOptions alone;
  alone.check = options.check;
  alone.layouts = options.layouts;
  const auto attempt = best_attempt(image, frame, alone, profile_symbol);
  if (!attempt || objection(*attempt, alone)) return std::nullopt;
  const Digits& digits = attempt->decoding.digits;
  if (std::ranges::find(options.code_book, digits) != options.code_book.end()) return std::nullopt;
  return "the digits " + to_string(digits) + " are in none of the given surveys";
}

Reading reading_from(const RefinedFrame& frame, const Attempt& attempt, const FrameCorners& corners,
                     const char* method) {
  Reading reading;
  reading.digits = attempt.decoding.digits;
  reading.sum10_holds = has_check_digit(CheckDigit::sum10, reading.digits);
  reading.gs1_holds = has_check_digit(CheckDigit::gs1, reading.digits);
  reading.corners = corners;
  reading.corner_covariance = turned(corner_covariance(frame), attempt.first_corner);
  reading.module_px = attempt.profile.module_px;
  reading.confidence = attempt.decoding.confidence;
  reading.method = method;
  return reading;
}

// Reads one picture: keeps what was found and what was tried, so that a frame seen at several
// levels is read once.
class PictureReader {
 public:
  PictureReader(const GrayView& image, const ReadOptions& options)
      : image_(image), options_(options) {
    if (options.camera) lens_ = LensBend(*options.camera);
  }

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
    Result<SettledFrame> settled = settle_frame(level.image, rough, known_bows(level, rough));
    // The corners of an outline's hull are too far out where its sides bow.
    if (!settled && lens_ && lens_->bends()) settled = settle_frame(level.image, rough);
    if (!settled) return pass_over(to_full(level, rough), settled.error().message);
    const Quad quad = to_full(level, settled->corners);
    if (is_read(quad)) return;
    if (was_tried(settled_, quad, 0.4)) return;
    settled_.push_back(quad);
    const Result<RefinedFrame> frame = refine_frame(image_, quad, lens_for(level, *settled));
    if (!frame) return pass_over(quad, frame.error().message);
    if (was_tried(refined_, frame->corners, 0.1)) return;
    refined_.push_back(frame->corners);
    judge_inside(*frame);
  }

  // Reads what stands in frames that are completed by the bars of a region. `half` is the image at
  // half its size.
  void try_bars(const GrayView& half, const BarRegion& region) {
    constexpr double kSymbolLike = 0.7;      // explained
    constexpr double kSameCompleted = 1.5;   // pixels
    constexpr std::size_t kMostLocated = 6;  // in one picture: bounds its time
    if (located_.size() == kMostLocated) return;
    const auto bars = locate_bars(image_, region, located_);
    if (!bars) return;
    located_.push_back(*bars);
    for (const SymbolLayout& layout : options_.layouts) {
      const auto rough = frame_by_bars(image_, half, *bars, layout, {lens_});
      if (!rough) continue;
      if (is_read(rough->corners)) return;
      if (was_tried(completed_, rough->corners, kSameCompleted)) continue;
      completed_.push_back(rough->corners);
      const auto attempt = best_explained(*rough);
      if (!attempt || attempt->decoding.fit.explained < kSymbolLike) continue;
      const auto frame = frame_by_symbol(image_, half, expected_corners(*rough, *attempt), layout,
                                         attempt->profile.module_px, {lens_});
      // Of either pair of sides one must show where the bars put it: else it may be another layout.
      if (!frame || !(frame->shown[0] || frame->shown[2])) continue;
      if (!(frame->shown[1] || frame->shown[3])) continue;
      if (judge_covered(*frame, true)) return;
    }
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

  // Reads carefully what did not convince at first: in the frame as it was found, or, where one of
  // its sides may be something else's edge, in the one that the bars inside complete. `half` is the
  // image at half its size.
  void try_covered(const GrayView& half) {
    for (const RefinedFrame& frame : covered_) {
      if (is_read(frame.corners) || judge_covered(frame, false)) continue;
      odd_bars_.push_back(bars_inside(image_, frame.corners));
    }
    for (const BarRegion& region : odd_bars_) {
      if (!has_reading_at(region.centre) && has_bars(image_, region)) try_bars(half, region);
    }
  }

  // Whether bars of about this place were looked at in try_covered.
  bool was_looked_at(const BarRegion& region) const {
    return std::ranges::any_of(odd_bars_, [&](const BarRegion& other) {
      return distance(other.centre, region.centre) < 0.25 * region.length;
    });
  }

  // Whether something was in the way of a tag: another may be behind it too.
  bool has_met_covers() const {
    return !covered_.empty() || std::ranges::any_of(result_.tags, [](const Reading& tag) {
      return tag.method == kPartlyCovered;
    });
  }

  bool has_reading_at(PixelPoint point) const {
    return std::ranges::any_of(result_.tags,
                               [&](const Reading& tag) { return contains(tag.corners, point); });
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

  // How a known lens bends the sides of a frame, in pixels of the level.
  SideBows known_bows(const PyramidLevel& level, const Quad& quad) const {
    if (!lens_) return {};
    return scaled(bows_of(*lens_, to_full(level, quad)), 1 / level.scale);
  }

  LensGuess lens_for(const PyramidLevel& level, const SettledFrame& settled) const {
    constexpr double kSettledSigma = 0.25;  // of a bow, pixels of the level
    if (lens_) return {lens_};
    const PixelPoint centre{(image_.width - 1) / 2.0, (image_.height - 1) / 2.0};
    return {std::nullopt,
            lambda_of_settled(to_full(level, settled.corners), scaled(settled.bows, level.scale),
                              kSettledSigma * level.scale, centre)};
  }

  void pass_over(const Quad& quad, const std::string& reason) {
    if (options_.tell_passed_over) result_.passed_over.push_back({reason, quad});
  }

  // Reads the symbol inside a frame; where that does not convince, carefully.
  void judge_inside(const RefinedFrame& frame) {
    const auto attempt = best_attempt(image_, frame, options_, profile_symbol);
    const auto reason = attempt ? objection_to_quick(frame, *attempt) : std::nullopt;
    if (attempt && !reason) {
      if (accept_where_bars_end(frame, *attempt, "frame")) return;
      odd_bars_.push_back(bars_inside(image_, frame.corners));
      result_.rejected.push_back({"feature frame: a side is hidden", corners_of(frame, *attempt)});
      return;
    }
    const double module_px = attempt ? attempt->profile.module_px : module_across(frame.corners);
    if (may_be_covered(module_px)) {
      if (attempt && is_symbol_like(*attempt)) {
        covered_.push_back(frame);
      } else {
        odd_bars_.push_back(bars_inside(image_, frame.corners));
      }
    }
    if (!attempt) return pass_over(frame.corners, "no guard patterns inside");
    const auto stranger =
        options_.code_book.empty() ? std::nullopt : stranger_to_book(image_, frame, options_);
    result_.rejected.push_back({stranger.value_or(*reason), corners_of(frame, *attempt)});
  }

  // Reads the symbol inside a frame carefully; whether it was believed.
  bool judge_covered(const RefinedFrame& frame, bool completed) {
    const auto attempt = read_believed(frame, completed);
    return attempt && accept_where_bars_end(frame, *attempt, kPartlyCovered);
  }

  // What speaks against believing a symbol that was read without regard to covers.
  std::optional<std::string> objection_to_quick(const RefinedFrame& frame,
                                                const Attempt& attempt) const {
    const auto reason = objection(attempt, options_);
    if (reason) return reason;
    const Quad corners = turned_to(frame, attempt.first_corner).corners;
    const auto strips = strips_along_bars(image_, FrameMap(corners, frame.lens), attempt.layout);
    if (strips.empty()) return std::nullopt;
    return kCoveredReason;
  }

  std::optional<Attempt> best_careful(const RefinedFrame& frame, AddedLight added) const {
    return best_attempt(image_, frame, options_,
                        [added](const GrayView& image, const RefinedFrame& of, std::size_t first,
                                const SymbolLayout& layout) {
                          return profile_covered_symbol(image, of, first, layout, added);
                        });
  }

  // What a completed frame holds, read quickly or carefully, whichever is explained better.
  std::optional<Attempt> best_explained(const RefinedFrame& frame) const {
    const auto quick = best_attempt(image_, frame, options_, profile_symbol);
    auto careful = best_careful(frame, AddedLight::even);
    if (!careful || (quick && quick->decoding.fit.explained > careful->decoding.fit.explained)) {
      return quick;
    }
    return careful;
  }

  // Where the bars put the corners of a completed frame, from P on. Where its left or right side is
  // hidden the rows say how it leans, and the symbol, read so, where it stands.
  Quad expected_corners(const RefinedFrame& completed, const Attempt& attempt) const {
    const Quad expected = corners_by_bars(completed, attempt);
    if (completed.shown[1] && completed.shown[3]) return expected;
    const double stroke_px = (completed.sides[0].stroke_px + completed.sides[2].stroke_px) / 2;
    RefinedFrame aligned = completed;
    aligned.corners = aligned_to_bars(image_, expected, stroke_px, attempt.layout, completed.lens);
    std::ranges::rotate(aligned.sides,
                        aligned.sides.begin() + static_cast<std::ptrdiff_t>(attempt.first_corner));
    const auto again = best_explained(aligned);
    return again ? corners_by_bars(aligned, *again) : Quad(aligned.corners);
  }

  // What a frame holds, where that is believed: read quickly where its sides were found or
  // completed by the bars since it was read last, or carefully.
  std::optional<Attempt> read_believed(const RefinedFrame& frame, bool quickly_too) const {
    if (quickly_too) {
      const auto quick = best_attempt(image_, frame, options_, profile_symbol);
      if (quick && !objection_to_quick(frame, *quick)) return quick;
    }
    // Symbols that were read with slanted light alone had 0.83 explained with even light
    // (`./dev bench troubled`).
    constexpr double kSymbolLike = 0.7;
    for (const AddedLight added : {AddedLight::even, AddedLight::slanted}) {
      const auto careful = best_careful(frame, added);
      if (!careful || careful->decoding.fit.explained < kSymbolLike) return std::nullopt;
      if (!objection(*careful, options_) && !too_little_shown(careful->profile)) return careful;
    }
    return std::nullopt;
  }

  // Accepts a believed symbol whose bars end where its frame has them end, or, where one of the
  // frame's upper and lower sides is something else's edge, with that side where the bars put it.
  // Whether it was accepted.
  bool accept_where_bars_end(const RefinedFrame& frame, const Attempt& attempt,
                             const char* method) {
    const EndsVerdict verdict =
        judge_by_bar_ends(image_, corners_of(frame, attempt), attempt.layout, frame.lens);
    const bool whole = std::ranges::all_of(frame.shown, std::identity{});
    if (verdict.kind == EndsVerdict::odd) return false;
    if (verdict.kind == EndsVerdict::unknown && !whole) return false;
    if (verdict.kind != EndsVerdict::hidden) {
      accept(frame, attempt, method);
      return true;
    }
    std::array<bool, 4> shown{};
    for (std::size_t i = 0; i < 4; ++i) {
      shown[i] = frame.shown[(attempt.first_corner + i) % 4] && i != verdict.side;
    }
    const auto completed =
        refine_shown_sides(image_, verdict.corners, shown, verdict.sigma_px, frame.lens);
    if (!completed) return false;
    const auto again = read_believed(*completed, true);
    if (!again || again->decoding.digits != attempt.decoding.digits) return false;
    accept(*completed, *again, kPartlyCovered);
    return true;
  }

  void accept(const RefinedFrame& frame, const Attempt& attempt, const char* method) {
    result_.tags.push_back(reading_from(frame, attempt, corners_of(frame, attempt), method));
  }

  // Whether the careful way may help: it needs bars that stand apart, and takes time.
  bool may_be_covered(double module_px) const {
    constexpr std::size_t kMostTries = 4;  // in one picture
    constexpr double kLeastModule = 1.2;   // pixels
    return module_px >= kLeastModule && covered_.size() + odd_bars_.size() < kMostTries;
  }

  static constexpr const char* kPartlyCovered = "frame, partly covered";

  GrayView image_;
  const ReadOptions& options_;
  std::optional<LensBend> lens_;  // of the camera, if that is known
  ReadResult result_;
  std::vector<Quad> settled_;  // frames tried, before and after the fine fit
  std::vector<Quad> refined_;
  std::vector<RefinedFrame> covered_;  // frames whose symbols did not convince
  std::vector<BarRegion> odd_bars_;    // what stands in frames where no symbol should
  std::vector<LocatedBars> located_;   // bars that frames were completed by
  std::vector<Quad> completed_;        // these frames
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
std::vector<BarRegion> unexplained_bars(const PictureReader& reader, const GrayView& image,
                                        const PyramidLevel& half) {
  constexpr std::size_t kLooked = 24;
  constexpr std::size_t kMost = 3;
  constexpr double kLeastProportion = 0.6, kMostProportion = 6;
  const PyramidLevel full{image, 1};
  const std::vector<Quad> known = reader.known_in(full);
  std::vector<BarRegion> bars;
  for (const BarRegion& region : find_bar_regions_apart(image, kLooked)) {
    if (bars.size() == kMost) return bars;
    const double proportion = region.length / std::max(region.height, 1.0);
    if (region.length < kLeastBarsLength || proportion < kLeastProportion ||
        proportion > kMostProportion) {
      continue;
    }
    const auto holds = [&](const Quad& quad) { return contains(quad, region.centre); };
    if (std::ranges::any_of(known, holds) || is_cut_off(image, region)) continue;
    const auto same = [&](const BarRegion& other) { return overlap(other, region); };
    if (std::ranges::any_of(bars, same)) continue;
    const BarBlock block{region.centre,
                         region.across,
                         {-region.across.y, region.across.x},
                         region.length / 2,
                         region.height / 2};
    if (is_symbol_like(half.image, scaled(block, 1 / half.scale)) && has_bars(image, region)) {
      bars.push_back(region);
    }
  }
  return bars;
}

// The largest of the blocks of bars that no reading explains.
std::vector<BarRegion> largest_of(const PictureReader& reader, const GrayView& image,
                                  std::vector<BarBlock> blocks) {
  constexpr std::size_t kMost = 1;
  std::ranges::stable_sort(blocks, std::ranges::greater{}, &BarBlock::half_width);
  std::vector<BarRegion> regions;
  for (const BarBlock& block : blocks) {
    if (regions.size() == kMost) break;
    const BarRegion region{block.centre, block.across, 2 * block.half_width, 2 * block.half_height};
    if (region.length < kLeastBarsLength || reader.has_reading_at(region.centre) ||
        reader.was_looked_at(region) || is_cut_off(image, region)) {
      continue;
    }
    if (has_bars(image, region)) regions.push_back(region);
  }
  return regions;
}

// Whether covered tags are looked for around all bars that no reading explains: where nothing was
// read, or something was in the way.
bool is_worth_care(const PictureReader& reader) {
  return !reader.has_read_any() || reader.has_met_covers();
}

// Reads carefully what may be covered tags, which takes longer than all the rest: in frames that
// did not convince, and around bars, where is_worth_care() does not say so those alone that were
// found to be much like a symbol (`symbols`).
void read_covered(PictureReader& reader, const GrayView& image, const PyramidLevel& half,
                  const std::vector<BarBlock>& symbols) {
  const bool everywhere = is_worth_care(reader);
  reader.try_covered(half.image);
  const std::vector<BarRegion> bars =
      everywhere ? unexplained_bars(reader, image, half) : largest_of(reader, image, symbols);
  for (const BarRegion& region : bars) reader.try_bars(half.image, region);
}

void search(PictureReader& reader, const GrayView& image) {
  const Pyramid pyramid(image);
  search_near_bars(reader, pyramid);
  // Bars that no reading explains, or a picture without any reading, are worth a closer look.
  const SearchLevel& half = pyramid.scaled_down(2);
  std::vector<BarBlock> symbols = search_around_bars(reader, pyramid.scaled_down(4), half.level);
  if (symbols.empty() && reader.has_read_any()) {
    return read_covered(reader, image, half.level, symbols);
  }
  const std::vector<BarBlock> small = search_around_bars(reader, half, half.level);
  symbols.insert(symbols.end(), small.begin(), small.end());
  const bool everywhere = !reader.has_read_any();
  for (const SearchLevel& at : pyramid.levels()) {
    const TileMask around = tiles_around(symbols, at);
    if (!everywhere && std::ranges::count(around.tiles, 1) == 0) continue;
    search_regions(reader, at.level, everywhere ? nullptr : &around, true);
  }
  read_covered(reader, image, half.level, symbols);
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
