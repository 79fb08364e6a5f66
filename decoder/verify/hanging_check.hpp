// SPDX-License-Identifier: Apache-2.0
// From the reports on photos to where the tags hang, and back into the reports.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "decoder/verify/finding.hpp"
#include "decoder/verify/hung_tags.hpp"
#include "decoder/verify/photo_cameras.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// The tags of these reports that are in order, by their cameras. What cannot be used is told in
// `notes`: photos of unknown cameras, and of other sizes than their camera's.
std::vector<SightedTag> sighted_tags(const Survey& survey, const Rig& rig,
                                     const PhotoCameras& cameras,
                                     std::span<const FileReport> reports,
                                     std::vector<std::string>& notes);

// Writes into every tag of the reports where it hangs: off becomes `misplaced`, doubtful
// `doubtful`, and a `misplaced` of find_misplaced that hangs as surveyed `ok`; and into the
// reports' findings. In photos that fit no place of the cameras all tags become `doubtful`.
void report_hung_tags(const HungTags& hung, const PhotoCameras& cameras,
                      std::vector<FileReport>& reports);

// For photos, whose up the rig tells: tags in order that the survey has upright and that stand on
// their head by the rig's stance, a quarter turn and more, become `misprinted` (rule
// `upside-down`), and what the camera's own note made doubtful is in order again. Only by a rig
// that stands_level.
void find_upside_down_in_photos(const Survey& survey, const Rig& rig, const PhotoCameras& cameras,
                                std::vector<FileReport>& reports);

}  // namespace tagsmith
