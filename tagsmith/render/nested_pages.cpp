// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/nested_pages.hpp"

#include <algorithm>
#include <cmath>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kRounding = 1e-9;

// A plate's share of the page: itself and half the gap around it, which holds its crop marks.
double gap_of(double bleed) { return 2 * std::max(bleed, kPaperMarkGap + kPaperMarkLength); }

int count_along(double room, double side, double gap) {
  return static_cast<int>(std::floor((room + kRounding) / (side + gap)));
}

NestPlan plan_on(const Rectangle& plate, double width, double height, double bleed) {
  const Rectangle area = content_area(width, height);
  const double gap = gap_of(bleed);
  return {count_along(area.width, plate.width, gap),
          count_along(area.height, plate.height, gap),
          width,
          height,
          false,
          false,
          bleed};
}

// Plates per metre of the roll.
double density(const NestPlan& plan) {
  return plan.plates() / std::max(plan.page_width, plan.page_height);
}

std::optional<NestPlan> better(std::optional<NestPlan> first, std::optional<NestPlan> second) {
  if (first->plates() == 0 && second->plates() == 0) return std::nullopt;
  return density(*second) > density(*first) ? second : first;
}

// Where the plate of this column and row lies.
PlatePoint place_of(const Rectangle& plate, const NestPlan& plan, int column, int row) {
  const Rectangle area = content_area(plan.page_width, plan.page_height);
  const double gap = gap_of(plan.bleed);
  return {area.x + gap / 2 + column * (plate.width + gap),
          area.y + gap / 2 + row * (plate.height + gap)};
}

std::string mm(double metres) { return format_number(std::ceil(metres * 1000 - 1e-6)); }

}  // namespace

std::optional<NestPlan> plan_nest(const Rectangle& plate, const PrintPaper& paper, double bleed,
                                  int dots_per_inch) {
  const double length = paper.roll() ? kLongestPage : paper.height;
  NestPlan upright = plan_on(plate, paper.width, length, bleed);
  NestPlan across = plan_on(plate, length, paper.width, bleed);
  upright.shortened_down = paper.roll();
  across.shortened_right = paper.roll();
  std::optional<NestPlan> plan = better(upright, across);
  if (plan) plan->dots_per_inch = dots_per_inch;
  return plan;
}

std::string papers_for(const Rectangle& plate, double bleed) {
  std::string text;
  for (const PrintPaper& paper : print_papers()) {
    if (plan_nest(plate, paper, bleed, 0)) text += (text.empty() ? "" : ", ") + paper.name;
  }
  const double gap = gap_of(bleed);
  const double upright = plate.width + gap + PaperBorder::kLeft + PaperBorder::kRight;
  const double across = plate.height + gap + PaperBorder::kTop + PaperBorder::kBottom;
  return text + (text.empty() ? "" : " or ") + "a roll of " + mm(std::min(upright, across)) + " mm";
}

Page lay_out_nested(std::span<const NamedDrawing> tags, const PageNotes& notes,
                    const NestPlan& plan) {
  Page page;
  page.notes = notes;
  page.width = plan.page_width;
  page.height = plan.page_height;
  const Rectangle plate = tags.front().drawing.plate;
  const int count = static_cast<int>(tags.size());
  const int rows = (count + plan.columns - 1) / plan.columns;
  if (plan.shortened_down) {
    page.height = place_of(plate, plan, 0, rows).y + PaperBorder::kBottom;
  } else if (plan.shortened_right) {
    const int columns = rows > 1 ? plan.columns : count;
    page.width = place_of(plate, plan, columns, 0).x + PaperBorder::kRight;
  }
  page.width = std::max(page.width, kScaleBarLength + PaperBorder::kLeft + PaperBorder::kRight);
  page.height = std::max(page.height, kScaleBarLength + PaperBorder::kTop + PaperBorder::kBottom);
  for (int i = 0; i < count; ++i) {
    const PlatePoint place = place_of(plate, plan, i % plan.columns, i / plan.columns);
    const NamedDrawing& tag = tags[static_cast<std::size_t>(i)];
    const TagDrawing drawing = moved(tag.drawing, at_dot(place.x - plate.x, plan.dots_per_inch),
                                     at_dot(place.y - plate.y, plan.dots_per_inch));
    add_crop_marks(page, drawing.plate, kPaperMarkGap, kPaperMarkLength);
    page.tags.push_back({tag.name, drawing});
  }
  add_scale_bars(page, 0.007, page.height - 0.007);
  add_paper_notes(page, notes.title + "  \u00b7  " + notes.subject,
                  what_to_measure(tags.front().drawing),
                  page.width - PaperBorder::kLeft - PaperBorder::kRight);
  return page;
}

}  // namespace tagsmith::detail
