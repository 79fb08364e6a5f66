// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/camera_chain.hpp"

namespace tagsmith::detail {

CameraChain camera_chain(const std::string& name) {
  CameraChain chain;
  chain.denoise_levels = 6;
  chain.noise_sigma = 2;
  if (name == "mild") {
    chain.sharpening = 0.5;
    chain.jpeg_quality = 92;
    return chain;
  }
  chain.contrast = 0.4;
  chain.sharpening = 1.2;
  chain.sharpening_px = 1.5;
  chain.defocus_px = 0.6;
  chain.jpeg_quality = 85;
  if (name == "strong") return chain;
  chain.defocus_px = 0.3;
  chain.exposure = 0.4;
  chain.noise_sigma = 12;
  chain.denoise_levels = 25;
  chain.denoise_px = 1.5;
  chain.sharpening = 1.6;
  chain.sharpening_px = 2.0;
  chain.jpeg_quality = 80;
  return chain;
}

}  // namespace tagsmith::detail
