// SPDX-License-Identifier: Apache-2.0
// The way from light to the picture that a camera stores: blur, exposure, noise, tone curve,
// quantisation; and the further processing of phones and webcams.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/image/gray.hpp"
#include "decoder/simulate/light.hpp"
#include "decoder/simulate/plate_in_image.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// ---- The processing of phones and webcams before they store a picture: a grid of colour filters,
// demosaicing, denoising, a bent tone curve, sharpening, compression, and rows read one by one.

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

// ---- The sensor: exposure, noise, tone curve, quantisation; and the blur.

enum class SensorTone {
  linear,
  srgb,  // IEC 61966-2-1, 0.0031308 and 1/2.4: what a camera's JPEG holds
};

struct SensorModel {
  double blur_sigma_px = 0.7;  // Gaussian point spread, besides each pixel's own square aperture
  Eigen::Vector2d motion_px = Eigen::Vector2d::Zero();  // path of the image during the exposure
  double exposure = 1;     // light times this = share of the white level
  double black_level = 0;  // grey levels of no light and of full light
  double white_level = 255;
  SensorTone tone = SensorTone::srgb;
  double noise_sigma = 0;  // grey levels, standard deviation at the middle grey level
  // Share of the variance at the middle level that does not grow with the light (read-out); the
  // rest is proportional to it (photon noise).
  double read_noise_share = 0.1;
  // The processing of the picture before it is stored; nothing = the grey levels unchanged.
  std::optional<CameraChain> chain;
};

// Grey levels of every sample: exposure, noise, tone curve, rounding, in this order; clipped to 0
// and the white level. The noise of a sample depends on the seed and its place only.
GrayImage expose(const LightImage& light, const SensorModel& sensor, std::uint64_t seed);

// A symmetric filter on cells of which `cells_per_px` make a pixel; the weights sum to 1.
struct BlurKernel {
  int cells_per_px = 1;
  int radius_px = 0;           // whole pixels beyond the pixel itself that the filter reaches
  std::vector<float> weights;  // (2 radius_px + 1) * cells_per_px
};

// Pixel aperture and Gaussian in one filter from the cells' mean light to the pixel's. Its own
// width is corrected for the cells' (variance h^2/12), so that the blur's variance is exact and an
// edge's response off by less than 0.003 of its contrast at 4 cells a pixel and 0.7 px sigma.
BlurKernel blur_kernel(double sigma_px, int cells_per_px);

// ---- From the light that reaches a sensor to the picture that a camera's chain stores of it.

// The sensor with the chain's blur, exposure and noise, which renders through the chain.
SensorModel through_chain(SensorModel sensor, const CameraChain& chain);

// The luma of the picture that the sensor's chain makes of the light, not yet compressed. The
// sensor's levels are 0 and 255, its tone sRGB.
GrayImage develop(const LightImage& light, const SensorModel& sensor, std::uint64_t seed);

// Moves a plate's corners to where rows that are read one by one show them.
void roll_corners(PlateTruth& truth, int image_height, double rolling_px);

// The picture decoded from a JPEG file of that quality.
Result<GrayImage> compressed(const GrayView& image, int jpeg_quality);

}  // namespace tagsmith::detail
