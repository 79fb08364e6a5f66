// SPDX-License-Identifier: Apache-2.0
// A sheet of a technical drawing: everything at its place on paper.
#pragma once

#include <cstdint>
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

// A grey picture; samples row by row, 0 black to 255 white.
struct SheetPicture {
  Eigen::Vector2d at{0, 0};  // upper left corner
  double width = 0;
  double height = 0;
  int columns = 0;  // pixels
  int rows = 0;
  std::vector<std::uint8_t> samples;
  std::string jpeg;  // the same as a JPEG file; empty = none
};

using SheetItem = std::variant<SheetLine, SheetArea, SheetText, SheetPicture>;

struct SheetLayer {
  std::string name;
  std::vector<SheetItem> items;
};

struct Sheet {
  double width = 0;  // metres
  double height = 0;
  std::string title;
  std::string subject;
  std::vector<SheetLayer> layers;
};

}  // namespace tagsmith
