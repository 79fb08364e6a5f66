// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/settle_frame.hpp"
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

// True when two quadrilaterals agree to less than half a pixel.
bool nearly_equal(const Quad& a, const Quad& b) {
  constexpr double kPixels = 0.4;
  for (std::size_t turn = 0; turn < 4; ++turn) {
    double farthest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      farthest = std::max(farthest, distance(a[i], b[(i + turn) % 4]));
    }
    if (farthest < kPixels) return true;
  }
  return false;
}

// The corners that may be P's: where the symbol runs along the longer sides; both ways when the
// foreshortened frame is nearly square. Upside down is left to the symbol.
std::vector<std::size_t> possible_first_corners(const Quad& quad) {
  const double along = distance(quad[0], quad[1]) + distance(quad[3], quad[2]);
  const double across = distance(quad[1], quad[2]) + distance(quad[0], quad[3]);
  if (along > 1.7 * across) return {0};
  if (across > 1.7 * along) return {1};
  return {0, 1};
}

ScanProfile reversed(const ScanProfile& profile) {
  ScanProfile turned(profile.rbegin(), profile.rend());
  for (ScanBin& bin : turned) bin.at = kModuleCount - bin.at;
  return turned;
}

struct Attempt {
  Decoding decoding;
  std::size_t first_corner = 0;
  SymbolProfile profile;
};

// The better of the two ways up, along the symbol direction(s) that are possible.
std::optional<Attempt> best_attempt(const GrayView& image, const RefinedFrame& frame,
                                    const ReadOptions& options) {
  const DecodeOptions decode_options{options.check, options.code_book};
  std::optional<Attempt> best;
  const auto attempt = [&](std::size_t first_corner, const SymbolLayout& layout) {
    SymbolProfile profile = profile_symbol(image, frame, first_corner, layout);
    for (const std::size_t half_turn : {0U, 2U}) {
      if (half_turn == 2) profile.bins = reversed(profile.bins);
      SymbolImage start;
      start.blur = std::clamp(profile.blur, 0.1, 3.0);
      const auto decoding = decode_profile(profile.bins, start, decode_options);
      if (!decoding) continue;
      if (best && decoding->fit.explained <= best->decoding.fit.explained) continue;
      best = Attempt{*decoding, (first_corner + half_turn) % 4, profile};
    }
  };
  for (const std::size_t first_corner : possible_first_corners(frame.corners)) {
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
  const Decoding& decoding = attempt.decoding;
  if (decoding.guards < kLeastGuards) return "guard pattern";
  if (decoding.fit.explained < kLeastExplained || decoding.worst_digit < kLeastDigit) {
    return "element widths";
  }
  if (decoding.fit.kept < kLeastKept) return "bars covered";
  if (std::abs(decoding.fit.image.growth) > kMostGrowth) return "bars grown or shrunk";
  if (decoding.confidence < options.min_confidence) return "not certain enough";
  return std::nullopt;
}

Reading reading_from(const Attempt& attempt, const FrameCorners& corners) {
  Reading reading;
  reading.digits = attempt.decoding.digits;
  reading.sum10_holds = has_check_digit(CheckDigit::sum10, reading.digits);
  reading.gs1_holds = has_check_digit(CheckDigit::gs1, reading.digits);
  reading.corners = corners;
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
    if (!looks_framed(level.image, candidate)) {
      return pass_over(to_full(level, candidate), kNotFramedReason);
    }
    const Result<Quad> settled = settle_frame(level.image, candidate);
    if (!settled) return pass_over(to_full(level, candidate), settled.error().message);
    const Quad quad = to_full(level, *settled);
    const auto read = [&](const Reading& tag) { return same_frame(tag.corners, quad); };
    if (std::ranges::any_of(result_.tags, read)) return;
    const auto again = [&](const Quad& other) { return nearly_equal(other, quad); };
    if (std::ranges::any_of(tried_, again)) return;
    tried_.push_back(quad);
    const Result<RefinedFrame> frame = refine_frame(image_, quad);
    if (!frame) return pass_over(quad, frame.error().message);
    const auto attempt = best_attempt(image_, *frame, options_);
    if (!attempt) return pass_over(quad, "no guard patterns inside");
    judge(*frame, *attempt);
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
  void pass_over(const Quad& quad, const std::string& reason) {
    if (options_.tell_passed_over) result_.passed_over.push_back({reason, quad});
  }

  void judge(const RefinedFrame& frame, const Attempt& attempt) {
    const FrameCorners corners = corners_of(frame, attempt);
    if (const auto reason = objection(attempt, options_)) {
      result_.rejected.push_back({*reason, corners});
    } else {
      result_.tags.push_back(reading_from(attempt, corners));
    }
  }

  GrayView image_;
  const ReadOptions& options_;
  ReadResult result_;
  std::vector<Quad> tried_;
};

}  // namespace

ReadResult read_tags(const GrayView& image, const ReadOptions& options) {
  PictureReader reader(image, options);
  const GrayImage half = half_size(image);
  const GrayImage quarter = half_size(half.view());
  // Noise halves from level to level, and with it the contrast that stands out from it.
  const std::array<PyramidLevel, 3> levels{
      {{image, 1, 20}, {half.view(), 2, 12}, {quarter.view(), 4, 7}}};
  for (const PyramidLevel& level : levels) {
    for (const Quad& candidate : find_candidates(level)) reader.try_candidate(level, candidate);
  }
  return with_frameless(image, options, reader.take_result());
}

}  // namespace tagsmith
