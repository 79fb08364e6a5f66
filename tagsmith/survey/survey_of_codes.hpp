// SPDX-License-Identifier: Apache-2.0
// A tunnel of which nothing is known except what its tags carry: their own coordinates.
#pragma once

#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A survey without tags in the frame of Xu et al. 2017: two straight walls along +y, the right one
// at x = 0, the left one at x = width (metres), the floor at z = 0, digits in centimetres. Its tags
// hang where their digits say. `tag_template`: name or file, as `tags.template` in surveys. Fails
// with words for the user where the template cannot be used.
Result<Survey> survey_of_codes(const std::string& tag_template, double width);

// The assumptions of this survey, a sentence for the user.
std::string assumed_of_codes(double width);

}  // namespace tagsmith::detail
