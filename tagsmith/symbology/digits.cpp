// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

std::optional<Digits> parse_digits(std::string_view text) {
  if (text.size() != kDigitCount) return std::nullopt;
  Digits digits{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] < '0' || text[i] > '9') return std::nullopt;
    digits[i] = static_cast<std::uint8_t>(text[i] - '0');
  }
  return digits;
}

std::string to_string(const Digits& digits) {
  std::string text;
  for (const std::uint8_t digit : digits) text += static_cast<char>('0' + digit);
  return text;
}

std::string to_string(CheckDigit scheme) { return scheme == CheckDigit::sum10 ? "sum10" : "gs1"; }

std::optional<CheckDigit> parse_check_digit(std::string_view text) {
  if (text == "sum10") return CheckDigit::sum10;
  if (text == "gs1") return CheckDigit::gs1;
  return std::nullopt;
}

std::uint8_t check_digit(CheckDigit scheme, std::span<const std::uint8_t, 11> digits) {
  int sum = 0;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const bool weighted = scheme == CheckDigit::gs1 && i % 2 == 0;
    sum += (weighted ? 3 : 1) * digits[i];
  }
  const int remainder = sum % 10;
  return static_cast<std::uint8_t>(scheme == CheckDigit::sum10 ? remainder : (10 - remainder) % 10);
}

bool has_check_digit(CheckDigit scheme, const Digits& digits) {
  return check_digit(scheme, std::span(digits).first<11>()) == digits.back();
}

}  // namespace tagsmith::detail
