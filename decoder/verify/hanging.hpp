// SPDX-License-Identifier: Apache-2.0
// Plates that read well and are still wrong: mirrored, upside down, exchanged, on the other wall.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/image/upright.hpp"
#include "decoder/verify/finding.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// A UPC-A symbol mirrored has the bars of the same symbol upside down, so its bars cannot tell.
// The label can: it stands below the frame as the bars are read, and above it in a mirrored print.
// Makes `ok` findings `misprinted` (rule `mirrored`) where that place is white and ink stands in
// the opposite one, from 4 px a module on. Where the frame stands 5 mm and more above or below the
// plate's middle, the plate's edges tell the same from 2 px a module on, before a dark ground.
void find_mirrored(const GrayView& image, const TagTemplate& tag,
                   std::vector<TagFinding>& findings);

// For pages, whose up is known: `ok` tags that stand on their head become `misprinted`.
void find_upside_down(std::vector<TagFinding>& findings);

// True when the survey has the tag hang with its arrow up, to 45 degrees.
bool hangs_upright(const Survey& survey, const TagFinding& finding);

// What a note on a photo says after "all 3 tags" when it doubts the camera's up.
inline constexpr std::string_view kDoubtedUp =
    " are upside down by the photo's EXIF orientation: the camera was upside down and noted "
    "otherwise, or all of them hang so; whether a single one does was not checked";

// For photos, `ok` tags that the survey has upright; returns what is known of the photo's up. Where
// the camera noted how it was held (EXIF, `camera_up`, of a picture as stored), those that stand on
// their head become `misprinted`. When all do, the camera's note is doubted: a single one becomes
// `doubtful`, several stay in order, since then the camera was held so. And, noted or not, one
// against whom two others and more stand, none with it, is `misprinted`.
UpSource find_upside_down_by_camera(const Survey& survey, const std::optional<Upright>& camera_up,
                                    std::vector<TagFinding>& findings);

// Compares `ok` tags of one picture in pairs, by the plane of one of the two plates. Both become
// `misplaced` when they hang in one plane and the survey has them on opposite walls (`wrong-wall`),
// or the other way round along their wall (`swapped`). Only neighbours within 4 m are compared,
// and only at 2 px a module or more: farther away the plane is too uncertain.
void find_misplaced(const Survey& survey, std::vector<TagFinding>& findings);

}  // namespace tagsmith
