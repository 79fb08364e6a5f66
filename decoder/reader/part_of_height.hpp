// SPDX-License-Identifier: Apache-2.0
// Tags of which the picture's border cuts off the upper or the lower side.
#pragma once

#include <optional>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/part_reading.hpp"
#include "decoder/reader/read_options.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {

// Reads a tag whose outline (to a pixel or two) has its upper or its lower side, as side 1, on the
// picture's border. All digits are in sight. Three sides are, too, with which the frame's
// proportions give the fourth, as the camera sees them. Nothing where no code of the book is read
// with the certainty that a whole tag needs, or where the bars do not end where they should beside
// the side in sight.
std::optional<PartReading> read_part_of_height(const GrayView& image, const Quad& cut,
                                               const Camera& camera, const ReadOptions& options);

}  // namespace tagsmith::detail
