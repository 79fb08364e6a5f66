// SPDX-License-Identifier: Apache-2.0
// The cameras of photos without a rig, from what the photos say of their lenses.
#pragma once

#include "decoder/verify/hanging_check.hpp"

namespace tagsmith::detail {

// A camera held by hand, of a picture of this size and a lens that is equivalent to this focal
// length (millimetres, on 35 mm film; CIPA DCG-001: of the same angle across the diagonal). Its
// calibration has the uncertainty of this length, and the changes by autofocus and stabilisation
// from photo to photo are included.
RigCamera camera_by_lens(int width, int height, double focal_35_mm);

// A camera for each lens and picture size that the photos name; each photo was taken separately,
// and held any way. The tags in all photos of a camera calibrate it when they are checked.
Result<HangingSetup> hanging_by_lenses(const EachFile& files, double tolerance);

}  // namespace tagsmith::detail
