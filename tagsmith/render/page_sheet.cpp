// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/page_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;

Vector2d point(const PlatePoint& p) { return {p.x, p.y}; }

Eigen::AlignedBox2d box_of(const Rectangle& r) {
  return {Vector2d(r.x, r.y), Vector2d(r.x + r.width, r.y + r.height)};
}

Points points_of(std::span<const PlatePoint> outline) {
  Points points;
  std::ranges::transform(outline, std::back_inserter(points), point);
  return points;
}

Points rectangle_outline(const Rectangle& r) { return points_of(corners_of(r)); }

// Adds a quarter of a circle, clockwise from the angle (0 = to the right, then down). Its sides
// miss the arc by less than a thousandth of the radius: finer than any plotter.
void add_quarter(Points& points, const Vector2d& centre, double radius, double angle) {
  constexpr int kSides = 36;
  for (int i = 0; i <= kSides; ++i) {
    const double turn = angle + std::numbers::pi / 2 * i / kSides;
    points.push_back(centre + radius * Vector2d(std::cos(turn), std::sin(turn)));
  }
}

// The rectangle with round corners; of no size, a circle.
Points rounded(const Rectangle& r, double radius) {
  if (radius <= 0) return rectangle_outline(r);
  const double right = r.x + r.width - radius;
  const double bottom = r.y + r.height - radius;
  Points points;
  const Points centres{
      {right, bottom}, {r.x + radius, bottom}, {r.x + radius, r.y + radius}, {right, r.y + radius}};
  for (std::size_t i = 0; i < centres.size(); ++i) {
    add_quarter(points, centres[i], radius, std::numbers::pi / 2 * static_cast<double>(i));
  }
  return points;
}

Points circle(const HoleOutline& hole) {
  const auto& [x, y] = hole.centre;
  const double radius = hole.radius;
  return rounded({x - radius, y - radius, 2 * radius, 2 * radius}, radius);
}

SheetText text(const TextItem& item) {
  return {.text = item.text,
          .at = {item.x, item.y},
          .height = item.height,
          .angle = item.upwards ? std::numbers::pi / 2 : 0,
          .max_width = item.max_width,
          .centred = item.centred};
}

void make_white(SheetItem& item) {
  if (auto* area = std::get_if<SheetArea>(&item)) area->fill = colours::kWhite;
  if (auto* line = std::get_if<SheetLine>(&item)) line->line.colour = colours::kWhite;
  if (auto* words = std::get_if<SheetText>(&item)) words->colour = colours::kWhite;
}

SheetArea area_of(const std::vector<Rectangle>& rectangles) {
  SheetArea area;
  for (const Rectangle& rectangle : rectangles)
    area.outlines.push_back(rectangle_outline(rectangle));
  return area;
}

SheetArea area_of(const std::vector<std::vector<PlatePoint>>& outlines) {
  SheetArea area;
  for (const std::vector<PlatePoint>& outline : outlines) {
    area.outlines.push_back(points_of(outline));
  }
  return area;
}

// The layers of one tag. The frame is one area, for four rectangles would leave hairline seams on
// some printers. So are the bars: renderers move the edges of a rectangle that stands alone onto
// whole pixels.
// The ground of a black plate reaches `bleed` beyond its edge, where the cut may be off.
std::vector<SheetLayer> layers_of(const TagDrawing& tag, double line_width, bool with_contour,
                                  double bleed) {
  const LineStyle line{.width = line_width};
  std::vector<SheetLayer> layers{
      {"feature-frame",
       {SheetArea{{rectangle_outline(tag.frame_outer), rectangle_outline(tag.frame_inner)}}}}};
  const auto layer = [&](const char* name) -> std::vector<SheetItem>& {
    return layers.emplace_back(SheetLayer{name, {}}).items;
  };
  if (!tag.bars.empty()) layer("bars") = {area_of(tag.bars)};
  auto& arrows = layer("up-arrow");
  for (const UpArrow& arrow : tag.arrows) {
    arrows.push_back(SheetArea{{points_of(outline_of(arrow))}});
  }
  if (tag.logo && !tag.logo->outlines.empty()) layer("logo") = {area_of(tag.logo->outlines)};
  if (tag.patches) {
    layer("patches") = {area_of(tag.patches->black),
                        SheetLine{rectangle_outline(tag.patches->white), line, true}};
  }
  auto& holes = layer("drill-holes");
  for (const HoleOutline& hole : tag.holes) {
    if (!with_contour) holes.push_back(SheetLine{circle(hole), line, true});
    const Vector2d centre = point(hole.centre);
    for (const Vector2d& arm : {Vector2d(hole.radius, 0), Vector2d(0, hole.radius)}) {
      holes.push_back(SheetLine{{centre - arm, centre + arm}, line});
    }
  }
  auto& label = layer("label");
  for (const TextItem& item : tag.label) label.push_back(text(item));
  std::erase_if(layers, [](const SheetLayer& each) { return each.items.empty(); });
  if (tag.white_on_black) {
    for (SheetLayer& each : layers) std::ranges::for_each(each.items, make_white);
    const Rectangle ground{tag.plate.x - bleed, tag.plate.y - bleed, tag.plate.width + 2 * bleed,
                           tag.plate.height + 2 * bleed};
    const double radius = tag.corner_radius > 0 ? tag.corner_radius + bleed : 0;
    layers.insert(layers.begin(), {"ground", {SheetArea{{rounded(ground, radius)}}}});
  }
  if (tag.qr && !tag.qr->modules.empty()) {
    layers.push_back({"qr", {area_of(tag.qr->box, colours::kWhite), area_of(tag.qr->modules)}});
  }
  return layers;
}

std::vector<SheetItem> contour_of(const TagDrawing& tag, double line_width) {
  const LineStyle line{kCutColour, line_width};
  std::vector<SheetItem> contour{SheetLine{rounded(tag.plate, tag.corner_radius), line, true}};
  for (const HoleOutline& hole : tag.holes) {
    contour.push_back(SheetLine{circle(hole), line, true});
  }
  return contour;
}

// Every item of the tag's drawing where its turn brings it.
void turn(const PageTag& tag, std::vector<SheetItem>& items) {
  if (!tag.turned_about) return;
  for (SheetItem& item : items) {
    for_each_place(item, [&](Vector2d& at) {
      at = point(on_page(tag, PlatePoint{at.x(), at.y()}));
    });
    if (auto* words = std::get_if<SheetText>(&item)) words->angle += std::numbers::pi / 2;
  }
}

SheetLayer marks_of(const Page& page) {
  SheetLayer marks{"marks", {}};
  for (const PageLine& line : page.lines) {
    LineStyle style{.width = page.line_width};
    if (line.dashed) style.dashes = {0.002, 0.001};
    marks.items.push_back(SheetLine{{point(line.from), point(line.to)}, style});
  }
  return marks;
}

}  // namespace

Sheet sheet_of(const Page& page, bool with_contour) {
  Sheet sheet{page.width, page.height, page.notes.title, page.notes.subject, {}};
  sheet.keywords = page.notes.keywords;
  if (page.trim) sheet.trim = box_of(*page.trim);
  if (page.bleed) sheet.bleed = box_of(*page.bleed);
  const bool alone = page.tags.size() == 1 && !page.tags.front().window;
  const double bleed = page.trim && page.bleed ? page.trim->x - page.bleed->x : 0;
  SheetLayer contour{kCutContour, {}};
  for (std::size_t i = 0; i < page.tags.size(); ++i) {
    const PageTag& tag = page.tags[i];
    const bool cut = with_contour && tag.drawing.cut_contour;
    for (SheetLayer& layer : layers_of(tag.drawing, page.line_width, cut, bleed)) {
      if (!alone) {
        layer.name = "tag-" + std::to_string(i + 1) + "-" + layer.name;
        layer.title = tag.name;
      }
      if (tag.window) layer.window = box_of(*tag.window);
      turn(tag, layer.items);
      sheet.layers.push_back(std::move(layer));
    }
    if (!cut) continue;
    std::vector<SheetItem> outlines = contour_of(tag.drawing, page.line_width);
    turn(tag, outlines);
    std::ranges::move(outlines, std::back_inserter(contour.items));
  }
  if (!contour.items.empty()) sheet.layers.push_back(std::move(contour));
  sheet.layers.push_back(marks_of(page));
  SheetLayer notes{"notes", {}};
  for (const TextItem& item : page.texts) notes.items.push_back(text(item));
  sheet.layers.push_back(std::move(notes));
  return sheet;
}

SheetArea area_of(const Rectangle& rectangle, const Colour& fill) {
  return {{rectangle_outline(rectangle)}, fill};
}

Sheet scaled(Sheet sheet, double right, double down) {
  const Vector2d by(right, down);
  const auto scale = [&](Vector2d& at) { at = at.cwiseProduct(by); };
  const auto scale_box = [&](std::optional<Eigen::AlignedBox2d>& box) {
    if (box) box = {Vector2d(box->min().cwiseProduct(by)), Vector2d(box->max().cwiseProduct(by))};
  };
  scale_box(sheet.trim);
  scale_box(sheet.bleed);
  for (SheetLayer& layer : sheet.layers) {
    scale_box(layer.window);
    for (SheetItem& item : layer.items) for_each_place(item, scale);
  }
  return sheet;
}

}  // namespace tagsmith::detail
