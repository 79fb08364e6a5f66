// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/survey_drawing.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tagsmith/survey/rig.hpp"

namespace tagsmith::detail {
namespace {

struct DrawOptions {
  std::vector<std::string> surveys;
  std::string rig;
  std::string output;
  Paper paper = Paper::a3;
};

// The files of the drawing are named when its sheets have been counted, and written last.
Result<void> check_files(const std::vector<Survey>& surveys, const std::optional<Rig>& rig,
                         const std::vector<SheetFile>& drawing) {
  CommandFiles files;
  for (const Survey& survey : surveys) files.reads(survey);
  if (rig) files.reads(*rig);
  for (const SheetFile& sheet : drawing) files.writes(sheet.path, "--output");
  return files.check();
}

// Of several surveys first the plan of all, then the sheets of each.
Result<std::vector<Sheet>> all_sheets(const std::vector<Survey>& surveys,
                                      const std::optional<Rig>& rig, Paper paper) {
  std::vector<Sheet> all;
  if (surveys.size() > 1) {
    auto together = draw_together(surveys, paper);
    if (!together) return together;
    all = std::move(*together);
  }
  for (const Survey& survey : surveys) {
    auto sheets = draw_survey(survey, rig, {paper, survey_revision(survey)});
    if (!sheets) return sheets;
    std::ranges::move(*sheets, std::back_inserter(all));
  }
  return all;
}

Result<int> draw(const DrawOptions& options) {
  if (!sheet_format_of(options.output)) {
    return fail("--output " + options.output + ": expected a name that ends in .pdf, .svg or .png");
  }
  if (!has_glyphs("0")) return fail("no font on this machine: install fonts-dejavu-core");
  const Result<std::vector<Survey>> surveys =
      load_surveys({options.surveys.begin(), options.surveys.end()});
  if (!surveys) return fail(surveys);
  std::optional<Rig> rig;
  if (!options.rig.empty()) {
    Result<Rig> loaded = load_rig(options.rig);
    if (!loaded) return fail(loaded);
    rig = std::move(*loaded);
  }
  const auto sheets = all_sheets(*surveys, rig, options.paper);
  if (!sheets) return fail(sheets);
  const auto files = render_sheets(*sheets, options.output);
  if (!files) return fail(files);
  if (auto usable = check_files(*surveys, rig, *files); !usable) return fail(usable);
  if (auto written = publish_files(*files); !written) return fail(written);
  for (const SheetFile& file : *files) to_stdout("{}\n", file.path.string());
  for (const Survey& survey : *surveys) {
    if (survey.tags.size() <= kMostListedTags) continue;
    to_stderr(
        "tagsmith draw: {} tags are drawn but not listed; for a list: tagsmith export {} -o "
        "tags.csv\n",
        survey.tags.size(), shell_word(survey.file.string()));
  }
  return kExitOk;
}

}  // namespace

Command draw_command() {
  const auto options = std::make_shared<DrawOptions>();
  return {
      .name = "draw",
      .summary = "What a survey means: plan, walls, section, theta, plates, table of tags",
      .options = {survey_argument(&options->surveys,
                                  "Survey file (YAML); several are drawn in one plan first"),
                  rig_option(&options->rig, "Rig file (YAML): draws the vehicle's cameras too"),
                  required(file_option(
                      "-o,--output", &options->output,
                      "FILE.pdf, or FILE.svg or FILE.png: several sheets are FILE-1, FILE-2 ...")),
                  drawing_paper_option("--paper", options->paper,
                                       "Paper, landscape (default: a3)")},
      .notes =
          "Compare the drawing with the tunnel before anything is printed. It is to scale: print "
          "it at 100 %. The plan is never mirrored; a grid whose x grows to the left shows so in "
          "its axes.\n\n"
          "Example:\n"
          "  tagsmith draw surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml \\\n"
          "    -o out/corridor.pdf",
      .run = [options] { return draw(*options); },
  };
}

}  // namespace tagsmith::detail
