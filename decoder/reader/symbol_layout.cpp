// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

SymbolLayout layout_of(const TagTemplate& tag) {
  const double top = tag.margin_modules * module_width(tag) / tag.frame_inner_height;
  return {tag.quiet_zone_modules, top, 1 - top};
}

}  // namespace tagsmith::detail
