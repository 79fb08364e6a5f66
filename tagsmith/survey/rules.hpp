// SPDX-License-Identifier: Apache-2.0
// What checks can find, and what to do about it. The catalogues are tables of the documentation,
// which the build takes into the program: a rule is written down once.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace tagsmith::detail {

struct Rule {
  std::string_view code;    // as in Diagnostic::code
  std::string_view finds;   // what is wrong
  std::string_view remedy;  // why it matters, and what to do
  std::string_view action;  // of verify: what the ledger asks for, "-" for nothing; else empty
};

// The rows "| `code` | finds | remedy |" or "| `code` | finds | remedy | action |" of a document in
// Markdown, which must outlive them.
std::vector<Rule> rules_in(std::string_view document);

// The rule with this code, or null.
const Rule* find_rule(std::string_view code, std::span<const Rule> among);

// By which files of surveys, rigs, templates, runs and boards are checked: docs/rules.md.
std::span<const Rule> rules();
const Rule* find_rule(std::string_view code);

}  // namespace tagsmith::detail
