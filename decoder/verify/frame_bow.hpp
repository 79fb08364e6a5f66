// SPDX-License-Identifier: Apache-2.0
// How far the sides of a feature frame are from straight: those of a bent plate bow.
#pragma once

#include <array>
#include <optional>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/verify/evidence.hpp"
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

// What is left of the bow when the image is undistorted by the one radial term (about its centre)
// that leaves least: what a bow tells of the plate when the lens is not known.
FrameBow without_radial(const FrameBow& bow, const FrameCorners& corners, int width, int height);

// Share of their length by which both of two opposite sides bow to the same direction; the larger
// of the two pairs of sides. A flat plate has next to none under any perspective.
double share_of_bend(const FrameBow& bow, const FrameCorners& corners);

// A bend from which a tag counts as bent: with a calibrated camera, and without one.
inline constexpr double kMostBend = 0.01;
inline constexpr double kMostBendOfUnknownLens = 0.02;

// The plate of a photo's tag that is bent.
std::optional<Finding> find_bent(const PictureEvidence& evidence, const TagEvidence& seen);

}  // namespace tagsmith::detail
