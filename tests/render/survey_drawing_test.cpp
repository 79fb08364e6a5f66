// SPDX-License-Identifier: Apache-2.0
// The drawing of a survey says what the survey says.
#include "tagsmith/render/survey_drawing.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/render/tag_text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

std::multiset<std::string> words_of(const std::vector<Sheet>& sheets) {
  std::multiset<std::string> words;
  for (const Sheet& sheet : sheets) {
    for (const SheetLayer& layer : sheet.layers) {
      for (const SheetItem& item : layer.items) {
        if (const auto* text = std::get_if<SheetText>(&item)) words.insert(text->text);
      }
    }
  }
  return words;
}

bool any_contains(const std::multiset<std::string>& words, const std::string& part) {
  return std::ranges::any_of(
      words, [&](const std::string& word) { return word.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("a survey's drawing names every tag with its code, and its angles and lengths") {
  struct Row {
    const char* file;
    const char* theta;
    const char* stagger;
    const char* width;
    const char* grid;
  };
  for (const Row& row :
       {Row{"corridor", "\u03b8 10.23\u00b0", "stagger 0.343", "W_T 1.9", "x to the left of +y"},
        Row{"corridor-table4", "\u03b8 11.89\u00b0", "stagger 0.4", "W_T 1.9",
            "x to the left of +y"},
        Row{"curved", "\u03b8 9.93\u00b0", "stagger 0.665", "W_T 3.8", "x to the right of +y"},
        Row{"drift", "\u03b8 9.12\u00b0", "stagger 0.662", "W_T 4.117", "x to the right of +y"}}) {
    CAPTURE(row.file);
    const std::string folder = std::string("surveys/") + row.file;
    const Survey survey = load_survey(folder + "/survey.yaml").value();
    const Rig rig = load_rig(folder + "/rig.yaml").value();
    const auto words = words_of(draw_survey(survey, rig, {.revision = "abc"}).value());
    for (const PlacedTag& tag : survey.tags) {
      CHECK(words.count(tag.name) >= 3);  // plan, wall, table
      CHECK(words.count(grouped_digits(survey.code, tag.digits)) == 1);
    }
    CHECK(words.count(row.width) == 2);  // the section and the pair from above agree
    for (const char* text : {row.theta, row.stagger, row.width, "P", "F", "Q", "P1", "P2", "abc"}) {
      CAPTURE(text);
      CHECK(words.contains(text));
    }
    CHECK(any_contains(words, row.grid));
    CHECK(any_contains(words, "left: alpha 3"));
  }
}

TEST_CASE("a drawing tells of regular pairs where there are some") {
  Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  const Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  const auto tells = [&] {
    return any_contains(words_of(draw_survey(survey, rig, {.revision = "abc"}).value()),
                        "Regular pairs");
  };
  CHECK(tells());
  survey.series->pairs = 0;
  CHECK_FALSE(tells());
}

TEST_CASE("draw writes the sheets, and nothing when the survey is wrong") {
  const TemporaryFolder folder;
  const std::string base = (folder.path() / "d").string();
  const ProgramOutput pdf = run_tagsmith(
      "draw surveys/curved/survey.yaml --rig surveys/curved/rig.yaml -o '" + base + ".pdf'");
  CHECK(pdf.exit_code == 0);
  CHECK(pdf.out == base + ".pdf\n");
  const ProgramOutput svg =
      run_tagsmith("draw surveys/corridor/survey.yaml --paper a4 -o '" + base + ".svg'");
  CHECK(svg.exit_code == 0);
  CHECK(svg.out.starts_with(base + "-1.svg\n" + base + "-2.svg\n"));
  CHECK(std::filesystem::exists(base + "-2.svg"));

  CHECK(run_tagsmith("draw surveys/absent.yaml -o '" + base + "-no.pdf'").exit_code == 2);
  const ProgramOutput dwg = run_tagsmith("draw surveys/curved/survey.yaml -o '" + base + ".dwg'");
  CHECK(dwg.exit_code == 2);
  CHECK(dwg.err.find("ends in .pdf, .svg or .png") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(base + "-no.pdf"));
  CHECK(run_tagsmith("draw --help").out.find("tagsmith draw surveys/corridor") !=
        std::string::npos);
}
