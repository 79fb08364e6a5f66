// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// True for the content of a PNG file.
bool is_png(std::string_view bytes);

// A PNG file (ISO/IEC 15948) with those of its chunks alone that make its pixels: the critical ones
// and tRNS. Of the others, such as colour profiles, libpng complains on standard error without
// naming the file, and no pixel that this program decodes depends on them. Fails, in words about
// the file, where a chunk's checksum is wrong or a chunk goes on beyond the file's end.
Result<std::string> png_of_pixels(std::string_view bytes);

}  // namespace tagsmith::detail
