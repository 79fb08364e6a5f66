// SPDX-License-Identifier: Apache-2.0
// Plates that were printed in pieces, put together again as the assembly sheet says.
#pragma once

#include <vector>

#include "decoder/verify/rasterize.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/tiled_pages.hpp"

namespace tagsmith::detail {

// Where one tile is drawn.
struct TilePage {
  std::filesystem::path file;
  int number = 0;        // of the page in a PDF, from 1; 0 in a picture
  PrinterScale scale{};  // of the printer that a PDF is for
};

// The plate at 150 dpi (pictures: at their own `dots_per_inch`; fewer when it would have more than
// 40 million pixels), each window of the plan pasted where it belongs, as the sheets are glued.
// `pages`: row by row, as many as the plan has tiles. Fails when one cannot be drawn.
Result<PageImage> assemble_tiles(const TilePlan& plan, const std::vector<TilePage>& pages,
                                 double dots_per_inch = 150);

}  // namespace tagsmith::detail
