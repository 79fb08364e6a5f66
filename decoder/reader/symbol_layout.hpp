// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// Where the symbol stands inside the feature frame. The default is that of both plates of Xu et al.
// (2017): 9 modules of white on every side of the bars.
struct SymbolLayout {
  double quiet_zone_modules = 9;  // between the frame's inner edge and the first and last bar
  double bars_top = 0.163;        // ends of the bars as shares of the frame's inner height
  double bars_bottom = 0.837;

  bool operator==(const SymbolLayout&) const = default;
};

SymbolLayout layout_of(const TagTemplate& tag);

}  // namespace tagsmith::detail
