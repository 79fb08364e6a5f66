// SPDX-License-Identifier: Apache-2.0
// What the reader returns.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "decoder/image/pixel.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith {

// Inner corners of the feature frame, clockwise from P: P, F, lower right, Q, as the tag's own
// "up" says (whatever way it is turned in the image).
using FrameCorners = std::array<PixelPoint, 4>;

// A tag that was read and is believed.
struct Reading {
  Digits digits{};
  bool sum10_holds = false;  // the paper's check digit
  bool gs1_holds = false;    // the standard's check digit
  FrameCorners corners{};
  double module_px = 0;   // width of a module in the middle of the frame, pixels
  double confidence = 0;  // estimated probability that every digit is right
  std::string method;     // which way it was read
  // Of the corners, pixels^2; zero = not estimated.
  CornerCovariance corner_covariance = CornerCovariance::Zero();
};

// Something that looks like a tag and was not read, and why.
struct Rejection {
  std::string reason;  // e.g. "too few pixels per module", "check digit", "guard pattern"
  FrameCorners corners{};
};

// A symbol read by its bars alone. It says which tag or product this is and roughly where, but has
// no corners to measure from.
struct FramelessReading {
  Digits digits{};
  bool sum10_holds = false;
  bool gs1_holds = false;
  // Outline of the bars that were used, clockwise from the upper left as the digits run; to a
  // module or so.
  std::array<PixelPoint, 4> bars{};
  double module_px = 0;  // mean width of a module along the symbol
  double confidence = 0;
};

// Bars that are much like a symbol and were not read, and why.
struct FramelessRejection {
  std::string reason;
  std::array<PixelPoint, 4> bars{};
};

struct FramelessResult {
  std::vector<FramelessReading> read;
  std::vector<FramelessRejection> rejected;
};

// Why most outlines are passed over: they are not even roughly a feature frame.
inline constexpr const char* kNotFramedReason = "no white, black, white across its sides";

// Why a symbol is refused that passed every test but that of its confidence.
inline constexpr const char* kDoubtfulReason = "not certain enough";

// Why a symbol is refused of which too little is in sight.
inline constexpr const char* kCoveredReason = "bars covered";

struct ReadResult {
  std::vector<Reading> tags;
  std::vector<Rejection> rejected;
  // Outlines that were looked at and are no feature frame or hold no symbol; empty unless asked for
  // (ReadOptions::tell_passed_over).
  std::vector<Rejection> passed_over{};
  FramelessResult frameless{};  // empty unless asked for (ReadOptions::frameless)
};

}  // namespace tagsmith
