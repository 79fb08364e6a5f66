// SPDX-License-Identifier: Apache-2.0
// Why a tag could not be read, as measured in the picture.
#pragma once

#include <optional>
#include <string>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

struct Diagnosis {
  std::string rule;   // docs/verify-rules.md
  std::string words;  // what was measured and its limit
};

// The reason why a refused tag cannot be read: the first that applies, in the order of kJudges
// (diagnose.cpp); else `undecodable`, with what is suspected. In a photo it is glare, too, when
// white at the end of the camera's scale leaves bars narrow. `orientation` of the picture (EXIF):
// places on a plate are described as in the upright picture; nothing = not known, then the stored
// picture's own up is used and named.
Diagnosis diagnose(const GrayView& image, const TagTemplate& tag, const Rejection& rejection,
                   const std::optional<int>& orientation = 1, bool is_photo = true);

// What covers or damages the bars of a tag that was read nevertheless: rule `covered`, and in words
// how much and where; nothing when all is in view. Takes as long as the diagnosis of an unread one.
std::optional<Diagnosis> find_cover(const GrayView& image, const TagTemplate& tag,
                                    const FrameCorners& corners,
                                    const std::optional<int>& orientation);

// What is wrong with the light on a plate, within these corners; nothing when it could be read.
std::optional<Diagnosis> diagnose_light(const GrayView& image, const FrameCorners& corners);

// What is wrong with the light of a whole picture in which no tag was found; nothing when a tag
// could have been seen in it.
std::optional<Diagnosis> diagnose_picture(const GrayView& image);

}  // namespace tagsmith::detail
