// SPDX-License-Identifier: Apache-2.0
// What phones and webcams make of the light before they store a picture: a grid of colour filters,
// demosaicing, denoising, a bent tone curve, sharpening, compression, and rows read one by one.
#pragma once

#include <string>

namespace tagsmith::detail {

// The defaults only demosaic.
struct CameraChain {
  double defocus_px = 0;      // standard deviation, besides the sensor's blur
  double exposure = 1;        // times the sensor's
  double noise_sigma = 0;     // grey levels at middle grey, besides the sensor's
  double contrast = 0;        // of the tone curve's S beyond sRGB; 1 makes greys 1.5 times as steep
  double denoise_levels = 0;  // bilateral filter: standard deviations in grey levels and pixels
  double denoise_px = 1;
  double sharpening = 0;  // unsharp mask: amount, and its Gaussian's standard deviation
  double sharpening_px = 1.2;
  int jpeg_quality = 100;
  double rolling_px = 0;  // to the right, while the rows are read from the first to the last
};

// Of `mild`, `strong` or `night`.
CameraChain camera_chain(const std::string& name);

}  // namespace tagsmith::detail
