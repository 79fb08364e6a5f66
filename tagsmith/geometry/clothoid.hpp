// SPDX-License-Identifier: Apache-2.0
// Clothoids, whose curvature grows in proportion to the length: transitions of roads and railways.
#pragma once

#include <vector>

#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {

// Level arcs that follow a clothoid of this length (metres) from one curvature to another
// (1/metres, positive to the right) within a twentieth of a millimetre; they end where it ends,
// with its heading. `number`: of the clothoid in its line, from 1 (CenterlineElement::clothoid).
std::vector<CenterlineElement> arcs_of_clothoid(double length, double from, double to, int number);

}  // namespace tagsmith::detail
