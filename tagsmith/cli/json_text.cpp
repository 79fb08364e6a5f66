// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/json_text.hpp"

#include <nlohmann/json.hpp>

namespace tagsmith::detail {

std::string json_text(const nlohmann::ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::ordered_json number_list(std::span<const double> values) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const double value : values) list.push_back(value);
  return list;
}

nlohmann::json parse_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

}  // namespace tagsmith::detail
