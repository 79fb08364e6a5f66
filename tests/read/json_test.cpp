// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/json.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/verify/survey_of_four.hpp"

namespace tagsmith {

using nlohmann::json;
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

TEST_CASE("lines of verify") {
  FileReport report;
  report.file = "a.pdf";
  report.pages = 2;
  TagFinding good;
  good.tag = "000L";
  good.digits = parse_digits("019000000404");
  good.confidence = 1;
  good.page = 1;
  TagFinding bad;
  bad.status = TagStatus::unreadable;
  bad.page = 2;
  bad.message = "too small";
  report.tags = {good, bad};
  report.findings = {"page 2: too small"};
  const json line = json::parse(to_json_line(report));
  CHECK(line["file"] == "a.pdf");
  CHECK(line["pages"] == 2);
  CHECK(line["findings"] == json{"page 2: too small"});
  CHECK(line["tags"][0]["tag"] == "000L");
  CHECK(line["tags"][0]["status"] == "ok");
  CHECK(line["tags"][0]["digits"] == "019000000404");
  CHECK(line["tags"][0]["corners"].size() == 4);
  CHECK(line["tags"][0]["page"] == 1);
  CHECK(line["tags"][1]["tag"].is_null());
  CHECK(line["tags"][1]["digits"].is_null());
  CHECK(line["tags"][1]["status"] == "unreadable");
  CHECK(line["tags"][1]["message"] == "too small");

  VerifySummary summary;
  summary.files = 3;
  summary.ok = 2;
  summary.missing = {"001R"};
  const json last = json::parse(to_json_line(summary))["summary"];
  CHECK(last["files"] == 3);
  CHECK(last["ok"] == 2);
  CHECK(last["missing"] == json{"001R"});
}

TEST_CASE("a file name that is no UTF-8 still gives a line of JSON") {
  const ImageReadings readings{"\xff\xfe.jpg", 1, 1, {}, 0};
  CHECK(json::parse(to_json_line(readings, {}), nullptr, false)["image"] ==
        "\xef\xbf\xbd\xef\xbf\xbd.jpg");
}

}  // namespace tagsmith
