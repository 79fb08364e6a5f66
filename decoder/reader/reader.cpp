// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/regions.hpp"
#include "decoder/reader/symbol_profile.hpp"
#include "decoder/scan/decode.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

// A quadrilateral that may be the inner edge of a feature frame, in pixels of the full image.
struct Candidate {
  Quad quad{};
  bool at_border = false;
};

// Regions whose outline fills its enclosing quadrilateral, scaled from a reduced image.
std::vector<Candidate> candidates_in(const GrayView& image, double scale) {
  constexpr double kLeastFill = 0.85;  // of the quadrilateral by the region's hull
  std::vector<Candidate> candidates;
  for (const Region& region : find_white_regions(image)) {
    const std::vector<PixelPoint> hull = convex_hull(region.outline);
    const std::optional<Quad> quad = enclosing_quad(hull);
    if (!quad || !is_convex(*quad) || area_of(hull) < kLeastFill * area_of(*quad)) continue;
    Candidate candidate{*quad, region.touches_border};
    const double offset = (scale - 1) / 2;  // pixel centres of a reduced image
    for (PixelPoint& corner : candidate.quad) {
      corner = {corner.x * scale + offset, corner.y * scale + offset};
    }
    candidates.push_back(candidate);
  }
  return candidates;
}

PixelPoint centre_of(const Quad& quad) { return 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]); }

// True when both frames are the same one seen twice.
bool same_frame(const Quad& a, const Quad& b) {
  const double size = std::sqrt(std::min(area_of(a), area_of(b)));
  const double ratio = area_of(a) / std::max(area_of(b), 1e-9);
  return distance(centre_of(a), centre_of(b)) < 0.1 * size && ratio > 0.7 && ratio < 1.4;
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
  for (const std::size_t first_corner : possible_first_corners(frame.corners)) {
    SymbolProfile profile = profile_symbol(image, frame, first_corner, options.quiet_zone_modules);
    for (const std::size_t half_turn : {0U, 2U}) {
      if (half_turn == 2) profile.bins = reversed(profile.bins);
      SymbolImage start;
      start.blur = std::clamp(profile.blur, 0.1, 3.0);
      const auto decoding = decode_profile(profile.bins, start, decode_options);
      if (!decoding) continue;
      if (best && decoding->fit.explained <= best->decoding.fit.explained) continue;
      best = Attempt{*decoding, (first_corner + half_turn) % 4, profile};
    }
  }
  return best;
}

FrameCorners corners_from(const Quad& quad, std::size_t first_corner) {
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = quad[(first_corner + i) % 4];
  return corners;
}

// What speaks against believing the attempt, or nothing.
std::optional<std::string> objection(const Attempt& attempt, const ReadOptions& options) {
  const Decoding& decoding = attempt.decoding;
  constexpr double kLeastExplained = 0.9;
  if (decoding.fit.explained < kLeastExplained) return "no symbol of this kind fits the bars";
  if (std::abs(decoding.fit.image.growth) > 0.7) return "bars grown too much";
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

}  // namespace

ReadResult read_tags(const GrayView& image, const ReadOptions& options) {
  ReadResult result;
  std::vector<Candidate> candidates = candidates_in(image, 1);
  const GrayImage half = half_size(image);
  for (const Candidate& candidate : candidates_in(half.view(), 2)) candidates.push_back(candidate);
  std::vector<Quad> done;
  for (const Candidate& candidate : candidates) {
    const Result<RefinedFrame> frame = refine_frame(image, candidate.quad);
    if (!frame) continue;
    const auto same = [&](const Quad& other) { return same_frame(other, frame->corners); };
    if (std::any_of(done.begin(), done.end(), same)) continue;
    const std::optional<Attempt> attempt = best_attempt(image, *frame, options);
    if (!attempt) continue;
    done.push_back(frame->corners);
    const FrameCorners corners = corners_from(frame->corners, attempt->first_corner);
    if (const auto reason = objection(*attempt, options)) {
      result.rejected.push_back({*reason, corners});
    } else {
      result.tags.push_back(reading_from(*attempt, corners));
    }
  }
  return result;
}

}  // namespace tagsmith
