// SPDX-License-Identifier: Apache-2.0
// What the reader returns: what it read and what it refused, each with what was measured of it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/part_reading.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/scan/decoding.hpp"
#include "decoder/scan/profile.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// Which way a tag was read.
enum class ReadingMethod {
  frame,           // in a frame of which nothing is hidden
  partly_covered,  // the same with something in front of it
  paper,           // as Xu et al. (2017) published it
};

std::string to_string(ReadingMethod method);

// A tag that was read and is believed.
struct Reading {
  Digits digits{};
  bool sum10_holds = false;  // the paper's check digit
  bool gs1_holds = false;    // the standard's check digit
  FrameCorners corners{};
  double module_px = 0;   // width of a module in the middle of the frame, pixels
  double confidence = 0;  // estimated probability that every digit is right
  ReadingMethod method = ReadingMethod::frame;
  // Of the corners, pixels^2; zero = not estimated.
  CornerCovariance corner_covariance = CornerCovariance::Zero();
  std::optional<SymbolHypothesis> symbol{};  // that was believed; nothing by the paper's method
  std::string_view proposer{};               // whose place led to it; empty by the paper's method
};

// Why something that looks like a tag was not read.
enum class RejectionReason {
  frame_fault,     // its outline is no feature frame: Rejection::fault
  side_hidden,     // the symbol is read, but its place in the frame is not that of the layout
  no_guards,       // nothing like guard patterns where they should be
  guard_pattern,   // too little of the guard patterns is explained
  element_widths,  // too little of the bars is explained
  covered,         // too little of the bars is in sight
  growth,          // the bars grew or shrank too much, modules
  blur,            // modules
  doubtful,        // the confidence is too low
  stranger,        // the code is certain, and in none of the surveys given
  lines_disagree,  // without a frame: the lines and their mean say different digits
  ean13,           // without a frame: the parities are those of an EAN-13
  check_digit,     // by the paper's method: the check digit is wrong
  not_in_survey,   // by the paper's method: the code is in none of the surveys given
  paper_step,      // by the paper's method: a step failed, Rejection::step
};

// Something that looks like a tag and was not read, and why.
struct Rejection {
  RejectionReason reason = RejectionReason::doubtful;
  FrameCorners corners{};
  // Of the test that failed, where it is of one number: what was found and the least or greatest
  // that passes.
  double measured = 0;
  double limit = 0;
  FrameFault fault = FrameFault::not_framed;
  std::optional<SymbolHypothesis> symbol{};  // that was refused, as far as it was seen
  // Whose place led to it; empty by the paper's method and of what was passed over.
  std::string_view proposer{};
  std::string step{};
};

// Why, in words: "element widths", "the digits 019000000404 are in none of the given surveys".
std::string describe(const Rejection& rejection);

// The same with the number that was too low or too high: "element widths (0.83, at least 0.90)".
std::string describe_measured(const Rejection& rejection);

// A symbol seen by its bars alone. It says which tag or product this is and roughly where, but has
// no corners to measure from.
struct FramelessReading {
  Digits digits{};  // what the lines say together
  bool sum10_holds = false;
  bool gs1_holds = false;
  // Outline of the bars that were used, clockwise from the upper left as the digits run; to a
  // module or so.
  std::array<PixelPoint, 4> bars{};
  double module_px = 0;  // mean width of a module along the symbol
  double confidence = 0;
  std::vector<std::array<PixelPoint, 2>> lines{};  // first and last bar on each line that was used
  ScanProfile profile{};                           // of all lines, straightened
  Decoding decoding{};                             // of the profile
};

// Bars that look much like a symbol and were not read, and why.
struct FramelessRejection {
  RejectionReason reason = RejectionReason::doubtful;
  FramelessReading symbol{};   // the best guess
  bool bars_are_sure = false;  // the reason for which its frame was refused is what makes it a
                               // guess
};

std::string describe(const FramelessRejection& rejection);

struct FramelessResult {
  std::vector<FramelessReading> read;
  std::vector<FramelessRejection> rejected;
};

struct ReadResult {
  std::vector<Reading> tags;
  std::vector<Rejection> rejected;
  // Outlines that were looked at and are no feature frame or hold no symbol; empty unless asked for
  // (ReadOptions::tell_passed_over).
  std::vector<Rejection> passed_over{};
  FramelessResult frameless{};  // empty unless asked for (ReadOptions::frameless)
  // Tags of which a part is in sight; empty without a code book.
  std::vector<PartReading> parts{};
};

}  // namespace tagsmith::detail
