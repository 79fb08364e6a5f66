// SPDX-License-Identifier: Apache-2.0
// The rules that files of surveys, rigs, templates and runs are checked by.
#pragma once

#include <span>
#include <string_view>

namespace tagsmith::detail {

struct Rule {
  std::string_view code;  // as in Diagnostic::code
  std::string_view title;
  std::string_view explanation;  // what is wrong, why it matters, what to do
};

// All of them, by code.
std::span<const Rule> rules();

// The rule with this code, or null.
const Rule* find_rule(std::string_view code);

}  // namespace tagsmith::detail
