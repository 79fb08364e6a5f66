// SPDX-License-Identifier: Apache-2.0
// Sketches on sheets: chosen scale, drawing border, title block, scale bars, axes of the grid.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/drawing_title.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sketch.hpp"

namespace tagsmith::detail {

// Directions of the grid's axes in a view, as sketched (x right, y up); unit vectors.
struct ViewAxes {
  Eigen::Vector2d x{1, 0};
  Eigen::Vector2d y{0, 1};
  std::string x_name = "x";
  std::string y_name = "y";
};

// One picture of a drawing. Views follow each other in rows, like words.
struct DrawingView {
  std::string title;
  Sketch sketch;
  std::optional<ViewAxes> axes{};
  std::optional<double> scale{};  // denominator of its own scale; none = the drawing's
  bool new_row = false;           // begins a row
};

// A table of tags, whose first cell is a tag's name.
struct ViewColumn {
  const char* title;
  double at;  // metres on paper from the table's left edge: where text begins, or ends
};
struct ViewRow {
  std::vector<std::string> cells;  // of the first columns, or of all
  Colour colour{};
};

struct DrawingStyle {
  Paper paper = Paper::a3;
  // Denominator of the least scale at which the sketches can be read. The drawing has the greatest
  // round scale with which all views share one sheet; where that would be less than this, it has
  // this one and as many sheets as necessary. A view larger than a sheet makes the scale less.
  double coarsest_scale = 1e9;
};

// The room for views on a sheet, metres on paper.
Eigen::Vector2d drawing_area(Paper paper);

// The table in as many views as the sheet's height requires, rows `step` apart.
std::vector<DrawingView> table_views(std::span<const ViewColumn> columns, TextAlign align,
                                     double step, std::span<const ViewRow> rows, Paper paper);

// The greatest round scale not above 1:denominator: 1, 2, 2.5 or 5 times a power of ten (ISO 5455,
// and 1:25, 1:250 as mines use them).
double round_scale(double denominator);

// Views that share sheets and a scale; another part of the drawing begins a sheet.
struct DrawingPart {
  std::vector<DrawingView> views;
  DrawingStyle style{};
};

// The sheets of all parts, numbered through. Fails when there is nothing to draw, and on points
// that are not finite.
Result<std::vector<Sheet>> lay_out_sheets(const TitleBlock& block,
                                          std::span<const DrawingPart> parts);
Result<std::vector<Sheet>> lay_out_sheets(const TitleBlock& block,
                                          std::span<const DrawingView> views,
                                          const DrawingStyle& style = {});

}  // namespace tagsmith::detail
