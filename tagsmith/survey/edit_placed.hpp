// SPDX-License-Identifier: Apache-2.0
// Updates of survey files with the measured places of tags.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/as_built_place.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The survey file's text with these tags in `placed`: their entries changed, or new ones added. The
// printed digits stay unchanged, and so do comments and all else. A tag that was placed where it
// was designed, not measured, gets that place as its `design`. `survey`: the content of the text.
// Fails where the layout of the file does not allow the change.
Result<std::string> survey_with_places(std::string_view text, const Survey& survey,
                                       const std::vector<AsBuiltPlace>& places);

}  // namespace tagsmith::detail
