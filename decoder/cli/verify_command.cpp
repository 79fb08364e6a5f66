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
#include "decoder/cli/report_files.hpp"
#include "decoder/cli/verify_annotate.hpp"
#include "decoder/cli/verify_hanging.hpp"
#include "decoder/cli/verify_lines.hpp"
#include "decoder/cli/verify_merge.hpp"
#include "decoder/image/load.hpp"
#include "decoder/verify/check_tags.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/jobs_option.hpp"
#include "tagsmith/cli/number_between.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExample = R"(Example:
  tagsmith verify surveys/corridor/survey.yaml print/*.pdf photos --html report.html

--json prints one object a file: file, tags (tag, status, digits, corners, message, page), findings;
and last the summary: counts by status, and the survey's tags that no file shows (missing).
Status: ok, unknown (not in the survey), misprinted (wrong check digit, size or file), unreadable,
duplicate, cut_off (at a photo's edge, which is no fault), misplaced, or doubtful (it or another
hangs wrong). With --rig tags that are seen together are checked for where they hang, all photos at
once, and the output comes when all are read (with --json --resume the lines come at once, and the
summary says where tags hang). Exit: 0 nothing is wrong, 1 something
is, 2 a file could not be read. Missing tags count as wrong only with --complete.)";

struct Options {
  std::string survey;
  std::vector<std::string> files;
  std::vector<std::string> also;
  std::string crops;     // folder; empty = none are saved
  std::string annotate;  // folder; empty = none are made
  std::string resume;    // earlier output; empty = none
  ReportFiles report;
  bool complete = false;
  bool json = false;
  int jobs = 0;
  std::optional<double> scan_dpi;
  HangingOptions hanging;
  CommandFiles* named = nullptr;  // what is read and written, when it is known
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
  to_stdout("{}: {}{}{}\n", report.file.string(), report.findings.empty() ? "ok" : "WRONG",
            good.empty() ? "" : "  ", joined(good));
  for (const std::string& finding : report.findings) to_stdout("  {}\n", finding);
  for (const std::string& code : report.rules) {
    if (const VerifyRule* rule = find_verify_rule(code)) {
      to_stdout("  {}: {}\n", code, rule->remedy);
    }
  }
  for (const std::string& note : report.notes) to_stdout("  note: {}\n", note);
}

void print_in_words(const VerifySummary& summary) {
  to_stdout(
      "{} {}, {} with findings; tags: {} ok, {} unknown, {} misprinted, {} unreadable, {} "
      "duplicate, {} cut off{}\n",
      summary.files, summary.files == 1 ? "file" : "files", summary.files_with_findings, summary.ok,
      summary.unknown, summary.misprinted, summary.unreadable, summary.duplicate, summary.cut_off,
      (summary.misplaced > 0 ? fmt::format(", {} misplaced", summary.misplaced) : "") +
          (summary.doubtful > 0 ? fmt::format(", {} doubtful", summary.doubtful) : ""));
  if (!summary.stale.empty()) to_stdout("print again: {}\n", joined(summary.stale));
  if (summary.missing.empty()) {
    to_stdout("every tag of the survey was seen\n");
  } else {
    to_stdout("not seen: {}\n", joined(summary.missing));
  }
}

// What was not checked.
void print_unchecked(const Survey& survey, const VerifyMerge& merged) {
  const Completeness covered = completeness_of(survey, merged);
  for (const std::string& words :
       {placement_in_words(covered), up_in_words(covered), noted_up_in_words(merged.noted_up)}) {
    if (!words.empty()) to_stdout("{}\n", words);
  }
}

// Crops and copies have names that come with the work.
Result<void> save_late(const Options& options, const std::string& role, const fs::path& file,
                       std::string_view bytes) {
  if (auto usable = options.named->check_no_input(file, role); !usable) return usable;
  return write_file(file, bytes);
}

// Writes a picture of the report as NAME-HASH-`which`.png, HASH being of the whole path: photos of
// several folders often have one name. Then the picture is let go, and `saved` is its file.
Result<void> save_crop(const Options& options, const FileReport& report, const std::string& which,
                       std::optional<GrayImage>& picture, std::string& saved) {
  const std::string hash = sha256(report.file.string()).substr(0, 8);
  const fs::path file = fs::path(options.crops) /
                        fmt::format("{}-{}-{}.png", report.file.stem().string(), hash, which);
  const Result<std::string> bytes = encode_gray_image(file, picture->view());
  if (!bytes) return fail(bytes.error().message);
  if (auto written = save_late(options, "--crops", file, *bytes); !written) return written;
  saved = file.string();
  picture.reset();
  return {};
}

// The crops of a report's faults, numbered, and the picture of a file without a tag.
Result<void> save_crops(const Options& options, FileReport& report) {
  int number = 0;
  for (TagFinding& tag : report.tags) {
    if (tag.crop || !tag.crop_file.empty()) ++number;
    if (!tag.crop) continue;
    const auto saved = save_crop(options, report, std::to_string(number), tag.crop, tag.crop_file);
    if (!saved) return saved;
  }
  if (!report.picture) return {};
  return save_crop(options, report, "whole", report.picture, report.picture_file);
}

// A file that cannot be read is one finding, not the end.
FileReport broken(const fs::path& file, const Error& error) {
  FileReport report;
  report.file = file;
  const std::string name = file.string() + ": ";
  const bool names_it = error.message.starts_with(name);
  report.findings.push_back(names_it ? error.message.substr(name.size()) : error.message);
  report.rules.insert("broken-file");
  return report;
}

// What became of one file.
struct VerifiedOne {
  FileReport report;
  FilePictures pictures;         // for reports
  std::optional<Error> problem;  // why it could not be read, or something not written
  bool skipped = false;          // verified before
};

// The crops of the report, small.
FilePictures pictures_of(const FileReport& report) {
  FilePictures pictures;
  const auto small = [](const std::optional<GrayImage>& picture) {
    return picture ? report_picture(picture->view()) : std::string();
  };
  for (const TagFinding& tag : report.tags) pictures.tags.push_back(small(tag.crop));
  pictures.whole = small(report.picture);
  return pictures;
}

// The crops, as files and as pictures of the report.
Result<void> save_crop_pictures(const Options& options, VerifiedOne& one) {
  if (options.report.shows_pictures()) one.pictures = pictures_of(one.report);
  if (!options.crops.empty()) {
    if (const Result<void> saved = save_crops(options, one.report); !saved) return saved;
  }
  for (TagFinding& tag : one.report.tags) tag.crop.reset();
  one.report.picture.reset();
  return {};
}

Result<void> save_annotated(const Options& options, const InputFile& input,
                            const FileReport& report) {
  const Result<std::optional<SheetFile>> copy = annotated_copy(options.annotate, input, report);
  if (!copy) return fail(copy.error().message);
  return *copy ? save_late(options, "--annotate", (*copy)->path, (*copy)->bytes) : Result<void>{};
}

// What was asked for besides the lines.
Result<void> save_pictures(const Options& options, const InputFile& input, VerifiedOne& one) {
  if (const Result<void> saved = save_crop_pictures(options, one); !saved) return saved;
  // With --rig what is wrong is known later.
  if (options.annotate.empty() || !options.hanging.rig.empty()) return {};
  return save_annotated(options, input, one.report);
}

// Content hashes of what earlier runs verified against this state of the survey.
using VerifiedBefore = std::set<std::string>;

VerifiedOne verify_one(const Options& options, const VerifyRequest& request,
                       const VerifiedBefore& before, const fs::path& file) {
  VerifiedOne one;
  const Result<InputFile> input = read_input_file(file);
  if (!input) {
    one.report = broken(file, input.error());
    one.problem = input.error();
    return one;
  }
  one.report.sha256 = input->sha256;
  one.skipped = before.contains(input->sha256);
  if (one.skipped) return one;
  Result<FileReport> report = verify_file(request, *input);
  if (!report) {
    one.problem = report.error();
    one.report = broken(file, report.error());
    return one;
  }
  one.report = std::move(*report);
  if (const Result<void> saved = save_pictures(options, *input, one); !saved) {
    one.problem = saved.error();
  }
  return one;
}

// All files together. An archive has more of them than memory holds: each report is printed, and
// its counts alone are kept.
struct Outcome {
  VerifyTally tally;
  VerifyMerge merged;
  std::vector<VerifiedOne> waiting;  // with --rig, until all are read
  std::optional<HungTags> hung;      // with --rig
  VerifiedBefore skipped;
  std::size_t skipped_files = 0;
  bool failed = false;  // a file could not be read, or something not be written
};

Result<VerifiedBefore> verified_before(const std::string& file, const std::string& revision) {
  VerifiedBefore hashes;
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return hashes;
  const Result<VerifyLineCounts> counts = read_verify_lines(file, [&](const VerifiedFile& done) {
    if (done.revision == revision && !done.sha256.empty()) hashes.insert(done.sha256);
  });
  if (!counts) return fail(counts.error().message);
  tell_broken_lines(file, *counts);
  return hashes;
}

void print(const Options& options, const FileReport& report) {
  if (options.json) {
    to_stdout("{}\n", to_json_line(report));
    std::fflush(stdout);  // what is printed stays when the run is killed
  } else {
    print_in_words(report);
  }
}

// A run that can be resumed prints a photo's line when it is read, before it is known where its
// tags hang: the summary says that.
bool prints_at_once(const Options& options) {
  return options.hanging.rig.empty() || (options.json && !options.resume.empty());
}

void count(const VerifiedOne& one, Outcome& outcome) {
  outcome.tally.add(one.report);
  merge(one.report.revision, verified_file(one.report), outcome.merged, one.pictures);
}

// Where tags hang takes all reports together: with --rig they wait to be counted.
void deliver(const Options& options, const std::string& revision, VerifiedOne& one,
             Outcome& outcome) {
  if (one.problem) {
    report_failure("verify", *one.problem);
    outcome.failed = true;
  }
  if (one.skipped) {
    ++outcome.skipped_files;
    outcome.skipped.insert(one.report.sha256);
    return;
  }
  one.report.revision = revision;
  if (prints_at_once(options)) print(options, one.report);
  if (options.hanging.rig.empty()) {
    count(one, outcome);
  } else {
    outcome.waiting.push_back(std::move(one));
  }
}

// Crops and the copy of a photo, of what only all photos together showed.
Result<void> save_late_pictures(const Options& options, VerifiedOne& one) {
  const auto lacks_crop = [](const TagFinding& tag) { return tag.hung && tag.crop_file.empty(); };
  const bool crops = !options.crops.empty() || options.report.shows_pictures();
  const bool late = crops && std::ranges::any_of(one.report.tags, lacks_crop);
  if (one.report.sha256.empty() || (!late && options.annotate.empty())) return {};
  const Result<InputFile> input = read_input_file(one.report.file);
  if (!input) return fail(input.error().message);
  if (late) {
    const Result<GrayImage> image = decode_gray_image(input->path.string(), input->bytes);
    if (!image) return fail(image.error().message);
    crop_faults(image->view(), one.report.tags, one.report.orientation.value_or(1));
    if (const Result<void> saved = save_crop_pictures(options, one); !saved) return saved;
  }
  if (options.annotate.empty()) return {};
  return save_annotated(options, *input, one.report);
}

// Where tags hang is known when every photo has been read.
Result<void> finish_hanging(const Options& options, const VerifyRequest& request,
                            const HangingSetup& setup, Outcome& outcome) {
  std::vector<FileReport> reports;
  for (VerifiedOne& one : outcome.waiting) reports.push_back(std::move(one.report));
  const double tolerance = 1e-3 * options.hanging.tolerance_mm;
  if (outcome.skipped.empty()) {
    outcome.hung = check_hanging(request.survey, setup, tolerance, reports);
  } else {
    Result<HungTags> hung =
        check_hanging_lines(request.survey, setup, tolerance, {options.resume}, reports);
    if (!hung) return fail(hung.error().message);
    outcome.hung = std::move(*hung);
  }
  for (std::size_t i = 0; i < reports.size(); ++i) {
    VerifiedOne& one = outcome.waiting[i];
    one.report = std::move(reports[i]);
    if (const Result<void> saved = save_late_pictures(options, one); !saved) {
      report_failure("verify", saved.error());
      outcome.failed = true;
    }
    if (!prints_at_once(options)) print(options, one.report);
    count(one, outcome);
  }
  outcome.waiting.clear();
  for (const std::string& note : outcome.hung->notes) to_stderr("verify: {}\n", note);
  print_assumptions("verify", outcome.hung->assumed);
  return {};
}

// Of the files that were skipped, what the earlier run said; with a rig, but for where tags hang.
Result<void> add_skipped(const Options& options, const Survey& survey, const HangingSetup* setup,
                         Outcome& outcome) {
  if (outcome.skipped.empty()) return {};
  const std::string revision = survey_revision(survey);
  const Result<VerifyLineCounts> counts =
      read_verify_lines(options.resume, [&](const VerifiedFile& line) {
        if (line.revision != revision || outcome.skipped.erase(line.sha256) == 0) return;
        VerifiedFile done = line;
        if (setup != nullptr) judge_line(survey, *setup, *outcome.hung, done);
        outcome.tally.add(report_of(done));
        merge(revision, done, outcome.merged);
      });
  if (!counts) return fail(counts.error().message);
  return {};
}

// `setup` null = where tags hang is not asked for.
Result<Outcome> verify_all(const Options& options, const VerifyRequest& request,
                           const HangingSetup* setup, const std::vector<fs::path>& files) {
  const std::string revision = survey_revision(request.survey);
  const Result<VerifiedBefore> before = verified_before(options.resume, revision);
  if (!before) return fail(before.error().message);
  Outcome outcome;
  ProgressBar bar("files", files.size());
  run_in_order(files.size(), options.jobs, [&](std::size_t i) -> Delivery {
    auto one = std::make_shared<VerifiedOne>(verify_one(options, request, *before, files[i]));
    return [&, one] { bar.advance([&] { deliver(options, revision, *one, outcome); }); };
  });
  if (setup != nullptr) {
    const Result<void> finished = finish_hanging(options, request, *setup, outcome);
    if (!finished) return fail(finished.error().message);
  }
  if (const auto added = add_skipped(options, request.survey, setup, outcome); !added) {
    return fail(added.error().message);
  }
  sort_faults(outcome.merged);
  if (options.report.shows_pictures())
    load_pictures(outcome.merged, {options.resume}, *options.named);
  return outcome;
}

Result<std::vector<Survey>> load_surveys(const std::vector<std::string>& names) {
  std::vector<Survey> surveys;
  for (const std::string& name : names) {
    Result<Survey> survey = load_survey(name);
    if (!survey) return fail(survey.error().message);
    surveys.push_back(std::move(*survey));
  }
  return surveys;
}

void print_summary(const Options& options, const Survey& survey, const VerifySummary& summary,
                   const Outcome& outcome, const SkippedFiles& skipped) {
  if (outcome.skipped_files > 0) {
    to_stderr("skipped, verified before: {}\n", outcome.skipped_files);
  }
  if (!skipped.empty()) {
    to_stderr("skipped, no pictures or print files: {}\n", skipped_in_words(skipped));
  }
  if (options.json) {
    to_stdout("{}\n", to_json_line(summary, survey, outcome.merged, outcome.hung, skipped));
  } else {
    if (outcome.hung) print_hanging(*outcome.hung);
    print_in_words(summary);
    print_unchecked(survey, outcome.merged);
  }
}

// Inputs and outputs; `listed` are the files to verify.
CommandFiles files_of(const Options& options, const Survey& survey, const std::vector<Survey>& also,
                      const std::optional<HangingSetup>& hanging,
                      const std::vector<fs::path>& listed) {
  CommandFiles files;
  files.reads(survey);
  for (const Survey& other : also) files.reads(other);
  if (hanging) add_hanging_files(options.hanging, *hanging, files);
  files.reads(options.resume, "the lines of --resume");
  if (std::ranges::count(options.files, "-") > 0) files.reads("/dev/stdin", "the list of files");
  std::set<fs::path> folders;
  for (const fs::path& file : listed) {
    files.reads(file, "the file");
    if (folders.insert(file.parent_path()).second) {
      files.reads(file.parent_path() / "manifest.json", "the manifest of print files");
    }
  }
  add_report_files(options.report, files);
  files.writes_into(options.crops, "--crops");
  files.writes_into(options.annotate, "--annotate");
  return files;
}

int run(Options options) {
  if (options.files.empty() && options.hanging.run.empty()) {
    return report_failure("verify", {"FILE is required: photos, print files, folders of them"});
  }
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return report_failure("verify", survey.error());
  const Result<std::optional<HangingSetup>> hanging = load_hanging(options.hanging);
  if (!hanging) return report_failure("verify", hanging.error());
  const bool of_run = options.files.empty() && *hanging;
  const Result<FileList> list =
      list_files(of_run ? (*hanging)->photos : options.files, image_and_pdf_extensions(), std::cin);
  if (!list) return report_failure("verify", list.error());
  const Result<std::vector<Survey>> also = load_surveys(options.also);
  if (!also) return report_failure("verify", also.error());
  CommandFiles files = files_of(options, *survey, *also, *hanging, list->files);
  if (const auto usable = files.check(); !usable) return report_failure("verify", usable.error());
  options.named = &files;
  if (!options.resume.empty()) {
    const Result<void> ready = prepare_to_append(options.resume);
    if (!ready) return report_failure("verify", ready.error());
  }
  ManifestCache manifests;
  const bool crops = !options.crops.empty() || options.report.shows_pictures();
  VerifyRequest request{*survey, *also, crops};
  request.manifests = &manifests;
  request.scan_dpi = options.scan_dpi;
  if (*hanging) {
    request.rig = &(*hanging)->rig;
    request.cameras = &(*hanging)->cameras;
  }
  const Result<Outcome> outcome =
      verify_all(options, request, *hanging ? &**hanging : nullptr, list->files);
  if (!outcome) return report_failure("verify", outcome.error());
  const VerifySummary summary = outcome->tally.summary(*survey);
  print_summary(options, *survey, summary, *outcome, list->skipped);
  const Result<void> written = write_report(options.report, *survey, outcome->merged, files);
  if (!written) return report_failure("verify", written.error());
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    return report_failure("verify", {"standard output cannot be written, is the disk full?"});
  }
  if (outcome->failed) return kExitFailure;
  const bool incomplete = options.complete && !summary.missing.empty();
  const bool contradicts = outcome->hung && outcome->hung->nothing_fits;
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
      ->type_name("SURVEY");
  app->add_option("--resume", options->resume,
                  "Skip files whose content an earlier --json run verified against this survey")
      ->type_name("FILE.jsonl");
  app->add_option("--crops", options->crops, "Folder for a picture of every faulty tag")
      ->type_name("DIR");
  app->add_option("--annotate", options->annotate,
                  "Folder for a copy of every photo with its tags outlined and named")
      ->type_name("DIR");
  add_report_options(*app, options->report);
  app->add_flag("--complete", options->complete,
                "Tags of the survey that no file shows are wrong too");
  app->add_flag("--json", options->json, "One JSON object a file, then the summary");
  add_jobs_option(*app, options->jobs, "Files read at once");
  add_hanging_options(*app, options->hanging);
  app->add_option("--dpi", options->scan_dpi,
                  "Pictures are flat scans of prints with so many dots per inch, not photos: their "
                  "printed size is checked, too")
      ->type_name("DPI")
      ->check(number_between(10, 10'000))
      ->excludes("--rig");
  app->footer(kExample);
  return {app, [options] { return run(*options); }};
}

}  // namespace tagsmith
