// SPDX-License-Identifier: Apache-2.0
// Texts of a template in which fields such as {name} are replaced by the values of each tag.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace tagsmith::detail {

// Name, side of the drive, digits, chainage and grid coordinates of P in metres, the survey's name
// and its revision.
inline constexpr std::array<std::string_view, 9> kLabelFields{
    "name", "side", "digits", "chainage", "x", "y", "z", "survey", "revision"};

// The first unknown field of the text (none of kLabelFields), or one that has no closing brace.
std::optional<std::string> unknown_field(std::string_view text);

// The text with `value_of` each of its fields; a field that is unknown stays unchanged.
std::string filled_in(std::string_view text,
                      const std::function<std::string(std::string_view field)>& value_of);

}  // namespace tagsmith::detail
