// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace tagsmith::detail {

// The changes from one text to another line by line, with three lines around each, as `diff -u`
// prints them and `patch` takes them. Empty where the texts are equal. Finds the fewest changes
// (E. W. Myers, "An O(ND) difference algorithm and its variations", Algorithmica 1, 1986); memory
// grows with the square of their number.
std::string unified_diff(std::string_view old_name, std::string_view old_text,
                         std::string_view new_name, std::string_view new_text);

}  // namespace tagsmith::detail
