// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/edge_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <doctest/doctest.h>

#include "tests/feature_frame/side_about.hpp"

using namespace tagsmith::detail;

namespace {

constexpr int kSize = 160;

// Grey level at a distance outwards from a blurred edge.
double level_at(double across) { return 200 - 150 * 0.5 * (1 + std::erf(across / 1.2)); }

struct Place {
  double along = 0;   // -1 to 1
  double across = 0;  // outwards from the side as it bows
};

Place place_of(const SideLine& side, PixelPoint pixel) {
  const PixelPoint from_middle = pixel - 0.5 * (side.begin + side.end);
  const double along = 2 * dot(from_middle, side.along) / distance(side.begin, side.end);
  const double bow = std::abs(along) < 1 ? side.bow.at(along) : 0;
  return {along, dot(from_middle, side.outward) - bow};
}

GrayImage image_of(const SideLine& side) {
  GrayImage image{kSize, kSize, {}};
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Place at = place_of(side, {static_cast<double>(x), static_cast<double>(y)});
      image.samples.push_back(static_cast<std::uint8_t>(std::lround(level_at(at.across))));
    }
  }
  return image;
}

// A side of 100 pixels with a stroke of so many.
SideLine side_at(double angle, double stroke) {
  return test::side_about({80.3, 79.6}, angle, 100, stroke);
}

}  // namespace

TEST_CASE("samples near a side are the picture's where they say that they are") {
  for (const double bow : {0.0, 4.0, -3.0}) {
    for (const double angle : {0.0, 0.3, 1.2, 2.0, 4.0}) {
      CAPTURE(bow);
      CAPTURE(angle);
      SideLine side = side_at(angle, 3);
      side.bow.c = {bow, 0.2 * bow, 0, 0, 0};
      const GrayImage image = image_of(side);
      const std::vector<EdgeSample> samples = edge_samples(image.view(), side);
      REQUIRE(samples.size() >= 4 * 7);
      double inmost = 0, outmost = 0;
      for (const EdgeSample& sample : samples) {
        const auto across = static_cast<double>(sample.across);
        CAPTURE(across);
        CHECK(std::abs(static_cast<double>(sample.value) - level_at(across)) < 4);
        CHECK(std::abs(sample.along) < 1);
        inmost = std::min(inmost, across);
        outmost = std::max(outmost, across);
      }
      // From the white inside to beyond a thin stroke.
      CHECK(inmost < -2.3);
      CHECK(outmost > 3.5);
    }
  }
}

TEST_CASE("each pixel near a side is taken once, but for those at its ends") {
  SideLine side = side_at(0.35, 3);
  const GrayImage image = image_of(side);
  double taken = 0;
  for (const EdgeSample& sample : edge_samples(image.view(), side)) {
    taken += static_cast<double>(sample.weight);
  }
  // 3 pixels inwards, 4.5 outwards, over the side less what its neighbours' edges reach.
  CHECK(taken == doctest::Approx(7.5 * (100 - 2 * 3.6)).epsilon(0.02));
}

TEST_CASE("samples are means over a quarter of the side each") {
  const SideLine side = side_at(0.35, 3);
  const GrayImage image = image_of(side);
  std::array<int, 4> samples{};
  std::array<double, 4> pixels{};
  for (const EdgeSample& sample : edge_samples(image.view(), side)) {
    const double along = static_cast<double>(sample.along);
    const auto quarter = static_cast<std::size_t>(2 * (along + 1));
    ++samples.at(quarter);
    pixels.at(quarter) += static_cast<double>(sample.weight);
    // The outer quarters lack the side's ends.
    CHECK(std::abs(along - (static_cast<double>(quarter) / 2 - 0.75)) < 0.16);
  }
  for (std::size_t quarter = 0; quarter < 4; ++quarter) {
    CAPTURE(quarter);
    CHECK(std::abs(samples[quarter] - samples[3 - quarter]) <= 2);
    CHECK(pixels[quarter] == doctest::Approx(pixels[3 - quarter]).epsilon(0.1));
  }
}

TEST_CASE("a thick stroke is seen on its inner part alone") {
  for (const double stroke : {6.0, 10.0, 30.0}) {
    CAPTURE(stroke);
    const SideLine side = side_at(1.0, stroke);
    const GrayImage image = image_of(side);
    float outmost = 0;
    for (const EdgeSample& sample : edge_samples(image.view(), side)) {
      outmost = std::max(outmost, sample.across);
    }
    CHECK(static_cast<double>(outmost) > 0.6 * std::min(stroke, 10.0));
    CHECK(static_cast<double>(outmost) < 0.8 * stroke);
    CHECK(outmost <= 8);
  }
}

TEST_CASE("where both edges of a stroke are seen, samples lie close together at both") {
  const SideLine side = side_at(1.0, 9);
  const GrayImage image = image_of(side);
  std::vector<float> across;
  for (const EdgeSample& sample : edge_samples(image.view(), side, 10.0)) {
    across.push_back(sample.across);
  }
  std::ranges::sort(across);
  REQUIRE(across.back() > 10);
  for (std::size_t i = 1; i < across.size(); ++i) CHECK(across[i] - across[i - 1] < 0.55F);
}

TEST_CASE("a side that leaves the picture is seen where it is in the picture") {
  SideLine side = side_at(0.2, 3);
  const PixelPoint away{-60, 0};
  side.begin = side.begin + away;
  side.end = side.end + away;
  const GrayImage image = image_of(side);
  const std::vector<EdgeSample> samples = edge_samples(image.view(), side);
  REQUIRE(!samples.empty());
  for (const EdgeSample& sample : samples) {
    const PixelPoint at = point_on(side, static_cast<double>(sample.along));
    CHECK(at.x > -6);
    CHECK(std::abs(static_cast<double>(sample.value) -
                   level_at(static_cast<double>(sample.across))) < 4);
  }
}
