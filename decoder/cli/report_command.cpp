// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <unordered_set>

#include <fmt/core.h>

#include "decoder/cli/commands.hpp"
#include "decoder/cli/report_files.hpp"
#include "decoder/cli/report_ledger.hpp"
#include "decoder/cli/verify_hanging.hpp"
#include "decoder/verify/verify_json.hpp"
#include "decoder/verify/verify_merge.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kReportNotes = R"(Example:
  tagsmith verify --json --crops crops mine/survey.yaml photos > photos.jsonl
  tagsmith report mine/survey.yaml photos.jsonl --html report.html --pdf report.pdf

Lines of several runs are merged; a file that is in two of them counts once. With --rig, or by
photos that name their lens (EXIF, as phones do) where no line says it yet, tags that are seen
together are checked for where they hang, by all photos of all runs at once.

With --ledger the lines are entered in it, and the report is of all photos that it has: what to print
again, clean, rehang and look for, what its trend will need when, and what was mended.
Exit: 0 every tag was seen and nothing is wrong, 1 otherwise (with --ledger: 0 nothing is to be done
now, 1 something is), 2 a file could not be read.)";

struct ReportOptions {
  std::string survey;
  std::vector<std::string> files;
  ReportFiles report;
  HangingOptions hanging;
  std::string ledger;  // empty = from these lines alone
  bool json = false;
};

void print_in_words(const Completeness& covered, const VerifyMerge& merged) {
  constexpr std::size_t kMostStretches = 40;
  constexpr std::size_t kMostNotes = 20;
  to_stdout("{}, {} of {} tags seen, {}\n", counted(merged.files, "file"), covered.seen,
            covered.tags, counted(merged.fault_count, "fault"));
  for (const std::string& line : completeness_words(covered, kMostStretches)) {
    to_stdout("{}\n", line);
  }
  for (const std::string& line : unchecked_and_notes_words(covered, merged, kMostNotes)) {
    to_stdout("{}\n", line);
  }
}

// All lines of all files, in turn; fails where there is no whole line. `report`: says how many
// lines were left out.
Result<void> read_all(const ReportOptions& options, const std::function<void(VerifiedFile)>& take,
                      bool report = false) {
  std::size_t read = 0;
  for (const std::string& file : options.files) {
    const Result<VerifyLineCounts> counts = read_own_lines(file, take);
    if (!counts) return fail(counts);
    if (report) report_broken_lines(file, *counts);
    read += counts->files;
  }
  if (read == 0) return fail(options.files.front() + ": has no whole line of `verify --json`");
  return {};
}

// Whether a line shows where a tag hangs.
Result<bool> any_shows_hanging(const ReportOptions& options) {
  bool shows = false;
  const auto read = read_all(options, [&](const VerifiedFile& line) {
    shows = shows || std::ranges::any_of(
                         line.tags, [](const VerifiedTag& tag) { return tag.hung.has_value(); });
  });
  if (!read) return fail(read);
  return shows;
}

// What a line says of its tags is valid for the state of the survey that it was verified against.
// For any other state the code that was read identifies the tag.
void judge_by_codes(const Survey& survey, VerifiedFile& line) {
  for (VerifiedTag& tag : line.tags) {
    if (!tag.digits) continue;
    const PlacedTag* same = find_tag(survey, *tag.digits);
    tag.tag = same != nullptr ? same->name : "";
    tag.hung.reset();
    const TagStatus status = tag.finding.status;
    // From places that may have changed since.
    const bool is_of_place = status == TagStatus::misplaced ||
                             (status == TagStatus::doubtful && !tag.finding.doubts_up());
    if (is_of_place || (same != nullptr && status == TagStatus::unknown)) tag.finding = {};
    if (same != nullptr || status == TagStatus::unknown) continue;
    tag.finding = {TagStatus::unknown, "not-in-survey",
                   fmt::format("{} is not in survey {}", to_string(*tag.digits), survey.name)};
  }
}

Result<VerifyMerge> merge_all(const ReportOptions& options, const Survey& survey,
                              const std::optional<LoadedHanging>& hanging,
                              const std::optional<HungTags>& hung, CommandFiles& files) {
  const std::string revision = survey_revision(survey);
  // A file that was verified again replaces the result for an earlier state of the survey.
  std::unordered_set<std::size_t> current;
  const auto content_of = [](const VerifiedFile& line) {
    return std::hash<std::string>{}(identity_of(line));
  };
  const Result<void> looked = read_all(options, [&](const VerifiedFile& line) {
    if (line.revision == revision) current.insert(content_of(line));
  });
  if (!looked) return fail(looked);
  VerifyMerge merged;
  if (hung) merged.hanging_remarks = remarks_of(*hung);
  const auto add = [&](VerifiedFile line) {
    if (line.revision != revision) {
      if (current.contains(content_of(line))) return;
      judge_by_codes(survey, line);
    }
    if (hanging) judge_hanging(survey, hanging->setup, *hung, line);
    merge(revision, std::move(line), merged);
  };
  const Result<void> read = read_all(options, add, true);
  if (!read) return fail(read);
  if (merged.other_revisions > 0) {
    to_stderr("{} verified against another state of the survey: verify again\n",
              merged.other_revisions == 1 ? "1 file was"
                                          : fmt::format("{} files were", merged.other_revisions));
  }
  finish(merged);
  if (options.report.shows_pictures()) load_pictures(merged, options.files, files);
  return merged;
}

Result<int> run(const ReportOptions& options) {
  if (!options.ledger.empty()) {
    return report_ledger(
        {options.survey, options.files, options.ledger, options.report.html, options.json});
  }
  if (options.files.empty()) return fail("FILE.jsonl is required, or --ledger");
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey);
  CommandFiles files;
  Result<std::optional<LoadedHanging>> hanging = load_hanging(options.hanging, files);
  if (!hanging) return fail(hanging);
  files.reads(*survey);
  for (const std::string& file : options.files) files.reads(file, "the lines");
  add_report_files(options.report, files);
  if (const auto usable = files.check(); !usable) return fail(usable);
  if (!*hanging) {
    const Result<bool> shown = any_shows_hanging(options);
    if (!shown) return fail(shown);
    if (!*shown) *hanging = hanging_without_rig(options.hanging);
  }
  const Result<std::optional<HungTags>> hung = check_hanging(
      "report", *survey, *hanging, [&](const auto& take) { return read_all(options, take); });
  if (!hung) return fail(hung);
  const Result<VerifyMerge> merged = merge_all(options, *survey, *hanging, *hung, files);
  if (!merged) return fail(merged);
  if (const auto written = write_report(options.report, *survey, *merged, files); !written) {
    return fail(written);
  }
  const Completeness covered = completeness_of(*survey, *merged);
  if (options.json) {
    to_stdout("{}\n", report_summary_line(*survey, *merged, *hung));
  } else {
    if (*hung) print_hanging(**hung);
    print_in_words(covered, *merged);
  }
  const bool contradicts = *hung && (*hung)->nothing_fits;
  const bool is_of_survey = merged->other_revisions == 0;
  const bool in_order =
      covered.seen == covered.tags && merged->fault_count == 0 && !contradicts && is_of_survey;
  return in_order ? kExitOk : kExitFindings;
}

}  // namespace

Command report_command() {
  auto options = std::make_shared<ReportOptions>();
  Command command{
      .name = "report",
      .summary = "Merge what verify runs found into one report",
      .options =
          joined({{survey_argument(&options->survey, "The survey"),
                   argument("FILE.jsonl", &options->files, ValueKind::json_lines,
                            "Output of `verify --json`"),
                   file_option("--ledger", &options->ledger,
                               "Report what this file has of all photos; FILE.jsonl are entered "
                               "in it before"),
                   json_flag(options->json, "Print the summary as one JSON object")},
                  report_options(options->report),
                  hanging_options(options->hanging)}),
      .notes = kReportNotes,
      .run = [options] { return run(*options); },
  };
  for (CommandOption& option : command.options) {
    const std::string& name = option.names;
    const bool is_of_lines =
        name == "--pdf" || name == "--csv" || name == "--rig" || name == "--tolerance";
    if (is_of_lines) option.excludes.push_back("--ledger");
  }
  return command;
}

}  // namespace tagsmith::detail
