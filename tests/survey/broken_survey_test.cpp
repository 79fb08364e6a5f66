// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

Diagnosed<Survey> read_text_as_survey(const std::string& text) {
  const TemporaryFolder folder;
  const auto reading = read_survey(write_text(folder.path() / "survey.yaml", text));
  REQUIRE(reading.has_value());
  return *reading;
}

const Breakage kSurveyErrors[] = {
    {"unknown key", "spacing:", "spaceing:", "unknown-key", 15},
    {"missing key", "  height: 3.0\n", "", "missing-key", 3},
    {"missing section", "tunnel:", "tunel:", "missing-key", 1},
    {"repeated key", "  height: 3.0\n", "  height: 3.0\n  height: 3.1\n", "duplicate-key", 6},
    {"text for a number", "width: 4.0", "width: wide", "wrong-type", 4},
    {"quoted number", "width: 4.0", "width: \"4.0\"", "wrong-type", 4},
    {"unit behind a number", "width: 4.0", "width: 4.0 m", "wrong-type", 4},
    {"hexadecimal", "width: 4.0", "width: 0x4", "wrong-type", 4},
    {"decimal comma", "width: 4.0", "width: 4,0", "decimal-comma", 4},
    {"leading zero", "pairs: 4", "pairs: 04", "leading-zero", 17},
    {"plates askew by a right angle", "pairs: 4", "pairs: 4\n  angle_sigma: 90", "out-of-range",
     18},
    {"infinity", "width: 4.0", "width: .inf", "not-finite", 4},
    {"not a number", "width: 4.0", "width: .nan", "not-finite", 4},
    {"more than a double holds", "width: 4.0", "width: 1e999", "wrong-type", 4},
    {"nothing for a number", "width: 4.0", "width:", "wrong-type", 4},
    {"list for a number", "width: 4.0", "width: [4.0]", "wrong-type", 4},
    {"number for a map", "grid: { x_axis: right }", "grid: 3", "wrong-type", 2},
    {"number for text", "survey: trial", "survey: 12", "wrong-type", 1},
    {"name with a slash", "survey: trial", "survey: a/b", "bad-name", 1},
    {"name of blanks", "survey: trial", "survey: \"  \"", "bad-text", 1},
    {"a quote without an end", "survey: trial", "survey: \"trial", "open-quote", 1},
    {"a quote closed by the next one", "survey: trial\ngrid: { x_axis: right }",
     "survey: \"trial\ngrid: { x_axis: \"right\" }", "open-quote", 1},
    {"negative spacing", "spacing: 0.6", "spacing: -2", "out-of-range", 15},
    {"zero width", "width: 4.0", "width: 0", "out-of-range", 4},
    {"huge width", "width: 4.0", "width: 1e300", "out-of-range", 4},
    {"short list", "[10.0, 20.0, 0.0]", "[10.0, 20.0]", "wrong-length", 7},
    {"comma in a list", "[10.0, 20.0, 0.0]", "[10,0, 20.0, 0.0]", "wrong-length", 7},
    {"word in a list", "[10.0, 20.0, 0.0]", "[10.0, 20.0, floor]", "wrong-type", 7},
    {"axis misspelt", "x_axis: right", "x_axis: rihgt", "bad-choice", 2},
    {"turn misspelt", "turn: left", "turn: lef", "bad-choice", 11},
    {"line and arc", "{ line: 12.0 }", "{ line: 12.0, arc: 9 }", "bad-element", 10},
    {"neither line nor arc", "{ line: 12.0 }", "{ grade: 2 }", "bad-element", 10},
    {"clothoid without a bend", "{ line: 12.0 }", "{ clothoid: 12, turn: left }", "bad-element",
     10},
    {"clothoid of one radius", "{ line: 12.0 }",
     "{ clothoid: 12, turn: left, from_radius: 9, to_radius: 9 }", "bad-element", 10},
    {"clothoid round and round", "{ line: 12.0 }", "{ clothoid: 900, turn: left, to_radius: 9 }",
     "bad-element", 10},
    {"clothoid of two radii round and round", "{ line: 12.0 }",
     "{ clothoid: 200, turn: left, from_radius: 21, to_radius: 20 }", "bad-element", 10},
    {"clothoid tighter than its wall", "{ line: 12.0 }",
     "{ clothoid: 2, turn: left, to_radius: 0.5 }", "tight-arc", 10},
    {"angle of a clothoid", "{ line: 12.0 }",
     "{ clothoid: 12, turn: left, to_radius: 9, angle: 9 }", "conflicting-keys", 10},
    {"radius of a line", "{ line: 12.0 }", "{ line: 12.0, to_radius: 9 }", "conflicting-keys", 10},
    {"angle of a line", "{ line: 12.0 }", "{ line: 12.0, angle: 5 }", "conflicting-keys", 10},
    {"arc tighter than the walls", "arc: 20.0", "arc: 1.9", "tight-arc", 11},
    {"no elements",
     "      - { line: 12.0 }\n      - { arc: 20.0, turn: left, angle: 30, grade: 1 }", "      []",
     "wrong-length", 10},
    {"unknown template", "template: tag-400x300", "template: tag-400x30", "no-template", 13},
    {"pairs and to", "pairs: 4", "pairs: 4\n  to: 9", "conflicting-keys", 18},
    {"a fraction of pairs", "pairs: 4", "pairs: 4.5", "wrong-type", 17},
    {"a thousand million pairs", "pairs: 4", "pairs: 1000000000", "out-of-range", 17},
    {"too many pairs by to", "pairs: 4", "to: 900000", "too-many-tags", 17},
    {"to before first", "pairs: 4", "to: 0.5", "out-of-range", 17},
    {"theta beyond 80", "pairs: 4", "pairs: 4\n  theta: 85", "out-of-range", 18},
    {"theta of nothing", "pairs: 4", "pairs: 4\n  theta: 0", "out-of-range", 18},
    {"theta in radians", "pairs: 4", "pairs: 4\n  theta: 0.0855", "theta", 18},
    {"no check digit", "check_digit: gs1, ", "", "missing-key", 19},
    {"other check digit", "check_digit: gs1", "check_digit: ean13", "bad-choice", 19},
    {"zero resolution", "resolution: 0.01", "resolution: 0", "out-of-range", 19},
    {"two resolutions", "resolution: 0.01", "resolution: [0.1, 0.1]", "wrong-length", 19},
    {"ten digits", "digits: [4, 4, 3]", "digits: [4, 4, 2]", "bad-digit-counts", 19},
    {"half a digit", "digits: [4, 4, 3]", "digits: [4.5, 3.5, 3]", "bad-digit-counts", 19},
    {"no digits for z", "digits: [4, 4, 3]", "digits: [4, 7, 0]", "out-of-range", 19},
    {"positions beyond the code", "origin: [0, 0, -1]", "origin: [0, 21.5, -1]", "code-range", 19},
    {"a code too coarse", "resolution: 0.01", "resolution: 5", "code-collision", 19},
    {"roof", "height: 1.4", "height: 3.1", "outside-tunnel", 14},
    {"floor", "height: 1.4", "height: 0.1", "outside-tunnel", 14},
    {"before the start", "first: 1.0", "first: -3.0", "outside-tunnel", 16},
    {"beyond the end", "pairs: 4", "pairs: 40", "outside-tunnel", 17},
    {"surveyed plate in the roof", "p: [12.0, 22.4, 1.4]", "p: [12.0, 22.4, 3.2]", "outside-tunnel",
     21},
    {"surveyed on a neighbour", "p: [12.0, 22.4, 1.4]", "p: [12.0, 21.5, 1.4]", "overlap", 21},
    {"behind the wall", "p: [12.0, 22.4, 1.4]", "p: [12.2, 22.4, 1.4]", "off-wall", 21},
    {"x and y swapped", "p: [12.0, 22.4, 1.4]", "p: [8.0, 22.4, 1.4]", "wrong-side", 21},
    {"side against name", "tag: 001R, side: right", "tag: 001R, side: left", "side-mismatch", 21},
    {"short name", "tag: 001R", "tag: 1R", "bad-tag-name", 21},
    {"name without side", "tag: 001R", "tag: 001", "bad-tag-name", 21},
    {"huge pair", "tag: 001R", "tag: 99999999999R", "bad-tag-name", 21},
    {"a tag twice", "tag: 004L, side: left", "tag: 001R, side: right", "duplicate-tag", 22},
    {"wrong check digit", "000000000017", "000000000018", "wrong-check-digit", 22},
    {"ten printed digits", "000000000017", "0000000000", "bad-digits", 22},
    {"letters for digits", "000000000017", "00000000001x", "bad-digits", 22},
    {"digits as a number", "\"000000000017\"", "000000000017", "bad-digits", 22},
    {"alias", "survey: trial", "survey: &a trial", "alias", 2},
    {"merge key", "grid: { x_axis: right }", "grid: { <<: 1, x_axis: right }", "merge-key", 2},
    {"tag of YAML", "survey: trial", "survey: !!python/object trial", "yaml-tag", 1},
    {"list as a key", "grid:", "? [a]\n: 3\ngrid:", "complex-key", 2},
    {"open bracket", "{ x_axis: right }", "{ x_axis: right", "syntax", 3},
    {"tabs", "  width: 4.0", "\twidth: 4.0", "syntax", 4},
    {"two documents", "tags:\n", "---\ntags:\n", "several-documents", 12},
    {"control character", "survey: trial",
     "survey: tri\x01"
     "al",
     "not-utf-8", 1},
    {"Latin-1", "survey: trial", "survey: tri\xE9l", "not-utf-8", 1},
};

}  // namespace

TEST_CASE("the survey that the others break is right") {
  const Diagnosed<Survey> reading = read_text_as_survey(right_survey());
  CHECK_MESSAGE(reading.diagnostics.empty(), to_string(reading.diagnostics));
  REQUIRE(reading.value.has_value());
  CHECK(reading.value->tags.size() == 9);
}

TEST_CASE("every way to break a survey is reported by its rule and line, with a place") {
  for (const Breakage& broken : kSurveyErrors) {
    CAPTURE(broken.name);
    std::string text = replaced(right_survey(), broken.from, broken.to);
    if (broken.name == "alias") text = replaced(text, "{ x_axis: right }", "*a");
    const Diagnosed<Survey> reading = read_text_as_survey(text);
    CHECK_FALSE(reading.value.has_value());
    CHECK_MESSAGE(count_findings(reading.diagnostics, broken.code, broken.line) >= 1,
                  to_string(reading.diagnostics));
    CHECK(has_errors(reading.diagnostics));
  }
}

TEST_CASE("a survey that is only odd is warned about and kept") {
  const Breakage warnings[] = {
      {"theta that staggers", "pairs: 4", "pairs: 4\n  theta: 6", "theta", 18},
      {"in front of the wall", "p: [12.0, 22.4, 1.4]", "p: [11.8, 22.4, 1.4]", "off-wall", 21},
      {"sigma in centimetres", "p: [12.0, 22.4, 1.4]", "sigma: 0.2, p: [12.0, 22.4, 1.4]",
       "large-sigma", 21},
      {"coarse code", "resolution: 0.01", "resolution: 0.05", "coarse-code", 19},
  };
  for (const Breakage& odd : warnings) {
    CAPTURE(odd.name);
    const Diagnosed<Survey> reading =
        read_text_as_survey(replaced(right_survey(), odd.from, odd.to));
    CHECK_MESSAGE(reading.value.has_value(), to_string(reading.diagnostics));
    CHECK(count_findings(reading.diagnostics, odd.code, odd.line) == 1);
    CHECK_FALSE(has_errors(reading.diagnostics));
  }
}

TEST_CASE("several errors are reported in one run, in the file's order") {
  std::string text = right_survey();
  text = replaced(text, "width: 4.0", "width: 4,0");
  text = replaced(text, "spacing:", "spaceing:");
  text = replaced(text, "digits: [4, 4, 3]", "digits: [4, 4, 2]");
  text = replaced(text, "000000000017", "000000000018");
  text = replaced(text, "turn: left", "turn: up");
  const Diagnosed<Survey> reading = read_text_as_survey(text);
  CHECK(count_findings(reading.diagnostics, "decimal-comma", 4) == 1);
  CHECK(count_findings(reading.diagnostics, "bad-choice", 11) == 1);
  CHECK(count_findings(reading.diagnostics, "unknown-key", 15) == 1);
  CHECK(count_findings(reading.diagnostics, "bad-digit-counts", 19) == 1);
  CHECK(count_findings(reading.diagnostics, "wrong-check-digit", 22) == 1);
  int line = 0;
  for (const Diagnostic& finding : reading.diagnostics) {
    CHECK(finding.line >= line);
    line = finding.line;
  }
}

TEST_CASE("a finding says place, what was found, what is expected and how to mend it") {
  const Diagnosed<Survey> reading =
      read_text_as_survey(replaced(right_survey(), "spacing:", "spaceing:"));
  REQUIRE(count_findings(reading.diagnostics, "unknown-key") == 1);
  for (const Diagnostic& finding : reading.diagnostics) {
    if (finding.code != "unknown-key") continue;
    CHECK(finding.line == 15);
    CHECK(finding.column == 3);
    CHECK(finding.message.find("`spaceing`") != std::string::npos);
    REQUIRE(finding.fix);
    CHECK(finding.fix->found == "spaceing");
    CHECK(finding.hint == "did you mean `spacing`?");
  }
  const Diagnosed<Survey> negative =
      read_text_as_survey(replaced(right_survey(), "spacing: 0.6", "spacing: -2"));
  REQUIRE(negative.diagnostics.size() == 1);
  CHECK(negative.diagnostics[0].message ==
        "tags.spacing is -2, expected more than 0 and at most 100000 m");
  CHECK(negative.diagnostics[0].column == 12);
  const Diagnosed<Survey> without_count = read_text_as_survey(
      replaced(replaced(right_survey(), "spacing: 0.6", "spacing: -2"), "pairs: 4", "to: 6"));
  CHECK(without_count.diagnostics.size() == 1);
}

TEST_CASE("regular tags that share a fault are reported once, with their number") {
  const Diagnosed<Survey> reading =
      read_text_as_survey(replaced(right_survey(), "pairs: 4", "pairs: 500"));
  CHECK(count_findings(reading.diagnostics, "outside-tunnel") == 1);
  CHECK(to_string(reading.diagnostics).find("499R") != std::string::npos);
}

TEST_CASE("a code out of range comes with an origin that mends it") {
  std::string text =
      replaced(right_survey(), "start: [10.0, 20.0, 0.0]", "start: [10.0, 7020.0, 0.0]");
  text = replaced(text, "p: [12.0, 22.4, 1.4]", "p: [12.0, 7022.4, 1.4]");
  text = replaced(text, "p: [8.0, 25.0, 1.4]", "p: [8.0, 7025.0, 1.4]");
  const Diagnosed<Survey> reading = read_text_as_survey(text);
  REQUIRE(count_findings(reading.diagnostics, "code-range") >= 1);
  CHECK(to_string(reading.diagnostics).find("7021") != std::string::npos);
  const Diagnosed<Survey> mended =
      read_text_as_survey(replaced(text, "origin: [0, 0, -1]", "origin: [0, 7021, -1]"));
  CHECK_MESSAGE(mended.value.has_value(), to_string(mended.diagnostics));
}

TEST_CASE("surveys together must have codes and names of their own") {
  const TemporaryFolder folder;
  const auto a = write_text(folder.path() / "a.yaml", right_survey());
  const auto b = write_text(folder.path() / "b.yaml", right_survey());
  const auto c = write_text(folder.path() / "c.yaml",
                            replaced(replaced(right_survey(), "survey: trial", "survey: other"),
                                     "origin: [0, 0, -1]", "origin: [-30, 0, -1]"));
  const auto same = load_surveys({a, b});
  REQUIRE_FALSE(same.has_value());
  CHECK(same.error().message.find("[code-collision]") != std::string::npos);
  CHECK(same.error().message.find("[duplicate-survey]") != std::string::npos);
  const auto printed_twice = load_surveys({a, c});  // both have the printed digits of 004L
  REQUIRE_FALSE(printed_twice.has_value());
  CHECK(printed_twice.error().message.find("000000000017") != std::string::npos);
  CHECK(printed_twice.error().message.find("[duplicate-survey]") == std::string::npos);
}

TEST_CASE("load_survey says all errors of the file in one message") {
  const TemporaryFolder folder;
  const auto path = write_text(folder.path() / "survey.yaml", "survey: x\ntunel: 3\n");
  const auto survey = load_survey(path);
  REQUIRE_FALSE(survey.has_value());
  for (const char* part : {"survey.yaml:2:1: error: unknown key `tunel`", "`tunnel` is missing",
                           "`tags` is missing", "`code` is missing"}) {
    CHECK_MESSAGE(survey.error().message.find(part) != std::string::npos, survey.error().message);
  }
  CHECK_FALSE(load_survey(folder.path() / "absent.yaml").has_value());
  CHECK_FALSE(load_survey(folder.path()).has_value());
}
