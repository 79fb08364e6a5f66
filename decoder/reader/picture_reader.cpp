// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/picture_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/covered_profile.hpp"
#include "decoder/reader/frame_by_bars.hpp"

namespace tagsmith {
namespace {

constexpr const char* kPartlyCovered = "frame, partly covered";

// True when both frames are the same one seen twice.
bool same_frame(const Quad& a, const Quad& b) {
  const double size = std::sqrt(std::min(area_of(a), area_of(b)));
  const double ratio = area_of(a) / std::max(area_of(b), 1e-9);
  return distance(centre_of(a), centre_of(b)) < 0.1 * size && ratio > 0.7 && ratio < 1.4;
}

bool was_tried(const std::vector<Quad>& tried, const Quad& quad, double pixels) {
  return std::ranges::any_of(tried,
                             [&](const Quad& other) { return nearly_equal(other, quad, pixels); });
}

}  // namespace

PictureReader::PictureReader(const GrayView& image, PictureBars& bars, const ReadOptions& options)
    : image_(image), bars_(bars), options_(options) {
  if (options.camera) lens_ = LensBend(*options.camera);
}

void PictureReader::try_candidate(const PyramidLevel& level, const Quad& candidate) {
  if (is_read(to_full(level, candidate))) return;
  if (!looks_framed(level.image, candidate)) {
    return pass_over(to_full(level, candidate), kNotFramedReason);
  }
  try_frame(level, candidate);
}

void PictureReader::try_frame(const PyramidLevel& level, const Quad& rough) {
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

void PictureReader::try_bars(const GrayView& half, const BarRegion& region) {
  constexpr double kSymbolLike = 0.7;      // explained
  constexpr double kSameCompleted = 1.5;   // pixels
  constexpr std::size_t kMostLocated = 6;  // in one picture: bounds its time
  if (located_.size() == kMostLocated) return;
  const auto bars = locate_bars(bars_.light, region, located_);
  if (!bars) return;
  located_.push_back(*bars);
  for (const SymbolLayout& layout : options_.layouts) {
    const auto rough = frame_by_bars(image_, half, *bars, layout, {lens_});
    if (!rough) continue;
    if (is_read(rough->corners)) return;
    if (was_tried(completed_, rough->corners, kSameCompleted)) continue;
    completed_.push_back(rough->corners);
    const auto attempt = attempt_both_ways(image_, *rough, options_);
    if (!attempt || attempt->decoding.fit.explained < kSymbolLike) continue;
    const auto frame = frame_by_symbol(image_, half, expected_corners(*rough, *attempt), layout,
                                       attempt->profile.module_px, {lens_});
    // Of either pair of sides one must show where the bars put it: else it may be another layout.
    if (!frame || !(frame->shown[0] || frame->shown[2])) continue;
    if (!(frame->shown[1] || frame->shown[3])) continue;
    if (judge_covered(*frame, true)) return;
  }
}

std::vector<Quad> PictureReader::known_in(const PyramidLevel& level) const {
  constexpr double kStroke = 0.04;  // of the frame's length: the frame and a little more
  std::vector<Quad> known;
  for (const Reading& tag : result_.tags) {
    const double stroke = kStroke * distance(tag.corners[0], tag.corners[1]);
    known.push_back(to_level(level, widened(tag.corners, stroke)));
  }
  return known;
}

void PictureReader::try_covered(const GrayView& half) {
  for (const RefinedFrame& frame : covered_) {
    if (is_read(frame.corners) || judge_covered(frame, false)) continue;
    odd_bars_.push_back(bars_inside(image_, frame.corners));
  }
  for (const BarRegion& region : odd_bars_) {
    if (!has_reading_at(region.centre) && has_bars(bars_.light, region)) try_bars(half, region);
  }
}

// Why: docs/decisions/0003-confidence-and-its-border.md.
void PictureReader::try_doubtful() {
  const std::optional<CheckDigit> scheme = scheme_shown();
  if (!scheme || options_.check || !options_.code_book.empty()) return;
  ReadOptions named = options_;
  named.check = scheme;
  for (const RefinedFrame& frame : std::exchange(doubtful_, {})) {
    if (is_read(frame.corners)) continue;
    const auto attempt = attempt_quickly(image_, frame, named);
    if (!attempt || objection_to_quick(image_, frame, *attempt, named)) continue;
    accept_where_bars_end(frame, *attempt, "frame");
  }
  for (const RefinedFrame& frame : std::exchange(doubtful_covered_, {})) {
    if (is_read(frame.corners)) continue;
    const auto attempt = believed_attempt(image_, frame, named, true);
    if (attempt) accept_where_bars_end(frame, *attempt, kPartlyCovered);
  }
}

std::optional<CheckDigit> PictureReader::scheme_shown() const {
  bool sum10 = false, gs1 = false;
  for (const Reading& tag : result_.tags) {
    sum10 = sum10 || !tag.gs1_holds;
    gs1 = gs1 || !tag.sum10_holds;
  }
  if (sum10 == gs1) return std::nullopt;
  return sum10 ? CheckDigit::sum10 : CheckDigit::gs1;
}

bool PictureReader::was_looked_at(const BarRegion& region) const {
  return std::ranges::any_of(odd_bars_, [&](const BarRegion& other) {
    return distance(other.centre, region.centre) < 0.25 * region.length;
  });
}

bool PictureReader::has_met_covers() const {
  return !covered_.empty() || std::ranges::any_of(result_.tags, [](const Reading& tag) {
    return tag.method == kPartlyCovered;
  });
}

bool PictureReader::has_reading_at(PixelPoint point) const {
  return std::ranges::any_of(result_.tags,
                             [&](const Reading& tag) { return contains(tag.corners, point); });
}

bool PictureReader::has_read(const ExpectedTag& expected) const {
  const auto fits = [&](const Reading& tag) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double off = distance(tag.corners[i], expected.corners[i]);
      if (off > expected.uncertainty_px + 1) return false;
    }
    return true;
  };
  return std::ranges::any_of(result_.tags, fits);
}

ReadResult PictureReader::result() const {
  // A frame that was read after all is no refusal, and one refused twice is one.
  ReadResult result{result_.tags, {}, result_.passed_over};
  for (const Rejection& rejection : result_.rejected) {
    const auto same = [&](const auto& other) {
      return same_frame(other.corners, rejection.corners);
    };
    if (std::ranges::any_of(result.tags, same) || std::ranges::any_of(result.rejected, same)) {
      continue;
    }
    result.rejected.push_back(rejection);
  }
  return result;
}

bool PictureReader::is_read(const Quad& quad) const {
  const auto same = [&](const Reading& tag) { return same_frame(tag.corners, quad); };
  return std::ranges::any_of(result_.tags, same);
}

SideBows PictureReader::known_bows(const PyramidLevel& level, const Quad& quad) const {
  if (!lens_) return {};
  return scaled(bows_of(*lens_, to_full(level, quad)), 1 / level.scale);
}

LensGuess PictureReader::lens_for(const PyramidLevel& level, const SettledFrame& settled) const {
  constexpr double kSettledSigma = 0.25;  // of a bow, pixels of the level
  if (lens_) return {lens_};
  const PixelPoint centre{(image_.width - 1) / 2.0, (image_.height - 1) / 2.0};
  return {std::nullopt,
          lambda_of_settled(to_full(level, settled.corners), scaled(settled.bows, level.scale),
                            kSettledSigma * level.scale, centre)};
}

void PictureReader::pass_over(const Quad& quad, const std::string& reason) {
  if (options_.tell_passed_over) result_.passed_over.push_back({reason, quad});
}

void PictureReader::judge_inside(const RefinedFrame& frame) {
  const auto attempt = attempt_quickly(image_, frame, options_);
  const auto reason =
      attempt ? objection_to_quick(image_, frame, *attempt, options_) : std::nullopt;
  if (attempt && !reason) {
    if (accept_where_bars_end(frame, *attempt, "frame")) return;
    odd_bars_.push_back(bars_inside(image_, frame.corners));
    result_.rejected.push_back({"feature frame: a side is hidden", corners_of(frame, *attempt)});
    return;
  }
  if (reason == kDoubtfulReason) doubtful_.push_back(frame);
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

bool PictureReader::judge_covered(const RefinedFrame& frame, bool completed) {
  const auto attempt = believed_attempt(image_, frame, options_, completed);
  if (!attempt) doubtful_covered_.push_back(frame);
  return attempt && accept_where_bars_end(frame, *attempt, kPartlyCovered);
}

Quad PictureReader::expected_corners(const RefinedFrame& completed, const Attempt& attempt) const {
  const Quad expected = corners_by_bars(completed, attempt);
  if (completed.shown[1] && completed.shown[3]) return expected;
  const double stroke_px = (completed.sides[0].stroke_px + completed.sides[2].stroke_px) / 2;
  RefinedFrame aligned = completed;
  aligned.corners = aligned_to_bars(image_, expected, stroke_px, attempt.layout, completed.lens);
  std::ranges::rotate(aligned.sides,
                      aligned.sides.begin() + static_cast<std::ptrdiff_t>(attempt.first_corner));
  const auto again = attempt_both_ways(image_, aligned, options_);
  return again ? corners_by_bars(aligned, *again) : Quad(aligned.corners);
}

bool PictureReader::accept_where_bars_end(const RefinedFrame& frame, const Attempt& attempt,
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
  const auto again = believed_attempt(image_, *completed, options_, true);
  if (!again || again->decoding.digits != attempt.decoding.digits) return false;
  accept(*completed, *again, kPartlyCovered);
  return true;
}

void PictureReader::accept(const RefinedFrame& frame, const Attempt& attempt, const char* method) {
  result_.tags.push_back(reading_from(frame, attempt, method));
}

bool PictureReader::may_be_covered(double module_px) const {
  constexpr std::size_t kMostTries = 4;  // in one picture
  constexpr double kLeastModule = 1.2;   // pixels
  return module_px >= kLeastModule && covered_.size() + odd_bars_.size() < kMostTries;
}

}  // namespace tagsmith
