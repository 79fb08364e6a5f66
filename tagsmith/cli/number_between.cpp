// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/number_between.hpp"

#include <optional>
#include <string>

#include "tagsmith/base/text.hpp"

namespace tagsmith {

std::function<std::string(const std::string&)> number_between(double low, double high) {
  return [low, high](const std::string& text) {
    const std::optional<double> value = parse_number(text);
    if (value && *value >= low && *value <= high) return std::string();
    return "found `" + text + "`, expected a number from " + format_number(low) + " to " +
           format_number(high);
  };
}

}  // namespace tagsmith
