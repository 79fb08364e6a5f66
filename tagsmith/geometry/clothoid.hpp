// SPDX-License-Identifier: Apache-2.0
// Clothoids, whose curvature grows in proportion to the length: transitions of roads and railways.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {

// Level arcs that follow a clothoid of this length (metres) from one curvature to another
// (1/metres, positive to the right) within a twentieth of a millimetre; they end where it ends,
// with its heading. `number`: of the clothoid in its line, from 1 (CenterlineElement::clothoid).
std::vector<CenterlineElement> arcs_of_clothoid(double length, double from, double to, int number);

// A clothoid of this length (metres) from one curvature to another.
struct Clothoid {
  double length = 0;
  double from = 0;
  double to = 0;
};

// The clothoid that these are all arcs of, as arcs_of_clothoid made them; nothing for other
// elements and where arcs are cut or missing.
std::optional<Clothoid> clothoid_of(std::span<const CenterlineElement> arcs);

// The first element, or all arcs of the clothoid that it begins.
std::span<const CenterlineElement> leading_part(std::span<const CenterlineElement> elements);

}  // namespace tagsmith::detail
