// SPDX-License-Identifier: Apache-2.0
// One picture that is being read: proposals in, hypotheses out.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/coarse_fit.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/sharpening.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/proposal.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/read_part.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/searched_image.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/reader/tag_hypotheses.hpp"

namespace tagsmith::detail {

// Makes hypotheses of proposals: fits the frame, reads the symbol inside and judges it. Its state
// is the hypotheses, so that a frame seen at several levels is read once, and parts of tags. The
// picture and the options must outlive it.
class Detector {
 public:
  Detector(SearchedImage& picture, const ReadOptions& options);

  // Names the proposer of the places that follow.
  void note_proposer(std::string_view name) { found_.note_proposer(name); }

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

  // Reads what was refused as any code again as one of the likely ones, once in each place.
  void try_likely_codes();

  // What came of the proposals so far.
  const TagHypotheses& found() const { return found_; }

  // What was read and refused so far, each frame once.
  ReadResult result() const;

 private:
  // Reads what stands in an outline, if it is framed.
  void look_at(const Outline& outline);

  // Reads what stands in a frame.
  void look_at(const RoughFrame& rough);

  // Reads what stands in a frame that was settled in a level; whether it was read, now or before.
  bool look_at_settled(const PyramidLevel& level, const CoarseFrame& settled);

  // Reads carefully what did not convince at first in a frame. Where it does not convince either,
  // one of its sides may be something else's edge, and the bars inside tell.
  void look_at(const RefusedFrame& refused);

  // Reads what stands in frames that are completed by the bars of a region.
  void look_at(const BarRegion& region);

  // How a known lens bends the sides of a frame, in pixels of the level.
  SideSagittas known_sagittas(const PyramidLevel& level, const Quad& quad) const;

  // The lens that a settled frame is fitted with.
  LensGuess lens_for(const PyramidLevel& level, const CoarseFrame& settled) const;

  // Tells, where that is wanted, of an outline that is no feature frame.
  void pass_over(const Quad& quad, FrameFault fault);

  // The reading of a clear symbol whose bars end where another layout has them: layouts with the
  // same quiet zone explain the bars alike.
  std::optional<Reading> read_in_another_layout(const GrayView& image, const RefinedFrame& frame,
                                                const SymbolLayout& tried) const;

  // Looks again at a hypothesis whose frame shows halos, in the picture without them.
  void look_behind_halos(const LensGuess& lens, TagHypothesis& hypothesis);

  // The picture, and without their halos the frames that were last looked at so. The next look may
  // change what it shows.
  GrayView image() const;

  // The picture, around a frame as it is stored.
  GrayView as_stored(const Quad& quad);

  // The picture, around a hypothesis's frame as that was looked at, without its halos.
  GrayView as_seen_by(const TagHypothesis& hypothesis);

  // What the quick profile shows inside a frame.
  TagHypothesis judged_quickly(const GrayView& image, const Quad& rough,
                               const RefinedFrame& frame) const;

  // Reads the symbol inside a frame carefully; the hypothesis that was kept.
  TagHypothesis& judge_carefully(const GrayView& image, const RefinedFrame& frame, bool completed);

  // Reads the symbol in the frame of a hypothesis again, when more is known of the codes.
  void judge_again(std::size_t index, const ReadOptions& named);

  SearchedImage& picture_;
  const ReadOptions& options_;
  SymbolLayout typical_;                // of the tags that are searched for
  std::optional<LensDistortion> lens_;  // of the camera, if that is known
  TagHypotheses found_;
  PartSearch part_search_;
  std::optional<UnsharpenedImage> unsharpened_;  // the picture that is read, where it was sharpened
};

}  // namespace tagsmith::detail
