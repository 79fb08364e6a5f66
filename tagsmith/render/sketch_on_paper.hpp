// SPDX-License-Identifier: Apache-2.0
// A sketch at a scale: every item at its place on paper. Internal to tagsmith/render.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sketch.hpp"

namespace tagsmith::detail {

// Paper frame: x right, y down, metres; the origin is the sketch's.
struct SketchOnPaper {
  std::vector<SheetLayer> layers;
  Eigen::AlignedBox2d bounds;  // of all ink; empty without items
};

// The item at another place of its sheet.
SheetItem moved(SheetItem item, const Eigen::Vector2d& by);

// Words whose place others have taken move by lines, upright ones away from what they name, with a
// line to there.
SketchOnPaper sketch_on_paper(const Sketch& sketch, double scale_denominator);

// Width and height of the sketch's points on the ground, metres; nothing when a point
// is not finite.
std::optional<Eigen::Vector2d> model_extent(const Sketch& sketch);

}  // namespace tagsmith::detail
