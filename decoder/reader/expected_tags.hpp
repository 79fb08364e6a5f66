// SPDX-License-Identifier: Apache-2.0
// Tags that should be in a picture, known beforehand.
#pragma once

#include <vector>

#include "decoder/reader/read_options.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The tags of a survey that a camera at this pose faces and has wholly in its image, at 0.25 pixels
// a module or more; nearest first. `uncertainty_px` is that of the corners, as the pose leaves it.
std::vector<ExpectedTag> expected_tags(const Survey& survey, const Camera& camera,
                                       const Pose& camera_from_world, double uncertainty_px);

}  // namespace tagsmith::detail
