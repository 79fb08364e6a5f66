// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/sheet_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "tagsmith/base/text.hpp"
#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {

// ---- Border, title block and scale bar of a sheet.

namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kBlockWidth = 0.180;  // ISO 7200
constexpr double kBlockHeight = 0.020;
constexpr double kTitleWidth = 0.074;
constexpr double kBlockPadding = 0.002;
constexpr double kValueHeight = 0.0020;
constexpr double kFieldNameHeight = 0.0014;

// Metres on paper, y down.
struct SheetFrame {
  Vector2d paper;       // width, height
  AlignedBox2d border;  // ISO 5457: 20 mm for filing on the left, 10 mm elsewhere
  AlignedBox2d block;   // the title block
  AlignedBox2d views;   // room for views
};

struct SheetNumber {
  std::size_t number = 1;
  std::size_t count = 1;
};

std::vector<Vector2d> corners(const AlignedBox2d& box) {
  return {box.min(), {box.max().x(), box.min().y()}, box.max(), {box.min().x(), box.max().y()}};
}

void add_text(SheetLayer& layer, const std::string& text, const Vector2d& at, double height,
              double max_width, const Colour& colour = {}) {
  layer.items.push_back(SheetText{
      .text = text, .at = at, .height = height, .max_width = max_width, .colour = colour});
}

std::vector<TitleField> all_fields(const TitleBlock& block, const SheetNumber& number,
                                   std::optional<double> scale) {
  std::vector<TitleField> fields = block.fields;
  if (scale) fields.push_back({"Scale", scale_text(*scale)});
  fields.push_back({"Unit", "metre"});
  fields.push_back(
      {"Sheet", std::to_string(number.number) + " of " + std::to_string(number.count)});
  return fields;
}

// Two rows of cells.
void add_fields(SheetLayer& layer, const std::vector<TitleField>& fields, const AlignedBox2d& box) {
  const std::size_t columns = (fields.size() + 1) / 2;
  const Vector2d cell(box.sizes().x() / static_cast<double>(columns), box.sizes().y() / 2);
  const LineStyle line{.width = kNarrow};
  const double middle = box.center().y();
  layer.items.push_back(SheetLine{{{box.min().x(), middle}, {box.max().x(), middle}}, line});
  for (std::size_t column = 0; column < columns; ++column) {
    const double x = box.min().x() + static_cast<double>(column) * cell.x();
    layer.items.push_back(SheetLine{{{x, box.min().y()}, {x, box.max().y()}}, line});
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::size_t row = i / columns;
    const Vector2d corner = box.min() + Vector2d(static_cast<double>(i % columns) * cell.x(),
                                                 static_cast<double>(row) * cell.y());
    const double width = cell.x() - kBlockPadding;
    add_text(layer, fields[i].name, corner + Vector2d(kBlockPadding / 2, 0.0028), kFieldNameHeight,
             width, colours::kGrey);
    add_text(layer, fields[i].value, corner + Vector2d(kBlockPadding / 2, 0.0075), kValueHeight,
             width);
  }
}

void add_scale_bar(SheetLayer& layer, double scale, const Vector2d& left_end) {
  constexpr int kParts = 4;
  constexpr double kThickness = 0.0015;
  constexpr double kTextHeight = 0.0018;
  constexpr double kLeastLength = 0.025;  // on paper
  const double ground = round_step(kLeastLength * scale);
  const double part = ground / scale / kParts;
  const LineStyle line{.width = kNarrow};
  for (int i = 0; i < kParts; ++i) {
    const Vector2d corner = left_end + Vector2d(i * part, 0);
    const std::vector<Vector2d> box =
        corners({corner, Vector2d(corner + Vector2d(part, kThickness))});
    if (i % 2 == 0) layer.items.push_back(SheetArea{{box}, colours::kBlack});
    layer.items.push_back(SheetLine{box, line, true});
  }
  for (const int tick : {0, kParts / 2, kParts}) {
    const std::string text =
        format_number(ground * tick / kParts, 6) + (tick == kParts ? " m" : "");
    const double width = text_width(text, kTextHeight);
    const double centred = left_end.x() + tick * part -
                           text_width(format_number(ground * tick / kParts, 6), kTextHeight) / 2;
    add_text(layer, text, Vector2d{centred, left_end.y() - 0.0012}, kTextHeight, width * 1.001);
  }
  const std::string text = scale_text(scale);
  add_text(layer, text, left_end + Vector2d(0, 0.0055), 0.0025, text_width(text, 0.0025) * 1.001);
}

Vector2d size_of(Paper paper) {
  if (paper == Paper::letter) return {0.2794, 0.2159};
  return paper == Paper::a4 ? Vector2d(0.297, 0.210) : Vector2d(0.420, 0.297);
}

SheetFrame sheet_frame(Paper paper) {
  constexpr double kFiling = 0.020;
  constexpr double kMargin = 0.010;
  constexpr double kInset = 0.005;
  SheetFrame frame;
  frame.paper = size_of(paper);
  frame.border =
      AlignedBox2d(Vector2d(kFiling, kMargin), Vector2d(frame.paper - Vector2d(kMargin, kMargin)));
  const Vector2d corner = frame.border.max();
  frame.block = AlignedBox2d(Vector2d(corner - Vector2d(kBlockWidth, kBlockHeight)), corner);
  frame.views = AlignedBox2d(Vector2d(frame.border.min() + Vector2d(kInset, kInset)),
                             Vector2d(corner.x() - kInset, frame.block.min().y() - kInset));
  return frame;
}

// Border, title block and, of the scale that the drawing is in, a scale bar.
void add_title_block(Sheet& sheet, const TitleBlock& block, const SheetNumber& number,
                     std::optional<double> scale_denominator, const SheetFrame& frame) {
  SheetLayer layer{"title-block", {}};
  layer.items.push_back(SheetLine{corners(frame.border), {.width = 0.0007}, true});
  layer.items.push_back(SheetLine{corners(frame.block), {.width = kWide}, true});
  const Vector2d corner = frame.block.min();
  add_text(layer, block.title, corner + Vector2d(kBlockPadding, 0.0075), 0.0035,
           kTitleWidth - 2 * kBlockPadding);
  add_text(layer, block.subject, corner + Vector2d(kBlockPadding, 0.0135), 0.0022,
           kTitleWidth - 2 * kBlockPadding);
  add_text(layer, "tagsmith", corner + Vector2d(kBlockPadding, 0.0180), kFieldNameHeight,
           kTitleWidth - 2 * kBlockPadding, colours::kGrey);
  add_fields(layer, all_fields(block, number, scale_denominator),
             {Vector2d(corner + Vector2d(kTitleWidth, 0)), frame.block.max()});
  if (scale_denominator) {
    add_scale_bar(layer, *scale_denominator,
                  {frame.border.min().x() + 0.006, frame.border.max().y() - 0.010});
  }
  sheet.layers.push_back(std::move(layer));
}

}  // namespace

std::string scale_text(double denominator) {
  return denominator < 1 ? format_number(1 / denominator, 3) + " : 1"
                         : "1 : " + format_number(denominator, 3);
}

double round_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= least * (1 - 1e-9)) return step * power;
  }
  return 10 * power;
}

// ---- Views on sheets.

namespace {

constexpr double kViewGap = 0.010;       // between views
constexpr double kTitleHeight = 0.0025;  // of a capital letter
constexpr double kTitleRoom = 0.0065;    // the title's line above a view
constexpr double kAxesRoom = 0.024;      // the column left of a view that shows the axes
constexpr double kAxisLength = 0.0075;
constexpr int kMostScales = 80;  // 20 powers of ten

struct PlacedView {
  const DrawingView* view = nullptr;
  SketchOnPaper sketch;
  Vector2d size{0, 0};    // with title and axes
  Vector2d corner{0, 0};  // upper left, within the drawing area
  int row = 0;
};

using SheetViews = std::vector<PlacedView>;

// A view with its title and axes.
Vector2d size_of(const DrawingView& view, const SketchOnPaper& sketch) {
  Vector2d size = sketch.bounds.isEmpty() ? Vector2d(0, 0) : Vector2d(sketch.bounds.sizes());
  if (view.axes) {
    size.x() += kAxesRoom;
    size.y() = std::max(size.y(), kAxesRoom);
  }
  if (!view.title.empty()) {
    size.x() = std::max(size.x(), text_width(view.title, kTitleHeight));
    size.y() += kTitleRoom;
  }
  return size;
}

// Rows of views, as many sheets as they take; nothing when a view is larger than a sheet.
std::optional<std::vector<SheetViews>> flow(std::span<const DrawingView> views, double scale,
                                            const Vector2d& room) {
  std::vector<SheetViews> sheets(1);
  Vector2d cursor(0, 0);
  double row_height = 0;
  int row = 0;
  for (const DrawingView& view : views) {
    PlacedView placed{&view, sketch_on_paper(view.sketch, view.scale.value_or(scale))};
    placed.size = size_of(view, placed.sketch);
    const Vector2d& size = placed.size;
    if ((size.array() > room.array()).any()) return std::nullopt;
    if (cursor.x() > 0 && (view.new_row || cursor.x() + size.x() > room.x())) {
      cursor = {0, cursor.y() + row_height + kViewGap};
      row_height = 0;
      ++row;
    }
    if (cursor.y() > 0 && cursor.y() + size.y() > room.y()) {
      sheets.emplace_back();
      cursor = {0, 0};
      row_height = 0;
      row = 0;
    }
    placed.corner = cursor;
    placed.row = row;
    cursor.x() += size.x() + kViewGap;
    row_height = std::max(row_height, size.y());
    sheets.back().push_back(std::move(placed));
  }
  return sheets;
}

double next_round_scale(double denominator) { return round_scale(denominator * 1.01); }

// A denominator that is certainly not too large, to begin the search with.
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

Result<Flow> choose_scale(std::span<const DrawingView> views, const DrawingStyle& style) {
  const Vector2d room = drawing_area(style.paper);
  double scale = finest_scale(views, room);
  for (int i = 0; i < kMostScales; ++i) {
    const double next = next_round_scale(scale);
    if (auto sheets = flow(views, scale, room)) {
      if (sheets->size() == 1 || next > style.coarsest_scale * 1.0001) {
        return Flow{scale, std::move(*sheets)};
      }
    }
    scale = next;
  }
  return fail("drawing: its words need more room than a sheet has");
}

void add_moved(SheetLayer& to, const std::vector<SheetItem>& items, const Vector2d& by) {
  for (const SheetItem& item : items) to.items.push_back(moved(item, by));
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

void add_view(Sheet& sheet, const PlacedView& placed, const Vector2d& area_corner) {
  const DrawingView& view = *placed.view;
  Vector2d corner = area_corner + placed.corner;
  if (!view.title.empty()) {
    layer_of(sheet, "titles")
        .items.push_back(SheetText{.text = view.title,
                                   .at = corner + Vector2d(0, kTitleHeight * 1.2),
                                   .height = kTitleHeight,
                                   .max_width = text_width(view.title, kTitleHeight)});
    corner.y() += kTitleRoom;
  }
  if (view.axes) {
    const SketchOnPaper axes = sketch_on_paper(axes_sketch(*view.axes), 1);
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

// Moves rows apart so that they fill the sheet evenly, but only a little.
void spread(SheetViews& views, const Vector2d& room) {
  constexpr double kMostMore = 0.02;
  double bottom = 0;
  for (const PlacedView& placed : views) {
    bottom = std::max(bottom, placed.corner.y() + placed.size.y());
  }
  const double more = std::min(kMostMore, (room.y() - bottom) / (views.back().row + 2));
  for (PlacedView& placed : views) placed.corner.y() += (placed.row + 1) * more;
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

Sheet make_sheet(const TitleBlock& block, Paper paper, SheetViews& views, double scale,
                 const SheetNumber& number) {
  const SheetFrame frame = sheet_frame(paper);
  spread(views, frame.views.sizes());
  Sheet sheet{frame.paper.x(), frame.paper.y(), block.title, block.subject, {}};
  bool scaled = false;
  for (const PlacedView& placed : views) {
    add_view(sheet, placed, frame.views.min());
    scaled = scaled || !placed.view->scale;
  }
  add_title_block(sheet, block, number, scaled ? std::optional(scale) : std::nullopt, frame);
  return sheet;
}

}  // namespace

std::vector<DrawingView> table_views(std::span<const ViewColumn> columns, TextAlign align,
                                     double step, std::span<const ViewRow> rows, Paper paper) {
  constexpr double kCellHeight = 0.0016;
  const auto most = static_cast<std::size_t>((drawing_area(paper).y() - 0.012) / step) - 1;
  std::vector<DrawingView> views;
  for (; !rows.empty(); rows = rows.subspan(std::min(most, rows.size()))) {
    const auto here = rows.first(std::min(most, rows.size()));
    DrawingView view;
    view.title = "Tags " + here.front().cells[0] + " to " + here.back().cells[0];
    view.scale = 1;
    SketchLayer& layer = view.sketch.layer("table");
    const auto add = [&](const std::string& text, std::size_t column, std::size_t row,
                         const Colour& colour) {
      layer.add(Words{.text = text,
                      .at = on_paper(columns[column].at, -step * static_cast<double>(row)),
                      .height = kCellHeight,
                      .align = align,
                      .colour = colour});
    };
    for (std::size_t i = 0; i < columns.size(); ++i) add(columns[i].title, i, 0, colours::kGrey);
    for (std::size_t row = 0; row < here.size(); ++row) {
      for (std::size_t i = 0; i < here[row].cells.size(); ++i) {
        add(here[row].cells[i], i, row + 1, here[row].colour);
      }
    }
    views.push_back(std::move(view));
  }
  return views;
}

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
  std::vector<Flow> flows;
  std::size_t count = 0;
  for (const DrawingPart& part : parts) {
    Result<Flow> chosen =
        check_views(part.views).and_then([&] { return choose_scale(part.views, part.style); });
    if (!chosen) return fail(chosen);
    count += chosen->sheets.size();
    flows.push_back(std::move(*chosen));
  }
  if (count == 0) return fail("drawing: nothing to draw, expected at least one view");
  std::vector<Sheet> sheets;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (SheetViews& placed : flows[i].sheets) {
      const SheetNumber number{sheets.size() + 1, count};
      sheets.push_back(make_sheet(block, parts[i].style.paper, placed, flows[i].scale, number));
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

}  // namespace tagsmith::detail
