// SPDX-License-Identifier: Apache-2.0
// The paper's image pipeline, literally: Xu et al. (2017), "Locating and recognition of barcode
// tags". It serves for comparison, so its known limits are kept: one global threshold, one tag an
// image, the tag must be the largest white area and nearly upright.
//
// The paper counts pixels from (1, 1); here pixel (0, 0) is the centre of the upper left one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "decoder/image/gray.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

struct PixelIndex {
  int x = 0;
  int y = 0;
};

// The outer boundary pixels of one white region, in order around it.
struct PaperOutline {
  std::vector<PixelIndex> points;
  double area = 0;  // enclosed by the outline through the pixels' centres, pixels^2
};

struct PaperSegmentation {
  int threshold = 0;                   // t of (2); samples >= t are white
  GrayImage binary;                    // I_2: 0 black, 1 white
  std::vector<PaperOutline> outlines;  // of the white regions of I_3, by area, largest first
};

// The threshold t in 0..255 that maximises (2), the least of equal ones; samples >= t are white.
// (OpenCV's Otsu threshold is t - 1, since its white is > threshold.) 0 for an image of one grey.
int otsu_threshold(const GrayView& image);

// Grey image -> Otsu -> 3x3 opening -> outlines. The opening ignores everything outside the image.
// The paper does not say what an outline's area is, nor whether the edges of holes are outlines;
// "the largest is the plate, the second largest the inside of the feature frame" holds when each
// white region has one outline, its outer one, and its area is what that encloses.
PaperSegmentation segment_paper(const GrayView& image);

// What the pipeline reads from an image.
struct PaperReading {
  Digits digits{};
  bool sum10_holds = false;  // the paper's check digit
  bool gs1_holds = false;
  PixelPoint p;            // P' by (3)
  PixelPoint q;            // Q' by (4)
  PixelPoint upper_right;  // F' and the lower right corner: not defined by the paper, the outline's
  PixelPoint lower_right;  // points with the greatest X - Y and X + Y
  double module_px = 0;    // b = S_B / 95, mean over the rows that gave these digits
  int rows_with_59_elements = 0;  // of the outline
  int rows_decoded = 0;           // every digit found in Table 1
  int rows_agreeing = 0;          // with the digits returned
};

// The step of the pipeline that could not be done.
enum class PaperStep { locate_frame, scan_rows, vote };

std::string to_string(PaperStep step);

struct PaperFailure {
  PaperStep step = PaperStep::locate_frame;
  std::string message;
  std::optional<FrameCorners> corners;  // of the supposed feature frame, where one was located
};

// Where the paper says nothing: an element's width is rounded to the nearest whole module; a row
// counts when the scan finds exactly 59 elements (60 boundaries) and Table 1 has all twelve digits,
// while the guard patterns are not checked; of rows that disagree the digits found most often win,
// and a tie fails. The check digit is reported, not used.
tl::expected<PaperReading, PaperFailure> read_paper(const PaperSegmentation& segmentation);

// segment_paper and read_paper as a reader: at most one tag, method "paper". Its corners F and
// lower right are the outline's (see PaperReading); its confidence is the share of decoded rows
// that agree, for which reason options.min_confidence does not apply. A wrong check digit, or
// digits that are not in the code book, are a rejection.
ReadResult read_tags_paper(const GrayView& image, const ReadOptions& options = {});

}  // namespace tagsmith::detail
