// SPDX-License-Identifier: Apache-2.0
// JSON to text and back. The library's templates for it are long: they are compiled here alone.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace tagsmith::detail {

// On one line, or with this many spaces a level. Bytes that are no UTF-8 become U+FFFD.
std::string json_text(const nlohmann::ordered_json& value, int indent = -1);

// A value for which is_discarded() holds where the text is no JSON.
nlohmann::json parse_json(std::string_view text);

}  // namespace tagsmith::detail
