// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/json_text.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace tagsmith::detail {

std::string json_text(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

double with_decimals(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

double with_digits(double value, int digits) {
  if (value == 0 || !std::isfinite(value)) return 0;
  return with_decimals(value,
                       digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
}

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json number_list(std::span<const double> values) {
  return json_list(values, [](double value) { return value; });
}

nlohmann::json parse_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

}  // namespace tagsmith::detail
