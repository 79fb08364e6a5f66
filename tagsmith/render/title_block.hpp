// SPDX-License-Identifier: Apache-2.0
// Border, title block and scale bar of a sheet. Internal to tagsmith/render.
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "tagsmith/render/drawing_title.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

// Metres on paper, y down.
struct SheetFrame {
  Eigen::Vector2d paper;       // width, height
  Eigen::AlignedBox2d border;  // ISO 5457: 20 mm for filing on the left, 10 mm elsewhere
  Eigen::AlignedBox2d block;   // the title block
  Eigen::AlignedBox2d views;   // room for views
};

SheetFrame sheet_frame(Paper paper);

struct SheetNumber {
  std::size_t number = 1;
  std::size_t count = 1;
};

// Border, title block and, of the scale that the drawing is in, a scale bar.
void add_title_block(Sheet& sheet, const TitleBlock& block, const SheetNumber& number,
                     std::optional<double> scale_denominator, const SheetFrame& frame);

}  // namespace tagsmith::detail
