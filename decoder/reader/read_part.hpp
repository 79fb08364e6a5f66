// SPDX-License-Identifier: Apache-2.0
// Tags of which a part is in sight, read against a code book.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/part_reading.hpp"
#include "decoder/reader/proposal.hpp"
#include "decoder/reader/read_options.hpp"

namespace tagsmith::detail {

// Reads the part in sight of a tag whose outline (to a pixel or two) has its side 1 on the
// picture's border. Nothing where what is in sight does not certainly belong to a code of the book,
// or too little is in sight. A lens that is not known is taken for one that bends nothing.
std::optional<PartReading> read_part(const GrayView& image, const Quad& cut,
                                     const ReadOptions& options);

// A symbol in a whole frame, of which something hides digits.
struct CoveredReading {
  // Nothing where what is in sight does not certainly belong to a code of the book, or too little
  // is in sight, or the bars end elsewhere than in this frame.
  std::optional<PartReading> part{};
  bool is_contradicted = false;  // a digit in sight is none of the likeliest code's
};

CoveredReading read_covered(const GrayView& image, const RefinedFrame& frame,
                            const ReadOptions& options);

// ---- Tags of one picture of which a part is in sight: noted during the search for whole tags,
// read where no whole tag was read.

// Does nothing without codes to compare with.
// Why: docs/decisions/0005-parts-and-frameless-symbols.md.
class PartSearch {
 public:
  // Whether a whole tag was read at a place of the picture.
  using IsRead = std::function<bool(PixelPoint)>;

  explicit PartSearch(const ReadOptions& options);

  // Keeps an outline that the picture's border cuts.
  void note_cut(const Outline& outline, const FrameShape& shape);

  // Keeps an outline within the picture that is framed on all sides but one, where something may
  // hide the end of a tag.
  void note_hidden_side(const Outline& outline, const FrameShape& shape);

  // Reads what was cut by the border and noted since the last call.
  void read_cut(const GrayView& image, const IsRead& is_read);

  // Keeps a frame whose begin or end may be the edge of the object that hides the rest.
  void note_hidden_end(const GrayView& image, const Quad& frame);

  // Reads what is in sight inside of a refused frame.
  void read_covered(const GrayView& image, const RefinedFrame& frame, const IsRead& is_read);

  // Reads what was noted, beside what hides it.
  void read_beside(const GrayView& image, const IsRead& is_read);

  const std::vector<PartReading>& parts() const { return parts_; }

 private:
  bool has_part_at(PixelPoint point) const;

  ReadOptions options_;             // the codes that parts are compared with are its book
  std::vector<Quad> cut_;           // outlines with their side 1 on the border
  std::size_t read_cuts_ = 0;       // of them, tried so far
  std::vector<Quad> hidden_sides_;  // outlines with something before their side 1
  std::vector<Quad> covered_;       // refused frames that were tried
  std::vector<Quad> strangers_;     // of them, those whose digits in sight contradict the book
  std::vector<PartReading> parts_;
};

}  // namespace tagsmith::detail
