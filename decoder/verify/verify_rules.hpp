// SPDX-License-Identifier: Apache-2.0
// What `verify` can find wrong, and what the people who hang, print or photograph the plates do
// about it: docs/verify-rules.md.
#pragma once

#include <span>
#include <string_view>

#include "tagsmith/survey/rules.hpp"

namespace tagsmith::detail {

std::span<const Rule> verify_rules();

// The rule with this code, or null.
const Rule* find_verify_rule(std::string_view code);

}  // namespace tagsmith::detail
