// SPDX-License-Identifier: Apache-2.0
// Why a picture was read as it was: what `tagsmith read --explain` draws.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/scan/decoding.hpp"
#include "decoder/scan/profile.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// A symbol's scan profile beside what its digits should look like.
struct ExplainedSymbol {
  Digits digits{};  // read, or the best guess where it was refused
  std::optional<std::string> refusal;
  std::string_view proposer{};  // whose place led to it; empty without a frame
  bool framed = true;
  std::array<PixelPoint, 4> outline{};           // inner corners of the frame from P, or the bars'
                                                 // outline
  std::vector<std::array<PixelPoint, 2>> lines;  // used: ends of the scanned part of the bars
  std::array<PixelPoint, kDigitCount> digit_places{};  // in the picture
  ScanProfile profile;
  std::vector<double> expected;  // darkness at the profile's places
  // How much likelier each digit is than the next best one there, with the others unchanged:
  // decades, by the noise that the fit of the symbol leaves.
  std::array<double, kDigitCount> margins{};
  Decoding decoding;
  double module_px = 0;
  double confidence = 0;
};

struct Explanation {
  std::vector<ExplainedSymbol> symbols;
  std::vector<Rejection> passed_over;
};

// Explains what a reader returned for an image, from the quantities that it measured.
Explanation explain(const ReadResult& result);

// The explanation drawn over the picture, with a panel for each symbol below: a PNG file's bytes.
Result<std::string> draw_explanation(const GrayView& image, const Explanation& explanation);

}  // namespace tagsmith::detail
