// SPDX-License-Identifier: Apache-2.0
// A sheet of a technical drawing: everything at its place on paper.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/render/sketch.hpp"

namespace tagsmith {

// Sheet frame: origin at the upper left corner, x to the right, y down, metres on paper. Angles are
// counter-clockwise as one sees them.
struct SheetLine {
  std::vector<Eigen::Vector2d> points;
  LineStyle line{};
  bool closed = false;
};

struct SheetArea {
  std::vector<Eigen::Vector2d> points;
  Colour fill{};
};

struct SheetText {
  std::string text;
  Eigen::Vector2d at{0, 0};  // left end of the baseline
  double height = 0;         // of a capital letter
  double angle = 0;
  double max_width = 0;  // the text is shrunk, then cut, to fit
  Colour colour{};
};

using SheetItem = std::variant<SheetLine, SheetArea, SheetText>;

struct SheetLayer {
  std::string name;
  std::vector<SheetItem> items;
};

struct Sheet {
  double width = 0;
  double height = 0;
  std::string title;
  std::string subject;
  std::vector<SheetLayer> layers;
};

}  // namespace tagsmith
