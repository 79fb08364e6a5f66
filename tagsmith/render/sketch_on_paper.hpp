// SPDX-License-Identifier: Apache-2.0
// A sketch at a scale: every item at its place on paper, no words over others.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sketch.hpp"

namespace tagsmith::detail {

// ---- Which part of a drawing is occupied by words, so that words do not overlap. Internal to
// tagsmith/render.

// A rectangle at any angle: a corner and the two sides from there, metres on paper.
struct TurnedBox {
  Eigen::Vector2d corner{0, 0};
  Eigen::Vector2d along{0, 0};
  Eigen::Vector2d up{0, 0};
};

class LabelRoom {
 public:
  // The first of the moves that brings the box to a free place; none = the box stays. Its place is
  // then occupied.
  Eigen::Vector2d take(const TurnedBox& box, std::span<const Eigen::Vector2d> moves);

 private:
  bool is_free(const TurnedBox& box) const;

  std::vector<TurnedBox> taken_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> taken_by_cell_;
};

// ---- The sketch at a scale. Internal to tagsmith/render.

// Paper frame: x right, y down, metres; the origin is the sketch's.
struct SketchOnPaper {
  std::vector<SheetLayer> layers;
  Eigen::AlignedBox2d bounds;  // of all ink; empty without items
};

// The item at another place of its sheet.
SheetItem moved(SheetItem item, const Eigen::Vector2d& by);

// Words whose place is occupied move by lines, upright ones away from the object that they name,
// with a line to it.
SketchOnPaper sketch_on_paper(const Sketch& sketch, double scale_denominator);

// Width and height of the sketch's points on the ground, metres; nothing when a point
// is not finite.
std::optional<Eigen::Vector2d> model_extent(const Sketch& sketch);

// ---- A sketch alone, for pages that show it as a picture.

// A sheet as large as the sketch's ink with a margin of 2 mm; one metre of the ground is one of
// paper.
Sheet picture_sheet(const Sketch& sketch, const std::string& title);

}  // namespace tagsmith::detail
