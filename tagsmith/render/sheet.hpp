// SPDX-License-Identifier: Apache-2.0
// A sheet of paper with everything at its place on it: the source of PDF, SVG and PNG, for
// technical drawings and for pages with plates alike.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "tagsmith/render/sketch.hpp"

namespace tagsmith::detail {

// Sheet frame: origin at the upper left corner, x to the right, y down, metres on paper. Angles are
// counter-clockwise as one sees them.
using SheetLine = LineThrough<Eigen::Vector2d>;
using SheetPicture = PictureAt<Eigen::Vector2d>;

// The area inside an odd number of these outlines: one polygon, or one with holes.
struct SheetArea {
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  Colour fill{};
};

struct SheetText {
  std::string text;
  Eigen::Vector2d at{0, 0};  // left end of the baseline
  double height = 0;         // of a capital letter
  double angle = 0;
  double max_width = 0;  // the text is shrunk, then cut, to fit
  Colour colour{};
  bool centred = false;  // `at` is the middle of the baseline
};

using SheetItem = std::variant<SheetLine, SheetArea, SheetText, SheetPicture>;

// Calls the function with every place of the item.
template <class Function>
void for_each_place(SheetItem& any, const Function& function) {
  std::visit(
      [&](auto& item) {
        if constexpr (requires { item.outlines; }) {
          for (auto& outline : item.outlines) std::ranges::for_each(outline, function);
        } else if constexpr (requires { item.points; }) {
          std::ranges::for_each(item.points, function);
        } else {
          function(item.at);
        }
      },
      any);
}

struct SheetLayer {
  std::string name;
  std::vector<SheetItem> items;
  std::string title{};                          // of the group in SVG; empty = none
  std::optional<Eigen::AlignedBox2d> window{};  // the part that is shown; none = all
};

// A layer of this name holds the lines that a cutting plotter follows, in kCutColour: PDF has them
// in the spot colour of this name.
inline constexpr const char* kCutContour = "CutContour";
inline constexpr Colour kCutColour{1, 0, 1};

struct Sheet {
  double width = 0;  // metres
  double height = 0;
  std::string title;
  std::string subject;
  std::vector<SheetLayer> layers;
  std::string keywords{};
  std::optional<Eigen::AlignedBox2d> trim{};   // the area that is cut out, where that is one piece
  std::optional<Eigen::AlignedBox2d> bleed{};  // to where its surface is printed
  bool text_as_outlines = false;               // PDF has areas in place of letters of a font
};

}  // namespace tagsmith::detail
