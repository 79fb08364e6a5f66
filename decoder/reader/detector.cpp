// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/detector.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>
#include <variant>

#include "decoder/feature_frame/crossing_lines.hpp"
#include "decoder/reader/frame_by_bars.hpp"
#include "decoder/reader/judge.hpp"
#include "decoder/reader/located_bars.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

using Source = TagHypothesis::Source;

// Where the bars are in a frame of which a side may be something else's edge: their direction is
// that of the texture inside.
BarRegion bars_inside(const GrayView& image, const Quad& quad, const SymbolLayout& layout) {
  BarRegion region;
  region.centre = centre_of(quad);
  region.across = main_gradient(image, quad);
  const auto extent = [&](PixelPoint direction) {
    const auto place = [&](PixelPoint corner) { return dot(corner, direction); };
    const auto [low, high] = std::ranges::minmax(quad | std::views::transform(place));
    return high - low;
  };
  region.length = extent(region.across) * (1 - 2 * layout.width_share(0));
  region.height = extent(region.along()) * (layout.bars_bottom - layout.bars_top);
  return region;
}

// Whether a frame's symbol was refused for nothing but its size: its digits explain what is seen of
// it, and its modules are narrower than a pixel. Lines of pixels, which show that less well than
// the whole profile, need not be followed for it.
bool is_too_small(const TagHypothesis& refused) {
  const Rejection* rejection = refused.refusal();
  return rejection != nullptr && rejection->symbol && refused.explained() >= kJudge.explained &&
         rejection->symbol->profile.module_px < 1;
}

Rejection fault_of(const Quad& quad, FrameFault fault) {
  Rejection rejection{RejectionReason::frame_fault, quad};
  rejection.fault = fault;
  return rejection;
}

}  // namespace

Detector::Detector(SearchedImage& picture, const ReadOptions& options)
    : picture_(picture),
      options_(options),
      typical_(typical_layout(options.layouts)),
      found_(typical_.frame),
      part_search_(options) {
  if (options.camera) lens_ = LensDistortion(*options.camera);
}

void Detector::consider(const Proposal& proposal) {
  std::visit([this](const auto& place) { look_at(place); }, proposal);
}

void Detector::look_at(const Outline& outline) {
  const auto& [level, quad] = outline;
  if (found_.is_read(to_full(level, quad))) return;
  part_search_.note_cut(outline, typical_.frame);
  if (!looks_framed(level.image, quad, typical_.frame)) {
    part_search_.note_hidden_side(outline, typical_.frame);
    return pass_over(to_full(level, quad), FrameFault::not_framed);
  }
  look_at(RoughFrame{level, quad});
}

void Detector::read_parts() {
  part_search_.read_cut(image(), [this](PixelPoint at) { return found_.has_reading_at(at); });
}

// The frames found last come first: those that bars complete are better than the outlines of what
// covers them. A frame in which next to nothing of a symbol shows may still end at what hides it.
void Detector::read_covered_parts() {
  const auto is_read = [this](PixelPoint at) { return found_.has_reading_at(at); };
  for (const TagHypothesis& hypothesis : std::views::reverse(found_.all())) {
    if (!hypothesis.frame || hypothesis.reading() != nullptr) continue;
    const GrayView seen = as_seen_by(hypothesis);
    if (hypothesis.may_be_covered || hypothesis.source == Source::careful) {
      part_search_.read_covered(seen, *hypothesis.frame, is_read);
    }
    if (!hypothesis.may_be_covered) {
      part_search_.note_hidden_end(seen, hypothesis.frame->corners);
    }
  }
  part_search_.read_beside(image(), is_read);
}

void Detector::look_at(const RoughFrame& proposed) {
  const auto& [level, rough] = proposed;
  const SideSagittas bows = known_sagittas(level, rough);
  const auto settled = fit_frame_coarsely(level.image, rough, bows, typical_.frame);
  if (settled && look_at_settled(level, *settled)) return;
  // The corners of an outline's hull are too far out where its sides bow.
  if (lens_ && lens_->bends()) {
    const auto straight = fit_frame_coarsely(level.image, rough, {}, typical_.frame);
    if (straight) {
      look_at_settled(level, *straight);
      return;
    }
  }
  if (!settled) pass_over(to_full(level, rough), settled.error());
}

bool Detector::look_at_settled(const PyramidLevel& level, const CoarseFrame& settled) {
  const Quad quad = to_full(level, settled.corners);
  if (found_.is_read(quad)) return true;
  if (found_.was_proposed(Source::outline, quad)) return false;
  const GrayView stored = as_stored(quad);
  FrameResult<RefinedFrame> frame =
      refine_frame(stored, quad, lens_for(level, settled), typical_.frame);
  if (frame && lies_between_crossing_lines(stored, *frame, typical_.frame)) {
    frame = fail(FrameFault::crossed);
  }
  const bool is_new = frame && !found_.was_fitted(*frame);
  TagHypothesis hypothesis;
  if (is_new) {
    hypothesis = judged_quickly(stored, quad, *frame);
    look_behind_halos(lens_for(level, settled), hypothesis);
  } else {
    hypothesis.rough = quad;
    if (!frame) hypothesis.outcome = fault_of(quad, frame.error());
  }
  return found_.keep(std::move(hypothesis)).reading() != nullptr;
}

void Detector::look_behind_halos(const LensGuess& lens, TagHypothesis& hypothesis) {
  const auto sharpening = sharpening_of(picture_.image(), *hypothesis.frame, typical_.frame);
  if (!sharpening) return;
  if (!unsharpened_) unsharpened_.emplace(picture_.image());
  unsharpened_->undo(*sharpening, hypothesis.frame->corners);
  const GrayView without = unsharpened_->view();
  auto frame = refine_frame(without, hypothesis.frame->corners, lens, typical_.frame, true);
  TagHypothesis plain;
  if (frame) add_halo_doubt(hypothesis.frame->corners, *frame);
  if (frame) plain = judged_quickly(without, hypothesis.rough, *frame);
  const Reading* before = hypothesis.reading();
  const Reading* now = plain.reading();
  if (now == nullptr && (before != nullptr || plain.explained() <= hypothesis.explained())) {
    return unsharpened_->restore(hypothesis.frame->corners);
  }
  if (before != nullptr && before->digits != now->digits) {
    plain.outcome = rejection_of(*now->symbol, {RejectionReason::doubtful});
  }
  plain.halos = sharpening;
  hypothesis = std::move(plain);
}

// A frame that is none of ours, such as the outline of blurred bars, tells of a wrong mask, and one
// that is met later must not be looked at through it.
GrayView Detector::as_stored(const Quad& quad) {
  if (unsharpened_) unsharpened_->restore(quad);
  return image();
}

GrayView Detector::as_seen_by(const TagHypothesis& hypothesis) {
  if (!unsharpened_ || !hypothesis.frame) return image();
  const Quad& corners = hypothesis.frame->corners;
  if (!hypothesis.halos) return as_stored(corners);
  unsharpened_->undo(*hypothesis.halos, corners);
  return image();
}

GrayView Detector::image() const { return unsharpened_ ? unsharpened_->view() : picture_.image(); }

std::optional<Reading> Detector::read_in_another_layout(const GrayView& image,
                                                        const RefinedFrame& frame,
                                                        const SymbolLayout& tried) const {
  for (const SymbolLayout& layout : options_.layouts) {
    if (layout == tried) continue;
    ReadOptions alone = options_;
    alone.layouts = {layout};
    const auto symbol = quick_hypothesis(image, frame, alone);
    if (!symbol || objection_to_quick(image, *symbol, alone)) continue;
    if (auto reading = reading_where_bars_end(image, *symbol, alone, ReadingMethod::frame)) {
      return reading;
    }
  }
  return std::nullopt;
}

TagHypothesis Detector::judged_quickly(const GrayView& image, const Quad& rough,
                                       const RefinedFrame& frame) const {
  TagHypothesis hypothesis;
  hypothesis.rough = rough;
  hypothesis.frame = frame;
  auto symbol = quick_hypothesis(image, frame, options_);
  const auto objection = symbol ? objection_to_quick(image, *symbol, options_) : std::nullopt;
  if (symbol && !objection) {
    auto reading = reading_where_bars_end(image, *symbol, options_, ReadingMethod::frame);
    if (!reading) reading = read_in_another_layout(image, frame, symbol->layout);
    if (reading) {
      hypothesis.outcome = *std::move(reading);
    } else {
      hypothesis.odd_bars = bars_inside(picture_.image(), frame.corners, typical_);
      hypothesis.outcome = rejection_of(*std::move(symbol), {RejectionReason::side_hidden});
    }
    return hypothesis;
  }
  if (found_.to_be_looked_at() < kSearch.most_tries) {
    hypothesis.may_be_covered = symbol && is_symbol_like(*symbol);
    if (!hypothesis.may_be_covered)
      hypothesis.odd_bars = bars_inside(picture_.image(), frame.corners, typical_);
  }
  if (!symbol) {
    hypothesis.outcome = Rejection{RejectionReason::no_guards, frame.corners};
    return hypothesis;
  }
  hypothesis.is_doubtful = objection->reason == RejectionReason::doubtful;
  auto stranger =
      options_.code_book.empty() ? std::nullopt : stranger_to_book(image, frame, options_);
  hypothesis.outcome = stranger ? rejection_of(*std::move(stranger), {RejectionReason::stranger})
                                : rejection_of(*std::move(symbol), *objection);
  return hypothesis;
}

void Detector::look_at(const BarRegion& region) {
  const auto followed_bars = std::ranges::count(found_.all(), Source::bars, &TagHypothesis::source);
  if (std::cmp_equal(followed_bars, kSearch.most_tries)) return;
  const auto bars = locate_bars(picture_.light, region);
  if (!bars) return;
  found_.keep({.source = Source::bars});
  const GrayView half = picture_.pyramid().scaled_down(2).level.image;
  for (const SymbolLayout& layout : options_.layouts) {
    const auto rough = frame_by_bars(image(), half, *bars, layout, {lens_});
    if (!rough) continue;
    if (found_.is_read(rough->corners)) return;
    if (found_.was_proposed(Source::completed, rough->corners)) continue;
    const GrayView stored = as_stored(rough->corners);
    found_.keep({.source = Source::completed, .rough = rough->corners});
    const auto symbol = better_hypothesis(stored, *rough, options_);
    if (!symbol || symbol->decoding.fit.explained < kJudge.like_symbol) continue;
    const auto frame = frame_by_symbol(stored, half, corners_by_bars(*symbol), layout,
                                       symbol->profile.module_px, {lens_});
    // Of either pair of sides one must show where the bars put it: else it may be another layout.
    if (!frame || !(frame->shown[0] || frame->shown[2])) continue;
    if (!(frame->shown[1] || frame->shown[3])) continue;
    if (judge_carefully(stored, *frame, true).reading() != nullptr) return;
  }
}

void Detector::look_at(const RefusedFrame& refused) {
  const RefinedFrame frame = *found_[refused.hypothesis].frame;
  if (found_.is_read(frame.corners)) return;
  const GrayView seen = as_seen_by(found_[refused.hypothesis]);
  const bool is_small = is_too_small(found_[refused.hypothesis]);
  TagHypothesis& looked = judge_carefully(seen, frame, false);
  if (looked.reading() == nullptr && !is_small) {
    looked.odd_bars = bars_inside(picture_.image(), frame.corners, typical_);
  }
}

TagHypothesis& Detector::judge_carefully(const GrayView& image, const RefinedFrame& frame,
                                         bool completed) {
  TagHypothesis hypothesis{.source = Source::careful, .rough = frame.corners, .frame = frame};
  const auto symbol = believed_hypothesis(image, frame, options_, completed);
  hypothesis.is_doubtful = !symbol;
  if (symbol) {
    auto reading = reading_where_bars_end(image, *symbol, options_, ReadingMethod::partly_covered);
    if (reading) hypothesis.outcome = *std::move(reading);
  }
  return found_.keep(std::move(hypothesis));
}

// Why: docs/decisions/0003-confidence-and-refusal.md.
void Detector::try_doubtful() {
  const std::optional<CheckDigit> scheme = found_.scheme_shown();
  if (!scheme || options_.check || !options_.code_book.empty()) return;
  ReadOptions named = options_;
  named.check = scheme;
  const std::size_t count = found_.all().size();
  for (const Source source : {Source::outline, Source::careful}) {
    for (std::size_t i = 0; i < count; ++i) {
      if (found_[i].source != source || !std::exchange(found_[i].is_doubtful, false)) continue;
      if (!found_.is_read(found_[i].frame->corners)) judge_again(i, named);
    }
  }
}

void Detector::judge_again(std::size_t index, const ReadOptions& named) {
  const bool carefully = found_[index].source == Source::careful;
  const RefinedFrame frame = *found_[index].frame;
  const GrayView seen = as_seen_by(found_[index]);
  auto symbol = carefully ? believed_hypothesis(seen, frame, named, true)
                          : quick_hypothesis(seen, frame, named);
  if (!symbol || (!carefully && objection_to_quick(seen, *symbol, named))) return;
  auto reading = reading_where_bars_end(
      seen, *symbol, named, carefully ? ReadingMethod::partly_covered : ReadingMethod::frame);
  if (!reading) return;
  TagHypothesis again{.source = Source::again, .rough = frame.corners, .frame = frame};
  again.outcome = *std::move(reading);
  found_.keep(std::move(again));
}

void Detector::try_likely_codes() {
  if (options_.likely_codes.empty()) return;
  ReadOptions named = options_;
  named.code_book = options_.likely_codes;
  std::vector<Quad> tried;
  const std::size_t count = found_.all().size();
  for (std::size_t i = 0; i < count; ++i) {
    const Rejection* refused = found_[i].refusal();
    if (refused == nullptr || !refused->symbol || !found_[i].frame) continue;
    const PixelPoint centre = centre_of(refused->corners);
    const auto holds = [&](const Quad& quad) { return contains(quad, centre); };
    if (found_.has_reading_at(centre) || std::ranges::any_of(tried, holds)) continue;
    tried.push_back(refused->corners);
    judge_again(i, named);
  }
}

ReadResult Detector::result() const {
  ReadResult result = found_.result(options_.tell_passed_over);
  for (const PartReading& part : part_search_.parts()) {
    const auto same = [&](const Reading& tag) {
      return contains(part.corners, centre_of(tag.corners));
    };
    if (std::ranges::none_of(result.tags, same)) result.parts.push_back(part);
  }
  return result;
}

SideSagittas Detector::known_sagittas(const PyramidLevel& level, const Quad& quad) const {
  if (!lens_) return {};
  return scaled(sagittas_of(*lens_, to_full(level, quad)), 1 / level.scale);
}

LensGuess Detector::lens_for(const PyramidLevel& level, const CoarseFrame& settled) const {
  if (lens_) return {lens_};
  const PixelPoint centre{(picture_.image().width - 1) / 2.0, (picture_.image().height - 1) / 2.0};
  return {std::nullopt,
          lambda_of_coarse(to_full(level, settled.corners), scaled(settled.bows, level.scale),
                           kSearch.sagitta_sigma * level.scale, centre)};
}

void Detector::pass_over(const Quad& quad, FrameFault fault) {
  if (!options_.tell_passed_over) return;
  TagHypothesis passed{.source = Source::passed};
  passed.outcome = fault_of(quad, fault);
  found_.keep(std::move(passed));
}

}  // namespace tagsmith::detail
