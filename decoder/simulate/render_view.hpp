// SPDX-License-Identifier: Apache-2.0
// What a camera sees of plates before a backdrop.
//
// Exact where a reader is measured: the light of a pixel is the area of plate and ink within its
// cells, computed from the projected outlines without sampling, under any perspective and lens
// distortion; blur and exposure act on linear light. Rough where nothing is measured: shading, dirt
// and occlusion by the backdrop are taken at pixel centres. Label text is not drawn.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "decoder/image/gray.hpp"
#include "decoder/simulate/light.hpp"
#include "decoder/simulate/plate_in_image.hpp"
#include "decoder/simulate/scene.hpp"
#include "decoder/simulate/sensor.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"

namespace tagsmith::detail {

struct ViewOptions {
  Lighting lighting;
  SensorModel sensor;
  double background_light = 0.25;  // where there is no backdrop
  std::uint64_t seed = 0;          // of the sensor's noise
};

struct View {
  GrayImage image;
  std::vector<PlateTruth> plates;  // one for each plate given, in that order
};

// Needs an image of at least 1 x 1 px, plates whose widths are positive, and a backdrop of the
// camera's size (or none). A plate seen from behind is not drawn. Takes time in proportion to the
// image's area, on one thread; the result is the same on any machine with IEEE arithmetic.
View render_view(const Camera& camera, std::span<const ScenePlate> plates,
                 const ViewOptions& options = {}, const Backdrop* backdrop = nullptr);

// The light that reaches the pixels, blur included, before exposure, noise and tone curve.
LightImage render_light(const Camera& camera, std::span<const ScenePlate> plates,
                        const ViewOptions& options = {}, const Backdrop* backdrop = nullptr);

}  // namespace tagsmith::detail
