// SPDX-License-Identifier: Apache-2.0
// Files taken for another kind of file. Internal to tagsmith/survey.
#pragma once

#include <string_view>

#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/yaml_document.hpp"

namespace tagsmith::detail {

// Whether a file whose first key should be `key` (survey, rig, tag or board) is of another
// kind. Then that is logged, as one error instead of one for each of its keys.
bool is_other_kind(const YamlNode& root, std::string_view key, FindingLog& log);

}  // namespace tagsmith::detail
