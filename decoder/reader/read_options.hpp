// SPDX-License-Identifier: Apache-2.0
// How a picture is to be read.
#pragma once

#include <optional>
#include <vector>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/geometry/camera.hpp"
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
// codes may differ from what is printed in a single digit; without a frame. docs/accuracy.md,
// "Reliability", compares confidence with the observed share of wrong readings.
inline constexpr double kSureInFrame = 1.0 - 1e-5;
inline constexpr double kSureWithBook = 1.0 - 2e-6;
inline constexpr double kSureWithoutFrame = 1.0 - 1e-6;

// Callers of the library set those of <tagsmith/read.hpp>, which decoder/api/read.cpp copies.
struct ReadOptions {
  // Looked for first, by fitting their frames where they should be: no search where that succeeds.
  std::vector<ExpectedTag> expected;
  Search search = Search::when_missing;
  // The camera that took the picture, of the picture's size: the corners are as exact under a lens
  // that bends straight lines as under any other. Without, a frame's own sides tell how its lens
  // bends them, as far as a radial distortion about the picture's middle does.
  std::optional<Camera> camera;
  // Which check digit a reading must satisfy; nothing = either (the reading says which held).
  std::optional<CheckDigit> check;
  // The plates are white on black.
  bool white_on_black = false;
  // Codes that exist (the survey's). When not empty, only these are returned, and reading works at
  // lower resolution.
  std::vector<Digits> code_book;
  // Codes that are likely where others are possible: what is refused as any code is read again as
  // one of these, in the frame that was found, without a frame nothing else is read, and tags of
  // which a part is in sight are read as one of these.
  std::vector<Digits> likely_codes;
  // Where the symbol stands in the frame, one for each template in use.
  std::vector<SymbolLayout> layouts{SymbolLayout{}};
  // Readings below this confidence are refused. Nothing = kSureInFrame, kSureWithBook or
  // kSureWithoutFrame, whichever applies.
  std::optional<double> min_confidence;
  // When symbols without a frame are read too, into ReadResult::frameless.
  Frameless frameless = Frameless::never;
  // Whether ReadResult::passed_over is filled.
  bool tell_passed_over = false;
};

}  // namespace tagsmith::detail
