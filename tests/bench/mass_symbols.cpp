// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/mass_symbols.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail::mass {
namespace {

Widths symbol_widths(const Digits& digits) {
  Widths widths;
  for (const std::uint8_t width : elements_of(digits)) widths.push_back(width);
  return widths;
}

void mirror_digit(Widths& widths, int position) {
  const auto first = widths.begin() + first_element_of_digit(position);
  std::reverse(first, first + kElementsPerDigit);
}

// How far the farthest inner edge of these widths is from that of the nearest digit, modules.
double distance_to_digits(std::span<const double, kElementsPerDigit> widths) {
  double nearest = kModulesPerDigit;
  for (const auto& digit : kDigitElements) {
    double farthest = 0, here = 0, there = 0;
    for (std::size_t i = 0; i + 1 < kElementsPerDigit; ++i) {
      here += widths[i];
      there += digit[i];
      farthest = std::max(farthest, std::abs(here - there));
    }
    nearest = std::min(nearest, farthest);
  }
  return nearest;
}

// Four arbitrary widths that are clearly those of no digit.
void misshape_digit(Widths& widths, int position, Random& random) {
  constexpr double kLeastDistance = 0.7;
  const std::span<double, kElementsPerDigit> elements(
      widths.data() + first_element_of_digit(position), kElementsPerDigit);
  do {
    std::array<double, 3> cuts{};
    for (double& cut : cuts) cut = uniform(random, 0.6, 6.4);
    std::ranges::sort(cuts);
    elements[0] = cuts[0];
    elements[1] = std::max(0.3, cuts[1] - cuts[0]);
    elements[2] = std::max(0.3, cuts[2] - cuts[1]);
    elements[3] = std::max(0.3, kModulesPerDigit - elements[0] - elements[1] - elements[2]);
  } while (distance_to_digits(elements) < kLeastDistance);
}

Widths code128_widths(Random& random) {
  Widths widths;
  for (int c = 0; c < 8; ++c) {
    std::array<int, 6> character{1, 1, 1, 1, 1, 1};
    for (int rest = 5; rest > 0;) {
      int& width = character[static_cast<std::size_t>(integer(random, 0, 5))];
      if (width == 4) continue;
      ++width;
      --rest;
    }
    widths.insert(widths.end(), character.begin(), character.end());
  }
  widths.insert(widths.end(), {2, 3, 3, 1, 1, 1, 2});
  return widths;
}

Widths upc_e_widths(Random& random) {
  Widths widths{1, 1, 1};
  for (int c = 0; c < 6; ++c) {
    auto character = kDigitElements[static_cast<std::size_t>(integer(random, 0, 9))];
    if (chance(random, 0.5)) std::ranges::reverse(character);
    widths.insert(widths.end(), character.begin(), character.end());
  }
  widths.insert(widths.end(), {1, 1, 1, 1, 1, 1});
  return widths;
}

Widths stripes_widths(const Digits& digits, Random& random) {
  Widths widths = symbol_widths(digits);
  for (std::size_t i = 3; i + 3 < widths.size(); ++i) widths[i] = integer(random, 1, 4);
  return widths;
}

}  // namespace

bool may_be_read(Kind kind) {
  return kind == Kind::tag || kind == Kind::misshapen || kind == Kind::moved_edge;
}

const char* name_of(Kind kind) {
  constexpr std::array<const char*, static_cast<std::size_t>(Kind::count)> kNames{
      "tags",
      "wrong check digit",
      "one character of no digit",
      "one digit of arbitrary widths",
      "one edge moved",
      "cut symbols",
      "EAN-13",
      "UPC-E",
      "Code 128-like",
      "random stripes",
      "gratings",
      "empty frames"};
  return kNames[static_cast<std::size_t>(kind)];
}

Kind random_kind(Random& random) {
  constexpr std::array<std::pair<Kind, double>, 11> kShares{{{Kind::tag, 0.45},
                                                             {Kind::wrong_check, 0.08},
                                                             {Kind::foreign, 0.12},
                                                             {Kind::misshapen, 0.06},
                                                             {Kind::moved_edge, 0.06},
                                                             {Kind::cut, 0.04},
                                                             {Kind::ean13, 0.06},
                                                             {Kind::upc_e, 0.02},
                                                             {Kind::code128, 0.03},
                                                             {Kind::stripes, 0.05},
                                                             {Kind::grating, 0.015}}};
  double lot = uniform(random, 0, 1);
  for (const auto& [kind, share] : kShares) {
    if (lot < share) return kind;
    lot -= share;
  }
  return Kind::empty;
}

Digits random_code(Random& random) {
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(integer(random, 0, 9));
  digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
  return digits;
}

Digits random_code_of(Kind kind, Random& random) {
  Digits code = random_code(random);
  if (kind != Kind::wrong_check) return code;
  do {
    code.back() = static_cast<std::uint8_t>(integer(random, 0, 9));
  } while (has_check_digit(CheckDigit::gs1, code) || has_check_digit(CheckDigit::sum10, code));
  return code;
}

Widths widths_of(Kind kind, const Digits& digits, Random& random) {
  Widths widths = symbol_widths(digits);
  switch (kind) {
    case Kind::foreign:
      mirror_digit(widths, integer(random, 0, 11));
      return widths;
    case Kind::misshapen:
      misshape_digit(widths, integer(random, 0, 11), random);
      return widths;
    case Kind::moved_edge: {
      const auto i = static_cast<std::size_t>(integer(random, 3, 54));
      const double move = std::min(uniform(random, 0.5, 1.5), widths[i + 1] - 0.1);
      widths[i] += move;
      widths[i + 1] -= move;
      return widths;
    }
    case Kind::cut: {
      const int kept = integer(random, 12, 52);
      if (chance(random, 0.5)) std::ranges::reverse(widths);
      widths.resize(static_cast<std::size_t>(kept));
      return widths;
    }
    case Kind::ean13: {
      std::array<int, 5> places{1, 2, 3, 4, 5};
      std::ranges::shuffle(places, random);
      for (std::size_t k = 0; k < 3; ++k) mirror_digit(widths, places[k]);
      return widths;
    }
    case Kind::upc_e:
      return upc_e_widths(random);
    case Kind::code128:
      return code128_widths(random);
    case Kind::stripes:
      return stripes_widths(digits, random);
    case Kind::grating:
      return Widths(static_cast<std::size_t>(2 * integer(random, 8, 47) + 1), 1.0);
    case Kind::empty:
      return {};
    default:
      return widths;
  }
}

}  // namespace tagsmith::detail::mass
