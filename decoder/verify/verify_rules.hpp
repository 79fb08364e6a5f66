// SPDX-License-Identifier: Apache-2.0
// What `verify` can find wrong, and what to do about it: docs/verify-rules.md is this table.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tagsmith::detail {

struct VerifyRule {
  std::string_view code;
  std::string_view finds;
  std::string_view remedy;  // for who hangs, prints or photographs the plates
};

// All of them, by code.
std::span<const VerifyRule> verify_rules();

// The rule with this code, or null.
const VerifyRule* find_verify_rule(std::string_view code);

// The rules as a table in Markdown.
std::string verify_rules_table();

}  // namespace tagsmith::detail
