// SPDX-License-Identifier: Apache-2.0
// Surveys that are read together.
#pragma once

#include <vector>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Findings about several surveys together: equal codes, equal survey names, plates of two colours.
std::vector<Diagnostic> check_together(const std::vector<Survey>& surveys);

// Fails where positions in them cannot be given together: grids whose x grows to opposite sides, or
// that are named and not the same.
Result<void> check_one_grid(const std::vector<Survey>& surveys);

}  // namespace tagsmith::detail
