// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/disturbances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tagsmith::detail::bench {
namespace {

// --- samples and light ---

// The light of each sample by sRGB (IEC 61966-2-1), 0-1.
cv::Mat light_of(const cv::Mat& picture) {
  cv::Mat table(1, 256, CV_32F);
  for (int i = 0; i < 256; ++i) {
    const double sample = i / 255.0;
    table.at<float>(i) = static_cast<float>(
        sample <= 0.04045 ? sample / 12.92 : std::pow((sample + 0.055) / 1.055, 2.4));
  }
  cv::Mat light;
  cv::LUT(picture, table, light);
  return light;
}

// The samples of an amount of light, not rounded; what is whiter than white is lost.
cv::Mat samples_of(const cv::Mat& light) {
  cv::Mat within = cv::max(cv::min(light, 1.0), 0.0);
  within.forEach<float>([](float& value, const int*) {
    value =
        255 * (value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1 / 2.4F) - 0.055F);
  });
  return within;
}

cv::Mat normal_noise(const cv::Mat& picture, double sigma, cv::RNG& draws) {
  cv::Mat noise(picture.size(), CV_32F);
  draws.fill(noise, cv::RNG::NORMAL, 0, sigma);
  return noise;
}

// Noise whose grains have the size of a blur, standard deviation 1.
cv::Mat grains(const cv::Mat& picture, double size, cv::RNG& draws) {
  cv::Mat noise = normal_noise(picture, 1, draws);
  cv::GaussianBlur(noise, noise, {}, size);
  cv::Scalar mean, deviation;
  cv::meanStdDev(noise, mean, deviation);
  return noise / deviation[0];
}

void compress(Scene& scene, int quality) {
  std::vector<unsigned char> file;
  cv::imencode(".jpg", scene.picture, file, {cv::IMWRITE_JPEG_QUALITY, quality});
  scene.picture = cv::imdecode(file, cv::IMREAD_GRAYSCALE);
}

// Stores samples as a camera does: noise, rounding, JPEG.
void store(Scene& scene, const cv::Mat& samples, cv::RNG& draws, double noise = 1) {
  const cv::Mat noisy = samples + normal_noise(samples, noise, draws);
  noisy.convertTo(scene.picture, CV_8U);
  compress(scene, 92);
}

void store_light(Scene& scene, const cv::Mat& light, cv::RNG& draws) {
  store(scene, samples_of(light), draws);
}

// --- what lies on a plate ---

// How much of the plate's light it takes at a place in modules, 0-1.
using Cover = std::function<double(double right, double down)>;

// Pixels of a plate and a little around it are covered as `draw_cover` says, each plate otherwise;
// what covers has a light of its own.
void cover_plates(Scene& scene, cv::RNG& draws, double light, Cover (*draw_cover)(cv::RNG&)) {
  constexpr double kAround = 12;  // modules
  cv::Mat shown = light_of(scene.picture);
  for (const cv::Matx33d& to_modules : scene.to_modules) {
    const Cover cover = draw_cover(draws);
    cv::Mat opacity(shown.size(), CV_32F, cv::Scalar(0));
    opacity.forEach<float>([&](float& value, const int* at) {
      const cv::Vec3d place = to_modules * cv::Vec3d(at[1], at[0], 1);
      const double right = place[0] / place[2], down = place[1] / place[2];
      if (right < -kAround || right > kFrameLength + kAround || down < -kAround ||
          down > kFrameHeight + kAround) {
        return;
      }
      value = static_cast<float>(std::clamp(cover(right, down), 0.0, 1.0));
    });
    cv::GaussianBlur(opacity, opacity, {}, 0.6);
    shown = shown.mul(1 - opacity) + light * opacity;
  }
  store_light(scene, shown, draws);
}

double part_of(double value, double period) { return value - period * std::floor(value / period); }

// A square mesh, wires and openings in modules.
Cover square_mesh(cv::RNG& draws, double period, double wire, double opacity) {
  const double turn = draws.uniform(-0.3, 0.3);
  const double right_of = draws.uniform(0.0, period), down_of = draws.uniform(0.0, period);
  return [=](double right, double down) {
    const bool is_wire = part_of(right + turn * down + right_of, period) < wire ||
                         part_of(down - turn * right + down_of, period) < wire;
    return is_wire ? opacity : 0;
  };
}

void mesh(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0.08, [](cv::RNG& of) { return square_mesh(of, 26, 1.3, 1); });
}

void mesh_shadow(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0, [](cv::RNG& of) { return square_mesh(of, 20, 2, 0.7); });
}

void mud(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0.06, [](cv::RNG& of) -> Cover {
    std::array<cv::Vec3d, 60> drops;
    for (cv::Vec3d& drop : drops) {
      const double size = 0.3 - 1.3 * std::log(of.uniform(1e-9, 1.0));
      drop = {of.uniform(-6.0, 119.0), of.uniform(-6.0, 61.0), size};
    }
    return [=](double right, double down) {
      return std::ranges::any_of(drops, [&](const cv::Vec3d& drop) {
        return std::hypot(right - drop[0], down - drop[1]) < drop[2];
      });
    };
  });
}

struct Run {
  double right, width, end, opacity;
};

void mud_runs(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0.08, [](cv::RNG& of) -> Cover {
    std::array<Run, 10> runs{};
    for (Run& run : runs) {
      run = {of.uniform(-6.0, 119.0), of.uniform(0.7, 3.0), of.uniform(-1.0, 54.0),
             of.uniform(0.3, 0.9)};
    }
    return [=](double right, double down) {
      double opacity = 0;
      for (const Run& run : runs) {
        const double off = std::abs(right - run.right - 0.4 * std::sin(down / 4));
        if (off < run.width / 2 && down < run.end) opacity = std::max(opacity, run.opacity);
      }
      return opacity;
    };
  });
}

struct Scratch {
  double right, down, angle, length, width;
};

void scratch(Scene& scene, cv::RNG& draws, double light) {
  cover_plates(scene, draws, light, [](cv::RNG& of) -> Cover {
    std::array<Scratch, 25> scratches{};
    for (Scratch& one : scratches) {
      one = {of.uniform(-6.0, 119.0), of.uniform(-6.0, 61.0), of.uniform(0.0, std::numbers::pi),
             of.uniform(5.0, 60.0), of.uniform(0.3, 0.9)};
    }
    return [=](double right, double down) {
      return std::ranges::any_of(scratches, [&](const Scratch& one) {
        const double x = right - one.right, y = down - one.down;
        const double c = std::cos(one.angle), s = std::sin(one.angle);
        return std::abs(x * c + y * s) < one.length / 2 && std::abs(y * c - x * s) < one.width / 2;
      });
    };
  });
}

void dark_scratches(Scene& scene, cv::RNG& draws) { scratch(scene, draws, 0.03); }

void bright_scratches(Scene& scene, cv::RNG& draws) {
  double white = 0;
  cv::minMaxLoc(light_of(scene.picture), nullptr, &white);
  scratch(scene, draws, 0.9 * white);
}

void sticker(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0.5, [](cv::RNG& of) -> Cover {
    const double x = of.uniform(5.0, 95.0), y = of.uniform(0.0, 40.0);
    return [=](double right, double down) {
      return std::abs(right - x) < 6 && std::abs(down - y) < 5;
    };
  });
}

void crust(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0.5, [](cv::RNG& of) -> Cover {
    const int side = of.uniform(0, 4);
    const double thick = of.uniform(0.3, 0.7);
    return [=](double right, double down) {
      const double beyond[] = {-down, right - kFrameLength, down - kFrameHeight, -right};
      const double along = side % 2 == 0 ? right : down;
      return beyond[side] > -0.1 && beyond[side] < thick * (1 + 0.15 * std::sin(0.7 * along));
    };
  });
}

void shadow_edge(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0, [](cv::RNG& of) -> Cover {
    const double edge = of.uniform(0, 2) * kFrameHeight + of.uniform(-2.0, 2.0);
    const bool is_below = of.uniform(0, 2) == 1;
    return [=](double, double down) { return (down > edge) == is_below ? 0.7 : 0; };
  });
}

void torn_corner(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 0.07, [](cv::RNG& of) -> Cover {
    const bool is_right = of.uniform(0, 2) == 1, is_low = of.uniform(0, 2) == 1;
    return [=](double right, double down) {
      const double along = is_right ? kFrameLength - right : right;
      const double across = is_low ? kFrameHeight - down : down;
      return along + across + 10 < 22 + 1.5 * std::sin(3 * along);
    };
  });
}

void spray(Scene& scene, cv::RNG& draws, double light) {
  cover_plates(scene, draws, light, [](cv::RNG& of) -> Cover {
    const double slope = of.uniform(-0.2, 0.2), y = of.uniform(5.0, 50.0);
    return [=](double right, double down) {
      const double off = (down - y - slope * (right - 56)) / 1.6;
      return std::min(0.95, 1.2 * std::exp(-off * off) - 0.1);
    };
  });
}

void dark_spray(Scene& scene, cv::RNG& draws) { spray(scene, draws, 0.02); }
void bright_spray(Scene& scene, cv::RNG& draws) { spray(scene, draws, 0.3); }

void reflection(Scene& scene, cv::RNG& draws) {
  cover_plates(scene, draws, 1.2, [](cv::RNG& of) -> Cover {
    const double slope = of.uniform(-0.6, 0.6), x = of.uniform(10.0, 103.0);
    const double width = of.uniform(2.0, 7.0);
    return [=](double right, double down) {
      const double off = (right - x - slope * (down - 27)) / width;
      return 1.5 * std::exp(-off * off);
    };
  });
}

void dust(Scene& scene, cv::RNG& draws) {
  const cv::Mat opacity = cv::max(cv::min(0.55 + 0.15 * grains(scene.picture, 6, draws), 0.9), 0.0);
  store_light(scene, light_of(scene.picture).mul(1 - opacity) + 0.15 * opacity, draws);
}

// --- light and air ---

// Blurred discs anywhere in the picture, each of an opacity of its own.
cv::Mat discs(const Scene& scene, int number, cv::Vec2d sizes, cv::Vec2d opacities, double blur,
              cv::RNG& draws) {
  cv::Mat opacity(scene.picture.size(), CV_32F, cv::Scalar(0));
  for (int i = 0; i < number; ++i) {
    const cv::Point at{draws.uniform(0, opacity.cols), draws.uniform(0, opacity.rows)};
    const int size = static_cast<int>(draws.uniform(sizes[0], sizes[1]));
    cv::circle(opacity, at, size, draws.uniform(opacities[0], opacities[1]), cv::FILLED);
  }
  cv::GaussianBlur(opacity, opacity, {}, blur);
  return opacity;
}

void dust_in_air(Scene& scene, cv::RNG& draws) {
  const cv::Mat opacity = discs(scene, 400, {1, 10}, {0.05, 0.5}, 1.5, draws);
  store_light(scene, light_of(scene.picture).mul(1 - opacity) + 0.7 * opacity, draws);
}

void haze(Scene& scene, cv::RNG& draws) {
  store_light(scene, 0.25 * light_of(scene.picture) + 0.3, draws);
}

// A lamp's spot near a plate's middle; around it a twentieth of the light.
void headlamp(Scene& scene, cv::RNG& draws) {
  cv::Point2d at{scene.picture.cols / 2.0, scene.picture.rows / 2.0};
  if (!scene.to_modules.empty()) {
    const int plate = draws.uniform(0, static_cast<int>(scene.to_modules.size()));
    const cv::Vec3d middle = scene.to_modules[static_cast<std::size_t>(plate)].inv() *
                             cv::Vec3d(kFrameLength / 2, kFrameHeight / 2, 1);
    at = {middle[0] / middle[2], middle[1] / middle[2]};
  }
  at += cv::Point2d(draws.gaussian(80), draws.gaussian(80));
  cv::Mat light = light_of(scene.picture);
  light.forEach<float>([at](float& value, const int* pixel) {
    const double off = std::hypot(pixel[1] - at.x, pixel[0] - at.y) / 110;
    value *= static_cast<float>(0.05 + 1.2 * std::exp(-off * off / 2));
  });
  store_light(scene, light, draws);
}

// A lamp that flickers while a rolling shutter reads the rows.
void flicker(Scene& scene, cv::RNG& draws, double strength, bool is_square) {
  const double phase = draws.uniform(0.0, 2 * std::numbers::pi), period = draws.uniform(25.0, 80.0);
  cv::Mat light = light_of(scene.picture);
  for (int y = 0; y < light.rows; ++y) {
    const double wave = std::sin(2 * std::numbers::pi * y / period + phase);
    light.row(y) *= 1 - strength + strength * (is_square ? std::copysign(1, wave) : wave);
  }
  store_light(scene, light, draws);
}

void hard_flicker(Scene& scene, cv::RNG& draws) { flicker(scene, draws, 0.42, true); }
void soft_flicker(Scene& scene, cv::RNG& draws) { flicker(scene, draws, 0.4, false); }

void blooming_lamp(Scene& scene, cv::RNG& draws) {
  cv::Mat lamp(scene.picture.size(), CV_32F, cv::Scalar(0));
  const cv::Point at{draws.uniform(0, lamp.cols), draws.uniform(0, lamp.rows)};
  cv::circle(lamp, at, 25, 60, cv::FILLED);
  cv::Mat wide, narrow;
  cv::GaussianBlur(lamp, wide, {}, 120);
  cv::GaussianBlur(lamp, narrow, {}, 30);
  store_light(scene, 1.6 * light_of(scene.picture) + lamp + wide + 0.3 * narrow, draws);
}

// --- lens ---

// Mixes the picture with a blurred one by this share of it.
void blur_partly(Scene& scene, const cv::Mat& share, double blur, cv::RNG& draws) {
  cv::Mat sharp, blurred;
  scene.picture.convertTo(sharp, CV_32F);
  cv::GaussianBlur(sharp, blurred, {}, blur);
  store(scene, sharp.mul(1 - share) + blurred.mul(share), draws, 0.7);
}

void drops_on_lens(Scene& scene, cv::RNG& draws) {
  blur_partly(scene, discs(scene, 25, {15, 60}, {1, 1}, 3, draws), 5, draws);
}

void condensation(Scene& scene, cv::RNG& draws) {
  const cv::Mat share = cv::max(cv::min(0.5 + 0.5 * grains(scene.picture, 40, draws), 1.0), 0.0);
  blur_partly(scene, share, 2, draws);
}

void lens_dirt(Scene& scene, cv::RNG& draws) {
  const cv::Mat opacity = discs(scene, 30, {20, 70}, {0.1, 0.6}, 15, draws);
  store_light(scene, light_of(scene.picture).mul(1 - opacity) + 0.04 * opacity, draws);
}

cv::Mat shifted_rows(const cv::Mat& picture, const std::function<double(int row)>& shift) {
  cv::Mat columns(picture.size(), CV_32F), rows(picture.size(), CV_32F), result;
  for (int y = 0; y < picture.rows; ++y) {
    const auto off = static_cast<float>(shift(y));
    for (int x = 0; x < picture.cols; ++x) {
      columns.at<float>(y, x) = static_cast<float>(x) + off;
      rows.at<float>(y, x) = static_cast<float>(y);
    }
  }
  cv::remap(picture, result, columns, rows, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return result;
}

// Colors that the lens makes larger and smaller.
void color_fringes(Scene& scene, cv::RNG& draws) {
  const auto scaled = [&scene](double scale) {
    const cv::Point2f middle(0.5F * static_cast<float>(scene.picture.cols),
                             0.5F * static_cast<float>(scene.picture.rows));
    cv::Mat samples;
    cv::warpAffine(scene.picture, samples, cv::getRotationMatrix2D(middle, 0, scale),
                   scene.picture.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    samples.convertTo(samples, CV_32F);
    return samples;
  };
  store(scene, 0.30 * scaled(1.0025) + 0.59 * scaled(1) + 0.11 * scaled(0.9975), draws, 0.7);
}

void blur_by(Scene& scene, cv::Mat kernel, cv::RNG& draws) {
  kernel /= cv::sum(kernel)[0];
  cv::Mat light;
  cv::filter2D(light_of(scene.picture), light, -1, kernel);
  store_light(scene, light, draws);
}

void defocus(Scene& scene, cv::RNG& draws) {
  cv::Mat kernel(5, 5, CV_32F, cv::Scalar(0));
  cv::circle(kernel, {2, 2}, 2, 1, cv::FILLED);
  blur_by(scene, kernel, draws);
}

// --- camera ---

void motion(Scene& scene, cv::RNG& draws) { blur_by(scene, cv::Mat::eye(5, 5, CV_32F), draws); }

void vibration(Scene& scene, cv::RNG& draws) {
  const double phase = draws.uniform(0.0, 2 * std::numbers::pi),
               period = draws.uniform(30.0, 120.0);
  scene.picture = shifted_rows(scene.picture, [=](int row) {
    return 1.2 * std::sin(2 * std::numbers::pi * row / period + phase);
  });
  compress(scene, 92);
}

// The second field shows the plate up to 4 pixels aside.
void interlacing(Scene& scene, cv::RNG& draws) {
  const double displacement = draws.uniform(0.5, 4.0);
  scene.picture = shifted_rows(
      scene.picture, [=](int row) { return row % 2 == 0 ? displacement / 2 : -displacement / 2; });
  compress(scene, 92);
}

void uneven_columns(Scene& scene, cv::RNG& draws) {
  cv::Mat gains(1, scene.picture.cols, CV_32F), samples;
  draws.fill(gains, cv::RNG::NORMAL, 1, 0.04);
  scene.picture.convertTo(samples, CV_32F);
  for (int y = 0; y < samples.rows; ++y) samples.row(y) = samples.row(y).mul(gains);
  store(scene, samples, draws, 0);
}

void local_contrast(Scene& scene, cv::RNG&) {
  cv::createCLAHE(4)->apply(scene.picture, scene.picture);
  compress(scene, 92);
}

// Light divided by the light around, to a power.
void tone_mapping(Scene& scene, cv::RNG& draws) {
  const cv::Mat light = light_of(scene.picture) + 0.002;
  cv::Mat around;
  cv::GaussianBlur(light, around, {}, 30);
  cv::pow(around, 0.6, around);
  store_light(scene, 0.35 * light / around, draws);
}

void strong_jpeg(Scene& scene, cv::RNG&) { compress(scene, 20); }

void half_size(Scene& scene, cv::RNG&) {
  cv::Mat small;
  cv::resize(scene.picture, small, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::resize(small, scene.picture, scene.picture.size(), 0, 0, cv::INTER_LINEAR);
}

void lost_blocks(Scene& scene, cv::RNG& draws) {
  for (int i = 0; i < 120; ++i) {
    const cv::Point at{16 * draws.uniform(0, scene.picture.cols / 16),
                       16 * draws.uniform(0, scene.picture.rows / 16)};
    cv::rectangle(scene.picture, {at, cv::Size(16 * draws.uniform(1, 4), 16)}, 128, cv::FILLED);
  }
}

void second_image(Scene& scene, cv::RNG& draws) {
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, 4, 0, 1, 2);
  cv::Mat moved, samples;
  cv::warpAffine(scene.picture, moved, move, scene.picture.size(), cv::INTER_LINEAR,
                 cv::BORDER_REPLICATE);
  cv::addWeighted(scene.picture, 0.7, moved, 0.3, 0, samples, CV_32F);
  store(scene, samples, draws, 0);
}

// What a video camera does against noise: each frame is mixed with what it gave out before, in
// which the plate stands 1 to 3 pixels aside a frame.
void temporal_filter(Scene& scene, cv::RNG& draws) {
  const double direction = draws.uniform(0.0, 2 * CV_PI), speed = draws.uniform(1.0, 3.0);
  const double kept = draws.uniform(0.3, 0.6);
  cv::Mat samples = cv::Mat::zeros(scene.picture.size(), CV_32F);
  double share = 1 - kept;
  for (int before = 0; share > 0.01; ++before, share *= kept) {
    const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, before * speed * std::cos(direction), 0,
                          1, before * speed * std::sin(direction));
    cv::Mat moved;
    cv::warpAffine(scene.picture, moved, move, scene.picture.size(), cv::INTER_CUBIC,
                   cv::BORDER_REPLICATE);
    cv::addWeighted(samples, 1, moved, share, 0, samples, CV_32F);
  }
  samples *= (1 - kept) / (1 - kept - share);  // of those that were left out
  store(scene, samples, draws);
}

void sixteen_greys(Scene& scene, cv::RNG&) {
  scene.picture.forEach<unsigned char>([](unsigned char& sample, const int*) {
    sample = static_cast<unsigned char>(sample / 16 * 16 + 8);
  });
}

void strong_noise(Scene& scene, cv::RNG& draws) {
  cv::Mat samples;
  scene.picture.convertTo(samples, CV_32F);
  store(scene, samples, draws, 15);
}

void coarse_noise(Scene& scene, cv::RNG& draws) {
  cv::Mat samples;
  scene.picture.convertTo(samples, CV_32F);
  store(scene, samples + 10 * grains(samples, 1.5, draws), draws, 0);
}

constexpr Disturbance kDisturbances[] = {
    {"nothing", "the photos as they are", [](Scene&, cv::RNG&) {}},
    {"mesh", "ground support mesh before the plate, wires of 1.3 modules each 26", mesh},
    {"mesh_shadow", "its shadow, 2 modules each 20, 0.3 of the light left", mesh_shadow},
    {"mud", "60 splashes, most of them of 1 to 3 modules", mud},
    {"mud_runs", "10 vertical runs, 0.1 to 0.7 of the light left", mud_runs},
    {"dust", "a patchy layer that leaves half of the contrast", dust},
    {"dark_scratches", "25 scratches of 0.3 to 0.9 modules", dark_scratches},
    {"bright_scratches", "the same, as bright as the plate", bright_scratches},
    {"sticker", "12 by 10 modules, grey", sticker},
    {"crust", "white along a stroke's inner edge, 0.3 to 0.7 modules", crust},
    {"shadow_edge", "a shadow's level edge within 2 modules of a side", shadow_edge},
    {"torn_corner", "a corner of 12 modules is gone", torn_corner},
    {"dark_spray", "a line of black paint along the plate", dark_spray},
    {"bright_spray", "a line of grey paint along the plate", bright_spray},
    {"reflection", "a lamp's reflection across the plate", reflection},
    {"dust_in_air", "400 bright specks out of focus", dust_in_air},
    {"haze", "a quarter of the contrast, three tenths of white added", haze},
    {"headlamp", "a spot with a twentieth of the light around it", headlamp},
    {"hard_flicker", "rows with 1.0 and 0.16 of the light by turns", hard_flicker},
    {"soft_flicker", "the same, between 1.0 and 0.2, as a sine", soft_flicker},
    {"blooming_lamp", "a lamp in the picture and its veil", blooming_lamp},
    {"drops_on_lens", "25 drops that blur by 5 pixels", drops_on_lens},
    {"condensation", "a blur of 2 pixels in patches", condensation},
    {"lens_dirt", "30 dark patches out of focus", lens_dirt},
    {"color_fringes", "red larger, blue smaller by a quarter percent", color_fringes},
    {"defocus", "a disc of 2 pixels' radius", defocus},
    {"motion", "5 pixels along a diagonal", motion},
    {"vibration", "rows shifted by up to 1.2 pixels", vibration},
    {"interlacing", "two fields 0.5 to 4 pixels apart", interlacing},
    {"uneven_columns", "gains of columns differ by 4 %", uneven_columns},
    {"local_contrast", "adaptive histogram equalization", local_contrast},
    {"tone_mapping", "light divided by the light around to the power 0.6", tone_mapping},
    {"strong_jpeg", "JPEG of quality 20", strong_jpeg},
    {"half_size", "made smaller by 2 and larger again", half_size},
    {"lost_blocks", "120 rows of 1 to 3 blocks replaced by grey", lost_blocks},
    {"second_image", "0.3 of the picture 4 pixels aside", second_image},
    {"temporal_filter", "mixed with 0.3 to 0.6 of earlier frames, 1 to 3 pixels aside each",
     temporal_filter},
    {"sixteen_greys", "16 levels of grey", sixteen_greys},
    {"strong_noise", "15 grey levels", strong_noise},
    {"coarse_noise", "10 grey levels in grains of 1.5 pixels", coarse_noise},
};

}  // namespace

std::span<const Disturbance> disturbances() { return kDisturbances; }

}  // namespace tagsmith::detail::bench
