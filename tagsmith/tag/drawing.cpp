// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/drawing.hpp"

#include <algorithm>

namespace tagsmith {
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

// The label stands below the frame, clear of it by a stroke, an up arrow at its left end.
void add_label(TagDrawing& drawing, const TagTemplate& tag, const TagText& text) {
  if (!tag.label.shown || text.lines.empty()) return;
  constexpr double kLinePitch = 1.6;  // of the capital height
  const double frame_bottom = drawing.frame_outer.y + drawing.frame_outer.height;
  const double plate_bottom = drawing.plate.y + drawing.plate.height;
  const double gap = tag.frame_stroke;
  const double room = plate_bottom - frame_bottom - 2 * gap;
  if (room <= 0) return;
  const double line_count = static_cast<double>(text.lines.size());
  const double height =
      std::min(tag.label.text_height, room / (1.0 + (line_count - 1.0) * kLinePitch));
  const double block = height * (1.0 + (line_count - 1.0) * kLinePitch);
  const double top = frame_bottom + gap;
  const double left = drawing.frame_outer.x;
  drawing.arrows.push_back({{left, top, 0.6 * block, block}});
  const double text_left = left + 0.6 * block + height;
  const double text_width = drawing.frame_outer.x + drawing.frame_outer.width - text_left;
  for (std::size_t i = 0; i < text.lines.size(); ++i) {
    const double baseline = top + height * (1.0 + static_cast<double>(i) * kLinePitch);
    drawing.label.push_back({text.lines[i], text_left, baseline, height, text_width, false});
  }
}

}  // namespace

TagDrawing draw_tag(const TagTemplate& tag, const Digits& digits, const TagText& text) {
  TagDrawing drawing;
  drawing.plate = plate_around(tag);
  drawing.frame_outer = outer_frame(tag);
  drawing.frame_inner = inner_frame(tag);
  drawing.bars = bars_of(tag, digits);
  drawing.module = module_width(tag);
  add_label(drawing, tag, text);
  return drawing;
}

}  // namespace tagsmith
