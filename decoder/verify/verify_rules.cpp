// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_rules.hpp"

#include <vector>

namespace tagsmith::detail {
namespace {

constexpr std::string_view kDocument =
#include "docs/verify-rules.md.inc"
    ;

}  // namespace

std::span<const Rule> verify_rules() {
  static const std::vector<Rule> all = rules_in(kDocument);
  return all;
}

const Rule* find_verify_rule(std::string_view code) { return find_rule(code, verify_rules()); }

}  // namespace tagsmith::detail
