// SPDX-License-Identifier: Apache-2.0
// `verify --rig`: where the tags of the photos hang.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "decoder/cli/verify_lines.hpp"
#include "decoder/verify/finding.hpp"
#include "decoder/verify/hung_tags.hpp"
#include "decoder/verify/photo_cameras.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace CLI {
class App;
}

namespace tagsmith {

class CommandFiles;

struct HangingOptions {
  std::string rig;     // empty = where tags hang is not checked
  std::string camera;  // of the rig, that took all photos
  std::string run;     // that says which camera took which photo
  double tolerance_mm = 1e3 * kHangTolerance;
};

void add_hanging_options(CLI::App& app, HangingOptions& options);

// Which photos can tell where tags hang.
struct HangingSetup {
  Rig rig;
  PhotoCameras cameras;
  std::vector<std::string> photos;  // of the run
};

// Nothing without --rig.
Result<std::optional<HangingSetup>> load_hanging(const HangingOptions& options);

// Names what it was loaded from as inputs of the command.
void add_hanging_files(const HangingOptions& options, const HangingSetup& setup,
                       CommandFiles& files);

// Checks all reports together and writes what is found into them.
HungTags check_hanging(const Survey& survey, const HangingSetup& setup, double tolerance,
                       std::vector<FileReport>& reports);

// The same for lines of `verify --json`, of any number of photos: reads every file twice, with the
// reports at hand besides, whose tags it judges. Lines of other states of the survey have no part
// in it. What lines are told is left to judge_line.
Result<HungTags> check_hanging_lines(const Survey& survey, const HangingSetup& setup,
                                     double tolerance, const std::vector<std::string>& lines,
                                     std::vector<FileReport>& reports);

// Writes into the line where its tags hang by all photos, in place of what it said of that.
void judge_line(const Survey& survey, const HangingSetup& setup, const HungTags& hung,
                VerifiedFile& file);

// One line a checked tag, for people.
void print_hanging(const HungTags& hung);

}  // namespace tagsmith
