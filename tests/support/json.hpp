// SPDX-License-Identifier: Apache-2.0
// JSON in tests. The parser is a template that takes the compiler a second wherever it is called.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tagsmith::detail::test {

// Throws nlohmann::json::parse_error where the text is no JSON.
nlohmann::json parsed_json(const std::string& text);

// What `--json` printed, an object a line.
std::vector<nlohmann::json> json_lines(const std::string& text);

}  // namespace tagsmith::detail::test
