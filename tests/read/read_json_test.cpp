// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/read_json.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/json.hpp"
#include "tests/verify/survey_of_four.hpp"

namespace tagsmith::detail {

using nlohmann::json;
using test::parsed_json;
using test::reading_of;
using test::survey_of_four;

TEST_CASE("a line of read has exactly the agreed keys") {
  ImageReadings readings{"a.jpg", 1280, 960, {}, 12.34567};
  readings.result.tags = {reading_of("019000000404")};
  readings.result.tags[0].method = ReadingMethod::frame;
  readings.result.tags[0].confidence = 0.999999;
  readings.result.rejected = {{RejectionReason::guard_pattern, {}}};
  const std::string line = to_json_line(readings, {});
  CHECK(line ==
        R"({"image":"a.jpg","width":1280,"height":960,"tags":[{"digits":"019000000404",)"
        R"("check_digit":"sum10","position":[1.9,0.0,0.4],"corners":[[100.0,100.0],[443.0,100.0],)"
        R"([443.0,268.0],[100.0,268.0]],"module_px":3.035,"confidence":0.999999,)"
        R"("method":"frame"}],"rejected":[{"reason":"guard pattern","corners":[[0.0,0.0],)"
        R"([0.0,0.0],[0.0,0.0],[0.0,0.0]]}],"time_ms":12.346})");
}

TEST_CASE("the check digit that held is named") {
  Reading reading = reading_of("019000000404");
  CHECK(check_digit_name(reading) == "sum10");
  reading = reading_of("019000000408");
  CHECK(check_digit_name(reading) == "gs1");
  reading = reading_of("000005140404");
  CHECK(check_digit_name(reading) == "both");
  reading = reading_of("000005140405");
  CHECK(check_digit_name(reading) == "none");
}

TEST_CASE("a position is coded as the survey that has the tag says, else in centimetres") {
  const Digits digits = *parse_digits("019000000404");
  CHECK(coded_position(digits, {}) == GridPoint{1.9, 0.0, 0.4});
  Survey survey = survey_of_four();
  survey.code.resolution = {0.1, 0.1, 0.001};
  survey.code.origin = {100, -5, 0};
  CHECK(coded_position(digits, {survey}) == GridPoint{119.0, -5.0, 0.04});
  const Digits strange = *parse_digits("019001600401");
  CHECK(coded_position(strange, {survey}) == GridPoint{1.9, 1.6, 0.4});
}

TEST_CASE("a file name that is no UTF-8 still gives a line of JSON") {
  const ImageReadings readings{"\xff\xfe.jpg", 1, 1, {}, 0};
  CHECK(parsed_json(to_json_line(readings, {}))["image"] == "\xef\xbf\xbd\xef\xbf\xbd.jpg");
}

}  // namespace tagsmith::detail
