// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/adjust_input.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "decoder/cli/file_list.hpp"
#include "decoder/cli/report_files.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_json.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

bool holds_lines(const std::string& file) {
  const std::string extension = fs::path(file).extension().string();
  return extension == ".jsonl" || extension == ".json" || extension == ".ndjson";
}

Result<std::vector<std::string>> control_tags(const AdjustOptions& options, const Survey& survey) {
  for (const std::string& name : options.control) {
    if (find_tag(survey, std::string_view(name)) != nullptr) continue;
    return fail(
        fmt::format("--control {}: {} has no tag of this name", name, survey.file.string()));
  }
  if (!options.control.empty()) return options.control;
  std::vector<std::string> names;
  for (const PlacedTag& tag : survey.tags) {
    if (tag.control) names.push_back(tag.name);
  }
  if (!names.empty()) return names;
  return fail(survey.file.string() +
              ": has no control tag: write `control: true` at the tags in `placed` that were "
              "surveyed best, or name them with --control");
}

// All photos, read and compared with the survey.
Result<std::vector<VerifiedFile>> verify_photos(const AdjustInput& input, int jobs) {
  VerifyRequest request{input.survey};
  request.rig = &input.setup.rig;
  request.cameras = &input.setup.cameras;
  const std::string revision = survey_revision(input.survey);
  std::vector<VerifiedFile> files(input.photos.size());
  std::string failure;
  ProgressBar progress("photos", files.size());
  run_in_order(files.size(), jobs, [&](std::size_t i) -> Delivery {
    auto verified = std::make_shared<Result<VerifiedFile>>(verify_file(request, input.photos[i]));
    return [&, i, verified] {
      if (*verified) {
        files[i] = std::move(**verified);
        files[i].revision = revision;
      } else if (failure.empty()) {
        failure = verified->error().message;
      }
      progress.advance([] {});
    };
  });
  if (!failure.empty()) return fail(failure);
  return files;
}

// How many files of what the lines say are photos, and how many of these of another survey.
struct Told {
  std::size_t photos = 0;
  std::size_t others = 0;
};

Result<Told> read_lines(const AdjustInput& input,
                        const std::function<void(const VerifiedFile&)>& take) {
  const std::string revision = survey_revision(input.survey);
  Told told;
  for (const fs::path& path : input.lines) {
    const Result<VerifyLineCounts> counts = read_verify_lines(path, [&](const VerifiedFile& file) {
      if (!file.is_photo()) return;
      ++told.photos;
      if (file.revision != revision) ++told.others;
      take(file);
    });
    if (!counts) return fail(counts.error().message);
    if (counts->files == 0) {
      return fail(path.string() + ": has no line of `verify --json`");
    }
    tell_broken_lines(path.string(), *counts);
  }
  if (told.photos > 0 && told.others == told.photos) {
    return fail(fmt::format(
        "{}: all {} photos were verified against another state of the survey {}: verify them again",
        input.lines.front().string(), told.photos, input.survey.file.string()));
  }
  return told;
}

}  // namespace

Result<AdjustInput> load_adjust_input(const AdjustOptions& options) {
  if (!options.date.empty() && !parse_day(options.date)) {
    return fail("--date " + options.date + ": expected a day as 2026-03-31");
  }
  if (!options.drawing.empty() && !sheet_format_of(options.drawing)) {
    return fail("--drawing " + options.drawing +
                ": expected a name that ends with .pdf, .svg or .png");
  }
  Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey.error().message);
  CommandFiles files;
  Result<std::optional<LoadedHanging>> hanging = load_hanging(options.hanging, files);
  if (!hanging) return fail(hanging.error().message);
  Result<std::vector<std::string>> control = control_tags(options, *survey);
  if (!control) return fail(control.error().message);
  AdjustInput input{std::move(*survey), std::move((*hanging)->setup), {}, {}, std::move(*control)};
  std::vector<std::string> photos;
  for (const std::string& file : options.files) {
    if (holds_lines(file)) {
      input.lines.emplace_back(file);
    } else {
      photos.push_back(file);
    }
  }
  if (options.files.empty()) photos = (*hanging)->photos;
  if (photos.empty() && input.lines.empty()) {
    return fail("FILE is required: output of `verify --json`, photos, or --run");
  }
  const Result<FileList> list = list_files(photos, image_extensions(), std::cin);
  if (!list) return fail(list.error().message);
  input.photos = list->files;
  files.reads(input.survey);
  for (const fs::path& file : input.lines) files.reads(file, "the lines");
  for (const fs::path& file : input.photos) files.reads(file, "a photo");
  files.writes(options.output, "--output");
  files.writes(options.diff, "--diff");
  files.writes(options.drawing, "--drawing");
  if (const auto usable = files.check(); !usable) return fail(usable.error().message);
  return input;
}

Result<std::vector<SightedTag>> sighted_tags(const AdjustInput& input, int jobs) {
  const Result<std::vector<VerifiedFile>> photos = verify_photos(input, jobs);
  if (!photos) return fail(photos.error().message);
  std::vector<SightedTag> all;
  std::vector<std::string> notes;
  Told told;
  const EachFile files = [&](const auto& take) -> Result<void> {
    for (const VerifiedFile& file : *photos) take(file);
    const Result<Told> read = read_lines(input, take);
    if (!read) return fail(read.error().message);
    told = *read;
    return {};
  };
  const auto taken = for_each_sighted(input.survey, input.setup, files,
                                      [&](const auto& tags, const std::string& note) {
                                        all.insert(all.end(), tags.begin(), tags.end());
                                        if (!note.empty()) notes.push_back(note);
                                      });
  if (!taken) return fail(taken.error().message);
  if (told.others > 0) {
    to_stderr("{}: {} photos were verified against another state of the survey and left out\n",
              kAdjust, told.others);
  }
  constexpr std::size_t kMostNotes = 20;
  for (std::size_t i = 0; i < std::min(notes.size(), kMostNotes); ++i) {
    to_stderr("{}: {}\n", kAdjust, notes[i]);
  }
  return all;
}

}  // namespace tagsmith::detail
