// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

SymbolLayout layout_of(const TagTemplate& tag) {
  const double module = module_width(tag);
  const double top = tag.margin_modules * module / tag.frame_inner_height;
  const FrameShape frame{tag.frame_inner_length / module, tag.frame_inner_height / module,
                         tag.frame_stroke / module};
  return {tag.quiet_zone_modules, top, 1 - top, frame};
}

FrameShape frame_shape_of(std::span<const SymbolLayout> layouts) {
  if (layouts.empty()) return {};
  FrameShape sum{0, 0, 0};
  for (const SymbolLayout& layout : layouts) {
    sum.length += layout.frame.length;
    sum.height += layout.frame.height;
    sum.stroke += layout.frame.stroke;
  }
  const auto count = static_cast<double>(layouts.size());
  return {sum.length / count, sum.height / count, sum.stroke / count};
}

}  // namespace tagsmith::detail
