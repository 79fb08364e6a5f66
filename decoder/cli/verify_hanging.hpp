// SPDX-License-Identifier: Apache-2.0
// `verify --rig`: where the tags of the photos hang.
#pragma once

#include <optional>
#include <string>
#include <vector>

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

// Checks all reports together and writes what is found into them.
HungTags check_hanging(const Survey& survey, const HangingSetup& setup, double tolerance,
                       std::vector<FileReport>& reports);

// One line a checked tag, for people.
void print_hanging(const HungTags& hung);

}  // namespace tagsmith
