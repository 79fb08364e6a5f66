// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "decoder/feature_frame/frame.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// Where the symbol stands inside the feature frame. The default is that of both plates of Xu et al.
// (2017): 9 modules of white on every side of the bars.
struct SymbolLayout {
  double quiet_zone_modules = 9;  // between the frame's inner edge and the first and last bar
  double bars_top = 0.163;        // ends of the bars as shares of the frame's inner height
  double bars_bottom = 0.837;
  FrameShape frame;  // around it

  // Modules from side to side of the frame's inner edge.
  double modules() const { return kModuleCount + 2 * quiet_zone_modules; }
  // A module, counted from the first bar, as a share of the frame's inner length.
  double width_share(double module) const { return (module + quiet_zone_modules) / modules(); }
  double bar_height() const { return bars_bottom - bars_top; }  // of the frame's inner height

  bool operator==(const SymbolLayout&) const = default;
};

SymbolLayout layout_of(const TagTemplate& tag);

// What to search for where any of these layouts may be: their mean.
SymbolLayout typical_layout(std::span<const SymbolLayout> layouts);

}  // namespace tagsmith::detail
