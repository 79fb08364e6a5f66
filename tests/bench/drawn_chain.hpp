// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <random>
#include <string>

#include "decoder/simulate/sensor.hpp"

namespace tagsmith::detail::bench {

// The chain of that name with other strengths, as other cameras have them.
inline CameraChain drawn_chain(const std::string& name, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(0, 1);
  CameraChain chain;
  if (name != "none") chain = camera_chain(name);
  const auto vary = [&](double& value, double by) { value *= 1 + by * (2 * any(random) - 1); };
  vary(chain.defocus_px, 0.5);
  vary(chain.exposure, 0.2);
  vary(chain.noise_sigma, 0.3);
  vary(chain.contrast, 0.5);
  vary(chain.denoise_levels, 0.3);
  vary(chain.sharpening, 0.3);
  vary(chain.sharpening_px, 0.4);
  chain.jpeg_quality = std::min(100, chain.jpeg_quality + static_cast<int>(9 * any(random)) - 4);
  return chain;
}

}  // namespace tagsmith::detail::bench
