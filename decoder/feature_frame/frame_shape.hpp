// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tagsmith::detail {

// The proportions of a feature frame as it is printed: of its inner edge and of its stroke, in
// modules of the symbol inside. The search needs to know them roughly. The default is that of the
// larger plate of Xu et al. (2017).
struct FrameShape {
  double length = 113;   // along the symbol
  double height = 55.3;  // along its bars
  double stroke = 3.95;  // thickness

  bool operator==(const FrameShape&) const = default;
};

}  // namespace tagsmith::detail
