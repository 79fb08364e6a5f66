// SPDX-License-Identifier: Apache-2.0
// Pictures of single feature frames with anything inside, degraded in every way at once; quick to
// draw, so that a million can be read.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail::mass {

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

// Whether a reading of such a symbol can be right: the tag's code, or that of a corrupted symbol
// which still looks most like what it was. A character that is no digit must not be read at all.
bool may_be_read(Kind kind);

struct Picture {
  GrayImage image;
  Kind kind = Kind::tag;
  Digits code{};             // the symbol's, or what it was before it was corrupted
  Quad corners{};            // of the frame's inner edge, from P on
  bool odd_margins = false;  // the bars do not stand where a template of ours has them
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

// The same through one of the chains of `simulate --camera-chain`, with other strengths each time.
Picture draw_chained(std::uint64_t seed);

// As draw(), but every one with a digit of arbitrary widths.
Picture draw_misprinted(std::uint64_t seed);

// One thing at a time that makes a tag of 1.3 to 4 px a module hard to read, strongly.
enum class Trouble {
  none,
  steep_cable,     // dark, along the bars or nearly so
  diagonal_cable,  // dark, over most digits, each elsewhere
  pale_cable,      // of the plate's colour
  hidden_side,     // a board over one of the frame's sides, not over the bars
  dirt,            // blotches
  glare,
  veil,             // dust: little contrast
  dark,             // little light, much noise
  motion_along,     // of the bars, up to 8 px
  motion_across,    // up to 1.2 modules
  steep,            // seen at 65 to 75 degrees
  several,          // three of them
  shadow,           // one or two with edges across the plate, as dark as a twentieth
  edge_along_side,  // a board along one of the frame's sides, a little within it
  count
};

const char* name_of(Trouble trouble);

// As draw(), but with this trouble alone; two pictures of three show a tag, the others something
// that must not be read.
Picture draw_troubled(Trouble trouble, std::uint64_t seed);

// Twelve random digits with a valid check digit (gs1).
Digits random_code(std::mt19937_64& random);

}  // namespace tagsmith::detail::mass
