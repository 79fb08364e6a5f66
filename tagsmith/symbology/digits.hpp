// SPDX-License-Identifier: Apache-2.0
// The twelve digits of a symbol and their check digit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace tagsmith::detail {

inline constexpr int kDigitCount = 12;
inline constexpr std::size_t kPayloadDigits = kDigitCount - 1;  // all but the check digit

// Twelve values 0-9, the check digit last.
using Digits = std::array<std::uint8_t, kDigitCount>;

// Exactly twelve characters '0'-'9'.
std::optional<Digits> parse_digits(std::string_view text);
std::string to_string(const Digits& digits);

// How the twelfth digit follows from the first eleven.
enum class CheckDigit {
  sum10,  // their plain sum modulo 10 (Xu et al. 2017, "Barcode tag design")
  gs1,    // GS1 General Specifications 7.9: weights 3,1,3,..., complement to 10 (standard UPC-A)
};

std::string to_string(CheckDigit scheme);
std::optional<CheckDigit> parse_check_digit(std::string_view text);

// The check digit of eleven digits.
std::uint8_t check_digit(CheckDigit scheme, std::span<const std::uint8_t, 11> digits);

bool has_check_digit(CheckDigit scheme, const Digits& digits);

}  // namespace tagsmith::detail
