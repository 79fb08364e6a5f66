// SPDX-License-Identifier: Apache-2.0
// Colours as printers and cutting plotters want them in the content of a PDF page.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tagsmith/base/result.hpp"

namespace tagsmith {

// The content (ISO 32000-2, 7.8.2) with `0 0 0 rg` as `0 g` and `0 0 0 RG` as `0 G`, and with a
// contour `1 0 1 RG` as the colour space CutContour in full. Text in brackets stays as it is.
std::string with_print_colours(std::string_view content, bool has_contour);

// zlib's format (RFC 1950), which PDF calls FlateDecode.
std::string deflated(std::string_view bytes);

// Fails on bytes that are not whole or no such stream.
Result<std::string> inflated(std::string_view bytes);

}  // namespace tagsmith
