// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/page.hpp"

#include <algorithm>
#include <cmath>

#include "tagsmith/base/text.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kLeastCropGap = 0.003;  // between the plate's corner and its crop marks
constexpr double kCropLength = 0.008;
constexpr double kTickLength = 0.004;
constexpr double kNoteStep = 1.8 * kNoteHeight;

double crop_gap(double bleed) { return std::max(kLeastCropGap, bleed); }

std::string scale_bar_text() { return format_number(kScaleBarLength * 1000) + " mm"; }

// Along a line through its middle, across the page or down it. The nominal length lies between the
// middles of the end ticks.
void add_scale_bar(Page& page, const PlatePoint& middle, bool upright) {
  const auto at = [&](double along, double aside) {
    return upright ? PlatePoint{middle.x + aside, middle.y + along}
                   : PlatePoint{middle.x + along, middle.y + aside};
  };
  constexpr double kEnd = kScaleBarLength / 2;
  page.lines.push_back({at(-kEnd, 0), at(kEnd, 0)});
  for (const double end : {-kEnd, kEnd}) {
    page.lines.push_back({at(end, -kTickLength / 2), at(end, kTickLength / 2)});
  }
  const PlatePoint text = at(0, (upright ? 1.6 : -0.6) * kNoteHeight);
  page.texts.push_back({.text = scale_bar_text(),
                        .x = text.x,
                        .y = text.y,
                        .height = kNoteHeight,
                        .max_width = kScaleBarLength,
                        .centred = true,
                        .upwards = upright});
}

// Two lines over the whole page, the others between the crop marks.
void add_notes(Page& page, const TagDrawing& tag) {
  double baseline = kScaleBarInset;
  const double width = page.width - 0.03;
  add_note(page, page.notes.title + "  \u00b7  " + page.notes.subject, baseline, width);
  add_note(page, what_to_measure(tag), baseline += kNoteStep, width);
  const double between_marks = std::min(width, tag.plate.width - 2 * kLeastCropGap);
  for (const std::string& line : page.notes.more) {
    add_note(page, line, baseline += kNoteStep, between_marks);
  }
}

Rectangle grown(const Rectangle& box, double by) {
  return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by};
}

}  // namespace

PlatePoint on_page(const PageTag& tag, const PlatePoint& point) {
  if (!tag.turned_about) return point;
  const auto& [x, y] = *tag.turned_about;
  return {x + point.y - y, y - (point.x - x)};
}

Rectangle on_page(const PageTag& tag, const Rectangle& rectangle) {
  const auto& [x, y, width, height] = rectangle;
  if (!tag.turned_about) return rectangle;
  const PlatePoint upper_left = on_page(tag, PlatePoint{x + width, y});
  return {upper_left.x, upper_left.y, height, width};
}

double least_margin(double bleed) {
  constexpr double kUnprinted = 0.005;
  constexpr double kNotes = 0.022;  // two lines, marks and the scale bars
  return std::max(kNotes, crop_gap(bleed) + kCropLength + kUnprinted);
}

double at_dot(double value, int dots_per_inch) {
  if (dots_per_inch == 0) return value;
  const double dot = kMetresPerInch / dots_per_inch;
  constexpr double kRounding = 1e-6;  // dots
  return std::floor(value / dot + kRounding) * dot;
}

void add_note(Page& page, const std::string& text, double baseline, double max_width) {
  page.texts.push_back({.text = text,
                        .x = page.width / 2,
                        .y = baseline,
                        .height = kNoteHeight,
                        .max_width = max_width,
                        .centred = true});
}

std::string what_to_measure(const TagDrawing& tag) {
  return "feature frame inside " + mm_text(tag.frame_inner.width) + " \u00d7 " +
         mm_text(tag.frame_inner.height) + " mm  \u00b7  plate " + mm_text(tag.plate.width) +
         " \u00d7 " + mm_text(tag.plate.height) +
         " mm  \u00b7  print at 100 %, then measure both " + scale_bar_text() + " bars";
}

void add_crop_marks(Page& page, const Rectangle& plate, double gap, double length) {
  for (const bool right : {false, true}) {
    for (const bool lower : {false, true}) {
      const double x = plate.x + (right ? plate.width : 0);
      const double y = plate.y + (lower ? plate.height : 0);
      const double across = right ? 1 : -1;
      const double down = lower ? 1 : -1;
      const double end = gap + length;
      page.lines.push_back({{x + across * gap, y}, {x + across * end, y}});
      page.lines.push_back({{x, y + down * gap}, {x, y + down * end}});
    }
  }
}

void add_scale_bars(Page& page, double x, double y) {
  add_scale_bar(page, {page.width / 2, y}, false);
  add_scale_bar(page, {x, page.height / 2}, true);
}

Page lay_out_page(const std::string& name, const TagDrawing& tag, const PageNotes& notes,
                  const PageStyle& style) {
  const double extra_lines = notes.more.empty() ? 0 : static_cast<double>(notes.more.size() - 1);
  const double margin = std::max(style.margin, least_margin(style.bleed)) + extra_lines * kNoteStep;
  const double least_size = kScaleBarLength + 2 * margin;
  Page page;
  page.notes = notes;
  page.width = std::max(tag.plate.width + 2 * margin, least_size);
  page.height = std::max(tag.plate.height + 2 * margin, least_size);
  const double p_right =
      at_dot((page.width - tag.plate.width) / 2 - tag.plate.x, style.dots_per_inch);
  const double p_down =
      at_dot((page.height - tag.plate.height) / 2 - tag.plate.y, style.dots_per_inch);
  page.tags.push_back({name, moved(tag, p_right, p_down)});
  const TagDrawing& placed = page.tags.front().drawing;
  page.trim = placed.plate;
  page.bleed = grown(placed.plate, style.bleed);
  add_crop_marks(page, placed.plate, crop_gap(style.bleed), kCropLength);
  add_scale_bars(page, kScaleBarInset, page.height - kScaleBarInset);
  add_notes(page, placed);
  return page;
}

}  // namespace tagsmith::detail
