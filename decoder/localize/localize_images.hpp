// SPDX-License-Identifier: Apache-2.0
// From images straight to the position, searching them no closer than the position needs.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/localize/fix.hpp"
#include "decoder/localize/live_track.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// An image of a measurement.
struct CameraImage {
  const RigCamera* camera = nullptr;
  GrayView image;
  std::string name;  // for messages
};

// The result of localize_jointly for these images and what is known already: tags seen otherwise,
// ranges, faults; mostly in half the time. The closer look at an image (TagSearch) is left out
// where all that was measured agrees on a position by two tags or more, and every tag of the survey
// whose bars should be wholly in the image and clear of its border, at 0.7 pixels a module or more,
// has been read there. A tag that stays unread so hangs elsewhere than surveyed and would be
// outvoted, or adds little: the position is the same except that such tags are not mentioned. With
// a prior the tags are first looked for where they should be, as observe() does. What the images
// show is added to `known`.
Fix localize_images(Observation& known, std::span<const CameraImage> images,
                    const std::vector<Survey>& surveys, const Rig& rig,
                    const std::optional<PosePrior>& prior = std::nullopt);

class PictureMemory;

// The same for a measurement, whose images are loaded first. Pictures that the memory knows from
// earlier measurements are left out. `seen` is set to what the measurement shows.
Fix localize_measurement(const Measurement& measurement, const std::vector<Survey>& surveys,
                         const Rig& rig, const std::optional<PosePrior>& prior,
                         PictureMemory& memory, Observation& seen);

}  // namespace tagsmith::detail
