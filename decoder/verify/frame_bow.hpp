// SPDX-License-Identifier: Apache-2.0
// How far the sides of a feature frame are from straight: the sides of a bent plate are bowed.
#pragma once

#include <array>
#include <optional>

#include "decoder/image/gray.hpp"
#include "decoder/verify/evidence.hpp"
#include "decoder/verify/verified_file.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// Of the sides P-F, F-R, R-Q, Q-P: how far the middle of the inner edge stands outwards from the
// line through its ends, pixels (inwards: negative).
using FrameBow = std::array<double, 4>;

// Nothing when a side is too small, blurred, dirty or covered to be followed to a third of a pixel.
std::optional<FrameBow> measure_bow(const GrayView& image, const TagTemplate& tag,
                                    const FrameCorners& corners);

// The bow that a camera's lens gives to straight sides between these corners.
FrameBow bow_of_lens(const Camera& camera, const FrameCorners& corners);

// Share of their length by which both of two opposite sides bow to the same direction; the larger
// of the two pairs of sides. A flat plate has almost none under any perspective.
double share_of_bend(const FrameBow& bow, const FrameCorners& corners);

// The plate of a photo's tag that is bent.
std::optional<Finding> find_bent(const PictureEvidence& evidence, const TagEvidence& seen);

}  // namespace tagsmith::detail
