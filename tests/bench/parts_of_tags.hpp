// SPDX-License-Identifier: Apache-2.0
// What parts of tags may be read of pictures made for campaigns.
#pragma once

#include <cstddef>

#include "decoder/reader/part_reading.hpp"
#include "tests/bench/mass_picture.hpp"

namespace tagsmith::detail::bench {

// Whether the digits in sight of a part are those of a code.
inline bool shows_digits_of(const PartReading& part, const Digits& code) {
  const Digits& read = part.candidates.front().digits;
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    if (part.in_sight[i] && read[i] != code[i]) return false;
  }
  return true;
}

// Whether a symbol's digits in sight can be those of its code. Where one character is no digit, or
// guards are cut off, that may be out of sight; an EAN-13 has digits like those of a UPC-A, too.
inline bool may_show_digits(mass::Kind kind) {
  using enum mass::Kind;
  return mass::may_be_read(kind) || kind == wrong_check || kind == foreign || kind == cut ||
         kind == ean13;
}

}  // namespace tagsmith::detail::bench
