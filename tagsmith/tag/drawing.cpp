// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tagsmith::detail {
namespace {

Rectangle inner_frame(const TagTemplate& tag) {
  return {0, 0, tag.frame_inner_length, tag.frame_inner_height};
}

Rectangle outer_frame(const TagTemplate& tag) {
  return {-tag.frame_stroke, -tag.frame_stroke, tag.frame_inner_length + 2 * tag.frame_stroke,
          tag.frame_inner_height + 2 * tag.frame_stroke};
}

Rectangle plate_around(const TagTemplate& tag) {
  const double left = (tag.frame_inner_length - tag.plate_length) / 2 - tag.frame_offset_right;
  const double top = (tag.frame_inner_height - tag.plate_height) / 2 + tag.frame_offset_up;
  return {left, top, tag.plate_length, tag.plate_height};
}

std::vector<Rectangle> bars_of(const TagTemplate& tag, const Digits& digits) {
  const double module = module_width(tag);
  const double top = tag.margin_modules * module;
  const double height = bar_height(tag);
  std::vector<Rectangle> bars;
  int position = 0;
  bool bar = true;
  for (const std::uint8_t width : elements_of(digits)) {
    if (bar) {
      const double left = (tag.quiet_zone_modules + position) * module;
      bars.push_back({left, top, width * module, height});
    }
    position += width;
    bar = !bar;
  }
  return bars;
}

constexpr double kRowHeight = kTextAscent + kTextDescent;  // of a line, in capital letters
constexpr double kCharacterWidth = 0.9;  // of a capital letter's height: a sans serif's mean
constexpr double kArrowAspect = 0.6;     // width over height

// Capital letters smaller than this are hard to read in a tunnel.
constexpr double kReadableHeight = 0.004;

// Characters of the last line that count when space is distributed: a longer one may be cut.
constexpr double kLastLineCharacters = 40;

// The part of the plate that the label may use, and which way its lines run.
struct LabelStrip {
  Rectangle box;
  bool upwards = false;

  double length() const { return upwards ? box.height : box.width; }
  double thickness() const { return upwards ? box.width : box.height; }
};

// Lines set below each other, all of one height.
struct LabelRows {
  LabelStrip strip;
  std::vector<std::string> rows;
  double height = 0;        // of a capital letter
  double least_height = 0;  // of the row that must be shrunk most to fit its width

  double thickness() const { return static_cast<double>(rows.size()) * kRowHeight * height; }

  // The arrow is as thick as the rows, upright whichever way they run.
  Rectangle arrow() const {
    const double size = thickness();
    const auto& [x, y, width, strip_height] = strip.box;
    if (!strip.upwards) return {x, y, kArrowAspect * size, size};
    return {x, y + strip_height - size / kArrowAspect, size, size / kArrowAspect};
  }

  double row_start() const { return (strip.upwards ? arrow().height : arrow().width) + height; }
  double row_length() const { return strip.length() - row_start(); }
};

// Characters of a UTF-8 text.
double length_of(const std::string& text) {
  return static_cast<double>(
      std::ranges::count_if(text, [](char byte) { return (byte & '\xc0') != '\x80'; }));
}

// A few printer's dots, so that no smear enters the clearance.
constexpr double kSmear = 0.0003;

LabelStrip strip_left(const TagDrawing& drawing, double gap) {
  const Rectangle& frame = drawing.frame_outer;
  const double left = drawing.plate.x + kEdgeClearance;
  return {{left, frame.y, frame.x - gap - left, frame.height}, true};
}

// Height the rows have when each is shrunk to its length.
double least_height(const LabelRows& label, const TagText& text) {
  double least = label.height;
  for (const std::string& row : label.rows) {
    double length = length_of(row);
    if (&row == &label.rows.back()) {
      length -= std::max(0.0, length_of(text.lines.back()) - kLastLineCharacters);
    }
    least = std::min(least, label.row_length() / (kCharacterWidth * length));
  }
  return least;
}

// The lines on so many rows: joined from the front, so that the last, which may be cut, is the
// least important one.
LabelRows arrange_label(const TagText& text, std::size_t rows, const LabelStrip& strip,
                        double wanted_height) {
  LabelRows label{strip, {}};
  const std::size_t joined = text.lines.size() - rows + 1;
  for (std::size_t i = 0; i < text.lines.size(); ++i) {
    if (i == 0 || i >= joined) {
      label.rows.push_back(text.lines[i]);
    } else {
      label.rows.back() += "  \u00b7  " + text.lines[i];
    }
  }
  const double room = strip.thickness() / (static_cast<double>(rows) * kRowHeight);
  label.height = std::min(wanted_height, room);
  label.least_height = least_height(label, text);
  return label;
}

LabelRows best_arrangement(const TagText& text, const LabelStrip& strip, double wanted_height) {
  LabelRows best{strip, {}};
  for (std::size_t rows = text.lines.size(); rows > 0; --rows) {
    LabelRows label = arrange_label(text, rows, strip, wanted_height);
    if (label.least_height > best.least_height) best = std::move(label);
  }
  return best;
}

// Below the frame, or beside it where that is the only readable place.
LabelRows place_label(const TagDrawing& drawing, const TagTemplate& tag, const TagText& text,
                      const Rectangle& strip) {
  const double wanted = tag.label.text_height;
  const double gap = label_clearance(tag) + kSmear;
  LabelRows below = best_arrangement(text, {strip}, wanted);
  if (below.least_height >= std::min(wanted, kReadableHeight)) return below;
  LabelRows beside = best_arrangement(text, strip_left(drawing, gap), wanted);
  return beside.least_height > below.least_height ? beside : below;
}

TextItem label_row(const LabelRows& label, std::size_t index) {
  const Rectangle& box = label.strip.box;
  const double down = (kTextAscent + static_cast<double>(index) * kRowHeight) * label.height;
  TextItem item{label.rows[index], 0, 0, label.height, label.row_length()};
  item.upwards = label.strip.upwards;
  item.x = item.upwards ? box.x + down : box.x + label.row_start();
  item.y = item.upwards ? box.y + box.height - label.row_start() : box.y + down;
  return item;
}

// A box at the right end of the strip, half way up; the strip loses it and a gap beside it.
std::optional<Rectangle> take_right_end(Rectangle& strip, double width, double height, double gap) {
  constexpr double kRounding = 1e-9;
  if (width <= 0 || height > strip.height + kRounding || 2 * width > strip.width) {
    return std::nullopt;
  }
  const double left = strip.x + strip.width - width;
  strip.width -= width + gap;
  return Rectangle{left, strip.y + (strip.height - height) / 2, width, height};
}

// The parts in the strip below the frame beside the label, which gets the rest of it.
Rectangle fill_strip(TagDrawing& drawing, const TagTemplate& tag) {
  Rectangle strip = strip_below_frame(tag);
  const double size = tag.patch_size;
  if (const auto box = take_right_end(strip, 2 * size, size, size / 2)) {
    drawing.patches = {{box->x, box->y, size, size}, {box->x + size, box->y, size, size}};
  }
  if (const auto box = take_right_end(strip, tag.qr.size, tag.qr.size, kEdgeClearance)) {
    drawing.qr = QrDrawing{*box};
  }
  if (const auto box = take_right_end(strip, tag.logo.width, tag.logo.height, kEdgeClearance)) {
    drawing.logo = LogoDrawing{*box};
  }
  return strip;
}

std::vector<HoleOutline> holes_of(const TagTemplate& tag, const Rectangle& plate) {
  std::vector<HoleOutline> holes;
  for (const DrillHole& hole : tag.holes) {
    const PlatePoint centre{plate.x + plate.width / 2 + hole.right,
                            plate.y + plate.height / 2 - hole.up};
    holes.push_back({centre, hole.diameter / 2});
  }
  return holes;
}

// The lines of the label, an up arrow at their start.
void add_label(TagDrawing& drawing, const TagTemplate& tag, const TagText& text,
               const Rectangle& strip) {
  if (!tag.label.shown) return;
  LabelRows label = place_label(drawing, tag, text, strip);
  // Smaller letters rather than lines that end early.
  const double whole = std::max(label.least_height / kLeastTextShrink, kLeastLabelHeight);
  label.height = std::min(label.height, whole);
  if (label.height < kLeastLabelHeight) return;
  drawing.arrows.push_back({label.arrow()});
  for (std::size_t i = 0; i < label.rows.size(); ++i) {
    drawing.label.push_back(label_row(label, i));
  }
}

}  // namespace

std::array<PlatePoint, 4> corners_of(const Rectangle& rectangle) {
  const auto& [x, y, width, height] = rectangle;
  return {{{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}};
}

std::array<PlatePoint, 7> outline_of(const UpArrow& arrow) {
  constexpr double kHead = 0.45;   // of the arrow's height
  constexpr double kShaft = 0.36;  // of its width
  const auto& [x, y, width, height] = arrow.box;
  const double middle = x + width / 2;
  const double shoulder = y + kHead * height;
  const double half_shaft = kShaft * width / 2;
  return {{{middle, y},
           {x + width, shoulder},
           {middle + half_shaft, shoulder},
           {middle + half_shaft, y + height},
           {middle - half_shaft, y + height},
           {middle - half_shaft, shoulder},
           {x, shoulder}}};
}

bool touches(const HoleOutline& hole, const Rectangle& box) {
  const double right = std::max({box.x - hole.centre.x, hole.centre.x - box.x - box.width, 0.0});
  const double down = std::max({box.y - hole.centre.y, hole.centre.y - box.y - box.height, 0.0});
  return std::hypot(right, down) < hole.radius;
}

double label_clearance(const TagTemplate& tag) {
  constexpr double kAmple = 0.012;  // thick strokes need no more
  return std::min(tag.frame_stroke, kAmple);
}

Rectangle strip_below_frame(const TagTemplate& tag) {
  const Rectangle plate = plate_around(tag);
  const Rectangle frame = outer_frame(tag);
  const double top = frame.y + frame.height + label_clearance(tag) + kSmear;
  return {frame.x, top, frame.width, plate.y + plate.height - kEdgeClearance - top};
}

TagDrawing moved(TagDrawing drawing, double right, double down, double scale) {
  const auto move = [&](Rectangle& box) {
    box = {scale * box.x + right, scale * box.y + down, scale * box.width, scale * box.height};
  };
  for (Rectangle* box : {&drawing.plate, &drawing.frame_outer, &drawing.frame_inner}) move(*box);
  for (Rectangle& bar : drawing.bars) move(bar);
  for (UpArrow& arrow : drawing.arrows) move(arrow.box);
  for (TextItem& item : drawing.label) {
    item.x = scale * item.x + right;
    item.y = scale * item.y + down;
    item.height *= scale;
    item.max_width *= scale;
  }
  for (HoleOutline& hole : drawing.holes) {
    hole = {{scale * hole.centre.x + right, scale * hole.centre.y + down}, scale * hole.radius};
  }
  if (drawing.patches) {
    move(drawing.patches->white);
    move(drawing.patches->black);
  }
  if (drawing.qr) {
    move(drawing.qr->box);
    for (Rectangle& module : drawing.qr->modules) move(module);
  }
  if (drawing.logo) {
    move(drawing.logo->room);
    for (std::vector<PlatePoint>& outline : drawing.logo->outlines) {
      for (PlatePoint& p : outline) p = {scale * p.x + right, scale * p.y + down};
    }
  }
  drawing.corner_radius *= scale;
  drawing.module *= scale;
  return drawing;
}

TagDrawing draw_tag(const TagTemplate& tag, const Digits& digits, const TagText& text) {
  TagDrawing drawing;
  drawing.plate = plate_around(tag);
  drawing.frame_outer = outer_frame(tag);
  drawing.frame_inner = inner_frame(tag);
  drawing.bars = bars_of(tag, digits);
  drawing.module = module_width(tag);
  const Rectangle strip = fill_strip(drawing, tag);
  drawing.holes = holes_of(tag, drawing.plate);
  drawing.corner_radius = tag.cut.corner_radius;
  drawing.white_on_black = tag.white_on_black;
  drawing.cut_contour = tag.cut.contour;
  add_label(drawing, tag, text, strip);
  return drawing;
}

}  // namespace tagsmith::detail
