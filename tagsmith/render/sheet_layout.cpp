// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sheet_layout.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Geometry>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/render/title_block.hpp"

namespace tagsmith {
namespace {

using Eigen::Vector2d;

constexpr double kViewGap = 0.010;       // between views
constexpr double kTitleHeight = 0.0025;  // of a capital letter
constexpr double kTitleRoom = 0.0065;    // the title's line above a view
constexpr double kAxesRoom = 0.024;      // the column left of a view that shows the axes
constexpr double kAxisLength = 0.0075;
constexpr int kMostScales = 80;  // 20 powers of ten

struct PlacedView {
  Vector2d corner;  // upper left, within the drawing area
  std::size_t view = 0;
  SketchOnPaper sketch;
};

using SheetViews = std::vector<PlacedView>;

// A view with its title and axes.
Vector2d size_of(const DrawingView& view, const SketchOnPaper& sketch, const TextWidths& widths) {
  Vector2d size = sketch.bounds.isEmpty() ? Vector2d(0, 0) : Vector2d(sketch.bounds.sizes());
  if (view.axes) {
    size.x() += kAxesRoom;
    size.y() = std::max(size.y(), kAxesRoom);
  }
  if (!view.title.empty()) {
    size.x() = std::max(size.x(), widths(view.title, kTitleHeight));
    size.y() += kTitleRoom;
  }
  return size;
}

// Rows of views, as many sheets as they take; nothing when a view is larger than a sheet.
std::optional<std::vector<SheetViews>> flow(std::span<const DrawingView> views, double scale,
                                            const Vector2d& room, const TextWidths& widths) {
  std::vector<SheetViews> sheets(1);
  Vector2d cursor(0, 0);
  double row_height = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    PlacedView placed{cursor, i,
                      sketch_on_paper(views[i].sketch, views[i].scale.value_or(scale), widths)};
    const Vector2d size = size_of(views[i], placed.sketch, widths);
    if ((size.array() > room.array()).any()) return std::nullopt;
    if (cursor.x() > 0 && (views[i].new_row || cursor.x() + size.x() > room.x())) {
      cursor = {0, cursor.y() + row_height + kViewGap};
      row_height = 0;
    }
    if (cursor.y() > 0 && cursor.y() + size.y() > room.y()) {
      sheets.emplace_back();
      cursor = {0, 0};
      row_height = 0;
    }
    placed.corner = cursor;
    sheets.back().push_back(std::move(placed));
    cursor.x() += size.x() + kViewGap;
    row_height = std::max(row_height, size.y());
  }
  return sheets;
}

double next_round_scale(double denominator) { return round_scale(denominator * 1.01); }

// A denominator that is surely not too large to begin the search with.
double finest_scale(std::span<const DrawingView> views, const Vector2d& room) {
  double least = 0;
  for (const DrawingView& view : views) {
    if (view.scale) continue;
    const Vector2d extent = model_extent(view.sketch).value_or(Vector2d(0, 0));
    least = std::max(least, (extent.array() / room.array()).maxCoeff());
  }
  return round_scale(least > 0 ? least : 1);
}

struct Flow {
  double scale = 1;
  std::vector<SheetViews> sheets;
};

Result<Flow> choose_scale(std::span<const DrawingView> views, const DrawingStyle& style,
                          const TextWidths& widths) {
  const Vector2d room = drawing_area(style.paper);
  double scale = finest_scale(views, room);
  for (int i = 0; i < kMostScales; ++i) {
    const double next = next_round_scale(scale);
    if (auto sheets = flow(views, scale, room, widths)) {
      if (sheets->size() == 1 || next > style.coarsest_scale * 1.0001) {
        return Flow{scale, std::move(*sheets)};
      }
    }
    scale = next;
  }
  return fail("drawing: its words need more room than a sheet has");
}

void add_moved(SheetLayer& to, const std::vector<SheetItem>& items, const Vector2d& by) {
  for (SheetItem item : items) {
    std::visit(
        [&](auto& value) {
          if constexpr (requires { value.points; }) {
            for (Vector2d& point : value.points) point += by;
          } else {
            value.at += by;
          }
        },
        item);
    to.items.push_back(std::move(item));
  }
}

SheetLayer& layer_of(Sheet& sheet, const std::string& name) {
  const auto found = std::ranges::find(sheet.layers, name, &SheetLayer::name);
  if (found != sheet.layers.end()) return *found;
  return sheet.layers.emplace_back(SheetLayer{name, {}});
}

Sketch axes_sketch(const ViewAxes& axes) {
  Sketch sketch;
  const Vector2d origin(0, 0);
  SketchLayer& layer = sketch.layer("axes");
  const auto add = [&](const Vector2d& direction, const std::string& name, const Colour& colour) {
    layer.add(Arrow{{origin, origin}, {origin, direction * kAxisLength}, {colour, kWide}});
    const double x = direction.x();
    layer.add(
        Words{.text = name,
              .at = {origin, direction * (kAxisLength + (std::abs(x) > 0.7 ? 0.001 : 0.0022))},
              .height = 0.0025,
              .align = x > 0.7    ? TextAlign::left
                       : x < -0.7 ? TextAlign::right
                                  : TextAlign::centre,
              .level = TextLevel::middle,
              .colour = colour});
  };
  add(axes.x, axes.x_name, colours::kRed);
  add(axes.y, axes.y_name, colours::kGreen);
  return sketch;
}

void add_view(Sheet& sheet, const DrawingView& view, const PlacedView& placed,
              const Vector2d& area_corner, const TextWidths& widths) {
  Vector2d corner = area_corner + placed.corner;
  if (!view.title.empty()) {
    layer_of(sheet, "titles")
        .items.push_back(SheetText{.text = view.title,
                                   .at = corner + Vector2d(0, kTitleHeight * 1.2),
                                   .height = kTitleHeight,
                                   .max_width = widths(view.title, kTitleHeight)});
    corner.y() += kTitleRoom;
  }
  if (view.axes) {
    const SketchOnPaper axes = sketch_on_paper(axes_sketch(*view.axes), 1, widths);
    add_moved(layer_of(sheet, "axes"), axes.layers.front().items,
              corner + Vector2d(kAxesRoom / 2, kAxesRoom / 2));
    corner.x() += kAxesRoom;
  }
  if (placed.sketch.bounds.isEmpty()) return;
  const Vector2d by = corner - placed.sketch.bounds.min();
  for (const SheetLayer& layer : placed.sketch.layers) {
    add_moved(layer_of(sheet, layer.name), layer.items, by);
  }
}

// Moves rows apart so that they fill the sheet evenly, though not by much.
void spread(SheetViews& views, std::span<const DrawingView> all, const Vector2d& room,
            const TextWidths& widths) {
  constexpr double kMostMore = 0.02;
  double bottom = 0;
  int rows = 0;
  double last = -1;
  for (const PlacedView& placed : views) {
    bottom =
        std::max(bottom, placed.corner.y() + size_of(all[placed.view], placed.sketch, widths).y());
    rows += placed.corner.y() > last ? 1 : 0;
    last = placed.corner.y();
  }
  const double more = std::min(kMostMore, (room.y() - bottom) / (rows + 1));
  int row = 0;
  last = -1;
  for (PlacedView& placed : views) {
    row += placed.corner.y() > last ? 1 : 0;
    last = placed.corner.y();
    placed.corner.y() += row * more;
  }
}

Result<void> check_views(std::span<const DrawingView> views) {
  if (views.empty()) return fail("drawing: nothing to draw, expected at least one view");
  for (const DrawingView& view : views) {
    if (!model_extent(view.sketch)) {
      return fail("drawing: a point of " + view.title + " is not finite");
    }
  }
  return {};
}

Sheet make_sheet(const TitleBlock& block, const DrawingPart& part, SheetViews& placed, double scale,
                 const SheetNumber& number, const TextWidths& widths) {
  const SheetFrame frame = sheet_frame(part.style.paper);
  spread(placed, part.views, frame.views.sizes(), widths);
  Sheet sheet{frame.paper.x(), frame.paper.y(), block.title, block.subject, {}};
  bool scaled = false;
  for (const PlacedView& view : placed) {
    add_view(sheet, part.views[view.view], view, frame.views.min(), widths);
    scaled = scaled || !part.views[view.view].scale;
  }
  add_title_block(sheet, block, number, scaled ? std::optional(scale) : std::nullopt, frame,
                  widths);
  return sheet;
}

}  // namespace

double round_scale(double denominator) {
  constexpr double kTolerance = 1 + 1e-9;
  double power = std::pow(10, std::floor(std::log10(denominator)) - 1);
  while (true) {
    for (const double step : {1.0, 2.0, 2.5, 5.0}) {
      const bool usual = step != 2.5 || power >= 9;
      // Divided, so that 1/10^n is as near as a double gets.
      const double scale = power < 1 ? step / std::round(1 / power) : step * std::round(power);
      if (usual && scale * kTolerance >= denominator) return scale;
    }
    power *= 10;
  }
}

Vector2d drawing_area(Paper paper) {
  const SheetFrame frame = sheet_frame(paper);
  return frame.views.sizes();
}

Result<std::vector<Sheet>> lay_out_sheets(const TitleBlock& block,
                                          std::span<const DrawingPart> parts) {
  const TextWidths widths;
  std::vector<Flow> flows;
  std::size_t count = 0;
  for (const DrawingPart& part : parts) {
    Result<Flow> chosen = check_views(part.views).and_then([&] {
      return choose_scale(part.views, part.style, widths);
    });
    if (!chosen) return tl::unexpected(chosen.error());
    count += chosen->sheets.size();
    flows.push_back(std::move(*chosen));
  }
  if (count == 0) return fail("drawing: nothing to draw, expected at least one view");
  std::vector<Sheet> sheets;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (SheetViews& placed : flows[i].sheets) {
      const SheetNumber number{sheets.size() + 1, count};
      sheets.push_back(make_sheet(block, parts[i], placed, flows[i].scale, number, widths));
    }
  }
  return sheets;
}

Result<std::vector<Sheet>> lay_out_sheets(const TitleBlock& block,
                                          std::span<const DrawingView> views,
                                          const DrawingStyle& style) {
  const DrawingPart part{{views.begin(), views.end()}, style};
  return lay_out_sheets(block, std::span(&part, 1));
}

}  // namespace tagsmith
