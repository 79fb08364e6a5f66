// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/fitted_side.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <random>

#include <doctest/doctest.h>

#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/tone_curve.hpp"
#include "tests/feature_frame/side_about.hpp"

using namespace tagsmith::detail;

namespace {

constexpr int kSideImage = 260;
constexpr double kInk = 0.08;  // share of the light that black reflects
constexpr double kStroke = 12;
constexpr double kBlur = 0.6;

// A side of 200 pixels, slightly askew.
SideLine true_side(double stroke = kStroke) {
  return test::side_about({129.3, 128.8}, 0.13, 200, stroke);
}

// The light of the plate's white along the side, -1 to 1 between its ends.
using LightAlong = std::function<double(double)>;

// The side's picture; white on both sides of the stroke, noise of one grey level.
GrayImage image_of_side(const SideLine& side, const LightAlong& white, double blur = kBlur) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 1);
  GrayImage image{kSideImage, kSideImage, {}};
  const PixelPoint middle = 0.5 * (side.begin + side.end);
  const auto step = [&](double across) {
    return 0.5 * (1 + std::erf(across / (std::numbers::sqrt2 * blur)));
  };
  for (int y = 0; y < kSideImage; ++y) {
    for (int x = 0; x < kSideImage; ++x) {
      const PixelPoint off = PixelPoint{static_cast<double>(x), static_cast<double>(y)} - middle;
      const double across = dot(off, side.outward);
      const double dark = step(across) - step(across - side.stroke);
      const double light = white(dot(off, side.along) / 100) * (1 - (1 - kInk) * dark);
      const double sample = ToneCurve::srgb().sample_of(std::min(light, 1.0)) + noise(random);
      image.samples.push_back(
          static_cast<std::uint8_t>(std::lround(std::clamp(sample, 0.0, 255.0))));
    }
  }
  return image;
}

// The fit from a place that is 0.7 pixels off at one end and 0.4 at the other.
std::optional<FittedSide> fit(const GrayImage& image, const SideLine& side) {
  return FittedSide::fit(image.view(), moved(side, 0.7, -0.4), kEdgeFit.thin_stroke);
}

// How far the ends of the fitted line are off those of the side, the farther one.
double off_by(const FittedSide& fitted, const SideLine& side) {
  const SideLine line = fitted.line();
  return std::max(std::abs(dot(line.begin - side.begin, side.outward)),
                  std::abs(dot(line.end - side.end, side.outward)));
}

double sigma_of(const FittedSide& fitted) {
  return std::sqrt(fitted.side().covariance.diagonal().maxCoeff());
}

double even(double) { return 0.6; }
double rising(double along) { return 0.5 + 0.3 * along; }
// A beam whose edge stands across the side: dark to its middle, then brighter and brighter.
double kinked(double along) { return 0.2 + std::max(0.0, 0.7 * along); }
double shadowed(double along) { return along < 0.1 ? 0.7 : 0.15; }

}  // namespace

TEST_CASE("a side is fitted to a hundredth of a pixel in even and in evenly changing light") {
  const SideLine side = true_side();
  for (const LightAlong& light : {LightAlong(even), LightAlong(rising)}) {
    const GrayImage image = image_of_side(side, light);
    const auto fitted = fit(image, side);
    REQUIRE(fitted);
    CHECK(fitted->stays_near());
    CHECK(off_by(*fitted, side) < 0.015);
    CHECK(sigma_of(*fitted) < 0.015);
    CHECK(fitted->blur_px() == doctest::Approx(kBlur).epsilon(0.1));
    CHECK(fitted->noise_correlation() >= 1);
    CHECK(fitted->noise_correlation() < 1.3);
    const FrameSide levels = fitted->side();
    CHECK(levels.white_begin == doctest::Approx(light(-1)).epsilon(0.06));
    CHECK(levels.white_end == doctest::Approx(light(1)).epsilon(0.06));
    CHECK(levels.black_end == doctest::Approx(kInk * light(1)).epsilon(0.2));
  }
}

TEST_CASE("a side that the edge of a beam or of a shadow crosses is fitted as well") {
  const SideLine side = true_side();
  for (const LightAlong& light : {LightAlong(kinked), LightAlong(shadowed)}) {
    const GrayImage image = image_of_side(side, light);
    const auto fitted = fit(image, side);
    REQUIRE(fitted);
    CHECK(off_by(*fitted, side) < 0.03);
    CHECK(sigma_of(*fitted) < 0.04);
    // The levels are the picture's where they stand, not those of even light.
    const FrameSide levels = fitted->side();
    CHECK(levels.white_begin == doctest::Approx(light(-1)).epsilon(0.15));
    CHECK(levels.black_begin == doctest::Approx(kInk * light(-1)).epsilon(0.3));
    CHECK(std::abs(levels.white_end - light(1)) < 0.3 * light(1));
  }
}

TEST_CASE("the part of a side in a beam beyond the sensor's end does not move its edge") {
  const SideLine side = true_side();
  for (const bool at_end : {false, true}) {
    const GrayImage image =
        image_of_side(side, [&](double along) { return (along > 0.1) == at_end ? 4.0 : 0.2; });
    const auto fitted = fit(image, side);
    REQUIRE(fitted);
    CAPTURE(at_end);
    // Light of four times the sensor's end puts an edge farther out by 0.7 pixels.
    CHECK(off_by(*fitted, side) < 0.15);
    CHECK(off_by(*fitted, side) < 4 * sigma_of(*fitted));
  }
}

TEST_CASE("a thin stroke is fitted by both of its edges") {
  const SideLine side = true_side(3);
  const GrayImage image = image_of_side(side, even);
  const auto fitted = fit(image, side);
  REQUIRE(fitted);
  CHECK(off_by(*fitted, side) < 0.015);
  CHECK(fitted->side().stroke_px == doctest::Approx(3).epsilon(0.03));
}

TEST_CASE("a side's bow is seen to a twentieth of a pixel") {
  const SideLine side = true_side();
  const GrayImage image = image_of_side(side, even);
  SideLine bowed = side;
  bowed.bow.c[0] = 0.5;
  const auto fitted = FittedSide::fit(image.view(), bowed, kEdgeFit.thin_stroke);
  REQUIRE(fitted);
  CHECK(std::abs(fitted->bow().beyond + 0.5) < 0.05);
  CHECK(std::abs(fitted->bow().beyond + 0.5) < 3 * std::sqrt(fitted->bow().variance));
}

TEST_CASE("another blur to start from is kept only where it fits better") {
  const SideLine side = true_side();
  const GrayImage image = image_of_side(side, even);
  auto fitted = fit(image, side);
  REQUIRE(fitted);
  const double before = fitted->blur_px();
  fitted->try_blur(2.5);
  CHECK(fitted->blur_px() == doctest::Approx(before).epsilon(0.02));
  CHECK(off_by(*fitted, side) < 0.015);
}

TEST_CASE("a sharp side of a large frame is found up to 13 pixels from where it was sought") {
  SideLine side = true_side(100);
  side.reach = 8;  // as of a stroke so thick
  const GrayImage image = image_of_side(
      side, [](double) { return 0.8; }, 0.25);
  for (const double off : {-13.0, -7.0, -6.5, 6.5, 7.0, 13.0}) {
    CAPTURE(off);
    const auto fitted = FittedSide::fit(image.view(), moved(side, off, off), kEdgeFit.thin_stroke);
    REQUIRE(fitted);
    CHECK(off_by(*fitted, side) < 0.2);
  }
}

TEST_CASE("a side outside of the picture, or far from any edge, is told") {
  const SideLine side = true_side();
  const GrayImage image = image_of_side(side, even);
  SideLine away = side;
  away.begin = away.begin + PixelPoint{400, 0};
  away.end = away.end + PixelPoint{400, 0};
  CHECK_FALSE(FittedSide::fit(image.view(), away, kEdgeFit.thin_stroke).has_value());
  const auto shifted = FittedSide::fit(image.view(), moved(side, -6, -6), kEdgeFit.thin_stroke);
  REQUIRE(shifted);
  CHECK_FALSE(shifted->stays_near());
}
