// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_command.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "decoder/cli/file_list.hpp"
#include "decoder/cli/json.hpp"
#include "decoder/cli/verify_hanging.hpp"
#include "decoder/cli/verify_lines.hpp"
#include "decoder/image/load.hpp"
#include "decoder/verify/check_tags.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExample = R"(Example:
  tagsmith verify surveys/corridor/survey.yaml print/*.pdf photos

--json prints one object a file: file, tags (tag, status, digits, corners, message, page), findings;
and last the summary: counts by status, and the survey's tags that no file shows (missing).
Status: ok, unknown (not in the survey), misprinted (wrong check digit, size or file), unreadable,
duplicate, cut_off (at a photo's edge, which is no fault), misplaced, or doubtful (it or another
hangs wrong). With --rig tags that are seen together are checked for where they hang, all photos at
once, and the output comes when all are read. Exit: 0 nothing is wrong, 1 something
is, 2 a file could not be read. Missing tags count as wrong only with --complete.)";

struct Options {
  std::string survey;
  std::vector<std::string> files;
  std::vector<std::string> also;
  std::string crops;   // folder; empty = none are saved
  std::string resume;  // earlier output; empty = none
  bool complete = false;
  bool json = false;
  int jobs = 0;
  HangingOptions hanging;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// "000L", or "000L (grade 3.4, modulation)".
std::string good_in_words(const TagFinding& tag) {
  if (!tag.grade) return tag.tag;
  if (tag.grade->grade >= 4) return tag.tag + " (grade 4.0)";
  return fmt::format("{} (grade {:.1f}, {})", tag.tag, tag.grade->grade,
                     to_string(tag.grade->worst));
}

void print_in_words(const FileReport& report) {
  std::vector<std::string> good;
  for (const TagFinding& tag : report.tags) {
    if (tag.status == TagStatus::ok) good.push_back(good_in_words(tag));
  }
  fmt::print("{}: {}{}{}\n", report.file.string(), report.findings.empty() ? "ok" : "WRONG",
             good.empty() ? "" : "  ", joined(good));
  for (const std::string& finding : report.findings) fmt::print("  {}\n", finding);
  for (const std::string& code : report.rules) {
    if (const VerifyRule* rule = find_verify_rule(code)) {
      fmt::print("  {}: {}\n", code, rule->remedy);
    }
  }
}

void print_in_words(const VerifySummary& summary) {
  fmt::print(
      "{} {}, {} with findings; tags: {} ok, {} unknown, {} misprinted, {} unreadable, {} "
      "duplicate, {} cut off{}\n",
      summary.files, summary.files == 1 ? "file" : "files", summary.files_with_findings, summary.ok,
      summary.unknown, summary.misprinted, summary.unreadable, summary.duplicate, summary.cut_off,
      (summary.misplaced > 0 ? fmt::format(", {} misplaced", summary.misplaced) : "") +
          (summary.doubtful > 0 ? fmt::format(", {} doubtful", summary.doubtful) : ""));
  if (!summary.stale.empty()) fmt::print("print again: {}\n", joined(summary.stale));
  if (summary.missing.empty()) {
    fmt::print("every tag of the survey was seen\n");
  } else {
    fmt::print("not seen: {}\n", joined(summary.missing));
  }
}

// Saves the crops of a report's faults as NAME-HASH-1.png ..., HASH being of the whole path: photos
// of several folders often have one name.
Result<void> save_crops(const fs::path& folder, FileReport& report) {
  int number = 0;
  const std::string hash = sha256(report.file.string()).substr(0, 8);
  for (TagFinding& tag : report.tags) {
    if (tag.crop || !tag.crop_file.empty()) ++number;
    if (!tag.crop) continue;
    const fs::path file =
        folder / fmt::format("{}-{}-{}.png", report.file.stem().string(), hash, number);
    const Result<std::string> bytes = encode_gray_image(file, tag.crop->view());
    if (!bytes) return fail(bytes.error().message);
    if (const Result<void> written = write_file(file, *bytes); !written) return written;
    tag.crop_file = file.string();
    tag.crop.reset();
  }
  return {};
}

Result<FileReport> verify_one(const Options& options, const VerifyRequest& request,
                              const fs::path& file) {
  Result<FileReport> report = verify_file(request, file);
  if (!report || options.crops.empty()) return report;
  if (const Result<void> saved = save_crops(options.crops, *report); !saved) {
    return fail(saved.error().message);
  }
  return report;
}

// A file that cannot be read is one finding, not the end.
FileReport broken(const fs::path& file, const Error& error) {
  FileReport report;
  report.file = file;
  report.findings.push_back(error.message);
  report.rules.insert("broken-file");
  return report;
}

struct Outcome {
  VerifySummary summary;
  std::optional<HungTags> hung;  // with --rig
  int skipped = 0;               // verified before
  bool unreadable_file = false;
};

// Content hashes of what earlier runs verified against this state of the survey.
Result<std::set<std::string>> verified_before(const std::string& file, const Survey& survey) {
  std::set<std::string> hashes;
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return hashes;
  const std::string revision = survey_revision(survey);
  const Result<VerifyLineCounts> counts = read_verify_lines(file, [&](const VerifiedFile& done) {
    if (done.revision == revision && !done.sha256.empty()) hashes.insert(done.sha256);
  });
  if (!counts) return fail(counts.error().message);
  return hashes;
}

void print(const Options& options, const FileReport& report) {
  if (options.json) {
    fmt::print("{}\n", to_json_line(report));
  } else {
    print_in_words(report);
  }
}

// Crops of what only all photos together showed.
void save_late_crops(const Options& options, FileReport& report) {
  const auto lacks_crop = [](const TagFinding& tag) { return tag.hung && tag.crop_file.empty(); };
  if (options.crops.empty() || std::ranges::none_of(report.tags, lacks_crop)) return;
  const Result<GrayImage> image = load_gray_image(report.file);
  if (!image) return;
  crop_faults(image->view(), report.tags);
  if (const Result<void> saved = save_crops(options.crops, report); !saved) {
    report_failure("verify", saved.error());
  }
}

// Where tags hang is known when every photo has been read.
void finish_hanging(const Options& options, const VerifyRequest& request, const HangingSetup& setup,
                    std::vector<FileReport>& reports, VerifyTally& tally, Outcome& outcome) {
  outcome.hung = check_hanging(request.survey, setup, 1e-3 * options.hanging.tolerance_mm, reports);
  for (FileReport& report : reports) {
    save_late_crops(options, report);
    print(options, report);
    tally.add(report);
  }
  for (const std::string& note : outcome.hung->notes) fmt::print(stderr, "verify: {}\n", note);
}

// Prints each report and keeps its counts alone: an archive has more files than memory holds.
// Where tags hang takes all reports together; `setup` null = it is not asked for.
Outcome verify_all(const Options& options, const VerifyRequest& request, const HangingSetup* setup,
                   const std::set<std::string>& before, const std::vector<fs::path>& files) {
  Outcome outcome;
  VerifyTally tally;
  std::vector<FileReport> reports;
  const std::string revision = survey_revision(request.survey);
  ProgressBar bar("files", files.size());
  run_in_order(files.size(), options.jobs, [&](std::size_t i) -> Delivery {
    const std::string hash = sha256_of_file(files[i]).value_or("");
    const bool skip = before.contains(hash);
    auto report = std::make_shared<Result<FileReport>>(
        skip ? FileReport{} : verify_one(options, request, files[i]));
    return [&, report, i, hash, skip] {
      bar.advance([&] {
        if (skip) {
          ++outcome.skipped;
          return;
        }
        if (!*report) {
          report_failure("verify", report->error());
          outcome.unreadable_file = true;
        }
        FileReport done = *report ? std::move(**report) : broken(files[i], report->error());
        if (*report) done.sha256 = hash;
        done.revision = revision;
        if (setup != nullptr) {
          reports.push_back(std::move(done));
          return;
        }
        print(options, done);
        tally.add(done);
      });
    };
  });
  if (setup != nullptr) finish_hanging(options, request, *setup, reports, tally, outcome);
  outcome.summary = tally.summary(request.survey);
  return outcome;
}

int run(const Options& options) {
  if (options.files.empty() && options.hanging.run.empty()) {
    return report_failure("verify", {"FILE is required: photos, print files, folders of them"});
  }
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return report_failure("verify", survey.error());
  const Result<std::optional<HangingSetup>> hanging = load_hanging(options.hanging);
  if (!hanging) return report_failure("verify", hanging.error());
  const bool of_run = options.files.empty() && *hanging;
  const Result<std::vector<fs::path>> files =
      list_files(of_run ? (*hanging)->photos : options.files, image_and_pdf_extensions(), std::cin);
  if (!files) return report_failure("verify", files.error());
  std::vector<Survey> also;
  for (const std::string& name : options.also) {
    Result<Survey> other = load_survey(name);
    if (!other) return report_failure("verify", other.error());
    also.push_back(std::move(*other));
  }
  VerifyRequest request{*survey, also, !options.crops.empty()};
  if (*hanging) {
    request.rig = &(*hanging)->rig;
    request.cameras = &(*hanging)->cameras;
  }
  const Result<std::set<std::string>> before = verified_before(options.resume, *survey);
  if (!before) return report_failure("verify", before.error());
  const Outcome outcome =
      verify_all(options, request, *hanging ? &**hanging : nullptr, *before, *files);
  const VerifySummary& summary = outcome.summary;
  if (outcome.skipped > 0) fmt::print(stderr, "skipped, verified before: {}\n", outcome.skipped);
  if (options.json) {
    fmt::print("{}\n", to_json_line(summary, outcome.hung));
  } else {
    if (outcome.hung) print_hanging(*outcome.hung);
    print_in_words(summary);
  }
  if (outcome.unreadable_file) return kExitFailure;
  const bool incomplete = options.complete && !summary.missing.empty();
  const bool contradicts = outcome.hung && outcome.hung->nothing_fits;
  return summary.files_with_findings > 0 || incomplete || contradicts ? kExitFindings : kExitOk;
}

}  // namespace

Command verify_command(CLI::App& parent) {
  auto options = std::make_shared<Options>();
  CLI::App* app =
      parent.add_subcommand("verify", "Check print files and photos against the survey");
  app->add_option("survey", options->survey, "The survey")->required()->type_name("SURVEY");
  app->add_option(
         "file", options->files,
         "Pictures, PDFs, SVGs, folders of them, or - for a list of files on standard input")
      ->type_name("FILE");
  app->add_option("--also", options->also,
                  "Another survey, whose tags are named when they turn up here")
      ->type_name("SURVEY")
      ->allow_extra_args(false);
  CLI::Option* resume =
      app->add_option("--resume", options->resume,
                      "Skip files whose content an earlier --json run verified against this survey")
          ->type_name("FILE.jsonl");
  app->add_option("--crops", options->crops, "Folder for a picture of every faulty tag")
      ->type_name("DIR");
  app->add_flag("--complete", options->complete,
                "Tags of the survey that no file shows are wrong too");
  app->add_flag("--json", options->json, "One JSON object a file, then the summary");
  app->add_option("--jobs", options->jobs, "Files read at once (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  add_hanging_options(*app, options->hanging);
  resume->excludes("--rig");  // which needs every photo
  app->footer(kExample);
  return {app, [options] { return run(*options); }};
}

}  // namespace tagsmith
