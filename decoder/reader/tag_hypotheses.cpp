// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/tag_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "decoder/reader/judge.hpp"
#include "decoder/reader/tuning.hpp"

namespace tagsmith::detail {
namespace {

// True when both frames are the same one seen twice.
bool same_frame(const Quad& a, const Quad& b) {
  const double size = std::sqrt(std::min(area_of(a), area_of(b)));
  const double ratio = area_of(a) / std::max(area_of(b), 1e-9);
  return distance(centre_of(a), centre_of(b)) < 0.1 * size && ratio > 0.7 && ratio < 1.4;
}

// Whether a symbol was refused for how it looks, before its digits were doubted.
bool is_refused_for_its_looks(const Rejection& rejection) {
  using enum RejectionReason;
  return rejection.reason == guard_pattern || rejection.reason == element_widths ||
         rejection.reason == growth || rejection.reason == blur;
}

// Outlines that are no tag are listed separately from refused tags.
bool is_passed_over(const Rejection& rejection) {
  if (rejection.reason == RejectionReason::frame_fault) return true;
  if (rejection.reason == RejectionReason::no_guards) return true;
  if (!rejection.symbol) return false;
  return !may_be_symbol(*rejection.symbol) ||
         (is_refused_for_its_looks(rejection) && !suits_its_frame(*rejection.symbol));
}

}  // namespace

double TagHypothesis::explained() const {
  const auto of = [](const auto& symbol) { return symbol ? symbol->decoding.fit.explained : 0; };
  if (const Reading* tag = reading()) return of(tag->symbol);
  return refusal() != nullptr ? of(refusal()->symbol) : 0;
}

template <class Condition>
bool TagHypotheses::any_reading(const Condition& condition) const {
  return std::ranges::any_of(all_, [&](const TagHypothesis& hypothesis) {
    const Reading* reading = hypothesis.reading();
    return reading != nullptr && condition(*reading);
  });
}

// If two plates in one place bear different digits, nothing shows which of them is another
// survey's.
TagHypothesis& TagHypotheses::keep(TagHypothesis hypothesis) {
  hypothesis.proposer = proposer_;
  for (TagHypothesis& other : all_) {
    const Reading* now = hypothesis.reading();
    const Reading* before = other.reading();
    if (now == nullptr || before == nullptr || !overlap(now->corners, before->corners)) continue;
    if (now->digits == before->digits) {
      (other.explained() < hypothesis.explained() ? other : hypothesis).outcome = {};
      continue;
    }
    for (TagHypothesis* read : {&other, &hypothesis}) {
      read->outcome = rejection_of(*read->reading()->symbol, {RejectionReason::doubtful});
    }
  }
  return all_.emplace_back(std::move(hypothesis));
}

bool TagHypotheses::was_proposed(TagHypothesis::Source source, const Quad& rough) const {
  return std::ranges::any_of(all_, [&](const TagHypothesis& other) {
    return other.source == source && nearly_equal(other.rough, rough, kSearch.same_px);
  });
}

bool TagHypotheses::was_fitted(const RefinedFrame& frame) const {
  return std::ranges::any_of(all_, [&](const TagHypothesis& other) {
    return other.source == TagHypothesis::Source::outline && other.frame &&
           nearly_equal(other.frame->corners, frame.corners, 0.1);
  });
}

bool TagHypotheses::is_read(const Quad& quad) const {
  return any_reading([&](const Reading& tag) { return same_frame(tag.corners, quad); });
}

std::vector<Quad> TagHypotheses::known_in(const PyramidLevel& level) const {
  std::vector<Quad> known;
  for (const TagHypothesis& hypothesis : all_) {
    const Reading* tag = hypothesis.reading();
    if (tag == nullptr) continue;
    const double module = distance(tag->corners[0], tag->corners[1]) / shape_.length;
    const double stroke = (shape_.stroke + 0.5) * module;
    known.push_back(to_level(level, widened(tag->corners, stroke)));
  }
  return known;
}

std::optional<CheckDigit> TagHypotheses::scheme_shown() const {
  const bool sum10 = any_reading([](const Reading& tag) { return !tag.gs1_holds; });
  const bool gs1 = any_reading([](const Reading& tag) { return !tag.sum10_holds; });
  if (sum10 == gs1) return std::nullopt;
  return sum10 ? CheckDigit::sum10 : CheckDigit::gs1;
}

std::vector<std::size_t> TagHypotheses::covered_frames() const {
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (all_[i].may_be_covered) frames.push_back(i);
  }
  return frames;
}

std::vector<BarRegion> TagHypotheses::odd_bars() const {
  std::vector<BarRegion> regions;
  for (const TagHypothesis& hypothesis : all_) {
    if (hypothesis.odd_bars) regions.push_back(*hypothesis.odd_bars);
  }
  return regions;
}

std::size_t TagHypotheses::to_be_looked_at() const {
  const auto asks = [](const TagHypothesis& hypothesis) {
    return hypothesis.may_be_covered || hypothesis.odd_bars.has_value();
  };
  return static_cast<std::size_t>(std::ranges::count_if(all_, asks));
}

bool TagHypotheses::has_met_covers() const {
  const auto shows_cover = [](const TagHypothesis& hypothesis) {
    return hypothesis.may_be_covered && hypothesis.explained() < kJudge.explained;
  };
  return std::ranges::any_of(all_, shows_cover) || any_reading([](const Reading& tag) {
           return tag.method == ReadingMethod::partly_covered;
         });
}

bool TagHypotheses::has_reading_at(PixelPoint point) const {
  return any_reading([&](const Reading& tag) { return contains(tag.corners, point); });
}

bool TagHypotheses::has_read_any() const {
  return any_reading([](const Reading&) { return true; });
}

bool TagHypotheses::has_frames() const {
  return std::ranges::any_of(
      all_, [](const TagHypothesis& hypothesis) { return hypothesis.frame.has_value(); });
}

bool TagHypotheses::has_read(const ExpectedTag& expected) const {
  return any_reading([&](const Reading& tag) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double off = distance(tag.corners[i], expected.corners[i]);
      if (off > expected.uncertainty_px + 1) return false;
    }
    return true;
  });
}

std::vector<Reading> TagHypotheses::tags() const {
  std::vector<Reading> tags;
  for (const TagHypothesis& hypothesis : all_) {
    if (hypothesis.reading() == nullptr) continue;
    tags.push_back(*hypothesis.reading());
    tags.back().proposer = hypothesis.proposer;
  }
  return tags;
}

ReadResult TagHypotheses::result(bool tell_passed_over) const {
  // A frame that was read after all is not listed as refused, and one refused twice is listed once.
  ReadResult result{tags(), {}};
  for (const TagHypothesis& hypothesis : all_) {
    const Rejection* rejection = hypothesis.refusal();
    if (rejection == nullptr) continue;
    if (is_passed_over(*rejection)) {
      if (tell_passed_over) result.passed_over.push_back(*rejection);
      continue;
    }
    const auto same = [&](const auto& other) {
      return same_frame(other.corners, rejection->corners);
    };
    if (std::ranges::any_of(result.tags, same) || std::ranges::any_of(result.rejected, same)) {
      continue;
    }
    result.rejected.push_back(*rejection);
    result.rejected.back().proposer = hypothesis.proposer;
  }
  return result;
}

}  // namespace tagsmith::detail
