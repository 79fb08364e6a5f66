// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/report_command.hpp"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "decoder/cli/verify_lines.hpp"
#include "decoder/cli/verify_merge.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith {
namespace {

constexpr const char* kExample = R"(Example:
  tagsmith verify --json mine/survey.yaml photos > photos.jsonl
  tagsmith report mine/survey.yaml photos.jsonl --html report.html --csv report.csv

Lines of several runs are merged; a file that is in two of them counts once.
Exit: 0 every tag was seen and nothing is wrong, 1 otherwise, 2 a file could not be read.)";

struct Options {
  std::string survey;
  std::vector<std::string> files;
  std::string html;
  std::string csv;
};

// True when every tag was seen and there is no fault.
bool print_in_words(const Survey& survey, const VerifyMerge& merged) {
  std::string unseen;
  std::size_t seen = 0;
  for (const PlacedTag& tag : survey.tags) {
    const auto found = merged.tags.find(tag.name);
    const bool was_seen = found != merged.tags.end() && found->second.seen > 0;
    seen += was_seen ? 1 : 0;
    if (!was_seen) unseen += " " + tag.name;
  }
  fmt::print("{} files, {} of {} tags seen, {} faults\n", merged.files, seen, survey.tags.size(),
             merged.fault_count);
  if (!unseen.empty()) fmt::print("not seen:{}\n", unseen);
  return unseen.empty() && merged.fault_count == 0;
}

Result<void> write_outputs(const Options& options, const Survey& survey,
                           const VerifyMerge& merged) {
  if (!options.csv.empty()) {
    const Result<void> written = write_file(options.csv, report_csv(survey, merged));
    if (!written) return written;
  }
  if (options.html.empty()) return {};
  const Result<std::string> page = report_page(survey, merged);
  if (!page) return fail(page.error().message);
  return write_file(options.html, *page);
}

int run(const Options& options) {
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return report_failure("report", survey.error());
  const std::string revision = survey_revision(*survey);
  VerifyMerge merged;
  for (const std::string& file : options.files) {
    const Result<VerifyLineCounts> counts = read_verify_lines(
        file, [&](const VerifiedFile& verified) { merge(revision, verified, merged); });
    if (!counts) return report_failure("report", counts.error());
    if (counts->broken > 0) {
      fmt::print(stderr, "{}: {} lines are not of `verify --json` and left out\n", file,
                 counts->broken);
    }
  }
  if (merged.other_revisions > 0) {
    fmt::print(stderr, "{} files were verified against another state of the survey\n",
               merged.other_revisions);
  }
  if (const Result<void> written = write_outputs(options, *survey, merged); !written) {
    return report_failure("report", written.error());
  }
  return print_in_words(*survey, merged) ? kExitOk : kExitFindings;
}

}  // namespace

Command report_command(CLI::App& parent) {
  auto options = std::make_shared<Options>();
  CLI::App* app = parent.add_subcommand("report", "Merge what verify runs found into one report");
  app->add_option("survey", options->survey, "The survey")->required()->type_name("SURVEY");
  app->add_option("file", options->files, "Output of `verify --json`")
      ->required()
      ->type_name("FILE.jsonl");
  app->add_option("--html", options->html, "Write a web page that needs nothing else")
      ->type_name("FILE");
  app->add_option("--csv", options->csv, "Write a table of the tags")->type_name("FILE");
  app->footer(kExample);
  return {app, [options] { return run(*options); }};
}

}  // namespace tagsmith
