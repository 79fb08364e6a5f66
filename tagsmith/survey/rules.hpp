// SPDX-License-Identifier: Apache-2.0
// What checks can find, and what to do about it. The catalogues are tables of the documentation,
// which the build includes in the program: a rule is written down once.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"

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

// The rules for files of surveys, rigs, templates, runs and boards: docs/rules.md.
std::span<const Rule> rules();
const Rule* find_rule(std::string_view code);

// ---- Comments in a file that allow what a rule warns of, each with its reason.

// Rules whose findings may come from the survey and another file together, a rig or a second
// survey: a comment that allows one is not reported as unused where that file was not given.
inline constexpr std::string_view kUnseenTagRule = "unseen-tag";
inline constexpr std::string_view kExchangedCodeRule = "exchanged-code";

// An error of a rig with a survey.
inline constexpr std::string_view kVehicleRoomRule = "vehicle-room";

// Removes the warnings about `file` that a comment `# tagsmith: allow RULE: REASON` in its text
// allows: on the line of the finding, on a line of its own before it, or anywhere for a finding
// about the whole file. Errors stay. Adds a finding for each such comment that names no rule, gives
// no reason, or allows nothing.
std::vector<Diagnostic> without_allowed(std::vector<Diagnostic> diagnostics, std::string_view text,
                                        const std::string& file);

// The warnings about a file that its comments do not allow, and nothing about the comments. All of
// them when the file cannot be read.
std::vector<Diagnostic> allowed_removed(std::vector<Diagnostic> diagnostics,
                                        const std::filesystem::path& file);

}  // namespace tagsmith::detail
