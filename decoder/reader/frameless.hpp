// SPDX-License-Identifier: Apache-2.0
// Symbols read by their bars alone: tags whose feature frame is cut or damaged, and product codes.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/picture_bars.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/sampled_light.hpp"
#include "decoder/scan/decode.hpp"

namespace tagsmith {

// Every UPC-A symbol of the image that its bars alone make certain, whatever its rotation; small,
// blurred and bent ones too. Bars are located by their texture, read line by line with a free
// distortion along the line (decoder/scan/elastic_scan.hpp), the lines' likelihoods are added, and
// the straightened profile must then pass what a framed symbol must. The check digit is
// options.check, or gs1, that of every product, unless options.code_book says which codes exist.
FramelessResult read_frameless(PictureBars& bars, const ReadOptions& options = {});
inline FramelessResult read_frameless(const GrayView& image, const ReadOptions& options = {}) {
  PictureBars bars(image);
  return read_frameless(bars, options);
}

// One region of bars much like a symbol: what read_frameless makes its answer from, for people who
// want to know why.
struct FramelessTrace {
  Digits digits{};  // what the lines say together
  double confidence = 0;
  std::optional<std::string> objection;  // nothing: it was read
  std::array<PixelPoint, 4> bars{};
  double module_px = 0;
  std::vector<std::array<PixelPoint, 2>> lines;  // first and last bar on each line that was used
  ScanProfile profile;                           // of all lines, straightened
  Decoding decoding;                             // of the profile
};

std::vector<FramelessTrace> trace_frameless(PictureBars& bars, const ReadOptions& options = {});

// Where the bars of a symbol stand, read or not.
struct LocatedBars {
  // Module of a pixel, from the first bar on: (a + b . p) / (1 + c . p) with p = pixel - centre.
  double a = 0;
  PixelPoint b;
  PixelPoint c;
  PixelPoint centre;
  double height = 0;  // along the bars over which they were followed, pixels

  // The line of all pixels of a module: normal . (pixel - centre) + distance = 0.
  PixelPoint normal_at(double module) const { return b - module * c; }
  double distance_at(double module) const { return a - module; }
  double module_of(PixelPoint pixel) const {
    return (a + dot(b, pixel - centre)) / (1 + dot(c, pixel - centre));
  }
};

// Follows the bars of a region line by line; nothing where they are not much like a symbol, or the
// same as some that were `located` before.
std::optional<LocatedBars> locate_bars(SampledLight& image, const BarRegion& region,
                                       std::span<const LocatedBars> located = {});

// The result with what options.frameless asks for. A tag that was read by its frame is not given
// again; one that its frame shows to be covered or doubtful is not believed by less: it joins those
// that were rejected.
ReadResult with_frameless(PictureBars& bars, const ReadOptions& options, ReadResult result);

}  // namespace tagsmith
