// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/develop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "decoder/image/load.hpp"
#include "decoder/simulate/noise.hpp"

namespace tagsmith::detail {
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

// Standard deviation of a green sample's light at the middle grey level.
double middle_noise(double noise_sigma, double middle_light) {
  const double slope = 255 * 1.055 / 2.4 * std::pow(middle_light, 1 / 2.4 - 1);
  return noise_sigma / slope;
}

// What the sensor reads under the grid of filters. Photon noise is that of the light that a filter
// lets through.
cv::Mat raw_samples(const cv::Mat& light, const SensorModel& sensor, std::uint64_t seed) {
  constexpr double kMiddleLight = 0.214041;
  const double sigma = middle_noise(sensor.noise_sigma, kMiddleLight);
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
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_gray_image("chain.jpg", *bytes);
}

}  // namespace tagsmith::detail
