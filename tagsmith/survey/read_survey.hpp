// SPDX-License-Identifier: Apache-2.0
// Survey files: reading, and all problems found in one pass.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Fails only when the file cannot be read at all; whatever is wrong inside it is a diagnostic.
// Templates are looked for beside the survey, then among the tool's own, or are a path.
Result<Diagnosed<Survey>> read_survey(const std::filesystem::path& path);

// The same for text that is or will be the content of the file at `path`.
Diagnosed<Survey> read_survey_text(const std::filesystem::path& path, std::string_view text);

// For commands that need a valid survey: the survey, or all its errors in one message.
Result<Survey> load_survey(const std::filesystem::path& path);

// As load_survey for each path; codes must be unique over all of them.
Result<std::vector<Survey>> load_surveys(const std::vector<std::filesystem::path>& paths);

}  // namespace tagsmith::detail
