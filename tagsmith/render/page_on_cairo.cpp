// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/page_on_cairo.hpp"

#include <algorithm>
#include <array>
#include <cairo.h>
#include <cmath>
#include <numbers>

#include "tagsmith/render/text.hpp"

namespace tagsmith {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

void add_rectangle(cairo_t* context, const Rectangle& rectangle) {
  cairo_rectangle(context, rectangle.x, rectangle.y, rectangle.width, rectangle.height);
}

// One path, filled by the even-odd rule: four rectangles would leave hairline seams on some
// printers.
void fill_feature_frame(cairo_t* context, const TagDrawing& tag) {
  add_rectangle(context, tag.frame_outer);
  add_rectangle(context, tag.frame_inner);
  cairo_set_fill_rule(context, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_fill(context);
}

void fill_arrow(cairo_t* context, const UpArrow& arrow) {
  for (const PlatePoint& corner : outline_of(arrow)) cairo_line_to(context, corner.x, corner.y);
  cairo_close_path(context);
  cairo_fill(context);
}

void draw_patches(cairo_t* context, const ReferencePatches& patches) {
  add_rectangle(context, patches.black);
  cairo_fill(context);
  add_rectangle(context, patches.white);
  cairo_stroke(context);
}

void add_circle(cairo_t* context, const HoleOutline& hole) {
  cairo_new_sub_path(context);
  cairo_arc(context, hole.centre.x, hole.centre.y, hole.radius, 0, 4 * kQuarter);
  cairo_close_path(context);
}

// The circle and a cross at its centre for the drill.
void stroke_hole(cairo_t* context, const HoleOutline& hole, bool with_circle) {
  const auto& [x, y] = hole.centre;
  if (with_circle) add_circle(context, hole);
  cairo_move_to(context, x - hole.radius, y);
  cairo_line_to(context, x + hole.radius, y);
  cairo_move_to(context, x, y - hole.radius);
  cairo_line_to(context, x, y + hole.radius);
  cairo_stroke(context);
}

void add_plate_outline(cairo_t* context, const Rectangle& plate, double radius) {
  if (radius <= 0) return add_rectangle(context, plate);
  const double right = plate.x + plate.width - radius;
  const double bottom = plate.y + plate.height - radius;
  const std::array<PlatePoint, 4> centres{{{right, plate.y + radius},
                                           {right, bottom},
                                           {plate.x + radius, bottom},
                                           {plate.x + radius, plate.y + radius}}};
  double angle = -kQuarter;
  cairo_new_sub_path(context);
  for (const PlatePoint& centre : centres) {
    cairo_arc(context, centre.x, centre.y, radius, angle, angle + kQuarter);
    angle += kQuarter;
  }
  cairo_close_path(context);
}

void stroke_contour(cairo_t* context, const TagDrawing& tag) {
  cairo_set_source_rgb(context, 1, 0, 1);
  add_plate_outline(context, tag.plate, tag.corner_radius);
  for (const HoleOutline& hole : tag.holes) add_circle(context, hole);
  cairo_stroke(context);
  cairo_set_source_rgb(context, 0, 0, 0);
}

void draw_tag_shapes(cairo_t* context, const PageTag& placed, bool with_contour) {
  const TagDrawing& tag = placed.drawing;
  cairo_save(context);
  if (placed.window) {
    add_rectangle(context, *placed.window);
    cairo_clip(context);
  }
  fill_feature_frame(context, tag);
  for (const Rectangle& bar : tag.bars) add_rectangle(context, bar);
  cairo_fill(context);
  for (const UpArrow& arrow : tag.arrows) fill_arrow(context, arrow);
  if (tag.patches) draw_patches(context, *tag.patches);
  const bool contour = with_contour && tag.cut_contour && placed.at_true_scale;
  for (const HoleOutline& hole : tag.holes) stroke_hole(context, hole, !contour);
  for (const TextItem& item : tag.label) show_text(context, item);
  if (contour) stroke_contour(context, tag);
  cairo_restore(context);
}

// Dashes one by one: Cairo's PDF cannot say dashes that are short in metres.
void add_dashes(cairo_t* context, const PageLine& line) {
  constexpr double kDash = 0.002;
  constexpr double kPeriod = 0.003;
  const double right = line.to.x - line.from.x;
  const double down = line.to.y - line.from.y;
  const double length = std::hypot(right, down);
  for (double start = 0; start < length; start += kPeriod) {
    const double end = std::min(start + kDash, length);
    cairo_move_to(context, line.from.x + right * start / length,
                  line.from.y + down * start / length);
    cairo_line_to(context, line.from.x + right * end / length, line.from.y + down * end / length);
  }
}

void stroke_lines(cairo_t* context, const Page& page) {
  for (const PageLine& line : page.lines) {
    if (line.dashed) {
      add_dashes(context, line);
      continue;
    }
    cairo_move_to(context, line.from.x, line.from.y);
    cairo_line_to(context, line.to.x, line.to.y);
  }
  cairo_stroke(context);
}

}  // namespace

void draw_page(cairo_t* context, const Page& page, bool with_contour) {
  cairo_set_source_rgb(context, 0, 0, 0);
  cairo_set_line_width(context, page.line_width);
  for (const PageTag& tag : page.tags) draw_tag_shapes(context, tag, with_contour);
  stroke_lines(context, page);
  for (const TextItem& item : page.texts) show_text(context, item);
}

}  // namespace tagsmith
