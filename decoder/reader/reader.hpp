// SPDX-License-Identifier: Apache-2.0
// Image -> readings. Needs no OpenCV to call.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith {

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
  // Codes that exist (the survey's). When not empty, only these are returned, and reading works at
  // lower resolution.
  std::vector<Digits> code_book;
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

// All tags in the image, whatever their rotation and perspective, and what was refused and why.
ReadResult read_tags(const GrayView& image, const ReadOptions& options = {});

// The same in two steps, for a caller who may know after the first that the second, which can take
// many times as long, is not needed. The image must outlive it.
class TagSearch {
 public:
  // Reads the tags whose frames stand out whole: where they are expected, and all over the image as
  // `options.search` says.
  TagSearch(const GrayView& image, const ReadOptions& options);
  TagSearch(TagSearch&&) noexcept;
  TagSearch& operator=(TagSearch&&) noexcept;
  ~TagSearch();

  // Reads frames that are in pieces or partly out of the image, and tags that are partly covered:
  // looks around the bars that no reading explains. Nothing where the image was
  // not searched, or has been looked at closer before.
  void look_closer();

  // The tags read so far.
  const std::vector<Reading>& tags() const;

  // The same with what was refused and why, and symbols without a frame as the options say.
  ReadResult result() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tagsmith
