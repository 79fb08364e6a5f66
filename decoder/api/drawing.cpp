// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/drawing.hpp"

#include <tagsmith/drawing.hpp>

#include "decoder/api/data.hpp"

namespace tagsmith {
namespace {

Rectangle rectangle_from(const detail::Rectangle& rectangle) {
  return {rectangle.x, rectangle.y, rectangle.width, rectangle.height};
}

}  // namespace

TagDrawing draw_tag(const PlateTemplate& plate, std::string_view digits) {
  const detail::TagDrawing drawn = detail::draw_tag(
      detail::template_from(plate), detail::checked_digits(digits, "the tag's digits"));
  TagDrawing drawing;
  drawing.plate = rectangle_from(drawn.plate);
  drawing.frame_outer = rectangle_from(drawn.frame_outer);
  drawing.frame_inner = rectangle_from(drawn.frame_inner);
  for (const detail::Rectangle& bar : drawn.bars) drawing.bars.push_back(rectangle_from(bar));
  drawing.module = drawn.module;
  return drawing;
}

}  // namespace tagsmith
