// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/page.hpp"

#include <algorithm>

#include "tagsmith/base/text.hpp"

namespace tagsmith {
namespace {

constexpr double kCropGap = 0.003;  // between the plate's corner and its crop marks
constexpr double kCropLength = 0.008;
constexpr double kScaleBarInset = 0.008;  // from the page's edge: printers leave about 5 mm blank
constexpr double kTickLength = 0.004;
constexpr double kNoteHeight = 0.0025;  // of a capital letter

Rectangle moved(Rectangle rectangle, double right, double down) {
  rectangle.x += right;
  rectangle.y += down;
  return rectangle;
}

TagDrawing moved(TagDrawing tag, double right, double down) {
  tag.plate = moved(tag.plate, right, down);
  tag.frame_outer = moved(tag.frame_outer, right, down);
  tag.frame_inner = moved(tag.frame_inner, right, down);
  for (Rectangle& bar : tag.bars) bar = moved(bar, right, down);
  for (UpArrow& arrow : tag.arrows) arrow.box = moved(arrow.box, right, down);
  for (TextItem& item : tag.label) {
    item.x += right;
    item.y += down;
  }
  return tag;
}

// Two marks a corner, each in line with one of the plate's edges.
void add_crop_marks(Page& page) {
  const Rectangle& plate = page.tag.plate;
  for (const bool right : {false, true}) {
    for (const bool lower : {false, true}) {
      const double x = plate.x + (right ? plate.width : 0);
      const double y = plate.y + (lower ? plate.height : 0);
      const double across = right ? 1 : -1;
      const double down = lower ? 1 : -1;
      const double end = kCropGap + kCropLength;
      page.lines.push_back({{x + across * kCropGap, y}, {x + across * end, y}});
      page.lines.push_back({{x, y + down * kCropGap}, {x, y + down * end}});
    }
  }
}

std::string scale_bar_text() { return format_number(kScaleBarLength * 1000) + " mm"; }

// The nominal length lies between the middles of the end ticks.
void add_horizontal_scale_bar(Page& page) {
  const double y = page.height - kScaleBarInset;
  const double left = (page.width - kScaleBarLength) / 2;
  const double right = left + kScaleBarLength;
  page.lines.push_back({{left, y}, {right, y}});
  for (const double x : {left, right}) {
    page.lines.push_back({{x, y - kTickLength / 2}, {x, y + kTickLength / 2}});
  }
  page.texts.push_back({.text = scale_bar_text(),
                        .x = page.width / 2,
                        .y = y - 0.6 * kNoteHeight,
                        .height = kNoteHeight,
                        .max_width = kScaleBarLength,
                        .centred = true});
}

void add_vertical_scale_bar(Page& page) {
  const double x = kScaleBarInset;
  const double top = (page.height - kScaleBarLength) / 2;
  const double bottom = top + kScaleBarLength;
  page.lines.push_back({{x, top}, {x, bottom}});
  for (const double y : {top, bottom}) {
    page.lines.push_back({{x - kTickLength / 2, y}, {x + kTickLength / 2, y}});
  }
  page.texts.push_back({.text = scale_bar_text(),
                        .x = x + 1.6 * kNoteHeight,
                        .y = page.height / 2,
                        .height = kNoteHeight,
                        .max_width = kScaleBarLength,
                        .centred = true,
                        .upwards = true});
}

std::string dimensions_text(const TagDrawing& tag) {
  const auto mm = [](double length) { return format_number(length * 1000, 3); };
  return "feature frame inside " + mm(tag.frame_inner.width) + " \u00d7 " +
         mm(tag.frame_inner.height) + " mm  \u00b7  plate " + mm(tag.plate.width) + " \u00d7 " +
         mm(tag.plate.height) + " mm  \u00b7  print at 100 %, then measure both " +
         scale_bar_text() + " bars";
}

void add_notes(Page& page) {
  const double width = page.width - 0.03;
  const std::string heading = page.notes.title + "  \u00b7  " + page.notes.subject;
  double baseline = 0.008;
  for (const std::string& line : {heading, dimensions_text(page.tag)}) {
    page.texts.push_back({.text = line,
                          .x = page.width / 2,
                          .y = baseline,
                          .height = kNoteHeight,
                          .max_width = width,
                          .centred = true});
    baseline += 1.8 * kNoteHeight;
  }
}

}  // namespace

Page lay_out_page(const TagDrawing& tag, const PageNotes& notes, const PageStyle& style) {
  const double margin = std::max(style.margin, kLeastPageMargin);
  const double least_size = kScaleBarLength + 2 * margin;
  Page page;
  page.notes = notes;
  page.width = std::max(tag.plate.width + 2 * margin, least_size);
  page.height = std::max(tag.plate.height + 2 * margin, least_size);
  page.tag = moved(tag, (page.width - tag.plate.width) / 2 - tag.plate.x,
                   (page.height - tag.plate.height) / 2 - tag.plate.y);
  add_crop_marks(page);
  add_horizontal_scale_bar(page);
  add_vertical_scale_bar(page);
  add_notes(page);
  return page;
}

}  // namespace tagsmith
