// SPDX-License-Identifier: Apache-2.0
#include "tests/support/json.hpp"

#include <sstream>

namespace tagsmith::detail::test {

nlohmann::json parsed_json(const std::string& text) { return nlohmann::json::parse(text); }

std::vector<nlohmann::json> json_lines(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(parsed_json(line));
  return lines;
}

}  // namespace tagsmith::detail::test
