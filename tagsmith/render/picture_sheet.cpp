// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/picture_sheet.hpp"

#include <utility>

#include "tagsmith/render/sketch_on_paper.hpp"

namespace tagsmith::detail {

Sheet picture_sheet(const Sketch& sketch, const std::string& title) {
  constexpr double kMargin = 0.002;
  SketchOnPaper drawn = sketch_on_paper(sketch, 1);
  Sheet sheet;
  sheet.title = title;
  if (drawn.bounds.isEmpty()) return sheet;
  sheet.width = drawn.bounds.sizes().x() + 2 * kMargin;
  sheet.height = drawn.bounds.sizes().y() + 2 * kMargin;
  const Eigen::Vector2d by = Eigen::Vector2d(kMargin, kMargin) - drawn.bounds.min();
  for (SheetLayer& layer : drawn.layers) {
    for (SheetItem& item : layer.items) item = moved(std::move(item), by);
  }
  sheet.layers = std::move(drawn.layers);
  return sheet;
}

}  // namespace tagsmith::detail
