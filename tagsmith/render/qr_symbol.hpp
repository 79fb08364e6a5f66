// SPDX-License-Identifier: Apache-2.0
// QR symbols on plates (ISO/IEC 18004).
#pragma once

#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// The symbol of the content with error correction of level M, in the box with a quiet zone of 4
// modules. Fails where the content is too long for any symbol, and where a module would be smaller
// than phones read.
Result<QrDrawing> qr_symbol(const std::string& content, const Rectangle& box);

}  // namespace tagsmith::detail
