// SPDX-License-Identifier: Apache-2.0
// What stands inside the frames of mass_picture.hpp: the elements of symbols, right and corrupted.
#pragma once

#include <vector>

#include "tagsmith/symbology/digits.hpp"
#include "tests/bench/lots.hpp"
#include "tests/bench/mass_picture.hpp"

namespace tagsmith::detail::mass {

// Of what is drawn, each as often as its share says.
Kind random_kind(Random& random);

// Digits for a symbol of this kind: with a check digit that holds under gs1, or under neither
// scheme.
Digits random_code_of(Kind kind, Random& random);

// Widths of the elements, bars first, in modules.
using Widths = std::vector<double>;

// Those of a symbol of the kind, made from these digits where it is a tag's or a corrupted one.
Widths widths_of(Kind kind, const Digits& digits, Random& random);

}  // namespace tagsmith::detail::mass
