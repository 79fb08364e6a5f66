// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/mass_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <opencv2/imgcodecs.hpp>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/normal.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::mass {
namespace {

using Random = std::mt19937_64;

// The plate of Xu et al. (2017), tag-400x300, in modules.
constexpr double kFrameWidth = 113;
constexpr double kFrameHeight = 55.35;
constexpr double kStroke = 3.95;
constexpr double kPlateMargin = 9.4;  // beyond the inner edge, left and right
constexpr double kPlateMarginAcross = 21.7;
constexpr double kBarsMargin = 9;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

bool chance(Random& random, double probability) { return uniform(random, 0, 1) < probability; }

int integer(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

double log_uniform(Random& random, double low, double high) {
  return std::exp(uniform(random, std::log(low), std::log(high)));
}

Kind random_kind(Random& random) {
  constexpr std::array<std::pair<Kind, double>, 11> kShares{{{Kind::tag, 0.45},
                                                             {Kind::wrong_check, 0.08},
                                                             {Kind::foreign, 0.12},
                                                             {Kind::misshapen, 0.06},
                                                             {Kind::moved_edge, 0.06},
                                                             {Kind::cut, 0.04},
                                                             {Kind::ean13, 0.06},
                                                             {Kind::upc_e, 0.02},
                                                             {Kind::code128, 0.03},
                                                             {Kind::stripes, 0.05},
                                                             {Kind::grating, 0.015}}};
  double lot = uniform(random, 0, 1);
  for (const auto& [kind, share] : kShares) {
    if (lot < share) return kind;
    lot -= share;
  }
  return Kind::empty;
}

// Widths of the elements, bars first, in modules.
using Widths = std::vector<double>;

Widths symbol_widths(const Digits& digits) {
  Widths widths;
  for (const std::uint8_t width : elements_of(digits)) widths.push_back(width);
  return widths;
}

void mirror_digit(Widths& widths, int position) {
  const auto first = widths.begin() + first_element_of_digit(position);
  std::reverse(first, first + kElementsPerDigit);
}

// How far the farthest inner edge of these widths is from that of the nearest digit, modules.
double distance_to_digits(std::span<const double, kElementsPerDigit> widths) {
  double nearest = kModulesPerDigit;
  for (const auto& digit : kDigitElements) {
    double farthest = 0, here = 0, there = 0;
    for (std::size_t i = 0; i + 1 < kElementsPerDigit; ++i) {
      here += widths[i];
      there += digit[i];
      farthest = std::max(farthest, std::abs(here - there));
    }
    nearest = std::min(nearest, farthest);
  }
  return nearest;
}

// Four arbitrary widths that are clearly those of no digit.
void misshape_digit(Widths& widths, int position, Random& random) {
  constexpr double kLeastDistance = 0.7;
  const std::span<double, kElementsPerDigit> elements(
      widths.data() + first_element_of_digit(position), kElementsPerDigit);
  do {
    std::array<double, 3> cuts{};
    for (double& cut : cuts) cut = uniform(random, 0.6, 6.4);
    std::ranges::sort(cuts);
    elements[0] = cuts[0];
    elements[1] = std::max(0.3, cuts[1] - cuts[0]);
    elements[2] = std::max(0.3, cuts[2] - cuts[1]);
    elements[3] = std::max(0.3, kModulesPerDigit - elements[0] - elements[1] - elements[2]);
  } while (distance_to_digits(elements) < kLeastDistance);
}

Widths code128_widths(Random& random) {
  Widths widths;
  for (int c = 0; c < 8; ++c) {
    std::array<int, 6> character{1, 1, 1, 1, 1, 1};
    for (int rest = 5; rest > 0;) {
      int& width = character[static_cast<std::size_t>(integer(random, 0, 5))];
      if (width == 4) continue;
      ++width;
      --rest;
    }
    widths.insert(widths.end(), character.begin(), character.end());
  }
  widths.insert(widths.end(), {2, 3, 3, 1, 1, 1, 2});
  return widths;
}

Widths upc_e_widths(Random& random) {
  Widths widths{1, 1, 1};
  for (int c = 0; c < 6; ++c) {
    auto character = kDigitElements[static_cast<std::size_t>(integer(random, 0, 9))];
    if (chance(random, 0.5)) std::ranges::reverse(character);
    widths.insert(widths.end(), character.begin(), character.end());
  }
  widths.insert(widths.end(), {1, 1, 1, 1, 1, 1});
  return widths;
}

Widths stripes_widths(const Digits& digits, Random& random) {
  Widths widths = symbol_widths(digits);
  for (std::size_t i = 3; i + 3 < widths.size(); ++i) widths[i] = integer(random, 1, 4);
  return widths;
}

Widths widths_of(Kind kind, const Digits& digits, Random& random) {
  Widths widths = symbol_widths(digits);
  switch (kind) {
    case Kind::foreign:
      mirror_digit(widths, integer(random, 0, 11));
      return widths;
    case Kind::misshapen:
      misshape_digit(widths, integer(random, 0, 11), random);
      return widths;
    case Kind::moved_edge: {
      const auto i = static_cast<std::size_t>(integer(random, 3, 54));
      const double move = std::min(uniform(random, 0.5, 1.5), widths[i + 1] - 0.1);
      widths[i] += move;
      widths[i + 1] -= move;
      return widths;
    }
    case Kind::cut: {
      const int kept = integer(random, 12, 52);
      if (chance(random, 0.5)) std::ranges::reverse(widths);
      widths.resize(static_cast<std::size_t>(kept));
      return widths;
    }
    case Kind::ean13: {
      std::array<int, 5> places{1, 2, 3, 4, 5};
      std::ranges::shuffle(places, random);
      for (std::size_t k = 0; k < 3; ++k) mirror_digit(widths, places[k]);
      return widths;
    }
    case Kind::upc_e:
      return upc_e_widths(random);
    case Kind::code128:
      return code128_widths(random);
    case Kind::stripes:
      return stripes_widths(digits, random);
    case Kind::grating:
      return Widths(static_cast<std::size_t>(2 * integer(random, 8, 47) + 1), 1.0);
    case Kind::empty:
      return {};
    default:
      return widths;
  }
}

struct Blotch {
  double u = 0, v = 0, radius = 0, light = 0;
};

// A straight cable or board in front.
struct Strip {
  double a = 0, b = 0, c = 0;  // a u + b v + c = distance from its axis, modules
  double half_width = 0;
  double light = 0;
};

struct Glare {
  double u = 0, v = 0, radius = 0, strength = 0;
};

// What is seen through the homography, in modules from the frame's upper left inner corner.
struct Scene {
  bool odd_margins = false;
  std::vector<double> edges;  // of the bars, ascending, even ones begin a bar
  double stroke_growth = 0;   // modules
  double white = 0, ink = 0, background = 0;
  double shade_u = 0, shade_v = 0;
  std::vector<Blotch> dirt;
  std::vector<Strip> strips;
  std::optional<Glare> glare;
};

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
    if (scene_.strips.empty()) return light;
    const float sharp = sight.sharp.mean();
    for (const Strip& strip : scene_.strips) {
      const float off =
          std::abs(float_of(strip.a) * sight.u + float_of(strip.b) * sight.v + float_of(strip.c));
      const float share = step((float_of(strip.half_width) - off) * sharp);
      light += share * (float_of(strip.light) - light);
    }
    return light;
  }

 private:
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
    float share = first_ % 2 == 0 ? 0 : 1;
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

void dirty(Scene& scene, Random& random) {
  if (chance(random, 0.3)) {
    const int count = integer(random, 1, 8);
    for (int i = 0; i < count; ++i) {
      scene.dirt.push_back({uniform(random, 0, kFrameWidth), uniform(random, 0, kFrameHeight),
                            log_uniform(random, 1, 14), uniform(random, 0.02, 0.7)});
    }
  }
  if (chance(random, 0.3)) {
    const int count = chance(random, 0.25) ? 2 : 1;
    for (int i = 0; i < count; ++i) {
      const double angle =
          chance(random, 0.3) ? uniform(random, -0.2, 0.2) : uniform(random, 0, std::numbers::pi);
      const double a = std::cos(angle), b = std::sin(angle);
      scene.strips.push_back(
          {a, b, -a * uniform(random, 0, kFrameWidth) - b * uniform(random, 0, kFrameHeight),
           log_uniform(random, 0.5, 8), uniform(random, 0, 0.9)});
    }
  }
  if (chance(random, 0.15)) {
    scene.glare = Glare{uniform(random, 0, kFrameWidth), uniform(random, 0, kFrameHeight),
                        uniform(random, 3, 25), uniform(random, 0.2, 3)};
  }
}

Scene make_scene(const Picture& picture, Random& random) {
  Scene scene;
  const Widths widths = widths_of(picture.kind, picture.code, random);
  double total = 0;
  for (const double width : widths) total += width;
  double quiet = 9;
  if (chance(random, 0.12)) quiet = uniform(random, 4, 16);
  scene.odd_margins = quiet != 9;
  double module = 1;
  // Other symbols fill the place of ours, or hold our module.
  const bool ours = picture.kind <= Kind::cut;
  if (!ours && total > 0 && chance(random, 0.7)) module = kModuleCount / total;
  module *= (kFrameWidth - 2 * quiet) / kModuleCount;
  double u = quiet + (chance(random, 0.1) ? uniform(random, -1.5, 1.5) : 0);
  scene.odd_margins = scene.odd_margins || u != quiet;
  if (!ours && chance(random, 0.3)) u = (kFrameWidth - total * module) / 2;
  if (picture.kind == Kind::cut && chance(random, 0.5)) u = kFrameWidth - 9 - total * module;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    scene.edges.push_back(u);
    u += widths[i] * module;
  }
  scene.edges.push_back(u);
  if (widths.empty()) scene.edges.clear();
  scene.stroke_growth = picture.growth;
  for (std::size_t i = 0; i < scene.edges.size(); ++i) {
    scene.edges[i] += (i % 2 == 0 ? -0.5 : 0.5) * picture.growth;
  }
  for (std::size_t i = 1; i < scene.edges.size(); ++i) {  // what has grown together
    scene.edges[i] = std::max(scene.edges[i], scene.edges[i - 1]);
  }
  const double contrast = uniform(random, 0.2, 1);
  scene.white = 0.435 + 0.385 * contrast;
  scene.ink = 0.435 - 0.385 * contrast;
  scene.background = uniform(random, 0.02, 0.7);
  if (chance(random, 0.3)) {
    scene.shade_u = uniform(random, -0.6, 0.6);
    scene.shade_v = uniform(random, -0.6, 0.6);
  }
  dirty(scene, random);
  return scene;
}

// The frame's inner corners in the picture, for a module of `module_px` in its middle, and the
// picture's size.
struct Placing {
  Quad corners{};
  int width = 0;
  int height = 0;
};

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

struct Sensor {
  double exposure = 1;
  bool linear = false;
  double noise = 0;
  PixelPoint motion;
};

// Rays from pixels to the plate.
class Rays {
 public:
  Rays(const Placing& placing, double sigma) : sharp_(1 / static_cast<float>(sigma)) {
    const Homography unit_from_image = inverse(homography_to(placing.corners));
    for (std::size_t i = 0; i < h_.size(); ++i) {
      const double scale = i < 3 ? kFrameWidth : i < 6 ? kFrameHeight : 1;
      h_[i] = static_cast<float>(scale * unit_from_image.h[i]);
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

GrayImage expose(const Scene& scene, const Placing& placing, const Sensor& sensor, double blur_px,
                 Random& random) {
  constexpr int kAsSharp = 8;  // pixels of a row for which the point spread is computed once
  const Rays rays(placing, std::sqrt(blur_px * blur_px + 1.0 / 12));
  const ToneCurve& tone = ToneCurve::srgb();
  Noise noise(random);
  const int steps = std::max(1, static_cast<int>(std::ceil(length(sensor.motion) / 1.2)));
  const auto motion_x = static_cast<float>(sensor.motion.x) / static_cast<float>(steps);
  const auto motion_y = static_cast<float>(sensor.motion.y) / static_cast<float>(steps);
  const auto exposure = static_cast<float>(sensor.exposure / steps);
  const auto sigma = static_cast<float>(sensor.noise);
  Light light(scene);
  GrayImage image{placing.width, placing.height, {}};
  image.samples.resize(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  std::uint8_t* sample = image.samples.data();
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
      const float share = exposure * sum;
      const float value =
          (sensor.linear ? 255 * share : tone.point_of(share).sample) + sigma * noise.next();
      *sample++ = static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F) + 0.5F);
    }
  }
  return image;
}

void compress(GrayImage& image, int quality) {
  const cv::Mat raw(image.height, image.width, CV_8U, image.samples.data());
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", raw, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  image.samples.assign(decoded.data, decoded.data + decoded.total());
}

}  // namespace

const char* name_of(Kind kind) {
  constexpr std::array<const char*, static_cast<std::size_t>(Kind::count)> kNames{
      "tags",
      "wrong check digit",
      "one character of no digit",
      "one digit of arbitrary widths",
      "one edge moved",
      "cut symbols",
      "EAN-13",
      "UPC-E",
      "Code 128-like",
      "random stripes",
      "gratings",
      "empty frames"};
  return kNames[static_cast<std::size_t>(kind)];
}

Digits random_code(Random& random) {
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(integer(random, 0, 9));
  digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
  return digits;
}

Picture draw(std::uint64_t seed) {
  Random random(seed);
  Picture picture;
  picture.kind = random_kind(random);
  picture.code = random_code(random);
  if (picture.kind == Kind::wrong_check) {
    do {
      picture.code.back() = static_cast<std::uint8_t>(integer(random, 0, 9));
    } while (has_check_digit(CheckDigit::gs1, picture.code) ||
             has_check_digit(CheckDigit::sum10, picture.code));
  }
  picture.module_px =
      chance(random, 0.85) ? log_uniform(random, 0.3, 1.3) : log_uniform(random, 1.3, 3.0);
  picture.blur_px = log_uniform(random, 0.25, 2.0);
  if (picture.blur_px > 1.5 * picture.module_px && chance(random, 0.7)) picture.blur_px /= 2;
  picture.growth = chance(random, 0.4) ? uniform(random, -0.8, 0.8) : 0;
  Sensor sensor;
  sensor.noise = chance(random, 0.3) ? uniform(random, 4, 30) : uniform(random, 0.5, 4);
  sensor.exposure = uniform(random, 0.1, 1.3);
  sensor.linear = chance(random, 0.25);
  if (chance(random, 0.2)) sensor.motion = {uniform(random, -4, 4), uniform(random, -4, 4)};
  picture.noise = sensor.noise;
  const Scene scene = make_scene(picture, random);
  const double tilt =
      radians(chance(random, 0.7) ? uniform(random, 0, 45) : uniform(random, 45, 72));
  const Placing placing = place(picture.module_px, tilt, random);
  picture.corners = placing.corners;
  picture.odd_margins = scene.odd_margins;
  picture.image = expose(scene, placing, sensor, picture.blur_px, random);
  picture.jpeg = chance(random, 0.15);
  if (picture.jpeg) compress(picture.image, integer(random, 60, 95));
  return picture;
}

const char* name_of(Trouble trouble) {
  constexpr std::array<const char*, static_cast<std::size_t>(Trouble::count)> kNames{
      "none",
      "dark cable along the bars",
      "dark cable across the bars",
      "cable of the plate's colour",
      "a side of the frame hidden",
      "dirt",
      "glare",
      "veil of dust",
      "darkness and noise",
      "motion along the bars",
      "motion across the bars",
      "steep view",
      "three of them"};
  return kNames[static_cast<std::size_t>(trouble)];
}

namespace {

Strip strip_at(double angle, double u, double v, double half_width, double light) {
  const double a = std::cos(angle), b = std::sin(angle);
  return {a, b, -a * u - b * v, half_width, light};
}

double any_place(double length, Random& random) { return uniform(random, 0.1, 0.9) * length; }

Strip hidden_side(Random& random) {
  const double light = uniform(random, 0.02, 0.3);
  const double half = uniform(random, 3, 5);
  const bool ends = chance(random, 0.5);  // left or right, else above or below
  const bool far = chance(random, 0.5);
  const double lean = uniform(random, -0.05, 0.05);
  if (ends) return strip_at(lean, far ? kFrameWidth : 0, kFrameHeight / 2, half, light);
  return strip_at(std::numbers::pi / 2 + lean, kFrameWidth / 2, far ? kFrameHeight : 0, half,
                  light);
}

void add_trouble(Trouble trouble, Scene& scene, Sensor& sensor, Random& random) {
  const double u = any_place(kFrameWidth, random);
  const double v = any_place(kFrameHeight, random);
  const double ink = uniform(random, 0.02, 0.12);
  switch (trouble) {
    case Trouble::steep_cable:
      scene.strips.push_back(
          strip_at(uniform(random, -0.35, 0.35), u, v, uniform(random, 1.5, 5), ink));
      break;
    case Trouble::diagonal_cable:
      scene.strips.push_back(strip_at(uniform(random, 0.6, 2.5), u, v, uniform(random, 2, 5), ink));
      break;
    case Trouble::pale_cable:
      scene.strips.push_back(strip_at(uniform(random, -1, 1), u, v, uniform(random, 1.5, 5),
                                      scene.white * uniform(random, 0.8, 1.1)));
      break;
    case Trouble::hidden_side:
      scene.strips.push_back(hidden_side(random));
      break;
    case Trouble::dirt: {
      const int count = integer(random, 3, 10);
      for (int i = 0; i < count; ++i) {
        scene.dirt.push_back({uniform(random, 0, kFrameWidth), uniform(random, 0, kFrameHeight),
                              log_uniform(random, 3, 12), uniform(random, 0.02, 0.6)});
      }
      break;
    }
    case Trouble::glare:
      scene.glare = Glare{u, v, uniform(random, 5, 18), uniform(random, 0.3, 2)};
      break;
    case Trouble::veil: {
      const double dust = uniform(random, 0.3, 0.5), cover = uniform(random, 0.6, 0.9);
      scene.white += cover * (dust - scene.white);
      scene.ink += cover * (dust - scene.ink);
      break;
    }
    case Trouble::dark:
      sensor.exposure = uniform(random, 0.05, 0.15);
      sensor.noise = uniform(random, 10, 20);
      break;
    default:  // a matter of the camera
      break;
  }
}

// The way of the image for motion along or across the bars.
PixelPoint motion_for(Trouble trouble, const Placing& placing, double module_px, Random& random) {
  const bool along = trouble == Trouble::motion_along;
  const PixelPoint side = placing.corners[along ? 3 : 1] - placing.corners[0];
  const double way = along ? uniform(random, 3, 8) : uniform(random, 0.5, 1.2) * module_px;
  return way / length(side) * side;
}

}  // namespace

Picture draw_troubled(Trouble trouble, std::uint64_t seed) {
  Random random(seed ^ 0x5bd1e995ULL * (static_cast<std::uint64_t>(trouble) + 1));
  Picture picture;
  picture.kind = chance(random, 0.67) ? Kind::tag : random_kind(random);
  picture.code = random_code(random);
  if (picture.kind == Kind::wrong_check) {
    do {
      picture.code.back() = static_cast<std::uint8_t>(integer(random, 0, 9));
    } while (has_check_digit(CheckDigit::gs1, picture.code) ||
             has_check_digit(CheckDigit::sum10, picture.code));
  }
  picture.module_px = log_uniform(random, 1.3, 4.0);
  picture.blur_px = log_uniform(random, 0.4, 0.9);
  Sensor sensor;
  sensor.noise = uniform(random, 1, 4);
  sensor.exposure = uniform(random, 0.3, 1);
  Scene scene = make_scene(picture, random);
  scene.dirt.clear();
  scene.strips.clear();
  scene.glare.reset();
  scene.white = uniform(random, 0.7, 0.85);
  scene.ink = uniform(random, 0.03, 0.1);
  std::vector<Trouble> troubles{trouble};
  if (trouble == Trouble::several) {
    troubles.clear();
    while (troubles.size() < 3) {
      troubles.push_back(static_cast<Trouble>(integer(random, 1, 11)));
    }
  }
  const bool steep = std::ranges::count(troubles, Trouble::steep) > 0;
  const Placing placing = place(
      picture.module_px, radians(steep ? uniform(random, 65, 75) : uniform(random, 0, 50)), random);
  for (const Trouble one : troubles) {
    add_trouble(one, scene, sensor, random);
    if (one == Trouble::motion_along || one == Trouble::motion_across) {
      sensor.motion = motion_for(one, placing, picture.module_px, random);
    }
  }
  picture.noise = sensor.noise;
  picture.corners = placing.corners;
  picture.odd_margins = scene.odd_margins;
  picture.image = expose(scene, placing, sensor, picture.blur_px, random);
  picture.jpeg = chance(random, 0.5);
  if (picture.jpeg) compress(picture.image, integer(random, 80, 95));
  return picture;
}

}  // namespace tagsmith::mass
