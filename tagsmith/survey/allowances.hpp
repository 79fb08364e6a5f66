// SPDX-License-Identifier: Apache-2.0
// Comments in a file that allow what a rule warns of, each with its reason. Internal to
// tagsmith/survey.
#pragma once

#include <string_view>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"

namespace tagsmith {

// Removes the warnings about `file` that a comment `# tagsmith: allow RULE: REASON` in its text
// allows: on the line of the finding, on a line of its own before it, or anywhere for a finding
// about the whole file. Errors stay. Adds a finding for each such comment that names no rule, gives
// no reason, or allows nothing.
std::vector<Diagnostic> without_allowed(std::vector<Diagnostic> diagnostics, std::string_view text,
                                        const std::string& file);

}  // namespace tagsmith
