// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/image/load.hpp"
#include "decoder/simulate/noise.hpp"

namespace tagsmith::detail {

// ---- Chains.

CameraChain camera_chain(const std::string& name) {
  if (name == "mild") {
    return {.noise_sigma = 2, .denoise_levels = 6, .sharpening = 0.5, .jpeg_quality = 92};
  }
  if (name == "strong") {
    return {.defocus_px = 0.6,
            .noise_sigma = 2,
            .contrast = 0.4,
            .denoise_levels = 6,
            .sharpening = 1.2,
            .sharpening_px = 1.5,
            .jpeg_quality = 85};
  }
  return {.defocus_px = 0.3,
          .exposure = 0.4,
          .noise_sigma = 12,
          .contrast = 0.4,
          .denoise_levels = 25,
          .denoise_px = 1.5,
          .sharpening = 1.6,
          .sharpening_px = 2.0,
          .jpeg_quality = 80};
}

// ---- The sensor.

namespace {

double light_for(SensorTone curve, double level_share) {
  if (curve == SensorTone::linear) return level_share;
  if (level_share <= 0.04045) return level_share / 12.92;
  return std::pow((level_share + 0.055) / 1.055, 2.4);
}

// Grey levels by comparison with the light at which each one begins: as exact as the tone curve
// itself and much cheaper.
class Quantiser {
 public:
  explicit Quantiser(const SensorModel& sensor) {
    const double range = sensor.white_level - sensor.black_level;
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      const double share = (static_cast<double>(i) + 0.5 - sensor.black_level) / range;
      begins_[i] =
          share > 1 ? std::numeric_limits<double>::infinity() : light_for(sensor.tone, share);
    }
  }

  std::uint8_t operator()(double light_share) const {
    const auto darker = [&](double begin) { return begin <= light_share; };
    return static_cast<std::uint8_t>(std::ranges::partition_point(begins_, darker) -
                                     begins_.begin());
  }

 private:
  std::array<double, 255> begins_{};  // of levels 1 to 255
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

// ---- The picture that a camera's chain stores.

namespace {

constexpr float kRawWhite = 16384;  // of a green sample in full light

// How much of white light the filters of the grid let through, as OpenCV counts the colours.
constexpr std::array<double, 3> kTransmission{0.55, 1.0, 0.6};  // blue, green, red

// The colour of the filter over a pixel: blue and green in the first row, green and red in the
// next.
std::size_t filter_at(int x, int y) {
  return static_cast<std::size_t>(x & 1) + static_cast<std::size_t>(y & 1);
}

double roll_of_row(double y, int height, double rolling_px) {
  return rolling_px * (y / std::max(1, height - 1) - 0.5);
}

cv::Mat rolled(const LightImage& light, double rolling_px) {
  cv::Mat image(light.height, light.width, CV_32F, const_cast<float*>(light.samples.data()));
  if (rolling_px == 0) return image;
  cv::Mat from(light.height, light.width, CV_32FC2);
  for (int y = 0; y < light.height; ++y) {
    const auto shift = static_cast<float>(roll_of_row(y, light.height, rolling_px));
    for (int x = 0; x < light.width; ++x) {
      from.at<cv::Vec2f>(y, x) = {static_cast<float>(x) - shift, static_cast<float>(y)};
    }
  }
  cv::Mat moved;
  cv::remap(image, moved, from, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return moved;
}

// What the sensor reads under the grid of filters. Photon noise is that of the light that a filter
// lets through.
cv::Mat raw_samples(const cv::Mat& light, const SensorModel& sensor, std::uint64_t seed) {
  constexpr double kMiddleLight = 0.214041;
  // Of a green sample's light at the middle grey level, by the slope of the tone curve there.
  const double sigma =
      sensor.noise_sigma / (255 * 1.055 / 2.4 * std::pow(kMiddleLight, 1 / 2.4 - 1));
  cv::Mat raw(light.size(), CV_16U);
  for (int y = 0; y < light.rows; ++y) {
    for (int x = 0; x < light.cols; ++x) {
      double share = std::max(0.0, sensor.exposure * static_cast<double>(light.at<float>(y, x))) *
                     kTransmission[filter_at(x, y)];
      const double variance =
          sensor.read_noise_share + (1 - sensor.read_noise_share) * share / kMiddleLight;
      const auto place = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(light.cols) +
                         static_cast<std::uint64_t>(x);
      share += sigma * std::sqrt(variance) * gaussian_noise(seed, place);
      raw.at<std::uint16_t>(y, x) = cv::saturate_cast<std::uint16_t>(
          std::min(share, kTransmission[filter_at(x, y)]) * static_cast<double>(kRawWhite));
    }
  }
  return raw;
}

// Grey levels of a share of full light: sRGB, then an S that is steepest at the middle grey.
float level_of(float share, float contrast) {
  const float light = std::clamp(share, 0.0F, 1.0F);
  const float grey =
      light <= 0.0031308F ? 12.92F * light : 1.055F * std::pow(light, 1 / 2.4F) - 0.055F;
  return 255 * (grey + contrast * (grey * grey * (3 - 2 * grey) - grey));
}

// The raw samples' colours, white balanced, by the tone curve.
cv::Mat demosaiced(const cv::Mat& raw, double contrast) {
  cv::Mat colours, levels;
  cv::cvtColor(raw, colours, cv::COLOR_BayerRG2BGR_EA);
  colours.convertTo(levels, CV_32FC3);
  levels.forEach<cv::Vec3f>([&](cv::Vec3f& pixel, const int*) {
    for (int colour = 0; colour < 3; ++colour) {
      const auto white =
          kRawWhite * static_cast<float>(kTransmission[static_cast<std::size_t>(colour)]);
      pixel[colour] = level_of(pixel[colour] / white, static_cast<float>(contrast));
    }
  });
  return levels;
}

cv::Mat denoised(const cv::Mat& levels, const CameraChain& chain) {
  if (chain.denoise_levels <= 0) return levels;
  cv::Mat smooth;
  const int diameter = 2 * static_cast<int>(std::ceil(2 * chain.denoise_px)) + 1;
  // Over three colours OpenCV adds up their differences.
  cv::bilateralFilter(levels, smooth, diameter, 3 * chain.denoise_levels, chain.denoise_px);
  return smooth;
}

cv::Mat sharpened(const cv::Mat& levels, const CameraChain& chain) {
  if (chain.sharpening <= 0) return levels;
  cv::Mat smooth, sharp;
  cv::GaussianBlur(levels, smooth, {}, chain.sharpening_px);
  cv::addWeighted(levels, 1 + chain.sharpening, smooth, -chain.sharpening, 0, sharp);
  return sharp;
}

}  // namespace

SensorModel through_chain(SensorModel sensor, const CameraChain& chain) {
  sensor.blur_sigma_px = std::hypot(sensor.blur_sigma_px, chain.defocus_px);
  sensor.noise_sigma = std::hypot(sensor.noise_sigma, chain.noise_sigma);
  sensor.exposure *= chain.exposure;
  sensor.chain = chain;
  return sensor;
}

GrayImage develop(const LightImage& light, const SensorModel& sensor, std::uint64_t seed) {
  const CameraChain chain = sensor.chain.value_or(CameraChain());
  const cv::Mat raw = raw_samples(rolled(light, chain.rolling_px), sensor, seed);
  const cv::Mat levels = sharpened(denoised(demosaiced(raw, chain.contrast), chain), chain);
  cv::Mat whole, luma;
  levels.convertTo(whole, CV_8UC3);
  cv::cvtColor(whole, luma, cv::COLOR_BGR2GRAY);
  return {luma.cols, luma.rows, {luma.datastart, luma.dataend}};
}

void roll_corners(PlateTruth& truth, int image_height, double rolling_px) {
  for (auto& corner : truth.corners) {
    if (corner) corner->x() += roll_of_row(corner->y(), image_height, rolling_px);
  }
}

Result<GrayImage> compressed(const GrayView& image, int jpeg_quality) {
  const Result<std::string> bytes = encode_gray_image("chain.jpg", image, jpeg_quality);
  if (!bytes) return fail(bytes);
  return decode_gray_image("chain.jpg", *bytes);
}

}  // namespace tagsmith::detail
