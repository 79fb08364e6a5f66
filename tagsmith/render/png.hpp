// SPDX-License-Identifier: Apache-2.0
// A page as PNG.
#pragma once

#include <filesystem>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/page.hpp"

namespace tagsmith {

// Writes the page at true scale in 8-bit grey, with its resolution (pHYs chunk) and title. Edges
// that stand on whole dots are sharp, others grey by coverage; cut contours are left out. Memory
// for a band of it is taken at a time. The same page gives the same bytes. Fails when the page
// would have more than 2 000 000 000 pixels or more than 30 000 a side, or the file cannot be
// written.
Result<void> write_png(const std::filesystem::path& path, const Page& page, int dots_per_inch);

}  // namespace tagsmith
