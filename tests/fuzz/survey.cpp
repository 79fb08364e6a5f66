// SPDX-License-Identifier: Apache-2.0
// Surveys: what is read without errors is also listed and drawn into points.
#include "tagsmith/cli/tag_list.hpp"
#include "tagsmith/survey/check_together.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Diagnosed<Survey> reading =
      read_survey_text("surveys/corridor/fuzz.yaml", fuzz::as_text(data, size));
  if (!reading.value) return 0;
  tags_csv(*reading.value);
  tags_json(*reading.value);
  check_together({*reading.value, *reading.value});
  return 0;
}
