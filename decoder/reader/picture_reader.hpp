// SPDX-License-Identifier: Apache-2.0
// The state of one picture that is being read: what was tried, read and refused.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/lens_bend.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/settle_frame.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/attempt.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/picture_bars.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/reading.hpp"

namespace tagsmith {

// Reads one picture: keeps what was found and what was tried, so that a frame seen at several
// levels is read once. Where to look is the caller's matter. The image, its bars and the options
// must outlive it.
class PictureReader {
 public:
  PictureReader(const GrayView& image, PictureBars& bars, const ReadOptions& options);

  // Looks at a candidate found in a level of the pyramid.
  void try_candidate(const PyramidLevel& level, const Quad& candidate);

  // Reads what stands in a frame that is known to a few pixels of the level.
  void try_frame(const PyramidLevel& level, const Quad& rough);

  // Reads what stands in frames that are completed by the bars of a region. `half` is the image at
  // half its size.
  void try_bars(const GrayView& half, const BarRegion& region);

  // Reads carefully what did not convince at first: in the frame as it was found, or, where one of
  // its sides may be something else's edge, in the one that the bars inside complete. `half` is the
  // image at half its size.
  void try_covered(const GrayView& half);

  // Reads again what was refused as doubtful because neither the check digit's scheme nor the codes
  // are given: the tags of a picture are of one survey, so that the scheme which all of those read
  // show, if any, is theirs too.
  void try_doubtful();

  // The plates read so far, in pixels of a level.
  std::vector<Quad> known_in(const PyramidLevel& level) const;

  // Whether bars of about this place were looked at in try_covered.
  bool was_looked_at(const BarRegion& region) const;

  // Whether something was in the way of a tag: another may be behind it too.
  bool has_met_covers() const;

  // Whether a point of the full image lies inside a frame that was read.
  bool has_reading_at(PixelPoint point) const;

  bool has_read_any() const { return !result_.tags.empty(); }

  // Whether an expected tag has been read where it should be.
  bool has_read(const ExpectedTag& expected) const;

  const std::vector<Reading>& tags() const { return result_.tags; }

  // What was read and refused so far, each frame once.
  ReadResult result() const;

 private:
  bool is_read(const Quad& quad) const;

  // How a known lens bends the sides of a frame, in pixels of the level.
  SideBows known_bows(const PyramidLevel& level, const Quad& quad) const;

  // The lens that a settled frame is fitted with.
  LensGuess lens_for(const PyramidLevel& level, const SettledFrame& settled) const;

  void pass_over(const Quad& quad, const std::string& reason);

  // Reads the symbol inside a frame; where that does not convince, keeps it for try_covered.
  void judge_inside(const RefinedFrame& frame);

  // The only scheme that the check digits read show.
  std::optional<CheckDigit> scheme_shown() const;

  // Reads the symbol inside a frame carefully; whether it was believed.
  bool judge_covered(const RefinedFrame& frame, bool completed);

  // Where the bars put the corners of a completed frame, from P on. Where its left or right side is
  // hidden the rows say how it leans, and the symbol, read so, where it stands.
  Quad expected_corners(const RefinedFrame& completed, const Attempt& attempt) const;

  // Accepts a believed symbol whose bars end where its frame has them end, or, where one of the
  // frame's upper and lower sides is something else's edge, with that side where the bars put it.
  // Whether it was accepted.
  bool accept_where_bars_end(const RefinedFrame& frame, const Attempt& attempt, const char* method);

  void accept(const RefinedFrame& frame, const Attempt& attempt, const char* method);

  // Whether the careful way may help: it needs bars that stand apart, and takes time.
  bool may_be_covered(double module_px) const;

  GrayView image_;
  PictureBars& bars_;
  const ReadOptions& options_;
  std::optional<LensBend> lens_;  // of the camera, if that is known
  ReadResult result_;
  std::vector<Quad> settled_;  // frames tried, before and after the fine fit
  std::vector<Quad> refined_;
  std::vector<RefinedFrame> covered_;           // frames whose symbols did not convince
  std::vector<RefinedFrame> doubtful_;          // frames whose symbols were not certain enough
  std::vector<RefinedFrame> doubtful_covered_;  // those that were read carefully and not believed
  std::vector<BarRegion> odd_bars_;             // what stands in frames where no symbol should
  std::vector<LocatedBars> located_;            // bars that frames were completed by
  std::vector<Quad> completed_;                 // these frames
};

}  // namespace tagsmith
