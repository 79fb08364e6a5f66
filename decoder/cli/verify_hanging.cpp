// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_hanging.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <unordered_set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "decoder/verify/hanging_check.hpp"
#include "decoder/verify/sighting_pick.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/number_between.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith {
namespace {

std::string verdict_in_words(const HungTag& tag) {
  switch (tag.verdict) {
    case HangVerdict::off:
      return tag.rule;
    case HangVerdict::doubtful:
      return tag.rivals.empty() ? tag.rule + "?" : "this one or " + tag.rivals.front();
    case HangVerdict::fits:
    case HangVerdict::unchecked:
      break;
  }
  return "ok";
}

void print_in_words(const HungTag& tag) {
  if (tag.offset.sigma.isZero()) {
    to_stdout("{:>8}  not measured  {}\n", tag.tag, verdict_in_words(tag));
    return;
  }
  const Measured3& offset = tag.offset;
  const Measured3& turn = tag.turn;
  const auto mm = [](double metres) { return 1e3 * metres; };
  to_stdout(
      "{:>8} {:+7.1f} ±{:4.1f} {:+7.1f} ±{:4.1f} {:+7.1f} ±{:4.1f} {:+6.2f} ±{:4.2f} {:+6.2f}"
      " ±{:4.2f} {:+6.2f} ±{:4.2f} {:4}  {}\n",
      tag.tag, mm(offset.value[0]), mm(offset.sigma[0]), mm(offset.value[1]), mm(offset.sigma[1]),
      mm(offset.value[2]), mm(offset.sigma[2]), degrees(turn.value[0]), degrees(turn.sigma[0]),
      degrees(turn.value[1]), degrees(turn.sigma[1]), degrees(turn.value[2]),
      degrees(turn.sigma[2]), tag.stations, verdict_in_words(tag));
}

// Photos that could not be used are told up to this number.
constexpr std::size_t kMostNotes = 20;

HungTags checked(const Survey& survey, const HangingSetup& setup, double tolerance,
                 const std::vector<SightedTag>& sighted, const std::vector<std::string>& notes) {
  HungTags hung = check_hung_tags(survey, setup.rig, sighted, tolerance);
  hung.notes.insert(hung.notes.begin(), notes.begin(), notes.end());
  if (hung.nothing_fits) {
    hung.notes.push_back(
        "more than half of the tags seen contradict the survey: are these its photos, and is the "
        "rig's calibration right? No tag was accused");
  }
  return hung;
}

void write_hanging(const Survey& survey, const HangingSetup& setup, const HungTags& hung,
                   std::vector<FileReport>& reports) {
  report_hung_tags(hung, setup.cameras, reports);
  find_upside_down_in_photos(survey, setup.rig, setup.cameras, reports);
}

std::size_t identity(const std::string& file, const std::string& sha256) {
  return std::hash<std::string>{}(file + '\n' + sha256);
}

// The tags of every photo's line, once each and none of `known`, with notes on those that could not
// be used.
Result<void> read_sighted(
    const Survey& survey, const HangingSetup& setup, const std::vector<std::string>& lines,
    std::unordered_set<std::size_t> known,
    const std::function<void(const std::vector<SightedTag>&, std::vector<std::string>&)>& take) {
  const std::string revision = survey_revision(survey);
  for (const std::string& path : lines) {
    const Result<VerifyLineCounts> read = read_verify_lines(path, [&](const VerifiedFile& line) {
      if (line.width == 0 || line.revision != revision) return;
      if (!known.insert(identity(line.file, line.sha256)).second) return;
      VerifiedFile file = line;
      forget_hanging(file);
      // A line without corners is of an older version.
      std::erase_if(file.tags, [](const VerifiedTag& tag) { return !tag.corners || !tag.is_read; });
      std::vector<std::string> notes;
      const std::vector<FileReport> reports{report_of(file)};
      take(sighted_tags(survey, setup.rig, setup.cameras, reports, notes), notes);
    });
    if (!read) return fail(read.error().message);
  }
  return {};
}

}  // namespace

void add_hanging_options(CLI::App& app, HangingOptions& options) {
  CLI::Option* rig =
      app.add_option(
             "--rig", options.rig,
             "The cameras that took the photos: tells where tags hang that are seen together")
          ->type_name("RIG");
  CLI::Option* camera =
      app.add_option(
             "--camera", options.camera,
             "The rig's camera that took all photos, each by itself (default: the one whose "
             "name stands in the file's name)")
          ->type_name("NAME")
          ->needs(rig);
  app.add_option("--run", options.run,
                 "Run file that says which camera took which photo, and which were taken together; "
                 "without FILE its photos are verified")
      ->type_name("RUN.csv")
      ->needs(rig)
      ->excludes(camera);
  app.add_option("--tolerance", options.tolerance_mm,
                 "Farthest that a corner of a tag's frame may be from its place, in mm")
      ->type_name("MM")
      ->capture_default_str()
      ->check(number_between(0.1, 1000))
      ->needs(rig);
}

Result<std::optional<HangingSetup>> load_hanging(const HangingOptions& options) {
  if (options.rig.empty()) return std::nullopt;
  Result<Rig> rig = load_rig(options.rig);
  if (!rig) return fail(rig.error().message);
  HangingSetup setup{std::move(*rig), {}, {}};
  if (!options.run.empty()) {
    const Result<Run> run = load_run(options.run, setup.rig);
    if (!run) return fail(run.error().message);
    setup.cameras = PhotoCameras::by_run(setup.rig, *run);
    for (const Measurement& row : run->measurements) {
      for (const auto& [name, seen] : row.cameras) {
        if (!seen.image.empty()) setup.photos.push_back(seen.image.string());
      }
    }
  } else if (!options.camera.empty()) {
    Result<PhotoCameras> cameras = PhotoCameras::by_camera(setup.rig, options.camera);
    if (!cameras) return fail(cameras.error().message);
    setup.cameras = std::move(*cameras);
  } else {
    setup.cameras = PhotoCameras::by_names(setup.rig);
  }
  return std::optional(std::move(setup));
}

void add_hanging_files(const HangingOptions& options, const HangingSetup& setup,
                       CommandFiles& files) {
  files.reads(setup.rig);
  files.reads(options.run, "the run");
  for (const std::string& photo : setup.photos) files.reads(photo, "a photo of the run");
}

HungTags check_hanging(const Survey& survey, const HangingSetup& setup, double tolerance,
                       std::vector<FileReport>& reports) {
  std::vector<std::string> notes;
  const std::vector<SightedTag> sighted =
      sighted_tags(survey, setup.rig, setup.cameras, reports, notes);
  HungTags hung = checked(survey, setup, tolerance, sighted, notes);
  write_hanging(survey, setup, hung, reports);
  return hung;
}

Result<HungTags> check_hanging_lines(const Survey& survey, const HangingSetup& setup,
                                     double tolerance, const std::vector<std::string>& lines,
                                     std::vector<FileReport>& reports) {
  SightingPick pick;
  std::vector<std::string> notes;
  const std::vector<SightedTag> of_reports =
      sighted_tags(survey, setup.rig, setup.cameras, reports, notes);
  std::size_t left_out = notes.size();
  if (notes.size() > kMostNotes) notes.resize(kMostNotes);
  pick.count(of_reports);
  // Output that is appended to the lines that are resumed has its reports there, too.
  std::unordered_set<std::size_t> known;
  for (const FileReport& report : reports) {
    known.insert(identity(report.file.string(), report.sha256));
  }
  const auto counted =
      read_sighted(survey, setup, lines, known, [&](const auto& sighted, auto& news) {
        pick.count(sighted);
        left_out += news.size();
        for (std::string& note : news) {
          if (notes.size() < kMostNotes) notes.push_back(std::move(note));
        }
      });
  if (!counted) return fail(counted.error().message);
  if (left_out > notes.size()) {
    notes.push_back(fmt::format("{} more photos likewise", left_out - notes.size()));
  }
  pick.choose();
  pick.take(of_reports);
  const auto taken = read_sighted(survey, setup, lines, known,
                                  [&](const auto& sighted, auto&) { pick.take(sighted); });
  if (!taken) return fail(taken.error().message);
  HungTags hung = checked(survey, setup, tolerance, pick.taken(), notes);
  write_hanging(survey, setup, hung, reports);
  return hung;
}

void judge_line(const Survey& survey, const HangingSetup& setup, const HungTags& hung,
                VerifiedFile& file) {
  if (file.width == 0 || file.revision != survey_revision(survey)) return;
  forget_hanging(file);
  std::vector<FileReport> reports{report_of(file)};
  write_hanging(survey, setup, hung, reports);
  take_findings(reports.front(), file);
}

void print_hanging(const HungTags& hung) {
  const auto is_checked = [](const HungTag& tag) { return tag.verdict != HangVerdict::unchecked; };
  const auto checked = std::ranges::count_if(hung.tags, is_checked);
  to_stdout(
      "where tags hang, against the survey and facing the wall: {} checked, {} never seen "
      "together with another\n",
      checked, static_cast<std::ptrdiff_t>(hung.tags.size()) - checked);
  if (checked == 0) return;
  to_stdout(
      "     tag    right, mm        up, mm       out, mm clockwise, deg right edge out     top "
      "out seen\n");
  for (const HungTag& tag : hung.tags) {
    if (is_checked(tag)) print_in_words(tag);
  }
}

}  // namespace tagsmith
