// SPDX-License-Identifier: Apache-2.0
// Pictures of single feature frames with anything inside, degraded in every way at once; quick to
// draw, so that a million can be read.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::mass {

enum class Kind {
  tag,
  wrong_check,  // a symbol whose check digit holds under neither scheme
  foreign,      // a tag with one character that is no digit
  misshapen,    // a tag with one digit of four arbitrary widths
  moved_edge,   // a tag with one element edge moved by half a module to one and a half
  cut,          // a tag whose begin or end is missing
  ean13,
  upc_e,
  code128,  // eleven-module characters of six elements
  stripes,  // random elements between guard patterns
  grating,
  empty,
  count
};

const char* name_of(Kind kind);

struct Picture {
  GrayImage image;
  Kind kind = Kind::tag;
  Digits code{};  // the symbol's, or what it was before it was spoilt
  double module_px = 0;
  double blur_px = 0;
  double noise = 0;
  double growth = 0;
  bool jpeg = false;
};

// A picture that depends on the seed alone: blur (camera and motion), noise, tone curve, exposure,
// JPEG, contrast, shading, ink spread, dirt, cables and boards in front, glare, quiet zones that
// are not as they should be, mirrored pictures. The point spread is Gaussian in the plate's own
// coordinates and corners are products of edges: cruder than decoder/simulate, a hundred times as
// quick.
Picture draw(std::uint64_t seed);

// Twelve random digits with a valid check digit (gs1).
Digits random_code(std::mt19937_64& random);

}  // namespace tagsmith::mass
