// SPDX-License-Identifier: Apache-2.0
// From the light that reaches a sensor to the picture that a camera's chain stores of it.
#pragma once

#include <cstdint>

#include "decoder/image/gray.hpp"
#include "decoder/simulate/light.hpp"
#include "decoder/simulate/plate_truth.hpp"
#include "decoder/simulate/sensor.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// The sensor with the chain's blur, exposure and noise, which renders through the chain.
SensorModel through_chain(SensorModel sensor, const CameraChain& chain);

// The luma of the picture that the sensor's chain makes of the light, not yet compressed. The
// sensor's levels are 0 and 255, its tone sRGB.
GrayImage develop(const LightImage& light, const SensorModel& sensor, std::uint64_t seed);

// Moves a plate's corners to where rows that are read one by one show them.
void roll_corners(PlateTruth& truth, int image_height, double rolling_px);

// The picture as a JPEG file of that quality holds it.
Result<GrayImage> compressed(const GrayView& image, int jpeg_quality);

}  // namespace tagsmith::detail
