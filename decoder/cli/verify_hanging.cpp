// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/verify_hanging.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "decoder/image/exif.hpp"
#include "decoder/image/heif.hpp"
#include "decoder/verify/lens_cameras.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {
namespace {

std::string verdict_in_words(const HungTag& tag) {
  switch (tag.verdict) {
    case HangVerdict::off:
      return fmt::format("{} (odds 10^{:.0f})", tag.rule, tag.odds);
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

// Less where the file is shorter; empty where it cannot be read.
std::string beginning_of(const std::filesystem::path& file, std::size_t size) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) return {};
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

}  // namespace

std::vector<CommandOption> hanging_options(HangingOptions& options) {
  return {
      rig_option(&options.rig,
                 "The cameras that took the photos: tells where tags hang that are seen together"),
      needing({"--rig"}, value_option("--camera", &options.camera, "NAME",
                                      "The rig's camera that took all photos, each by itself "
                                      "(default: the one whose name stands in the file's name)")),
      excluding({"--camera"},
                needing({"--rig"},
                        value_option("--run", &options.run, "RUN.csv",
                                     "Run file that says which camera took which photo, and which "
                                     "were taken together; without FILE its photos are verified",
                                     ValueKind::table))),
      with_default(
          number_option("--tolerance", &options.tolerance_mm, "MM", 0.1, 1000,
                        "Farthest that a corner of a tag's frame may be from its place, in mm"))};
}

Result<std::optional<LoadedHanging>> load_hanging(const HangingOptions& options,
                                                  CommandFiles& files) {
  if (options.rig.empty()) return std::nullopt;
  Result<Rig> rig = load_rig(options.rig);
  if (!rig) return fail(rig);
  LoadedHanging loaded{{std::move(*rig), {}, 1e-3 * options.tolerance_mm}, {}};
  HangingSetup& setup = loaded.setup;
  files.reads(setup.rig);
  if (!options.run.empty()) {
    const Result<Run> run = load_run(options.run, setup.rig);
    if (!run) return fail(run);
    files.reads(*run);
    setup.cameras = PhotoCameras::by_run(setup.rig, *run);
    for (const auto& photo : photos_of(run->measurements)) loaded.photos.push_back(photo.string());
  } else if (!options.camera.empty()) {
    Result<PhotoCameras> cameras = PhotoCameras::by_camera(setup.rig, options.camera);
    if (!cameras) return fail(cameras);
    setup.cameras = std::move(*cameras);
  } else {
    setup.cameras = PhotoCameras::by_names(setup.rig);
  }
  return std::optional(std::move(loaded));
}

LoadedHanging hanging_without_rig(const HangingOptions& options) {
  LoadedHanging loaded;
  loaded.setup.by_lenses = true;
  loaded.setup.tolerance = 1e-3 * options.tolerance_mm;
  return loaded;
}

bool any_names_lens(const std::vector<std::filesystem::path>& files) {
  constexpr std::size_t kHeader = 128UL * 1024;  // of a JPEG; the EXIF segment has at most half
  return std::ranges::any_of(files, [&](const std::filesystem::path& file) {
    std::string bytes = beginning_of(file, kHeader);
    if (is_heif(bytes)) bytes = read_file(file).value_or("");
    return photo_lens(bytes).has_value();
  });
}

// Which tags that fit are known too badly to show that they are off by the tolerance; or empty.
std::string too_unsure_in_words(const HungTags& hung, double tolerance) {
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::string> unsure;
  for (const HungTag& tag : hung.tags) {
    const bool tells = tag.offset.sigma.head<2>().maxCoeff() <= tolerance;
    if (tag.verdict == HangVerdict::fits && !tells) unsure.push_back(tag.tag);
  }
  if (unsure.empty()) return {};
  const std::size_t count = unsure.size();
  unsure.resize(std::min(count, kMostNamed));
  return fmt::format(
      "{} that {} may be off by more than the tolerance of {} mm: one standard deviation is more "
      "than that ({}{}); photos from nearer, or a rig that is better known, would tell",
      counted(count, "tag"), count == 1 ? "fits" : "fit", format_number(1000 * tolerance),
      fmt::join(unsure, ", "), count > kMostNamed ? " ..." : "");
}

Result<std::optional<HungTags>> check_hanging(const char* command, const Survey& survey,
                                              std::optional<LoadedHanging>& hanging,
                                              const EachFile& files) {
  if (!hanging) return std::nullopt;
  if (hanging->setup.by_lenses) {
    Result<HangingSetup> by_lenses = hanging_by_lenses(files, hanging->setup.tolerance);
    if (!by_lenses) return fail(by_lenses);
    if (by_lenses->rig.cameras.empty()) {
      hanging.reset();
      return std::nullopt;
    }
    hanging->setup = std::move(*by_lenses);
  }
  Result<HungTags> hung = check_hanging(survey, hanging->setup, files);
  if (!hung) return fail(hung);
  if (hanging->setup.by_lenses) {
    to_stderr(
        "tagsmith {}: no rig given: where tags hang was checked by photos that name their lens and "
        "show two "
        "tags and more; the tags calibrate it\n",
        command);
  }
  if (std::string unsure = too_unsure_in_words(*hung, hanging->setup.tolerance); !unsure.empty()) {
    hung->notes.insert(hung->notes.begin(), std::move(unsure));
  }
  for (const std::string& note : hung->notes) to_stderr("tagsmith {}: {}\n", command, note);
  print_assumptions(command, hung->assumed);
  return std::optional(std::move(*hung));
}

// Nothing where the tags were judged.
std::optional<std::string> not_judged_in_words(const HungTags& hung) {
  if (!hung.nothing_fits) return std::nullopt;
  return std::string("not judged, because ") +
         (hung.rig_doubt.empty() ? "more than half of the tags seen contradict the survey"
                                 : "the rig is in doubt");
}

std::vector<std::string> remarks_of(const HungTags& hung) {
  std::vector<std::string> remarks;
  if (auto words = not_judged_in_words(hung)) remarks.push_back(std::move(*words));
  std::ranges::copy(hung.notes, std::back_inserter(remarks));
  std::ranges::copy(hung.assumed, std::back_inserter(remarks));
  return remarks;
}

void print_hanging(const HungTags& hung) {
  if (const auto words = not_judged_in_words(hung)) {
    to_stdout("where tags hang: {}\n", *words);
    return;
  }
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

}  // namespace tagsmith::detail
