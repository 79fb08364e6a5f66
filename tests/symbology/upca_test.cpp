// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/symbology/upca.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <span>
#include <string>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

namespace {

std::string module_text(const Digits& digits) {
  std::string text;
  for (const auto module : modules_of(digits)) text += module == 1 ? '1' : '0';
  return text;
}

Digits random_digits(std::mt19937& random) {
  std::uniform_int_distribution<int> digit(0, 9);
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(digit(random));
  return digits;
}

// The digits that have these elements' widths at their places; nothing where a place has none's.
std::optional<Digits> digits_with(const std::array<std::uint8_t, kElementCount>& elements) {
  Digits digits{};
  for (int i = 0; i < kDigitCount; ++i) {
    const auto* const first = elements.begin() + first_element_of_digit(i);
    const auto found = std::ranges::find_if(kDigitElements, [&](const auto& widths) {
      return std::ranges::equal(widths, std::span(first, kElementsPerDigit));
    });
    if (found == kDigitElements.end()) return std::nullopt;
    digits[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(found - kDigitElements.begin());
  }
  return digits;
}

}  // namespace

TEST_CASE("the published symbol of 036000291452 has these 95 modules") {
  // Wikipedia, "Universal Product Code", encoding table, applied by hand to its example number.
  // clang-format off
  const std::string expected =
      "101" "0001101" "0111101" "0101111" "0001101" "0001101" "0001101" "01010"
      "1101100" "1110100" "1100110" "1011100" "1001110" "1101100" "101";
  // clang-format on
  CHECK(module_text(*parse_digits("036000291452")) == expected);
}

TEST_CASE("the published symbol of 012345678905 has these 95 modules") {
  // GS1 General Specifications, number sets A and C.
  // clang-format off
  const std::string expected =
      "101" "0001101" "0011001" "0010011" "0111101" "0100011" "0110001" "01010"
      "1010000" "1000100" "1001000" "1110100" "1110010" "1001110" "101";
  // clang-format on
  CHECK(module_text(*parse_digits("012345678905")) == expected);
}

TEST_CASE("published check digits") {
  struct Case {
    const char* digits;
    CheckDigit scheme;
  };
  const Case cases[] = {
      {"036000291452", CheckDigit::gs1},   {"012345678905", CheckDigit::gs1},
      {"042100005264", CheckDigit::gs1},   {"614141000036", CheckDigit::gs1},
      {"019000000404", CheckDigit::sum10},  // the paper's P(1.9, 0, 0.4)
  };
  for (const Case& example : cases) {
    CAPTURE(example.digits);
    Digits digits = *parse_digits(example.digits);
    CHECK(has_check_digit(example.scheme, digits));
    digits[3] = static_cast<std::uint8_t>((digits[3] + 1) % 10);
    CHECK_FALSE(has_check_digit(example.scheme, digits));
  }
}

TEST_CASE("check digits go by the names that their schemes are written with") {
  CHECK(parse_check_digit("sum10") == CheckDigit::sum10);
  CHECK(parse_check_digit("gs1") == CheckDigit::gs1);
  CHECK_FALSE(parse_check_digit("GS1"));
  for (const CheckDigit scheme : {CheckDigit::sum10, CheckDigit::gs1}) {
    CHECK(parse_check_digit(to_string(scheme)) == scheme);
  }
}

TEST_CASE("a sum of whole tens has the check digit zero") {
  // By gs1 3 (5 + 5), by sum10 5 + 5.
  for (const CheckDigit scheme : {CheckDigit::sum10, CheckDigit::gs1}) {
    CHECK(has_check_digit(scheme, *parse_digits("500000000050")));
  }
}

TEST_CASE("either check digit finds every single wrong digit") {
  std::mt19937 random(1);
  for (const CheckDigit scheme : {CheckDigit::sum10, CheckDigit::gs1}) {
    Digits digits = random_digits(random);
    digits.back() = check_digit(scheme, std::span(digits).first<11>());
    for (std::size_t position = 0; position < digits.size(); ++position) {
      for (std::uint8_t step = 1; step < 10; ++step) {
        Digits wrong = digits;
        wrong[position] = static_cast<std::uint8_t>((wrong[position] + step) % 10);
        CHECK_FALSE(has_check_digit(scheme, wrong));
      }
    }
  }
}

TEST_CASE("elements say which digits they are of, and none upside down") {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Digits digits = random_digits(random);
    CAPTURE(to_string(digits));
    auto elements = elements_of(digits);
    CHECK(digits_with(elements) == digits);
    std::ranges::reverse(elements);
    CHECK_FALSE(digits_with(elements).has_value());
  }
}

TEST_CASE("digits are exactly twelve decimal digits") {
  for (const char* text : {"", "12345678901", "1234567890123", "12345678901x", " 12345678901"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_digits(text).has_value());
  }
}
