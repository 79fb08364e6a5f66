// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/survey_of_codes.hpp"

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"

namespace tagsmith::detail {

Result<Survey> survey_of_codes(const std::string& tag_template, double width) {
  const auto file = find_template(tag_template, ".");
  if (!file) {
    return fail(fmt::format("no template `{}`, expected a file or one of {}", tag_template,
                            own_templates()));
  }
  // The reader of surveys checks every value; the one tag is removed again.
  const std::string text = fmt::format(
      "survey: own-codes\n"
      "grid: {{ x_axis: left }}\n"
      "tunnel:\n"
      "  width: {}\n"
      "  height: 10\n"
      "  centerline: {{ start: [{}, 0, 0], heading: 0, elements: [ {{ line: 99.99 }} ] }}\n"
      "tags: {{ template: {}, height: 1, spacing: 1, first: 1, pairs: 1 }}\n"
      "code: {{ check_digit: sum10, resolution: 0.01 }}\n",
      width, width / 2, single_quoted(file->string()));
  Diagnosed<Survey> reading = read_survey_text("without a survey", text);
  if (!reading.value) return fail(to_string(reading.diagnostics, true));
  reading.value->tags.clear();
  return std::move(*reading.value);
}

std::string assumed_of_codes(double width) {
  return fmt::format(
      "no survey: tags are assumed to hang where their digits say, in centimetres, on two straight "
      "walls along y at x = 0 and x = {} m, x growing to the left of the drive",
      format_number(width, 3));
}

}  // namespace tagsmith::detail
