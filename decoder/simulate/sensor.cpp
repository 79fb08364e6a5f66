// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "decoder/simulate/noise.hpp"

namespace tagsmith::detail {
namespace {

double light_for(SensorTone curve, double level_share) {
  if (curve == SensorTone::linear) return level_share;
  if (level_share <= 0.04045) return level_share / 12.92;
  return std::pow((level_share + 0.055) / 1.055, 2.4);
}

// Grey levels by comparison with the light at which each one begins, a start given by a table: as
// exact as the tone curve itself and much cheaper.
class Quantiser {
 public:
  explicit Quantiser(const SensorModel& sensor) {
    const double range = sensor.white_level - sensor.black_level;
    for (int level = 1; level <= 255; ++level) {
      const double share = (level - 0.5 - sensor.black_level) / range;
      begins_[static_cast<std::size_t>(level)] =
          share > 1 ? std::numeric_limits<double>::infinity() : light_for(sensor.tone, share);
    }
    int level = 0;
    for (std::size_t bin = 0; bin < starts_.size(); ++bin) {
      starts_[bin] = static_cast<std::uint8_t>(level);
      while (level < 255 &&
             begins_[static_cast<std::size_t>(level) + 1] <= static_cast<double>(bin + 1) / kBins) {
        ++level;
      }
    }
  }

  std::uint8_t operator()(double light_share) const {
    const double bin = std::clamp(light_share, 0.0, 1.0) * kBins;
    int level = light_share > 0 ? starts_[static_cast<std::size_t>(bin)] : 0;
    while (level < 255 && begins_[static_cast<std::size_t>(level) + 1] <= light_share) ++level;
    return static_cast<std::uint8_t>(level);
  }

 private:
  static constexpr int kBins = 1024;
  std::array<double, 256> begins_{};
  std::array<std::uint8_t, kBins + 1> starts_{};
};

struct MiddleGrey {
  double light_share = 0;
  double slope = 0;  // of the tone curve there
};

MiddleGrey middle_grey(SensorTone curve) {
  if (curve == SensorTone::linear) return {0.5, 1.0};
  const double light_share = light_for(curve, 0.5);
  return {light_share, 1.055 / 2.4 * std::pow(light_share, 1.0 / 2.4 - 1.0)};
}

// Square aperture of 1 px convolved with the Gaussian, at distance x.
double aperture(double x, double sigma) {
  if (sigma <= 0) return std::abs(x) < 0.5 ? 1.0 : 0.0;
  const double scale = 1.0 / (sigma * std::numbers::sqrt2);
  return 0.5 * (std::erf((x + 0.5) * scale) - std::erf((x - 0.5) * scale));
}

}  // namespace

GrayImage expose(const LightImage& light, const SensorModel& sensor, std::uint64_t seed) {
  const MiddleGrey middle = middle_grey(sensor.tone);
  const double range = sensor.white_level - sensor.black_level;
  const double sigma = range > 0 ? sensor.noise_sigma / (range * middle.slope) : 0.0;
  const Quantiser quantise(sensor);
  GrayImage image{light.width, light.height, {}};
  image.samples.resize(light.samples.size());
  for (std::size_t i = 0; i < light.samples.size(); ++i) {
    double share = sensor.exposure * static_cast<double>(light.samples[i]);
    if (sigma > 0) {
      const double growth = std::max(share, 0.0) / middle.light_share;
      const double variance = sensor.read_noise_share + (1 - sensor.read_noise_share) * growth;
      share += sigma * std::sqrt(variance) * gaussian_noise(seed, i);
    }
    image.samples[i] = quantise(share);
  }
  return image;
}

BlurKernel blur_kernel(double sigma_px, int cells_per_px) {
  constexpr double kReach = 3.5;  // sigmas; what lies beyond is 5e-4 of the light
  const double cell = 1.0 / cells_per_px;
  const double sigma = std::sqrt(std::max(0.0, sigma_px * sigma_px - cell * cell / 12));
  BlurKernel kernel;
  kernel.cells_per_px = cells_per_px;
  kernel.radius_px = sigma > 0 ? static_cast<int>(std::ceil(kReach * sigma)) : 0;
  const int count = (2 * kernel.radius_px + 1) * cells_per_px;
  double sum = 0;
  std::vector<double> weights;
  for (int i = 0; i < count; ++i) {
    weights.push_back(aperture((i + 0.5) * cell - 0.5 * count * cell, sigma));
    sum += weights.back();
  }
  for (const double weight : weights) kernel.weights.push_back(static_cast<float>(weight / sum));
  return kernel;
}

}  // namespace tagsmith::detail
