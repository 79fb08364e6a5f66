// SPDX-License-Identifier: Apache-2.0
// A survey of four tags, made without files.
#pragma once

#include <string>
#include <vector>

#include "decoder/reader/reading.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail::test {

// Tags 000L, 000R, 001L, 001R of a survey "little" with check digit sum10. Of the plates
// the feature frame has a size and nothing else.
inline Survey survey_of_four() {
  Survey survey;
  survey.name = "little";
  survey.code.check = CheckDigit::sum10;
  survey.tag_template.name = "tag-400x300";
  survey.tag_template.frame_inner_length = 0.343;
  survey.tag_template.frame_inner_height = 0.168;
  const std::vector<std::pair<std::string, std::string>> tags{{"000L", "019000000404"},
                                                              {"000R", "000000340401"},
                                                              {"001L", "019000800402"},
                                                              {"001R", "000001140400"}};
  for (const auto& [name, digits] : tags) {
    PlacedTag tag;
    tag.name = name;
    tag.digits = *parse_digits(digits);
    survey.tags.push_back(tag);
  }
  return survey;
}

// A reading of these digits whose corners are a 343 x 168 pixel rectangle at (x, 100).
inline Reading reading_of(const std::string& digits, double x = 100) {
  Reading reading;
  reading.digits = *parse_digits(digits);
  reading.sum10_holds = has_check_digit(CheckDigit::sum10, reading.digits);
  reading.gs1_holds = has_check_digit(CheckDigit::gs1, reading.digits);
  reading.corners = {{{x, 100}, {x + 343, 100}, {x + 343, 268}, {x, 268}}};
  reading.module_px = 343.0 / 113;
  reading.confidence = 1;
  return reading;
}

}  // namespace tagsmith::detail::test
