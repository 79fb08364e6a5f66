// SPDX-License-Identifier: Apache-2.0
// Tags of which a part is in sight, read against a code book.
#pragma once

#include <optional>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/part_reading.hpp"
#include "decoder/reader/read_options.hpp"

namespace tagsmith::detail {

// Reads the part in sight of a tag whose outline (to a pixel or two) has its side 1 on the
// picture's border. Nothing where what is in sight is not certainly that of a code of the book, or
// too little of it, or the camera's lens bends what is straight.
std::optional<PartReading> read_part(const GrayView& image, const Quad& cut,
                                     const ReadOptions& options);

// A symbol in a whole frame, of which something hides digits.
struct CoveredReading {
  // Nothing where what is in sight is not certainly that of a code of the book, or too little of
  // it, or the bars end elsewhere than in this frame.
  std::optional<PartReading> part{};
  bool is_contradicted = false;  // a digit in sight is none of the likeliest code's
};

CoveredReading read_covered(const GrayView& image, const RefinedFrame& frame,
                            const ReadOptions& options);

}  // namespace tagsmith::detail
