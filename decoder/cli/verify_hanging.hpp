// SPDX-License-Identifier: Apache-2.0
// Where the tags of the photos hang: with `--rig`, or with the lenses that the photos name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "decoder/verify/hanging_check.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

class CommandFiles;

struct HangingOptions {
  std::string rig;     // empty = by the lenses that photos name
  std::string camera;  // of the rig, that took all photos
  std::string run;     // that says which camera took which photo
  double tolerance_mm = 1e3 * kHangTolerance;
};

std::vector<CommandOption> hanging_options(HangingOptions& options);

// What the options specify; nothing without --rig. The files are added as inputs of the command,
// and the photos of the run are `photos`.
struct LoadedHanging {
  HangingSetup setup;
  std::vector<std::string> photos;
};
Result<std::optional<LoadedHanging>> load_hanging(const HangingOptions& options,
                                                  CommandFiles& files);

// Without --rig: photos whose lenses their lines name (EXIF).
LoadedHanging hanging_without_rig(const HangingOptions& options);

// True when one of the files is a photo that names its lens.
bool any_names_lens(const std::vector<std::filesystem::path>& files);

// The findings on all tags: on standard error what could not be used and what is assumed. Nothing
// without a rig when no photo names its lens; the result for lenses is added to `hanging`.
Result<std::optional<HungTags>> check_hanging(const char* command, const Survey& survey,
                                              std::optional<LoadedHanging>& hanging,
                                              const EachFile& files);

// What a reader of the result must know: why nothing was judged, what could not be used and what is
// assumed; sentences without their full stop.
std::vector<std::string> remarks_of(const HungTags& hung);

// One line a checked tag, for people.
void print_hanging(const HungTags& hung);

}  // namespace tagsmith::detail
