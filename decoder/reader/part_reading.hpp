// SPDX-License-Identifier: Apache-2.0
// What the reader returns of a tag of which the picture shows a part.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/scan/decode_part.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// A tag that the picture's border cuts, or of which something hides digits or an end. What is in
// sight is certain and belongs to one of the candidates, or to a plate of no survey given whose
// digits in sight are the same: nothing in the picture distinguishes these, so that a part alone is
// no evidence that a tag is in its place. Why: docs/decisions/0005-parts-and-frameless-symbols.md.
struct PartReading {
  std::vector<PartCandidate> candidates;     // of the code book, likeliest first; not empty
  std::array<bool, kDigitCount> in_sight{};  // digits that are seen wholly, and certain
  // All bars are in sight between both sides beside them, over a part of their height: the digits
  // identify the tag as those of a whole one do.
  bool shows_all_bars = false;
  double share = 0;  // of the symbol's length that is in sight; cut above or below, of the height
  // From P on. What is out of sight follows from the sides and bars in sight.
  FrameCorners corners{};
  std::array<bool, 4> corner_in_sight{};
  CornerCovariance corner_covariance = CornerCovariance::Zero();  // pixels^2
  double module_px = 0;   // width of a module amid what is in sight, pixels
  double confidence = 0;  // estimated probability that the digits in sight are a candidate's
};

// The digits in sight of the likeliest candidate, the others as "-": "019003------".
std::string digits_in_sight(const PartReading& part);

}  // namespace tagsmith::detail
