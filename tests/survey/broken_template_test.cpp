// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include <doctest/doctest.h>

#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/read_template.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

Diagnosed<TagTemplate> read_text_as_template(const std::string& text) {
  const TemporaryFolder folder;
  const auto reading = read_template(write_text(folder.path() / "t.yaml", text));
  REQUIRE(reading.has_value());
  return *reading;
}

const Breakage kTemplateErrors[] = {
    {"no name", "tag: trial\n", "", "missing-key", 1},
    {"no frame", "feature_frame:", "frame:", "missing-key", 1},
    {"name as a path", "tag: trial", "tag: ../trial", "bad-name", 1},
    {"plate of one number", "[0.400, 0.300]", "0.4", "wrong-type", 2},
    {"plate of centimetres", "[0.400, 0.300]", "[40, 30]", "out-of-range", 2},
    {"no stroke", ", stroke: 0.012", "", "missing-key", 3},
    {"quiet zone below GS1's", "quiet_zone: 9", "quiet_zone: 8", "out-of-range", 4},
    {"negative margin", "margin: 9", "margin: -1", "out-of-range", 4},
    {"margin that leaves low bars", "margin: 9", "margin: 27", "no-bars", 4},
    {"margin that leaves no bars", "margin: 9", "margin: 28", "no-bars", 4},
    {"frame longer than the plate", "inner: [0.343", "inner: [0.39", "frame-outside-plate", 3},
    {"frame pushed off the plate", "offset: [0, 0.02]", "offset: [0, 0.06]", "frame-outside-plate",
     3},
    {"a word for a truth value", "shown: true", "shown: yes", "wrong-type", 5},
    {"dots of no printer", "margin: 9", "margin: 9, dots_per_inch: 5", "out-of-range", 4},
    {"a hole on the frame", "tag: trial", "holes: { diameter_mm: 8, at: [[0, 0.1]] }\ntag: trial",
     "hole-misplaced", 1},
    {"a hole over the edge", "tag: trial", "holes: { diameter_mm: 8, inset_mm: 3 }\ntag: trial",
     "hole-misplaced", 1},
    {"a hole in the label", "tag: trial", "holes: { diameter_mm: 8, at: [[0, -0.14]] }\ntag: trial",
     "hole-misplaced", 1},
    {"holes nowhere", "tag: trial", "holes: { diameter_mm: 8 }\ntag: trial", "missing-key", 1},
    {"patches without room", "tag: trial", "patches: { size_mm: 90 }\ntag: trial",
     "no-room-for-patches", 1},
    {"a QR symbol without room", "tag: trial", "qr: { size_mm: 90 }\ntag: trial", "no-room-for-qr",
     1},
    {"a QR symbol of no size", "tag: trial", "qr: { content: \"{digits}\" }\ntag: trial",
     "missing-key", 1},
    {"a QR symbol of an unknown field", "tag: trial",
     "qr: { size_mm: 30, content: \"{digit}\" }\ntag: trial", "unknown-field", 1},
    {"a logo of no size", "tag: trial", "logo: { file: none.svg }\ntag: trial", "missing-key", 1},
    {"a field without an end", "text_height_mm: 8", "lines: [\"{name\"]", "unknown-field", 5},
    {"no lines", "text_height_mm: 8", "lines: []", "out-of-range", 5},
    {"corners rounder than the plate", "tag: trial", "cut: { corner_radius_mm: 200 }\ntag: trial",
     "corner-radius", 1},
    {"corners that cut the feature frame", "tag: trial",
     "cut: { corner_radius_mm: 140 }\ntag: trial", "corner-radius", 1},
    {"holes that rounded corners leave near the edge", "tag: trial",
     "cut: { corner_radius_mm: 20 }\nholes: { diameter_mm: 4, inset_mm: 6 }\ntag: trial",
     "hole-misplaced", 2},
    {"material as a list", "tag: trial", "material: [steel]\ntag: trial", "wrong-type", 1},
    {"a quiet zone wider than the symbol", "quiet_zone: 9", "quiet_zone: 96", "out-of-range", 4},
    {"text in metres", "text_height_mm: 8", "text_height_mm: 0.008", "out-of-range", 5},
    {"text of no height", "text_height_mm: 8", "text_height_mm: 0", "out-of-range", 5},
};

}  // namespace

TEST_CASE("the template that the others break is right") {
  const Diagnosed<TagTemplate> reading = read_text_as_template(right_template());
  CHECK_MESSAGE(reading.diagnostics.empty(), to_string(reading.diagnostics));
  REQUIRE(reading.value.has_value());
  CHECK(reading.value->frame_offset_up == 0.02);
  CHECK(reading.value->label.text_height == doctest::Approx(0.008));
}

TEST_CASE("every way to break a template is reported by its rule and line") {
  for (const Breakage& broken : kTemplateErrors) {
    CAPTURE(broken.name);
    const Diagnosed<TagTemplate> reading =
        read_text_as_template(replaced(right_template(), broken.from, broken.to));
    CHECK_FALSE(reading.value.has_value());
    CHECK_MESSAGE(count_findings(reading.diagnostics, broken.code, broken.line) >= 1,
                  to_string(reading.diagnostics));
  }
}

TEST_CASE("a logo that is not there is a warning: whoever reads photos needs none") {
  const Diagnosed<TagTemplate> reading =
      read_text_as_template("logo: { file: none.svg, size_mm: [40, 20] }\n" + right_template());
  CHECK(reading.value.has_value());
  CHECK(count_findings(reading.diagnostics, "no-logo", 1) == 1);
}

TEST_CASE("a stroke thinner than a module is a warning: such plates may hang") {
  const auto findings = [](const std::string& stroke) {
    return read_text_as_template(replaced(right_template(), "0.012", stroke)).diagnostics;
  };
  CHECK(count_findings(findings("0.003"), "thin-stroke", 3) == 1);
  CHECK_FALSE(has_errors(findings("0.003")));
  CHECK(findings("0.0031").empty());
}

TEST_CASE("bars near the frame are a warning: such plates may hang") {
  const auto findings = [](const std::string& margin) {
    return read_text_as_template(replaced(right_template(), "margin: 9", "margin: " + margin))
        .diagnostics;
  };
  CHECK(count_findings(findings("2.9"), "narrow-margin", 4) == 1);
  CHECK_FALSE(has_errors(findings("2.9")));
  CHECK(findings("3").empty());
}

TEST_CASE("holes, patches, cut and material are read; dots shrink the module to whole ones") {
  const std::string extras =
      "holes: { diameter_mm: 6, inset_mm: 8 }\npatches: { size_mm: 20 }\n"
      "cut: { contour: true, corner_radius_mm: 5 }\nmaterial: matt white\n";
  const Diagnosed<TagTemplate> reading = read_text_as_template(
      extras + replaced(right_template(), "margin: 9", "margin: 9, dots_per_inch: 300"));
  CHECK_MESSAGE(reading.diagnostics.empty(), to_string(reading.diagnostics));
  REQUIRE(reading.value.has_value());
  const TagTemplate& tag = *reading.value;
  REQUIRE(tag.holes.size() == 4);
  CHECK(tag.holes[0].right == doctest::Approx(-0.192));
  CHECK(tag.holes[0].up == doctest::Approx(0.142));
  CHECK(tag.patch_size == doctest::Approx(0.02));
  CHECK(tag.cut.contour);
  CHECK(tag.material == "matt white");
  CHECK(module_width(tag) == doctest::Approx(35 * 0.0254 / 300));
  CHECK(tag.frame_inner_length == 0.343);
}

TEST_CASE("a template is looked for as a path, beside the survey, then among the tool's own") {
  const TemporaryFolder folder;
  const auto own = find_template("tag-400x300", folder.path());
  REQUIRE(own.has_value());
  CHECK(*own == data_directory() / "templates/tag-400x300.yaml");
  const auto beside = write_text(folder.path() / "tag-400x300.yaml", right_template());
  CHECK(find_template("tag-400x300", folder.path()) == beside);
  CHECK(find_template("./tag-400x300.yaml", folder.path()).has_value());
  CHECK(find_template(beside.string(), "elsewhere") == beside);
  CHECK_FALSE(find_template("tag-1x1", folder.path()).has_value());
  CHECK_FALSE(find_template(std::string(5000, 'a'), folder.path()).has_value());
}

TEST_CASE("what is wrong with a survey's template is reported with the template's place") {
  const TemporaryFolder folder;
  write_text(folder.path() / "mine.yaml",
             replaced(right_template(), "quiet_zone: 9", "quiet_zone: 3"));
  const auto path =
      write_text(folder.path() / "survey.yaml", replaced(right_survey(), "tag-400x300", "mine"));
  const auto reading = read_survey(path);
  REQUIRE(reading.has_value());
  CHECK_FALSE(reading->value.has_value());
  REQUIRE(reading->diagnostics.size() == 1);
  CHECK(reading->diagnostics[0].file.ends_with("mine.yaml"));
  CHECK(reading->diagnostics[0].line == 4);
}

TEST_CASE("the data folder can be named by the environment") {
  const char* before = std::getenv("TAGSMITH_DATA");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TAGSMITH_DATA", "/somewhere/else", 1);
  CHECK(data_directory() == "/somewhere/else");
  if (before == nullptr) {
    unsetenv("TAGSMITH_DATA");
  } else {
    setenv("TAGSMITH_DATA", kept.c_str(), 1);
  }
  CHECK(std::filesystem::exists(data_directory() / "templates"));
}
