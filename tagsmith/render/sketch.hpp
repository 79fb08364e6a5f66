// SPDX-License-Identifier: Apache-2.0
// The content of a technical drawing, before it has a scale: lines, areas, words and dimensions in
// metres of the ground, with line weights and text sizes in metres of paper.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace tagsmith::detail {

// sRGB, 0 to 1.
struct Colour {
  double red = 0;
  double green = 0;
  double blue = 0;
};

namespace colours {
inline constexpr Colour kBlack{0, 0, 0};
inline constexpr Colour kGrey{0.5, 0.5, 0.5};
inline constexpr Colour kPale{0.88, 0.88, 0.88};
inline constexpr Colour kWhite{1, 1, 1};
inline constexpr Colour kRed{0.80, 0.10, 0.10};
inline constexpr Colour kGreen{0.05, 0.50, 0.20};
inline constexpr Colour kBlue{0.05, 0.30, 0.70};
inline constexpr Colour kOrange{0.85, 0.45, 0.00};
}  // namespace colours

// A line as ISO 128-2:2020 draws it: width and dashes in metres on paper. Dashes alternate with
// gaps; none = continuous.
struct LineStyle {
  Colour colour{};
  double width = 0.00018;
  std::vector<double> dashes{};
};

// Line widths of ISO 128-2:2020, group 0.35: narrow and wide; and extra narrow for grids and
// hatching.
inline constexpr double kExtraNarrow = 0.00013;
inline constexpr double kNarrow = 0.00018;
inline constexpr double kWide = 0.00035;

// Dashes of ISO 128-2:2020 for narrow lines, metres on paper: hidden edges; center lines.
std::vector<double> dashed();
std::vector<double> long_dashed_dotted();

// A place of a sketch: `model` metres on the ground, drawn to scale, plus `paper` metres on paper,
// x to the right and y up, whatever the scale.
struct SketchPoint {
  SketchPoint(const Eigen::Vector2d& at) : model(at) {}  // NOLINT: a point of the ground is one
  SketchPoint(const Eigen::Vector2d& at, const Eigen::Vector2d& offset)
      : model(at), paper(offset) {}

  Eigen::Vector2d model;
  Eigen::Vector2d paper = Eigen::Vector2d::Zero();
};

// A place that does not move with the scale, metres on paper.
inline SketchPoint on_paper(double x, double y) { return {{0, 0}, {x, y}}; }

// A line through points: SketchPoint in a sketch, a place on paper in a sheet.
template <class Point>
struct LineThrough {
  std::vector<Point> points;
  LineStyle line{};
  bool closed = false;
};
using Polyline = LineThrough<SketchPoint>;

// A filled polygon without an outline.
struct Area {
  std::vector<SketchPoint> points;
  Colour fill{};
};

// An outlined ellipse; equal semi-axes make a circle.
struct Ellipse {
  SketchPoint at{Eigen::Vector2d::Zero()};
  Eigen::Vector2d semi_axes{0, 0};  // metres on the ground, or on paper
  bool on_paper = false;            // semi_axes are metres on paper
  double angle = 0;                 // of the first semi-axis, radians from x towards y
  LineStyle line{};
};

// A filled disc, radius in metres on paper.
struct Dot {
  SketchPoint at{Eigen::Vector2d::Zero()};
  double radius = 0.0005;
  Colour fill{};
};

// A grey picture, its upper left corner at `at`, metres on paper.
template <class Point>
struct PictureAt {
  Point at{Eigen::Vector2d::Zero()};
  double width = 0;
  double height = 0;
  int columns = 0;  // pixels
  int rows = 0;
  std::vector<std::uint8_t> samples;  // row by row, 0 black to 255 white
  std::string jpeg{};                 // the same as a JPEG file, which PDF and SVG carry
};
using Picture = PictureAt<SketchPoint>;

enum class TextAlign { left, centre, right };
enum class TextLevel { baseline, middle, top };

// Of a capital letter, and from line to line, metres on paper (ISO 3098: 1.8, 2.5, 3.5 mm).
inline constexpr double kWordsHeight = 0.0018;
inline constexpr double kWordsLine = 2 * kWordsHeight;

// A line of text.
struct Words {
  std::string text;
  SketchPoint at{Eigen::Vector2d::Zero()};
  double height = kWordsHeight;  // of a capital letter, metres on paper
  double angle = 0;              // of the baseline, radians from x towards y
  TextAlign align = TextAlign::left;
  TextLevel level = TextLevel::baseline;
  Colour colour{};
  bool in_row = false;  // upright ones of a row: make room for each other aside
};

// A line whose end has a filled arrowhead; head length in metres on paper.
struct Arrow {
  SketchPoint from{Eigen::Vector2d::Zero()};
  SketchPoint to{Eigen::Vector2d::Zero()};
  LineStyle line{};
  double head = 0.0025;
};

// A dimension line with arrows, extension lines and its text (ISO 129-1). It runs `offset` metres
// on paper to the left of the way from `from` to `to`, or to the right when negative. Where the
// arrows do not fit between the extension lines, they are placed outside. In a chain, where others
// follow on both ends, oblique strokes take their place, and a text wider than the line is upright.
struct Dimension {
  SketchPoint from{Eigen::Vector2d::Zero()};
  SketchPoint to{Eigen::Vector2d::Zero()};
  double offset = 0.008;
  std::string text;
  Colour colour{};
  bool in_chain = false;
};

using SketchItem = std::variant<Area, Polyline, Ellipse, Dot, Arrow, Words, Dimension, Picture>;

// Layers of one name are one group in SVG. Later layers cover earlier ones.
struct SketchLayer {
  std::string name;
  std::vector<SketchItem> items;

  template <class Item>
  void add(Item item) {
    items.emplace_back(std::move(item));
  }
};

// Adds lines of words below each other, the first `y` metres on paper above the origin, each `step`
// below the one before; returns where the next would be.
double add_lines(SketchLayer& layer, const std::vector<std::string>& lines, double y,
                 const Colour& colour = colours::kBlack, double height = kWordsHeight,
                 double step = kWordsLine);

// x to the right and y up.
struct Sketch {
  std::vector<SketchLayer> layers;

  // The layer of this name, made on top of the others when there is none.
  SketchLayer& layer(std::string_view name);
};

}  // namespace tagsmith::detail
