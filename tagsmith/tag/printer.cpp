// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/printer.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

double dot_of(int dots_per_inch) { return kMetresPerInch / dots_per_inch; }

// Both edges rounded; the size is what lies between them.
Rectangle rounded(const Rectangle& box, double dot) {
  const auto edge = [&](double value) { return std::round(value / dot) * dot; };
  return {edge(box.x), edge(box.y), edge(box.x + box.width) - edge(box.x),
          edge(box.y + box.height) - edge(box.y)};
}

// Left and upper edges moved by `before` to the left and up, right and lower ones by `after`.
Rectangle grown(const Rectangle& box, double before, double after) {
  return {box.x - before, box.y - before, box.width + before + after, box.height + before + after};
}

constexpr double kWhole = 0.01;   // dots: smaller differences do not count
constexpr double kQuietZone = 9;  // modules (GS1 General Specifications)

bool is_whole(double dots) { return std::abs(dots - std::round(dots)) < kWhole; }

// The symbol's outer edges where quiet zones that had 9 modules have them still.
void keep_quiet_zones(TagDrawing& drawing, double gap, double dot) {
  if (drawing.bars.empty() || gap < kQuietZone * drawing.module - kWhole * dot) return;
  const double least = std::ceil(kQuietZone * drawing.module / dot - kWhole) * dot;
  Rectangle& first = drawing.bars.front();
  Rectangle& last = drawing.bars.back();
  const double left = std::max(first.x, drawing.frame_inner.x + least);
  const double right =
      std::min(last.x + last.width, drawing.frame_inner.x + drawing.frame_inner.width - least);
  first.width -= left - first.x;
  first.x = left;
  last.width = right - last.x;
}

}  // namespace

// A page fitted to its paper is smaller than this share, and both directions are alike so far.
constexpr double kFittedPage = 0.99;
constexpr double kFittedAlike = 0.002;

bool is_usual(const PrinterScale& scale) {
  constexpr double kRounding = 1e-9;
  const auto usual = [](double value) {
    return std::abs(value - 1) <= kMostPrinterScale + kRounding;
  };
  const double unequal = std::abs(scale.right - scale.down);
  const bool is_fitted = std::max(scale.right, scale.down) < kFittedPage && unequal <= kFittedAlike;
  return usual(scale.right) && usual(scale.down) && unequal <= kMostUnequalScale + kRounding &&
         !is_fitted;
}

std::string usual_scales() {
  return fmt::format("{:g} to {:g}, alike to {:g}, and not both less than {:g} and alike to {:g}",
                     1 - kMostPrinterScale, 1 + kMostPrinterScale, kMostUnequalScale, kFittedPage,
                     kFittedAlike);
}

PrinterScale reach_of(const PrinterScale& scale) {
  return {std::min(scale.right, 1.0), std::min(scale.down, 1.0)};
}

TagTemplate fitted_to_dots(TagTemplate tag, int dots_per_inch) {
  const double dot = dot_of(dots_per_inch);
  const double before = module_width(tag);
  const double dots = std::floor(before / dot + kWhole);
  if (dots < 1 || std::abs(before / dot - dots) < kWhole) return tag;
  const double bars = bar_height(tag);
  const double module = dots * dot;
  tag.quiet_zone_modules = (tag.frame_inner_length / module - kModuleCount) / 2;
  tag.margin_modules = (tag.frame_inner_height - bars) / (2 * module);
  return tag;
}

TagTemplate drawn_on_dots(const TagTemplate& tag, int dots_per_inch) {
  constexpr double kMostMove = 0.1;  // modules: little compared with the blur of a camera
  const TagTemplate whole = fitted_to_dots(tag, dots_per_inch);
  const double move = kModuleCount / 2.0 * (1 - module_width(whole) / module_width(tag));
  return move <= kMostMove ? whole : tag;
}

// Why: docs/decisions/0016-printing.md.
TagDrawing on_whole_dots(TagDrawing drawing, int dots_per_inch) {
  const double dot = dot_of(dots_per_inch);
  const double gap = drawing.bars.empty() ? 0 : drawing.bars.front().x - drawing.frame_inner.x;
  for (Rectangle* box : {&drawing.frame_outer, &drawing.frame_inner}) *box = rounded(*box, dot);
  for (Rectangle& bar : drawing.bars) bar = rounded(bar, dot);
  keep_quiet_zones(drawing, gap, dot);
  return drawing;
}

double drawn_adjustment(double adjustment, int dots_per_inch) {
  if (dots_per_inch <= 0) return adjustment;
  const double dot = dot_of(dots_per_inch);
  return std::round(adjustment / dot) * dot;
}

TagDrawing with_bar_adjustment(TagDrawing drawing, double adjustment, int dots_per_inch) {
  const double whole = drawn_adjustment(adjustment, dots_per_inch);
  double before = whole / 2;
  if (dots_per_inch > 0) {
    const double dot = dot_of(dots_per_inch);
    before = std::floor(before / dot + kWhole) * dot;
  }
  const double after = whole - before;
  drawing.frame_outer = grown(drawing.frame_outer, before, after);
  drawing.frame_inner =
      grown(drawing.frame_inner, -after, -before);  // white: its left edge ends ink
  for (Rectangle& bar : drawing.bars) bar = grown(bar, before, after);
  return drawing;
}

std::string describe_rounding(const TagTemplate& wanted, const TagTemplate& drawn,
                              int dots_per_inch) {
  const double dot = dot_of(dots_per_inch);
  const double before = module_width(wanted) / dot;
  const double after = module_width(drawn) / dot;
  const std::string module = "module " + format_number(before * dot * 1e3, 4) +
                             " mm = " + format_number(before, 2) + " dots of " +
                             std::to_string(dots_per_inch) + " dpi, printed as ";
  if (!is_whole(after)) {
    return module + format_number(std::floor(after)) + " or " + format_number(std::ceil(after)) +
           " dots, every edge on the nearest one; quiet zone not under " +
           format_number(std::min(kQuietZone, wanted.quiet_zone_modules), 3) + " modules";
  }
  if (std::abs(before - after) < 1e-9 / dot) return {};
  return module + format_number(after, 0) + " dots = " + format_number(after * dot * 1e3, 4) +
         " mm; quiet zone " + format_number(wanted.quiet_zone_modules, 3) + " -> " +
         format_number(drawn.quiet_zone_modules, 3) + " modules";
}

}  // namespace tagsmith::detail
