// SPDX-License-Identifier: Apache-2.0
// Where tags hang, determined from all photos together: as-built deviations from the survey, judged
// over the results of all files and written back into each.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "decoder/plates/hung_tags.hpp"
#include "decoder/verify/photo_cameras.hpp"
#include "decoder/verify/verified_file.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Which photos can show where tags hang, and how far from its place one may hang.
struct HangingSetup {
  Rig rig;
  PhotoCameras cameras;
  double tolerance = kHangTolerance;  // metres
  bool by_lenses = false;             // the rig is that of hanging_by_lenses
};

// Calls back with the result of every file, in the same order each time.
using EachFile = std::function<Result<void>(const std::function<void(const VerifiedFile&)>&)>;

// Calls `take` with the tags of every photo that show where they hang, and with the note on a photo
// that could not be used. A file counts once, and only if it was verified against this state of the
// survey.
Result<void> for_each_sighted(
    const Survey& survey, const HangingSetup& setup, const EachFile& files,
    const std::function<void(const std::vector<SightedTag>&, const std::string&)>& take);

// The deviations of all tags in order that were seen by known cameras. Goes over the files twice,
// so that an archive need not be in memory: first to choose stations (SightingPick), then to take
// their tags. A file counts once, and only if it was verified against this state of the survey.
// Photos of unknown cameras, and of other sizes than their camera's, are left out and noted.
Result<HungTags> check_hanging(const Survey& survey, const HangingSetup& setup,
                               const EachFile& files);

// Writes into a photo's tags where they hang: off becomes `misplaced`, doubtful `doubtful`, and a
// `misplaced` by one photo alone that hangs as surveyed `ok`. In photos that fit no place of the
// cameras all tags become `doubtful`. What an earlier check said of where they hang is removed.
// With a rig that stands_level, tags in order that the survey has upright and that are turned by a
// quarter turn and more become `misprinted` (rule `upside-down`), and tags that the camera's own
// note made doubtful are in order again.
void judge_hanging(const Survey& survey, const HangingSetup& setup, const HungTags& hung,
                   VerifiedFile& file);

}  // namespace tagsmith::detail
