// SPDX-License-Identifier: Apache-2.0
// What is known of a picture while it is read: the places that were looked at, and the result at
// each.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/sharpening.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"

namespace tagsmith::detail {

// A place that may hold a tag, and what became of it.
struct TagHypothesis {
  enum class Source {
    outline,    // an outline that was settled onto edges all around
    bars,       // bars that were followed, without a frame yet
    completed,  // the frame that such bars complete, before it is fitted to their symbol
    careful,    // a frame whose symbol was read carefully
    again,      // a frame whose symbol was read again when more was known of the codes
    passed,     // an outline that is no feature frame; kept where these are to be reported
  };

  Source source = Source::outline;
  std::string_view proposer{};          // whose place led to it
  Quad rough{};                         // the frame before its fine fit
  std::optional<RefinedFrame> frame{};  // as it was fitted
  std::optional<Sharpening> halos{};    // undone in the picture that it was looked at in
  // Read, refused, or not reported: an attempt that leaves an earlier refusal unchanged.
  std::variant<std::monostate, Reading, Rejection> outcome{};
  bool may_be_covered = false;          // a careful look may read what was refused
  std::optional<BarRegion> odd_bars{};  // the bars inside may stand in another frame than this one
  bool is_doubtful = false;             // the scheme of the check digit, were it known, may help

  const Reading* reading() const { return std::get_if<Reading>(&outcome); }
  const Rejection* refusal() const { return std::get_if<Rejection>(&outcome); }

  // Of the profile of the symbol that was read or refused; 0 where there was none.
  double explained() const;
};

// The hypotheses of a picture in the order in which they were met. Lengths are pixels of the full
// image unless a level is named.
class TagHypotheses {
 public:
  // Of tags with such a frame.
  explicit TagHypotheses(const FrameShape& shape) : shape_(shape) {}

  const std::vector<TagHypothesis>& all() const { return all_; }
  TagHypothesis& operator[](std::size_t index) { return all_[index]; }

  // Names the proposer of the hypotheses that follow.
  void note_proposer(std::string_view name) { proposer_ = name; }

  // Adds a hypothesis, which is returned. Of two readings in one place the one that explains more
  // stays where their digits are the same; none does where they differ.
  TagHypothesis& keep(TagHypothesis hypothesis);

  // Whether a hypothesis of this source began at the same place.
  bool was_proposed(TagHypothesis::Source source, const Quad& rough) const;

  // Whether an outline was fitted to the same frame before.
  bool was_fitted(const RefinedFrame& frame) const;

  // Whether this frame was read.
  bool is_read(const Quad& quad) const;

  // The plates read so far with their strokes, in pixels of a level.
  std::vector<Quad> known_in(const PyramidLevel& level) const;

  // The only scheme that the check digits read show.
  std::optional<CheckDigit> scheme_shown() const;

  // Those whose frames were refused and may be covered.
  std::vector<std::size_t> covered_frames() const;

  // Bars in refused frames that may stand in other frames than these.
  std::vector<BarRegion> odd_bars() const;

  // How many of them ask for a careful look, at a frame or at the bars inside.
  std::size_t to_be_looked_at() const;

  // Whether something was in the way of a tag: another may be behind it too. What is explained and
  // refused all the same is too small or blurred.
  bool has_met_covers() const;

  // Whether a point lies inside a frame that was read.
  bool has_reading_at(PixelPoint point) const;

  bool has_read_any() const;

  // Whether there is a frame, read or refused.
  bool has_frames() const;

  // Whether an expected tag has been read where it should be.
  bool has_read(const ExpectedTag& expected) const;

  std::vector<Reading> tags() const;

  // What was read and refused so far, each frame once; ReadResult::passed_over where that is to be
  // reported.
  ReadResult result(bool tell_passed_over) const;

 private:
  template <class Condition>
  bool any_reading(const Condition& condition) const;

  FrameShape shape_;
  std::string_view proposer_;
  std::vector<TagHypothesis> all_;
};

}  // namespace tagsmith::detail
