// SPDX-License-Identifier: Apache-2.0
// Plates that read well and still hang wrong: upside down, exchanged, on the other wall.
#pragma once

#include <optional>
#include <string_view>

#include "decoder/verify/evidence.hpp"
#include "decoder/verify/verified_file.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// True when the survey has the tag hang with its arrow up, to 45 degrees.
bool hangs_upright(const Survey& survey, const VerifiedTag& tag);

// True for a tag of the survey that is read in its frame, once, and not mirrored.
bool reads_well(const PictureEvidence& evidence, const TagEvidence& seen);

// The text of a note on a photo after "all 3 tags" when it doubts the camera's up.
inline constexpr std::string_view kDoubtedUp =
    " are upside down by the photo's EXIF orientation: the camera was upside down and noted "
    "otherwise, or all of them hang so; whether a single one does was not checked";

// Which way is up as the camera noted (EXIF), or `doubted` when all tags that read well and that
// the survey has upright are upside down by it.
UpSource up_of_photo(const PictureEvidence& evidence);

// Tags that are upside down: on a page; and in a photo, whose up no rig gives, those that the
// survey has upright. When all of a photo are so, a single one is `doubtful`, and several are in
// order, since then the camera was held so. And, whatever the camera noted, one that two others and
// more contradict and none agrees with.
std::optional<Finding> find_upside_down(const PictureEvidence& evidence, const TagEvidence& seen);

// Compares tags of one photo in pairs, by the plane of one of the two plates. Both are `misplaced`
// when they hang in one plane and the survey has them on opposite walls (`wrong-wall`), or in the
// opposite order along their wall (`swapped`). Only neighbours within 4 m are compared, and only at
// 2 px a module or more: farther away the plane is too uncertain.
std::optional<Finding> find_misplaced(const PictureEvidence& evidence, const TagEvidence& seen);

}  // namespace tagsmith::detail
