// SPDX-License-Identifier: Apache-2.0
// JSON to text and back, and lists of numbers. The library's templates for it are long: they are
// compiled here alone.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace tagsmith::detail {

// JSON as the program writes it: keys stay in their order.
using Json = nlohmann::ordered_json;

// On one line, or with this many spaces a level. Bytes that are no UTF-8 become U+FFFD.
std::string json_text(const Json& value, int indent = -1);

// Rounded so that the shortest text of the number has at most that many decimals.
double with_decimals(double value, int decimals);

// Rounded to that many digits; 0 for what is not finite.
double with_digits(double value, int digits);

// JSON has no infinity: null stands for what is not finite.
Json finite_or_null(double value);

// What `json_of` makes of each item, as a list.
template <class Items, class JsonOf, class List = Json>
List json_list(const Items& items, const JsonOf& json_of) {
  List list = List::array();
  for (const auto& item : items) list.push_back(json_of(item));
  return list;
}

// The numbers as a list.
Json number_list(std::span<const double> values);

// Those of a vector of Eigen's.
template <typename Vector>
auto number_list(const Vector& vector) {
  return number_list(std::span<const typename Vector::Scalar>(
      vector.data(), static_cast<std::size_t>(vector.size())));
}

// A value for which is_discarded() holds where the text is no JSON.
nlohmann::json parse_json(std::string_view text);

}  // namespace tagsmith::detail
