// SPDX-License-Identifier: Apache-2.0
// Print quality of the tags that were found in order.
#pragma once

#include <optional>

#include "decoder/grade/grade.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/verify/verified_file.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// What the template's reference patches are taken to reflect: plain white film and solid ink.
inline constexpr double kWhitePatchReflectance = 0.85;
inline constexpr double kBlackPatchReflectance = 0.04;

// Light of the plate's reference patches; `corners` are the feature frame's. Nothing when the
// template has none, one leaves the picture, the white one is overexposed, or the two differ by
// less than a tenth of all light.
std::optional<ReflectanceReferences> find_references(const GrayView& image, const TagTemplate& tag,
                                                     const FrameCorners& corners);

// Fills `grade`, or `grade_reason`.
void grade_tag(const GrayView& image, const TagTemplate& tag, VerifiedTag& verified);

}  // namespace tagsmith::detail
