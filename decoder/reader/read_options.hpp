// SPDX-License-Identifier: Apache-2.0
// How a picture is to be read.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// A tag that should be in the picture: predicted from a survey and the last position, or seen in
// the picture before.
struct ExpectedTag {
  FrameCorners corners{};     // from P on
  double uncertainty_px = 4;  // farthest that a corner may be off
};

// When the whole picture is searched.
enum class Search {
  always,
  when_missing,  // when no tag is expected, or an expected one is not read where it should be
  never,         // only expected tags are read
};

// When to look for symbols without a frame.
enum class Frameless {
  never,     // where corners are needed
  fallback,  // when no tag was read by its frame: costs nothing where one was
  always,
};

// Least confidence at which a reading is believed: in a frame; in a frame with a code book, whose
// codes may differ from what is printed in a single digit; where something covers a part of the
// bars, which the stated doubt does not foresee; without a frame. docs/accuracy.md, "Reliability",
// compares confidence with the observed share of wrong readings.
inline constexpr double kSureInFrame = 1.0 - 1e-5;
inline constexpr double kSureWithBook = 1.0 - 2e-6;
inline constexpr double kSureIfCovered = 1.0 - 1e-6;
inline constexpr double kSureWithoutFrame = 1.0 - 1e-6;

// Callers of the library set those of <tagsmith/read.hpp>, which decoder/api/read.cpp copies.
struct ReadOptions {
  // Looked for first, by fitting their frames where they should be: no search where that succeeds.
  std::vector<ExpectedTag> expected;
  Search search = Search::when_missing;
  // The camera that took the picture, of the picture's size: the corners are as exact under a lens
  // that bends straight lines as under any other. Without it, the distortion is estimated from a
  // frame's own sides, as far as it is radial about the picture's middle.
  std::optional<Camera> camera;
  // Which check digit a reading must satisfy; nothing = either (the reading says which held).
  std::optional<CheckDigit> check;
  // The plates are white on black.
  bool white_on_black = false;
  // Codes that exist (the survey's). When not empty, only these are returned, and reading works at
  // lower resolution.
  std::vector<Digits> code_book;
  // Codes that are likely where others are possible: what is refused when any code is allowed is
  // read again as one of these, in the frame that was found. Without a frame only these are read,
  // and tags of which a part is in sight are read as one of these.
  std::vector<Digits> likely_codes;
  // Where the symbol stands in the frame, one for each template in use.
  std::vector<SymbolLayout> layouts{SymbolLayout{}};
  // Readings below this confidence are refused. Nothing = kSureInFrame, kSureWithBook,
  // kSureIfCovered or kSureWithoutFrame, whichever applies.
  std::optional<double> min_confidence;
  // When symbols without a frame are read too, into ReadResult::frameless.
  Frameless frameless = Frameless::never;
  // Whether ReadResult::passed_over is filled.
  bool tell_passed_over = false;
};

// ---- What a survey gives the reader: how to read its tags, and which of them should be in a
// picture.

// How to read the tags of these surveys: their templates' layouts, their codes as the code book,
// and their check digit where they agree on one.
ReadOptions read_options_for(std::span<const Survey> surveys);

// The same for surveys that lie apart; none is copied.
ReadOptions read_options_of(std::span<const Survey* const> surveys);

// ---- Tags that should be in a picture, known beforehand.

// The tags of a survey that a camera at this pose faces and has wholly in its image, at 0.25 pixels
// a module or more; nearest first. `uncertainty_px` is that of the corners, as the pose leaves it.
std::vector<ExpectedTag> expected_tags(const Survey& survey, const Camera& camera,
                                       const Pose& camera_from_world, double uncertainty_px);

}  // namespace tagsmith::detail
