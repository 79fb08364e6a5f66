// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

SymbolLayout layout_of(const TagTemplate& tag) {
  const double module = module_width(tag);
  const double top = tag.margin_modules * module / tag.frame_inner_height;
  const FrameShape frame{tag.frame_inner_length / module, tag.frame_inner_height / module,
                         tag.frame_stroke / module, 0.03};
  return {tag.quiet_zone_modules, top, 1 - top, frame};
}

SymbolLayout typical_layout(std::span<const SymbolLayout> layouts) {
  if (layouts.empty()) return {};
  SymbolLayout sum{0, 0, 0, {0, 0, 0, 0}};
  for (const SymbolLayout& layout : layouts) {
    sum.quiet_zone_modules += layout.quiet_zone_modules;
    sum.bars_top += layout.bars_top;
    sum.bars_bottom += layout.bars_bottom;
    sum.frame.length += layout.frame.length;
    sum.frame.height += layout.frame.height;
    sum.frame.stroke += layout.frame.stroke;
    sum.frame.stroke_tolerance += layout.frame.stroke_tolerance;
  }
  const auto count = static_cast<double>(layouts.size());
  return {sum.quiet_zone_modules / count,
          sum.bars_top / count,
          sum.bars_bottom / count,
          {sum.frame.length / count, sum.frame.height / count, sum.frame.stroke / count,
           sum.frame.stroke_tolerance / count}};
}

}  // namespace tagsmith::detail
