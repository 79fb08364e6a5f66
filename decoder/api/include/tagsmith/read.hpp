// SPDX-License-Identifier: Apache-2.0
// Image to readings.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <tagsmith/export.hpp>
#include <tagsmith/geometry.hpp>
#include <tagsmith/image.hpp>
#include <tagsmith/rig.hpp>
#include <tagsmith/survey.hpp>

namespace tagsmith {

// When to look for symbols whose feature frame cannot be seen.
enum class Frameless {
  never,
  fallback,  // when no tag was read by its frame
  always,
};

struct ReadOptions {
  // Only their tags are read, smaller ones too, and readings have names. Empty = any code of a
  // plate with the layout of Xu et al. (2017).
  std::vector<Survey> surveys;
  // The camera that took the image, of the image's size: corners are then as exact under a lens
  // that bends straight lines as under any other.
  std::optional<CameraModel> camera;
  // The check digit that a tag must have. Absent = that of the surveys where they agree on one,
  // else either.
  std::optional<CheckDigit> check_digit;
  Frameless frameless = Frameless::never;
  // Readings below this confidence are refused; absent = the reader's own borders, at which about
  // one reading in 100,000 may be wrong (docs/accuracy.md, "Reliability").
  std::optional<double> min_confidence;
  // The plates are white on black; surveys say so themselves.
  bool white_on_black = false;
};

enum class ReadingMethod {
  frame,           // in a frame of which nothing is hidden
  partly_covered,  // in a frame with something in front of it
  frameless,       // by the bars alone
};

// "frame", "partly_covered", "frameless".
TAGSMITH_EXPORT const char* to_string(ReadingMethod method) noexcept;

// A tag that was read and is believed.
struct Tag {
  std::string digits;        // twelve
  bool sum10_holds = false;  // which check digits they satisfy
  bool gs1_holds = false;
  Vector3 position{};  // that the digits say: grid of the survey that has the tag; of a
                       // stranger by the code of Xu et al. (2017)
  std::string survey;  // that has the tag; empty = none does
  std::string name;    // of the tag in it; empty likewise
  Corners corners{};   // of the feature frame
  std::optional<CornerCovariance> corner_covariance;  // absent = not estimated
  double module_px = 0;   // width of the narrowest bar in the middle of the frame
  double confidence = 0;  // estimated probability that every digit is right
  ReadingMethod method = ReadingMethod::frame;
};

// A symbol without a frame: which tag it is, and roughly where. It has no corners to measure from.
struct FramelessTag {
  std::string digits;
  bool sum10_holds = false;
  bool gs1_holds = false;
  Vector3 position{};
  std::string survey;
  std::string name;
  std::array<Point, 4> bars{};  // outline, clockwise from the upper left as the digits run
  double module_px = 0;
  double confidence = 0;
};

// Why something that looks like a tag was not read.
enum class RefusalReason {
  frame_fault,     // its outline is no feature frame
  side_hidden,     // the symbol's place in the frame is not that of the plate
  no_guards,       // nothing like guard patterns where they should be
  guard_pattern,   // too little of the guard patterns is explained
  element_widths,  // too little of the bars is explained
  covered,         // too little of the bars is in sight
  growth,          // the bars grew or shrank too much
  blur,
  doubtful,        // the confidence is too low
  stranger,        // certain, and in none of the surveys given
  lines_disagree,  // without a frame: lines say different digits
  ean13,           // without a frame: an EAN-13
};

// "frame_fault" and so on.
TAGSMITH_EXPORT const char* to_string(RefusalReason reason) noexcept;

struct Refusal {
  RefusalReason reason = RefusalReason::doubtful;
  std::string text;       // the reason in words
  bool has_frame = true;  // whether the corners are a frame's, or those of the bars
  Corners corners{};
  // For a reason that is one number: what was found and the least or greatest that passes.
  double measured = 0;
  double limit = 0;
};

struct ReadResult {
  std::vector<Tag> tags;
  std::vector<FramelessTag> frameless;  // as ReadOptions::frameless asks
  std::vector<Refusal> refusals;
};

// All tags in the image, whatever their rotation and perspective, and what was refused and why. An
// image without a tag is no failure. Fails with ErrorCode::invalid_argument on a view of nothing
// and on a camera of another size. Threads may call it at once.
TAGSMITH_EXPORT ReadResult read(const ImageView& image, const ReadOptions& options = {});

}  // namespace tagsmith
