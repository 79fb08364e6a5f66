// SPDX-License-Identifier: Apache-2.0
// Tags whose digits say where another tag hangs. Internal to tagsmith/survey.
#pragma once

#include <span>

#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Logs a warning for each tag of the survey whose digits code the place of another tag, clearly
// nearer than its own by more than the code's resolution. The other tags are those of `among`; of
// several surveys `survey` itself is left out, since it has been looked at alone.
void lint_exchanged_codes(const Survey& survey, std::span<const Survey> among, FindingLog& log);

}  // namespace tagsmith::detail
