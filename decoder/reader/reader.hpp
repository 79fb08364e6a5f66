// SPDX-License-Identifier: Apache-2.0
// Image -> readings. Needs no OpenCV to call.
#pragma once

#include <optional>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith {

struct ReadOptions {
  // Which check digit a reading must satisfy; nothing = either (the reading says which held).
  std::optional<CheckDigit> check;
  // Codes that exist (the survey's). When not empty, only these are returned, and reading works at
  // lower resolution.
  std::vector<Digits> code_book;
  // Where the symbol stands in the frame, one for each template in use.
  std::vector<SymbolLayout> layouts{SymbolLayout{}};
  // Readings below this confidence are refused. The highest of a wrong code among some 50 000
  // simulated frames was 1 - 3e-4 (docs/accuracy.md, "Reliability").
  double min_confidence = 1.0 - 1e-4;
};

// All tags in the image, whatever their rotation and perspective, and what was refused and why.
ReadResult read_tags(const GrayView& image, const ReadOptions& options = {});

}  // namespace tagsmith
