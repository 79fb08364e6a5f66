// SPDX-License-Identifier: Apache-2.0
// Surveys that are read together.
#pragma once

#include <span>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// ---- Tags whose digits say where another tag hangs. Internal to tagsmith/survey.

// Logs a warning for each tag of the survey whose digits code the place of another tag, clearly
// nearer than its own by more than the code's resolution. The other tags are those of `among`; of
// several surveys `survey` itself is left out, since it has already been checked alone.
void lint_exchanged_codes(const Survey& survey, std::span<const Survey> among, FindingLog& log);

// ---- Several surveys.

// Findings about several surveys together: equal codes, equal survey names, plates of two colours.
std::vector<Diagnostic> check_together(const std::vector<Survey>& surveys);

// Fails where positions in them cannot be combined: grids whose x grows to opposite sides, or that
// are named and not the same.
Result<void> check_one_grid(const std::vector<Survey>& surveys);

}  // namespace tagsmith::detail
