// SPDX-License-Identifier: Apache-2.0
// What a survey tells the reader: how to read its tags, and which of them should be in a picture.
#pragma once

#include <span>
#include <vector>

#include "decoder/reader/read_options.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// How to read the tags of these surveys: their templates' layouts, their codes as the code book,
// and their check digit where they agree on one.
ReadOptions read_options_for(std::span<const Survey> surveys);

// The same of surveys that lie apart; none is copied.
ReadOptions read_options_of(std::span<const Survey* const> surveys);

// ---- Tags that should be in a picture, known beforehand.

// The tags of a survey that a camera at this pose faces and has wholly in its image, at 0.25 pixels
// a module or more; nearest first. `uncertainty_px` is that of the corners, as the pose leaves it.
std::vector<ExpectedTag> expected_tags(const Survey& survey, const Camera& camera,
                                       const Pose& camera_from_world, double uncertainty_px);

}  // namespace tagsmith::detail
