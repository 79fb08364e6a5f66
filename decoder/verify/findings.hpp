// SPDX-License-Identifier: Apache-2.0
// What is wrong with the tags of a picture: one function for each kind of finding, here or, where
// it needs more than a picture's evidence, in hanging.hpp. To add one, write it,
// name it in the list in findings.cpp, and describe its rule in docs/verify-rules.md, which the
// build takes into the program.
#pragma once

#include <array>
#include <optional>

#include "decoder/image/gray.hpp"
#include "decoder/verify/evidence.hpp"
#include "decoder/verify/verified_file.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// ---- How far the sides of a feature frame are from straight: the sides of a bent plate are bowed.

// Of the sides P-F, F-R, R-Q, Q-P: how far the middle of the inner edge stands outwards from the
// line through its ends, pixels (inwards: negative).
using FrameBow = std::array<double, 4>;

// Nothing when a side is too small, blurred, dirty or covered to be followed to a third of a pixel.
std::optional<FrameBow> measure_bow(const GrayView& image, const TagTemplate& tag,
                                    const FrameCorners& corners);

// The bow that a camera's lens gives to straight sides between these corners.
FrameBow bow_of_lens(const Camera& camera, const FrameCorners& corners);

// The rest of the bow when the image is undistorted by the one radial term (about its centre) that
// leaves least: the evidence for a bent plate when the lens is not known.
FrameBow without_radial(const FrameBow& bow, const FrameCorners& corners, int width, int height);

// Share of their length by which both of two opposite sides bow to the same direction; the larger
// of the two pairs of sides. A flat plate has almost none under any perspective.
double share_of_bend(const FrameBow& bow, const FrameCorners& corners);

// A bend from which a tag counts as bent: with a calibrated camera, and without one.
inline constexpr double kMostBend = 0.01;
inline constexpr double kMostBendOfUnknownLens = 0.02;

// The plate of a photo's tag that is bent.
std::optional<Finding> find_bent(const PictureEvidence& evidence, const TagEvidence& seen);

// ---- The findings.

// Checks one tag for which none of the findings before it in the list was made. `status` of the
// picture's other tags is the result of those findings.
using FindFault = std::optional<Finding> (*)(const PictureEvidence&, const TagEvidence&);

// Makes at most one finding for every tag: the first of the list, in its order of precedence.
void find_faults(PictureEvidence& evidence);

std::optional<Finding> find_unknown(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_duplicate(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_cut_off(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_unread(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_mirrored(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_wrong_scale(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_repeated(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_other_file(const PictureEvidence& evidence, const TagEvidence& seen);

}  // namespace tagsmith::detail
