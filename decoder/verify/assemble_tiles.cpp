// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/assemble_tiles.hpp"

#include <algorithm>
#include <cmath>

#include "tagsmith/tag/printer_dots.hpp"

namespace tagsmith::detail {
namespace {

int pixels(double metres, double per_metre) {
  return static_cast<int>(std::lround(metres * per_metre));
}

}  // namespace

Result<PageImage> assemble_tiles(const TilePlan& plan, const std::vector<TilePage>& pages,
                                 double dots_per_inch) {
  constexpr double kMaxPixels = 40e6;
  const double width = (plan.columns - 1) * plan.step_right + plan.window.width;
  const double height = (plan.rows - 1) * plan.step_down + plan.window.height;
  // Pictures come as they are; pages of documents are drawn as asked for.
  const bool scalable = pages.front().number > 0 || is_svg(pages.front().file);
  const double least = std::sqrt(kMaxPixels / (width * height)) * kMetresPerInch;
  const double dpi = scalable ? std::min(dots_per_inch, least) : dots_per_inch;
  const double per_metre = dpi / kMetresPerInch;
  GrayImage plate{pixels(width, per_metre), pixels(height, per_metre), {}};
  constexpr double kMostPixels = 200e6;
  if (static_cast<double>(plate.width) * plate.height > kMostPixels) {
    return fail(pages.front().file.string() + ": the plate in tiles is too large a picture");
  }
  plate.samples.assign(
      static_cast<std::size_t>(plate.width) * static_cast<std::size_t>(plate.height), 255);
  const PixelRegion window{pixels(plan.window.x, per_metre), pixels(plan.window.y, per_metre),
                           static_cast<int>(plan.window.width * per_metre),
                           static_cast<int>(plan.window.height * per_metre)};
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const auto column = static_cast<int>(i) % plan.columns;
    const auto row = static_cast<int>(i) / plan.columns;
    const Result<GrayImage> tile =
        rasterize_part(pages[i].file, pages[i].number, dpi, window, pages[i].scale);
    if (!tile) return fail(tile.error().message);
    paste(*tile, plate, pixels(column * plan.step_right, per_metre),
          pixels(row * plan.step_down, per_metre));
  }
  return PageImage{std::move(plate), 1 / per_metre, {}};
}

}  // namespace tagsmith::detail
