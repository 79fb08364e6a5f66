// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/mass_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "decoder/image/tone_curve.hpp"
#include "decoder/simulate/light.hpp"
#include "decoder/simulate/sensor.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail::mass {
namespace {

// One over the point spread's standard deviations on the plate, modules.
struct Sharpness {
  float u = 0, v = 0;
  float reach_u = 0, reach_v = 0;  // beyond which an edge is sharp, modules

  float mean() const { return 2 / (1 / u + 1 / v); }
};

// Standard deviations of the point spread beyond which an edge is sharp: to a hundredth of a grey
// level.
constexpr float kReach = 4;

// Where a ray meets the plate, modules.
struct PlatePlace {
  float u = 0, v = 0;
};

// That and how sharp the picture is there.
struct Sight : PlatePlace {
  Sharpness sharp;
};

// The light that a scene sends along a ray. One for each row of a picture, from left to right: the
// edge of the last bar in reach is where the next ray's search begins.
class Light {
 public:
  explicit Light(const Scene& scene) : scene_(scene), growth_(float_of(scene.stroke_growth) / 2) {
    edges_.reserve(scene.edges.size());
    for (const double edge : scene.edges) edges_.push_back(float_of(edge));
  }

  float along(const Sight& sight) {
    const float plate = inside(sight, kPlateMargin, kPlateMarginAcross);
    float light = float_of(scene_.background);
    if (plate > 0) light += plate * (on_plate(sight) - light);
    if (!scene_.shadows.empty()) light *= left_by_shadows(sight);
    if (scene_.strips.empty()) return light;
    const float sharp = sight.sharp.mean();
    for (const Strip& strip : scene_.strips) {
      const float share = step((float_of(strip.half_width) - off_axis(strip, sight)) * sharp);
      light += share * (float_of(strip.light) - light);
    }
    return light;
  }

 private:
  static float off_axis(const Strip& strip, const Sight& sight) {
    return std::abs(float_of(strip.a) * sight.u + float_of(strip.b) * sight.v + float_of(strip.c));
  }

  float left_by_shadows(const Sight& sight) const {
    float left = 1;
    for (const Shadow& shadow : scene_.shadows) {
      const float spread = std::hypot(1 / sight.sharp.mean(), float_of(shadow.penumbra));
      const float share = step((float_of(shadow.half_width) - off_axis(shadow, sight)) / spread);
      left *= 1 - share * (1 - float_of(shadow.light));
    }
    return left;
  }

  static float float_of(double value) { return static_cast<float>(value); }

  // An edge, `z` standard deviations of the point spread away.
  float step(float z) const {
    if (z <= -kReach) return 0;
    if (z >= kReach) return 1;
    return normal_(z).integral;
  }

  float between(float at, float low, float high, float sharp) const {
    return step((at - low) * sharp) - step((at - high) * sharp);
  }

  // The share of a rectangle that is so much larger on each side than the frame's inner edge.
  float inside(const Sight& sight, double beyond, double beyond_across) const {
    const float left = -float_of(beyond), right = float_of(kFrameWidth + beyond);
    const float top = -float_of(beyond_across), bottom = float_of(kFrameHeight + beyond_across);
    const Sharpness& sharp = sight.sharp;
    // How far within, modules.
    const float u = std::min(sight.u - left, right - sight.u);
    const float v = std::min(sight.v - top, bottom - sight.v);
    if (u <= -sharp.reach_u || v <= -sharp.reach_v) return 0;
    if (u >= sharp.reach_u && v >= sharp.reach_v) return 1;
    return between(sight.u, left, right, sharp.u) * between(sight.v, top, bottom, sharp.v);
  }

  float bars_at(const Sight& sight) {
    const float begin = sight.u - sight.sharp.reach_u, end = sight.u + sight.sharp.reach_u;
    while (first_ > 0 && edges_[first_ - 1] >= begin) --first_;
    while (first_ < edges_.size() && edges_[first_] < begin) ++first_;
    float share = first_ % 2 == 0 ? 0.0F : 1.0F;
    for (std::size_t i = first_; i < edges_.size() && edges_[i] < end; ++i) {
      share += (i % 2 == 0 ? 1.0F : -1.0F) * step((sight.u - edges_[i]) * sight.sharp.u);
    }
    return share;
  }

  float on_plate(const Sight& sight) {
    const double g = static_cast<double>(growth_);
    const float outer = inside(sight, kStroke + g, kStroke + g);
    float ink = 0;
    if (outer > 0) {
      ink = outer - inside(sight, -g, -g);
      const float high = inside(sight, kStroke, g - kBarsMargin);
      if (high > 0) ink += high * bars_at(sight);
    }
    const float lamp = 1 + float_of(scene_.shade_u) * (sight.u / float_of(kFrameWidth) - 0.5F) +
                       float_of(scene_.shade_v) * (sight.v / float_of(kFrameHeight) - 0.5F);
    float light = (float_of(scene_.white) + ink * float_of(scene_.ink - scene_.white)) * lamp;
    if (!scene_.dirt.empty()) light = behind_dirt(sight, lamp, light);
    if (scene_.glare) {
      const float du = (sight.u - float_of(scene_.glare->u)) / float_of(scene_.glare->radius);
      const float dv = (sight.v - float_of(scene_.glare->v)) / float_of(scene_.glare->radius);
      light += float_of(scene_.glare->strength) * std::exp(-0.5F * (du * du + dv * dv));
    }
    return light;
  }

  float behind_dirt(const Sight& sight, float lamp, float light) const {
    const float spread = 1 / sight.sharp.mean() + 0.2F;
    for (const Blotch& blotch : scene_.dirt) {
      const float du = sight.u - float_of(blotch.u), dv = sight.v - float_of(blotch.v);
      const float reach = float_of(blotch.radius) + kReach * spread;
      const float square = du * du + dv * dv;
      if (square > reach * reach) continue;
      const float off = float_of(blotch.radius) - std::sqrt(square);
      light += step(off / spread) * (float_of(blotch.light) * lamp - light);
    }
    return light;
  }

  const Scene& scene_;
  const NormalTable& normal_ = NormalTable::get();
  std::vector<float> edges_;
  float growth_;           // of the frame's stroke, at each side
  std::size_t first_ = 0;  // edge in reach of the last ray
};

// Normal deviates, drawn once and then picked at random.
class Noise {
 public:
  explicit Noise(Random& random) : random_(random) {}

  float next() {
    if (left_ == 0) {
      lot_ = random_();
      left_ = 4;
    }
    const float deviate = deviates_[lot_ & 0xffffU];
    lot_ >>= 16U;
    --left_;
    return deviate;
  }

 private:
  static const std::vector<float>& deviates() {
    static const std::vector<float> kDeviates = [] {
      std::vector<float> deviates(1U << 16U);
      Random random(5489);
      std::normal_distribution<float> normal;
      for (float& deviate : deviates) deviate = normal(random);
      return deviates;
    }();
    return kDeviates;
  }

  Random& random_;
  const std::vector<float>& deviates_ = deviates();
  std::uint64_t lot_ = 0;
  int left_ = 0;
};

// Rays from pixels to the plate.
class Rays {
 public:
  Rays(const Placing& placing, double sigma) : sharp_(1 / static_cast<float>(sigma)) {
    const Homography frame_from_image = inverse(homography_to(placing.corners));
    for (std::size_t i = 0; i < h_.size(); ++i) {
      const double scale = i < 3 ? kFrameWidth : i < 6 ? kFrameHeight : 1;
      h_[i] = static_cast<float>(scale * frame_from_image.h[i]);
    }
  }

  PlatePlace through(float x, float y) const {
    const float c = 1 / (h_[6] * x + h_[7] * y + h_[8]);
    return {(h_[0] * x + h_[1] * y + h_[2]) * c, (h_[3] * x + h_[4] * y + h_[5]) * c};
  }

  Sharpness sharpness(float x, float y) const {
    const PlatePlace at = through(x, y);
    const float c = sharp_ * std::abs(h_[6] * x + h_[7] * y + h_[8]);
    const float u = c / length(h_[0] - at.u * h_[6], h_[1] - at.u * h_[7]);
    const float v = c / length(h_[3] - at.v * h_[6], h_[4] - at.v * h_[7]);
    return {u, v, kReach / u, kReach / v};
  }

 private:
  static float length(float a, float b) { return std::sqrt(a * a + b * b); }

  std::array<float, 9> h_{};  // to modules
  float sharp_;               // one over the point spread's standard deviation, 1 / pixels
};

// Shares of full exposure. `blur_px`: standard deviation of the point spread.
LightImage gather_light(const Scene& scene, const Placing& placing, const Sensor& sensor,
                        double blur_px) {
  constexpr int kAsSharp = 8;  // pixels of a row for which the point spread is computed once
  const Rays rays(placing, std::sqrt(blur_px * blur_px + 1.0 / 12));
  const int steps = std::max(1, static_cast<int>(std::ceil(length(sensor.motion) / 1.2)));
  const auto motion_x = static_cast<float>(sensor.motion.x) / static_cast<float>(steps);
  const auto motion_y = static_cast<float>(sensor.motion.y) / static_cast<float>(steps);
  const auto exposure = static_cast<float>(sensor.exposure / steps);
  Light light(scene);
  LightImage image(placing.width, placing.height);
  float* share = image.samples.data();
  for (int row = 0; row < image.height; ++row) {
    const auto y = static_cast<float>(row);
    Sight sight;
    for (int column = 0; column < image.width; ++column) {
      const auto x = static_cast<float>(column);
      if (column % kAsSharp == 0) sight.sharp = rays.sharpness(x + kAsSharp / 2.0F, y);
      float sum = 0;
      for (int k = 0; k < steps; ++k) {
        const float t = static_cast<float>(k) + 0.5F - 0.5F * static_cast<float>(steps);
        static_cast<PlatePlace&>(sight) = rays.through(x + t * motion_x, y + t * motion_y);
        sum += light.along(sight);
      }
      *share++ = exposure * sum;
    }
  }
  return image;
}

GrayImage sensed(const LightImage& light, const Sensor& sensor, Random& random) {
  if (sensor.chain) {
    SensorModel model;
    model.noise_sigma = sensor.noise;
    return develop(light, through_chain(model, *sensor.chain), random());
  }
  const ToneCurve& tone = ToneCurve::srgb();
  Noise noise(random);
  const auto sigma = static_cast<float>(sensor.noise);
  GrayImage image{light.width, light.height, {}};
  image.samples.reserve(light.samples.size());
  for (const float share : light.samples) {
    const float value =
        (sensor.linear ? 255 * share : tone.point_of(share).sample) + sigma * noise.next();
    image.samples.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F) + 0.5F));
  }
  return image;
}

// As if saved as a JPEG of this quality, 1 to 100, and loaded.
void compress(GrayImage& image, int quality) {
  const cv::Mat raw(image.height, image.width, CV_8U, image.samples.data());
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", raw, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  image.samples.assign(decoded.data, decoded.data + decoded.total());
}

}  // namespace

Placing place(double module_px, double tilt, Random& random) {
  const double yaw = chance(random, 0.5) ? tilt : -tilt;
  const double pitch = uniform(random, -0.35, 0.35);
  const double roll = uniform(random, 0, 2 * std::numbers::pi);
  const double distance = uniform(random, 200, 1500);  // modules
  const double scale = module_px * distance / std::cos(tilt);
  const bool mirrored = chance(random, 0.05);
  const auto project = [&](double u, double v) {
    const double x0 = u - kFrameWidth / 2;
    const double y0 = v - kFrameHeight / 2;
    const double x = x0 * std::cos(yaw);
    const double z1 = x0 * std::sin(yaw);
    const double y = y0 * std::cos(pitch) - z1 * std::sin(pitch);
    const double z = distance + y0 * std::sin(pitch) + z1 * std::cos(pitch);
    const double px = scale * x / z;
    const double py = scale * y / z;
    return PixelPoint{(mirrored ? -1 : 1) * (std::cos(roll) * px - std::sin(roll) * py),
                      std::sin(roll) * px + std::cos(roll) * py};
  };
  Placing placing;
  placing.corners = {project(0, 0), project(kFrameWidth, 0), project(kFrameWidth, kFrameHeight),
                     project(0, kFrameHeight)};
  const double out = kStroke + 5;
  double left = 0, right = 0, top = 0, bottom = 0;
  for (const PixelPoint& p :
       {project(-out, -out), project(kFrameWidth + out, -out),
        project(kFrameWidth + out, kFrameHeight + out), project(-out, kFrameHeight + out)}) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
  }
  const PixelPoint shift{uniform(random, 4, 5) - left, uniform(random, 4, 5) - top};
  for (PixelPoint& corner : placing.corners) corner = corner + shift;
  placing.width = std::max(32, static_cast<int>(right - left + 10));
  placing.height = std::max(32, static_cast<int>(bottom - top + 10));
  return placing;
}

void take(Picture& picture, const Scene& scene, const Placing& placing, const Sensor& sensor,
          const Compression& compression, Random& random) {
  constexpr int kMostQuality = 95;
  picture.noise = sensor.noise;
  picture.corners = placing.corners;
  picture.odd_margins = scene.odd_margins;
  if (sensor.chain) picture.blur_px = std::hypot(picture.blur_px, sensor.chain->defocus_px);
  picture.image = sensed(gather_light(scene, placing, sensor, picture.blur_px), sensor, random);
  if (sensor.chain) {
    picture.jpeg = true;
    compress(picture.image, sensor.chain->jpeg_quality);
    return;
  }
  picture.jpeg = chance(random, compression.share);
  if (picture.jpeg) {
    compress(picture.image, integer(random, compression.least_quality, kMostQuality));
  }
}

}  // namespace tagsmith::detail::mass
