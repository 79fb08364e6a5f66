// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/printer_sheet.hpp"

#include <cmath>
#include <utility>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/tag/printer_test.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kUnprinted = 0.005;  // what office printers leave blank

Rectangle moved(const Rectangle& r, const PlatePoint& by) {
  return {r.x + by.x, r.y + by.y, r.width, r.height};
}

// A line with a tick at every centimetre and its length.
void add_long_scale(Page& page, const Rectangle& scale) {
  constexpr double kTick = 0.002;
  const bool lying = scale.height == 0;
  const double length = lying ? scale.width : scale.height;
  page.lines.push_back({{scale.x, scale.y}, {scale.x + scale.width, scale.y + scale.height}});
  const int ticks = static_cast<int>(std::lround(length / 0.010));
  for (int i = 0; i <= ticks; ++i) {
    const double at = length * i / ticks;
    const double reach = i == 0 || i == ticks ? 2 * kTick : kTick;
    const double x = scale.x + (lying ? at : 0);
    const double y = scale.y + (lying ? 0 : at);
    page.lines.push_back({{x, y}, {x + (lying ? 0 : reach), y + (lying ? reach : 0)}});
  }
  page.texts.push_back({.text = format_number(length * 1000) + " mm",
                        .x = scale.x + scale.width / 2 + (lying ? 0 : 0.008),
                        .y = scale.y + scale.height / 2 + (lying ? 0.008 : 0),
                        .height = kNoteHeight,
                        .max_width = length,
                        .centred = true,
                        .upwards = !lying});
}

Page page_of(const PrinterTest& test, const PrintPaper& paper, const PlatePoint& corner,
             double adjustment) {
  Page page;
  page.width = paper.width;
  page.height = paper.height;
  page.notes = {"Printer test", "tagsmith printer"};
  for (const TagDrawing& mark : test.marks) {
    const TagDrawing placed = tagsmith::detail::moved(mark, corner.x, corner.y);
    page.tags.push_back({"mark", with_bar_adjustment(placed, adjustment)});
  }
  for (const Rectangle& scale : test.scales) add_long_scale(page, moved(scale, corner));
  const double below = corner.y + 0.205;
  const double width = test.width - 0.010;
  add_note(page, "Printer test: print at 100 %, scan the whole sheet flat at 300 dpi or more",
           below, width);
  add_note(page, "tagsmith printer SCAN --dpi 300 -o printer.yaml", below + 0.005, width);
  return page;
}

}  // namespace

Result<Sheet> printer_sheet(const PrintPaper& paper, const PrinterProfile& profile) {
  const PrinterTest test = printer_test();
  const PlatePoint corner{(paper.width - test.width) / 2, (paper.height - test.height) / 2};
  if (corner.x < kUnprinted || corner.y < kUnprinted) {
    return fail("--paper " + paper.name + ": a printer test needs a sheet of at least " +
                format_number((test.width + 2 * kUnprinted) * 1000) + " x " +
                format_number((test.height + 2 * kUnprinted) * 1000) + " mm, for example A4");
  }
  const double adjustment = bar_adjustment_for(profile, false);
  Sheet sheet = sheet_of(page_of(test, paper, corner, adjustment));
  SheetLayer bars{"width-steps", {}};
  const auto add_bar = [&](const Rectangle& bar, double wider, double higher) {
    const Rectangle drawn{bar.x + corner.x - wider / 2, bar.y + corner.y - higher / 2,
                          bar.width + wider, bar.height + higher};
    if (drawn.width > 0 && drawn.height > 0) bars.items.push_back(area_of(drawn));
  };
  for (const Rectangle& bar : test.upright) add_bar(bar, adjustment, 0);
  for (const Rectangle& bar : test.lying) add_bar(bar, 0, adjustment);
  SheetLayer tones{"tones", {}};
  for (const TonePatch& tone : test.tones) {
    const double grey = 1 - tone.cover;
    tones.items.push_back(area_of(moved(tone.square, corner), {grey, grey, grey}));
  }
  sheet.layers.push_back(std::move(bars));
  sheet.layers.push_back(std::move(tones));
  return scaled(std::move(sheet), 1 / profile.scale.right, 1 / profile.scale.down);
}

}  // namespace tagsmith::detail
