// SPDX-License-Identifier: Apache-2.0
// One picture that is being read: proposals in, hypotheses out.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/coarse_fit.hpp"
#include "decoder/feature_frame/frame_fault.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/sharpening.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/judge.hpp"
#include "decoder/reader/part_search.hpp"
#include "decoder/reader/proposal.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/searched_image.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

// A place that may hold a tag, and what became of it.
struct TagHypothesis {
  enum class Source {
    outline,    // an outline that was settled onto edges all around
    bars,       // bars that were followed, without a frame yet
    completed,  // the frame that such bars complete, before it is fitted to their symbol
    careful,    // a frame whose symbol was read carefully
    again,      // a frame whose symbol was read again when more was known of the codes
    passed,     // an outline that is no feature frame; kept where that is to be told
  };

  Source source = Source::outline;
  Quad rough{};                         // the frame before its fine fit
  std::optional<RefinedFrame> frame{};  // as it was fitted
  std::optional<Sharpening> halos{};    // undone in the picture that it was looked at in
  // Read, refused, or not to be told: an attempt that leaves an earlier refusal as it was.
  std::variant<std::monostate, Reading, Rejection> outcome{};
  bool may_be_covered = false;          // a careful look may read what was refused
  std::optional<BarRegion> odd_bars{};  // the bars inside may stand in another frame than this one
  bool is_doubtful = false;             // the scheme of the check digit, were it known, may help

  const Reading* reading() const { return std::get_if<Reading>(&outcome); }
  const Rejection* refusal() const { return std::get_if<Rejection>(&outcome); }

  // Of the profile of the symbol that was read or refused; 0 where there was none.
  double explained() const;
};

// Makes hypotheses of proposals: fits the frame, reads the symbol inside and judges it. Its state
// is the list of hypotheses, so that a frame seen at several levels is read once. The picture and
// the options must outlive it.
class Detector {
 public:
  Detector(SearchedImage& picture, const ReadOptions& options);

  // Looks at a proposed place.
  void consider(const Proposal& proposal);

  // Reads again what was refused as doubtful because neither the check digit's scheme nor the codes
  // are given: the tags of a picture are of one survey, so that the scheme which all of those read
  // show, if any, is theirs too.
  void try_doubtful();

  // Reads what shows of the tags that the picture's border cuts, where there is a code book.
  void read_parts();

  // Reads what shows of the tags in refused frames of which something may hide digits, where there
  // is a code book.
  void read_covered_parts();

  // Reads what was refused as any code again as one of the likely ones.
  void try_likely_codes();

  // The plates read so far, in pixels of a level.
  std::vector<Quad> known_in(const PyramidLevel& level) const;

  // The hypotheses whose frames were refused and may be covered.
  std::vector<std::size_t> covered_frames() const;

  // Bars in refused frames that may stand in other frames than these.
  std::vector<BarRegion> odd_bars() const;

  // Whether bars of about this place are among those.
  bool was_looked_at(const BarRegion& region) const;

  // Whether something was in the way of a tag: another may be behind it too.
  bool has_met_covers() const;

  // Whether a point of the full image lies inside a frame that was read.
  bool has_reading_at(PixelPoint point) const;

  bool has_read_any() const;

  // Whether an expected tag has been read where it should be.
  bool has_read(const ExpectedTag& expected) const;

  std::vector<Reading> tags() const;

  // What was read and refused so far, each frame once.
  ReadResult result() const;

 private:
  // Reads what stands in an outline, if it is framed.
  void look_at(const Outline& outline);

  // Reads what stands in a frame.
  void look_at(const RoughFrame& rough);

  // Reads carefully what did not convince at first in a frame. Where it does not convince either,
  // one of its sides may be something else's edge, and the bars inside tell.
  void look_at(const RefusedFrame& refused);

  // Reads what stands in frames that are completed by the bars of a region.
  void look_at(const BarRegion& region);

  template <class Condition>
  bool any_reading(const Condition& condition) const;

  bool is_read(const Quad& quad) const;

  // Adds a hypothesis. Of two readings in one place the one that explains more stays where their
  // digits are the same; none does where they differ.
  void keep(TagHypothesis hypothesis);

  // How a known lens bends the sides of a frame, in pixels of the level.
  SideSagittas known_sagittas(const PyramidLevel& level, const Quad& quad) const;

  // The lens that a settled frame is fitted with.
  LensGuess lens_for(const PyramidLevel& level, const CoarseFrame& settled) const;

  // Tells, where that is wanted, of an outline that is no feature frame.
  void pass_over(const Quad& quad, FrameFault fault);

  // The reading of a clear symbol whose bars end where another layout has them: layouts with the
  // same quiet zone explain the bars alike.
  std::optional<Reading> read_in_another_layout(const RefinedFrame& frame,
                                                const SymbolLayout& tried) const;

  // Looks again at a hypothesis whose frame shows halos, in the picture without them.
  void look_behind_halos(const LensGuess& lens, TagHypothesis& hypothesis);

  // Shows the picture around a frame as it is stored.
  void show_as_stored(const Quad& quad);

  // Shows it around a hypothesis's frame as that was looked at, without its halos.
  void show_as_seen_by(const TagHypothesis& hypothesis);

  // What the quick profile shows inside a frame.
  TagHypothesis judged_quickly(const Quad& rough, const RefinedFrame& frame) const;

  // Whether there is time left for a careful look at one more refused symbol.
  bool may_be_cared_for() const;

  // Reads the symbol inside a frame carefully; whether it was believed.
  bool judge_carefully(const RefinedFrame& frame, bool completed);

  // Reads a doubtful symbol in the frame of a hypothesis again, when more is known of the codes.
  void judge_again(std::size_t index, const ReadOptions& named);

  // The only scheme that the check digits read show.
  std::optional<CheckDigit> scheme_shown() const;

  GrayView image_;
  SearchedImage& picture_;
  const ReadOptions& options_;
  SymbolLayout typical_;                // of the tags that are searched for
  std::optional<LensDistortion> lens_;  // of the camera, if that is known
  std::vector<TagHypothesis> hypotheses_;
  PartSearch part_search_;
  std::optional<UnsharpenedImage> unsharpened_;  // the picture that is read, where it was sharpened
};

}  // namespace tagsmith::detail
