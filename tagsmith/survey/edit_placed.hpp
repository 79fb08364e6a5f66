// SPDX-License-Identifier: Apache-2.0
// Survey files that take over where tags were measured to hang.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/as_built_place.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The survey file's text with these tags in `placed`: their entries changed, or new ones added.
// The printed digits stay what they are, and so do comments and all else. A tag that was placed
// where it was designed, not measured, gets that place as its `design`. `survey`: what the text
// says. Fails where the file is laid out in a way that cannot be changed.
Result<std::string> survey_with_places(std::string_view text, const Survey& survey,
                                       const std::vector<AsBuiltPlace>& places);

}  // namespace tagsmith::detail
