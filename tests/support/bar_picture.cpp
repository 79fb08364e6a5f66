// SPDX-License-Identifier: Apache-2.0
#include "tests/support/bar_picture.hpp"

#include <algorithm>
#include <cmath>

#include "decoder/image/tone_curve.hpp"
#include "decoder/simulate/noise.hpp"

namespace tagsmith::detail::test {
namespace {

constexpr int kFiner = 3;  // samples of a pixel on each axis

struct Point {
  double x = 0;
  double y = 0;
};

class Scene {
 public:
  Scene(const std::vector<int>& widths, const BarPicture& how) : how_(how) {
    double at = 0;
    for (const int width : widths) {
      edges_.push_back(at);
      at += width;
    }
    edges_.push_back(at);
    length_ = at;
    const double half_x = length_ / 2 + how.margin_modules;
    const double half_y = how.height_modules / 2 + how.margin_modules;
    const double c = std::abs(std::cos(how.roll));
    const double s = std::abs(std::sin(how.roll));
    width_ = static_cast<int>(2 * how.module_px * (c * half_x + s * half_y));
    height_ = static_cast<int>(2 * how.module_px * (s * half_x + c * half_y));
  }

  int width() const { return width_; }
  int height() const { return height_; }

  double light_at(double x, double y) const {
    const Point at = on_symbol(x - (width_ - 1) / 2.0, y - (height_ - 1) / 2.0);
    const double light = is_bar(at) ? how_.ink : how_.paper;
    const double blob =
        std::hypot((at.x - 0.6 * length_) / (0.2 * length_), at.y / (0.25 * how_.height_modules));
    return std::min(1.0, light + how_.glare * std::exp(-blob * blob));
  }

 private:
  // Modules from the symbol's begin and from the bars' middle.
  Point on_symbol(double x, double y) const {
    const double c = std::cos(how_.roll);
    const double s = std::sin(how_.roll);
    double u = (c * x + s * y) / how_.module_px;
    double v = (-s * x + c * y) / how_.module_px;
    // A plane turned about the bars' direction, seen from five symbols' length away.
    const double distance = 5 * length_;
    const double scale =
        distance / (distance * std::cos(how_.incidence) - u * std::sin(how_.incidence));
    u *= scale;
    v *= scale * std::cos(how_.incidence);
    if (how_.bend > 0) {
      const double radius = length_ / 2 / how_.bend;
      u = radius * std::asin(std::clamp(u / radius, -1.0, 1.0));
    }
    if (how_.crumple > 0) {
      u += how_.crumple * (2 * value_noise(how_.seed, u / 18, v / 25 + 7) - 1);
    }
    return {u + length_ / 2, v};
  }

  bool is_bar(const Point& at) const {
    if (std::abs(at.y) > how_.height_modules / 2) return false;
    const double half = how_.growth / 2;
    for (std::size_t i = 0; i + 1 < edges_.size(); i += 2) {
      if (at.x >= edges_[i] - half && at.x < edges_[i + 1] + half) return true;
    }
    return false;
  }

  BarPicture how_;
  std::vector<double> edges_;
  double length_ = 0;
  int width_ = 0;
  int height_ = 0;
};

std::vector<double> gaussian(double sigma) {
  const int radius = static_cast<int>(std::ceil(3.5 * sigma));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

// Filters every row and transposes, so that twice is both axes.
std::vector<double> filtered(const std::vector<double>& light, int width, int height,
                             const std::vector<double>& weights) {
  const int radius = static_cast<int>(weights.size() / 2);
  std::vector<double> result(light.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const int from = std::clamp(x + static_cast<int>(k) - radius, 0, width - 1);
        sum += weights[k] * light[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(from)];
      }
      result[static_cast<std::size_t>(x) * static_cast<std::size_t>(height) +
             static_cast<std::size_t>(y)] = sum;
    }
  }
  return result;
}

}  // namespace

GrayImage picture_of(const std::vector<int>& element_widths, const BarPicture& how) {
  const Scene scene(element_widths, how);
  std::vector<double> light;
  for (int y = 0; y < scene.height(); ++y) {
    for (int x = 0; x < scene.width(); ++x) {
      double sum = 0;
      for (int row = 0; row < kFiner; ++row) {
        for (int column = 0; column < kFiner; ++column) {
          sum += scene.light_at(x + (column + 0.5) / kFiner - 0.5, y + (row + 0.5) / kFiner - 0.5);
        }
      }
      light.push_back(sum / (kFiner * kFiner));
    }
  }
  const std::vector<double> weights = gaussian(std::max(how.blur_px, 0.05));
  light = filtered(light, scene.width(), scene.height(), weights);
  light = filtered(light, scene.height(), scene.width(), weights);
  GrayImage image{scene.width(), scene.height(), {}};
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double level =
        ToneCurve::srgb().sample_of(light[i]) + how.noise * gaussian_noise(how.seed, i);
    image.samples.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L)));
  }
  return image;
}

}  // namespace tagsmith::detail::test
