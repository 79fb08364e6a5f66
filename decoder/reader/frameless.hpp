// SPDX-License-Identifier: Apache-2.0
// Symbols read by their bars alone: tags whose feature frame is cut or damaged, and product codes.
#pragma once

#include "decoder/image/gray.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/searched_image.hpp"

namespace tagsmith::detail {

// Every UPC-A symbol of the image that its bars alone make certain, whatever its rotation; small,
// blurred and bent ones too. Bars are located by their texture, read line by line with a free
// distortion along the line (decoder/scan/elastic_scan.hpp), the lines' likelihoods are added, and
// the straightened profile must then pass what a framed symbol must. The check digit is
// options.check, or gs1, that of every product, unless options.code_book says which codes exist.
FramelessResult read_frameless(SearchedImage& picture, const ReadOptions& options = {});
inline FramelessResult read_frameless(const GrayView& image, const ReadOptions& options = {}) {
  SearchedImage picture(image);
  return read_frameless(picture, options);
}

// Adds to the result what options.frameless asks for. A tag that was read by its frame is not
// returned again. A reading of one that its frame shows to be covered or doubtful is not believed
// on less evidence: it joins those that were rejected.
ReadResult with_frameless(SearchedImage& picture, const ReadOptions& options, ReadResult result);

}  // namespace tagsmith::detail
