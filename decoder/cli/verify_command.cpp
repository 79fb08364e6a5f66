// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>
#include <span>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include "decoder/cli/commands.hpp"
#include "decoder/cli/file_list.hpp"
#include "decoder/cli/report_files.hpp"
#include "decoder/cli/report_ledger.hpp"
#include "decoder/cli/verify_hanging.hpp"
#include "decoder/image/annotate.hpp"
#include "decoder/image/load.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/rasterize.hpp"
#include "decoder/verify/verified_file.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_json.hpp"
#include "decoder/verify/verify_merge.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/command_help.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {

// ---- Copies of verified photos that show what was found where.

namespace {

constexpr double kPoor = 1.5;  // grades below it are poor

std::array<std::uint8_t, 3> colour_of(const VerifiedTag& tag) {
  if (tag.finding.status == TagStatus::cut_off) return {96, 104, 112};
  if (tag.finding.status != TagStatus::ok) return {190, 20, 20};
  return tag.grade && tag.grade->grade < kPoor ? std::array<std::uint8_t, 3>{190, 100, 0}
                                               : std::array<std::uint8_t, 3>{10, 120, 50};
}

std::vector<std::string> words_of(const VerifiedTag& tag) {
  constexpr std::size_t kLine = 46;
  constexpr std::size_t kMostLines = 4;
  std::string first = tag.tag.empty() ? std::string() : tag.tag + "  ";
  first += to_string(tag.finding.status);
  if (tag.grade) first += "  grade " + to_string(*tag.grade);
  if (!tag.finding.rule.empty()) first += "  " + tag.finding.rule;
  std::vector<std::string> lines{first};
  std::vector<std::string> more = wrapped_lines(tag.finding.message, kLine);
  if (more.size() > kMostLines) {
    more.resize(kMostLines);
    more.back() += " ...";
  }
  lines.insert(lines.end(), more.begin(), more.end());
  return lines;
}

// NAME-HASH, HASH being of the whole path: photos of several folders often have one name.
std::string name_of_copy(const std::filesystem::path& file) {
  return fmt::format("{}-{}", file.stem().string(), sha256(file.string()).substr(0, 8));
}

// NAME-HASH.jpg (of lossless pictures .png) in the folder. Each tag is outlined in the colour of
// its status, with its name, status, grade and what is wrong. Print files (PDF, SVG) have no copy.
// Fails when the picture cannot be decoded.
Result<std::optional<SheetFile>> annotated_copy(const std::filesystem::path& folder,
                                                const InputFile& file,
                                                const VerifiedFile& verified) {
  if (is_pdf(file.bytes) || is_svg(file.path)) return std::nullopt;
  std::vector<PictureMark> marks;
  for (const VerifiedTag& tag : verified.tags) {
    marks.push_back({tag.corners, colour_of(tag), words_of(tag)});
  }
  std::vector<std::string> caption{file.path.filename().string()};
  if (verified.tags.empty()) {
    caption.insert(caption.end(), verified.findings.begin(), verified.findings.end());
  }
  const Result<AnnotatedPicture> copy =
      annotate_picture(file.path.string(), file.bytes, marks, caption);
  if (!copy) return fail(copy);
  return SheetFile{folder / (name_of_copy(file.path) + copy->extension), copy->bytes};
}

// ---- The command.

namespace fs = std::filesystem;

constexpr const char* kVerifyNotes = R"(Example:
  tagsmith verify surveys/corridor/survey.yaml print/*.pdf photos --html report.html

--json prints one object a file: file, tags (tag, status, digits, corners, message, page), findings;
and last the summary: counts by status, and the survey's tags that no file shows (missing).
Status: ok, unknown (not in the survey), misprinted (wrong check digit, size or file), unreadable,
duplicate, cut_off (at a photo's edge, which is no fault), misplaced, or doubtful (it or another
hangs wrong). With --rig, or by photos that name their lens (EXIF, as phones do), tags that are seen
together are checked for where they hang, all photos at once, and the output comes when all are read
(with --json --resume the lines come at once, and the summary says where tags hang). Exit: 0 nothing is wrong, 1 something
is, 2 a file could not be read. Missing tags count as wrong only with --complete.)";

struct VerifyCommandOptions {
  std::string survey;
  std::vector<std::string> files;
  std::vector<std::string> also;
  std::string crops;     // folder; empty = none are saved
  std::string annotate;  // folder; empty = none are made
  std::string resume;    // earlier output; empty = none
  std::string ledger;    // empty = none is kept
  ReportFiles report;
  bool complete = false;
  bool json = false;
  int jobs = 0;
  std::optional<double> scan_dpi;
  HangingOptions hanging;
  bool hangs_late =
      false;  // where tags hang is checked, and what is wrong known, when all are read
  CommandFiles* named = nullptr;  // what is read and written, when it is known

  bool wants_crops() const { return !crops.empty() || report.shows_pictures(); }
};

// "000L", or "000L (grade 3.4, modulation)".
std::string good_in_words(const VerifiedTag& tag) {
  if (!tag.grade) return tag.tag;
  if (tag.grade->grade >= 4) return tag.tag + " (grade 4.0)";
  return fmt::format("{} (grade {:.1f}, {})", tag.tag, tag.grade->grade,
                     to_string(tag.grade->worst));
}

void print_in_words(const VerifiedFile& file) {
  const std::vector<std::string> findings = findings_of(file);
  std::vector<std::string> good;
  for (const VerifiedTag& tag : file.tags) {
    if (tag.finding.status == TagStatus::ok) good.push_back(good_in_words(tag));
  }
  const bool is_without_tag = file.only_lacks_tags();
  to_stdout("{}: {}{}{}\n", file.file.string(),
            findings.empty() ? "ok"
            : is_without_tag ? "no tag"
                             : "WRONG",
            good.empty() ? "" : "  ", fmt::join(good, " "));
  for (const std::string& note : file.notes) to_stdout("  note: {}\n", note);
  if (is_without_tag) return;
  for (const std::string& finding : findings) to_stdout("  {}\n", finding);
  for (const std::string& code : rules_of(file)) {
    if (const Rule* rule = find_verify_rule(code)) {
      to_stdout("  {}: {}\n", code, rule->remedy);
    }
  }
}

// The counts, what no file shows as it should be, and what was not checked.
void print_in_words(const Survey& survey, const VerifyMerge& merged) {
  const auto count = [&](TagStatus status) {
    return merged.by_status[static_cast<std::size_t>(status)];
  };
  const std::size_t files = merged.files + merged.repeated;
  std::string rare;
  for (const TagStatus status : {TagStatus::misplaced, TagStatus::doubtful}) {
    if (count(status) > 0) rare += fmt::format(", {} {}", count(status), to_string(status));
  }
  to_stdout(
      "{} {}, {} with findings; tags: {} ok, {} unknown, {} misprinted, {} unreadable, {} "
      "duplicate, {} cut off{}\n",
      files, files == 1 ? "file" : "files", merged.files_with_findings, count(TagStatus::ok),
      count(TagStatus::unknown), count(TagStatus::misprinted), count(TagStatus::unreadable),
      count(TagStatus::duplicate), count(TagStatus::cut_off), rare);
  if (!merged.stale.empty())
    to_stdout("print again, or remove: {}\n", fmt::join(merged.stale, " "));
  const std::vector<std::string> missing = missing_tags(survey, merged);
  if (missing.empty()) {
    to_stdout("every tag of the survey was seen\n");
  } else {
    to_stdout("not ok in any file: {}\n", fmt::join(missing, " "));
  }
  for (const std::string& words : unchecked_words(completeness_of(survey, merged), merged)) {
    to_stdout("{}\n", words);
  }
}

// Crops and copies have names that come with the work.
Result<void> save_late(const VerifyCommandOptions& options, const std::string& role,
                       const fs::path& file, std::string_view bytes) {
  if (auto usable = options.named->check_no_input(file, role); !usable) return usable;
  return write_file(file, bytes);
}

// Keeps a picture for the report and, with --crops, writes it as NAME-HASH-`which`.png. Then its
// memory is freed.
Result<void> save_picture(const VerifyCommandOptions& options, const fs::path& of,
                          const std::string& which, FaultPicture& picture) {
  const std::optional<GrayImage> image = std::exchange(picture.image, std::nullopt);
  if (!image) return {};
  if (options.report.shows_pictures()) picture.jpeg = report_picture(image->view());
  if (options.crops.empty()) return {};
  const fs::path file = fs::path(options.crops) / fmt::format("{}-{}.png", name_of_copy(of), which);
  const Result<std::string> bytes = encode_gray_image(file, image->view());
  if (!bytes) return fail(bytes);
  if (auto written = save_late(options, "--crops", file, *bytes); !written) return written;
  picture.file = file.string();
  return {};
}

// The pictures of a file's faults, numbered, and that of a file without a tag.
Result<void> save_pictures(const VerifyCommandOptions& options, VerifiedFile& file) {
  int number = 0;
  for (VerifiedTag& tag : file.tags) {
    if (tag.picture.image || !tag.picture.file.empty()) ++number;
    auto saved = save_picture(options, file.file, std::to_string(number), tag.picture);
    if (!saved) return saved;
  }
  return save_picture(options, file.file, "whole", file.picture);
}

Result<void> save_annotated(const VerifyCommandOptions& options, const InputFile& input,
                            const VerifiedFile& file) {
  if (options.annotate.empty()) return {};
  const Result<std::optional<SheetFile>> copy = annotated_copy(options.annotate, input, file);
  if (!copy) return fail(copy);
  return *copy ? save_late(options, "--annotate", (*copy)->path, (*copy)->bytes) : Result<void>{};
}

// What became of one file.
struct VerifiedOne {
  VerifiedFile file{};
  std::optional<Error> problem{};  // why it could not be read, or something not written
  bool skipped = false;            // verified before
};

// A file that cannot be read is one finding, not the end.
VerifiedOne broken(const fs::path& file, const Error& error) {
  VerifiedOne one{{file}, error};
  const std::string name = file.string() + ": ";
  const bool names_it = error.message.starts_with(name);
  one.file.add_finding("broken-file", names_it ? error.message.substr(name.size()) : error.message);
  return one;
}

// Content and conditions of what earlier runs verified against this state of the survey.
using VerifiedBefore = std::set<std::pair<std::string, std::string>>;

std::pair<std::string, std::string> key_of(const VerifiedFile& file) {
  return {file.sha256, file.conditions};
}

// The conditions of an earlier run whose result can be used for this file: the same ones, or, of a
// photo, without any rig, since where tags hang is judged by the rig all the same. What another
// rig's photo shows is verified anew.
Result<std::optional<std::string>> conditions_before(const VerifyRequest& request,
                                                     const VerifiedBefore& before,
                                                     const fs::path& file,
                                                     const std::string& sha256,
                                                     const std::string& conditions) {
  if (before.contains({sha256, conditions})) return conditions;
  if (request.rig == nullptr) return std::nullopt;
  VerifyRequest without_rig = request;
  without_rig.rig = nullptr;
  Result<std::string> others = conditions_of(without_rig, file);
  if (!others) return fail(others);
  return before.contains({sha256, *others}) ? std::optional(std::move(*others)) : std::nullopt;
}

VerifiedOne verify_one(const VerifyCommandOptions& options, const VerifyRequest& request,
                       const VerifiedBefore& before, const fs::path& file) {
  const Result<InputFile> input = read_input_file(file);
  if (!input) return broken(file, input.error());
  const Result<std::string> conditions = conditions_of(request, file);
  if (!conditions) return broken(file, conditions.error());
  const auto known = conditions_before(request, before, file, input->sha256, *conditions);
  if (!known) return broken(file, known.error());
  if (*known) {
    VerifiedOne skipped{{file, input->sha256}, std::nullopt, true};
    skipped.file.conditions = **known;
    return skipped;
  }
  Result<VerifiedFile> verified = verify_file(request, *input);
  if (!verified) return broken(file, verified.error());
  VerifiedOne one{std::move(*verified)};
  one.file.conditions = *conditions;
  Result<void> saved = save_pictures(options, one.file);
  if (saved && !options.hangs_late) saved = save_annotated(options, *input, one.file);
  if (!saved) one.problem = saved.error();
  return one;
}

// All files together. An archive has more of them than memory holds: each is printed, and its
// counts alone are kept.
struct VerifyOutcome {
  VerifyMerge merged;
  std::vector<VerifiedFile> waiting;  // where tags hang is checked: until all are read
  std::optional<HungTags> hung;
  VerifiedBefore skipped;
  std::size_t skipped_files = 0;
  bool failed = false;  // a file could not be read, or something not be written
};

// The lines to be resumed, of this state of the survey; none when there is no such file yet.
Result<void> read_resumed(const VerifyCommandOptions& options, const std::string& revision,
                          const std::function<void(VerifiedFile)>& take, bool report = false) {
  std::error_code ignored;
  if (options.resume.empty() || !fs::exists(options.resume, ignored)) return {};
  const Result<VerifyLineCounts> counts = read_verify_lines(options.resume, [&](VerifiedFile line) {
    if (line.revision == revision) take(std::move(line));
  });
  if (!counts) return fail(counts);
  if (report) report_broken_lines(options.resume, *counts);
  return {};
}

void print(const VerifyCommandOptions& options, const VerifiedFile& file) {
  if (options.json) {
    to_stdout("{}\n", to_json_line(file));
    std::fflush(stdout);  // what is printed stays when the run is killed
  } else {
    print_in_words(file);
  }
}

// Crops and the copy of a photo, of what only all photos together showed.
Result<void> save_late_pictures(const VerifyCommandOptions& options, VerifiedFile& file) {
  const auto lacks_crop = [](const VerifiedTag& tag) {
    return tag.finding.is_fault() && tag.picture.file.empty() && tag.picture.jpeg.empty();
  };
  const bool late = options.wants_crops() && std::ranges::any_of(file.tags, lacks_crop);
  if (file.sha256.empty() || (!late && options.annotate.empty())) return {};
  const Result<InputFile> input = read_input_file(file.file);
  if (!input) return fail(input);
  if (late) {
    const Result<GrayImage> image = decode_gray_image(input->path.string(), input->bytes);
    if (!image) return fail(image);
    crop_faults(image->view(), file.tags, file.orientation.value_or(1));
    if (auto saved = save_pictures(options, file); !saved) return saved;
  }
  return save_annotated(options, *input, file);
}

void note_failure(const Result<void>& result, VerifyOutcome& outcome) {
  if (result) return;
  report_failure("verify", result.error());
  outcome.failed = true;
}

// Where the file's last whole line ends.
Result<off_t> end_of_lines(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  if (!stream) return fail(path.string() + ": cannot be read");
  for (off_t at = stream.tellg(); at > 0; --at) {
    stream.seekg(at - 1);
    if (stream.get() == '\n') return at;
  }
  return 0;
}

// What is wrong with writing to standard output while the lines of `path` are resumed; nothing in
// most cases. When both are one file, standard output must append to it, and a last line that a
// killed run left without its end is cut off, so that the next one begins a line.
Result<void> prepare_to_append(const std::filesystem::path& path) {
  struct stat file {};
  struct stat output {};
  if (::stat(path.c_str(), &file) != 0 || ::fstat(STDOUT_FILENO, &output) != 0) return {};
  if (file.st_dev != output.st_dev || file.st_ino != output.st_ino) return {};
  const int flags = ::fcntl(STDOUT_FILENO, F_GETFL);
  if (flags < 0 || (flags & O_APPEND) == 0) {
    return fail(path.string() +
                ": is overwritten by this run's output, expected `>>` instead of `>`");
  }
  const Result<off_t> end = end_of_lines(path);
  if (!end) return fail(end);
  if (*end != file.st_size && ::ftruncate(STDOUT_FILENO, *end) != 0) {
    return fail(path.string() + ": its last line is cut short and cannot be removed");
  }
  return {};
}

// What all files of the run have in common.
struct Job {
  const VerifyCommandOptions& options;
  const VerifyRequest& request;
  std::optional<LoadedHanging>& hanging;
  LedgerWriter& ledger;
  std::string revision;
  // Lines say where tags hang, which takes all files together. But those of a run that can be
  // resumed are printed when they are known: then the summary says it.
  bool prints_late = hanging && !(options.json && !options.resume.empty());
};

// What is known of the file, all that other files say of it included.
void take(const Job& job, VerifiedFile file, VerifyOutcome& outcome) {
  note_failure(job.ledger.add(file), outcome);
  merge(job.revision, std::move(file), outcome.merged);
}

void deliver(const Job& job, VerifiedOne& one, VerifyOutcome& outcome) {
  if (one.problem) note_failure(tl::unexpected(*one.problem), outcome);
  if (one.skipped) {
    ++outcome.skipped_files;
    outcome.skipped.insert(key_of(one.file));
    return;
  }
  one.file.revision = job.revision;
  if (!job.prints_late) print(job.options, one.file);
  if (job.hanging) {
    outcome.waiting.push_back(std::move(one.file));
  } else {
    take(job, std::move(one.file), outcome);
  }
}

// Where the tags of all files hang, those of the lines that are resumed too.
Result<void> judge_waiting(const Job& job, VerifyOutcome& outcome) {
  const EachFile all = [&](const auto& take) -> Result<void> {
    for (const VerifiedFile& file : outcome.waiting) take(file);
    if (outcome.skipped.empty()) return {};
    return read_resumed(job.options, job.revision, [&](const VerifiedFile& line) {
      if (outcome.skipped.contains(key_of(line))) take(line);
    });
  };
  Result<std::optional<HungTags>> hung =
      check_hanging("verify", job.request.survey, job.hanging, all);
  if (!hung) return fail(hung);
  outcome.hung = std::move(*hung);
  if (outcome.hung) outcome.merged.hanging_remarks = remarks_of(*outcome.hung);
  for (VerifiedFile& file : outcome.waiting) {
    if (outcome.hung) judge_hanging(job.request.survey, job.hanging->setup, *outcome.hung, file);
    note_failure(save_late_pictures(job.options, file), outcome);
    if (job.prints_late) print(job.options, file);
    take(job, std::move(file), outcome);
  }
  return {};
}

// Of the files that were skipped, what the earlier run said.
Result<void> add_skipped(const Job& job, VerifyOutcome& outcome) {
  return read_resumed(job.options, job.revision, [&](VerifiedFile line) {
    if (outcome.skipped.erase(key_of(line)) == 0) return;
    if (outcome.hung) judge_hanging(job.request.survey, job.hanging->setup, *outcome.hung, line);
    take(job, std::move(line), outcome);
  });
}

Result<VerifyOutcome> verify_all(const Job& job, const std::vector<fs::path>& files) {
  const VerifyCommandOptions& options = job.options;
  VerifyOutcome outcome;
  VerifiedBefore before;
  const auto remember = [&](const VerifiedFile& line) {
    if (!line.sha256.empty()) before.insert(key_of(line));
  };
  if (auto read = read_resumed(options, job.revision, remember, true); !read) {
    return fail(read);
  }
  run_below_bar(
      "files", files.size(), options.jobs,
      [&](std::size_t i) { return verify_one(options, job.request, before, files[i]); },
      [&](std::size_t, VerifiedOne& one) { deliver(job, one, outcome); });
  for (const auto& step : {judge_waiting, add_skipped}) {
    if (auto done = step(job, outcome); !done) return fail(done);
  }
  note_failure(job.ledger.flush(), outcome);
  job.ledger.print_tally();
  finish(outcome.merged);
  if (options.report.shows_pictures()) {
    load_pictures(outcome.merged, {options.resume}, *options.named);
  }
  return outcome;
}

void print_summary(const VerifyCommandOptions& options, const Survey& survey,
                   const VerifyOutcome& outcome, const SkippedFiles& skipped) {
  if (outcome.skipped_files > 0) {
    to_stderr("skipped, verified before: {}\n", outcome.skipped_files);
  }
  if (!skipped.empty()) {
    to_stderr("skipped, no pictures or print files: {}\n", skipped_in_words(skipped));
  }
  if (options.json) {
    to_stdout("{}\n", verify_summary_line(survey, outcome.merged, outcome.hung, skipped));
  } else {
    if (outcome.hung) print_hanging(*outcome.hung);
    print_in_words(survey, outcome.merged);
  }
}

// Names what else is read and written; `listed` are the files to verify.
void add_files(const VerifyCommandOptions& options, const Survey& survey,
               std::span<const Survey> also, const std::vector<fs::path>& listed,
               CommandFiles& files) {
  files.reads(survey);
  for (const Survey& other : also) files.reads(other);
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
  add_ledger_files(options.ledger, files);
  files.writes_into(options.crops, "--crops");
  files.writes_into(options.annotate, "--annotate");
}

Result<int> run(VerifyCommandOptions options) {
  if (options.files.empty() && options.hanging.run.empty()) {
    return fail("FILE is required: photos, print files, folders of them");
  }
  std::vector<fs::path> paths{options.survey};
  paths.insert(paths.end(), options.also.begin(), options.also.end());
  const Result<std::vector<Survey>> surveys = load_surveys(paths);
  if (!surveys) return fail(surveys);
  const Survey& survey = surveys->front();
  const std::span also = std::span(*surveys).subspan(1);
  CommandFiles files;
  Result<std::optional<LoadedHanging>> hanging = load_hanging(options.hanging, files);
  if (!hanging) return fail(hanging);
  const bool of_run = options.files.empty() && *hanging;
  const Result<FileList> list =
      list_files(of_run ? (*hanging)->photos : options.files, image_and_pdf_extensions(), std::cin);
  if (!list) return fail(list);
  add_files(options, survey, also, list->files, files);
  if (const auto usable = files.check(); !usable) return fail(usable);
  options.named = &files;
  if (const auto ready = prepare_to_append(options.resume); !ready) {
    return fail(ready);
  }
  Result<LedgerWriter> ledger = LedgerWriter::open(options.ledger, survey.name);
  if (!ledger) return fail(ledger);
  ManifestCache manifests;
  VerifyRequest request{survey, also, options.wants_crops()};
  request.manifests = &manifests;
  request.scan_dpi = options.scan_dpi;
  for (const Survey& other : also) {
    request.also_revisions += fmt::format("{} {};", other.name, survey_revision(other));
  }
  if (*hanging) {
    request.rig = &(*hanging)->setup.rig;
    request.cameras = &(*hanging)->setup.cameras;
  } else if (!options.scan_dpi && any_names_lens(list->files)) {
    *hanging = hanging_without_rig(options.hanging);
  }
  options.hangs_late = hanging->has_value();
  const Result<VerifyOutcome> outcome =
      verify_all({options, request, *hanging, *ledger, survey_revision(survey)}, list->files);
  if (!outcome) return fail(outcome);
  const VerifyMerge& merged = outcome->merged;
  print_summary(options, survey, *outcome, list->skipped);
  if (const auto written = write_report(options.report, survey, merged, files); !written) {
    return fail(written);
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    return fail("standard output cannot be written, is the disk full?");
  }
  if (outcome->failed) return kExitFailure;
  const bool incomplete = options.complete && !missing_tags(survey, merged).empty();
  const bool contradicts = outcome->hung && outcome->hung->nothing_fits;
  return merged.files_with_findings > 0 || incomplete || contradicts ? kExitFindings : kExitOk;
}

}  // namespace

Command verify_command() {
  auto options = std::make_shared<VerifyCommandOptions>();
  return {
      .name = "verify",
      .summary = "Check print files and photos against the survey",
      .options = joined(
          {{survey_argument(&options->survey, "The survey"),
            argument("FILE", &options->files, ValueKind::file,
                     "Pictures, PDFs, SVGs, folders of them, or - for a list of files on standard "
                     "input"),
            value_option("--also", &options->also, "SURVEY",
                         "Another survey, whose tags are named when they turn up here",
                         ValueKind::survey),
            value_option(
                "--resume", &options->resume, "FILE.jsonl",
                "Skip files whose content an earlier --json run verified against this survey "
                "under the same conditions (manifest, --dpi, --also)",
                ValueKind::json_lines),
            file_option("--ledger", &options->ledger,
                        "Add what the photos show of each plate to this history, for "
                        "`report --ledger`"),
            folder_option("--crops", &options->crops, "Folder for a picture of every faulty tag"),
            folder_option("--annotate", &options->annotate,
                          "Folder for a copy of every photo with its tags outlined and named"),
            flag("--complete", &options->complete,
                 "Tags of the survey that no file shows are wrong too"),
            json_flag(options->json, "One JSON object a file, then the summary"),
            excluding({"--rig"},
                      number_option("--dpi", &options->scan_dpi, "DPI", 10, 10'000,
                                    "Pictures are flat scans of prints with so many dots per inch, "
                                    "not photos: their printed size is checked, too")),
            jobs_option(options->jobs, "Files read at once")},
           report_options(options->report),
           hanging_options(options->hanging)}),
      .notes = kVerifyNotes,
      .run = [options] { return run(*options); },
  };
}

}  // namespace tagsmith::detail
