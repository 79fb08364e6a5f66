// SPDX-License-Identifier: Apache-2.0
// Which part of a side shows its edge, by samples made for it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/feature_frame/fitted_side.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "tests/support/seen_tag.hpp"

namespace tagsmith::detail::test {
namespace {

constexpr double kNoise = 3;

// White inside, black outside, blurred over two pixels; `edge_at` gives the edge along the side.
std::vector<EdgeSample> samples_of(const std::function<double(int slice, double along)>& edge_at) {
  std::vector<EdgeSample> samples;
  for (int slice = 0; slice < kSlices; ++slice) {
    const double along = (2 * slice + 1.0) / kSlices - 1;
    for (double across = -8; across <= 8; across += 0.5) {
      const double black = std::clamp((across - edge_at(slice, along) + 1) / 2, 0.0, 1.0);
      samples.push_back({static_cast<float>(along), static_cast<float>(across),
                         static_cast<float>(200 - 150 * black), 2});
    }
  }
  return samples;
}

double line(double along) { return 0.4 - 0.3 * along; }

}  // namespace

TEST_CASE("a side that shows all of its edge, straight or bowed, is left as it is") {
  for (const double bow : {0.0, 0.3, -3.0, 5.0}) {
    CAPTURE(bow);
    CHECK_FALSE(shown_part(
        samples_of([&](int, double along) { return line(along) + bow * (1 - along * along); }),
        kNoise));
  }
}

TEST_CASE("the edge of what covers a part of a side is left out") {
  for (const int covered : {2, 4}) {
    for (const double off : {-4.0, -2.0, 2.0, 5.0}) {
      CAPTURE(covered);
      CAPTURE(off);
      const auto part = shown_part(samples_of([&](int slice, double along) {
                                     return line(along) + (slice < covered ? off : 0);
                                   }),
                                   kNoise);
      REQUIRE(part);
      CHECK(std::abs(part->place - line(0)) < 0.05);
      CHECK(std::abs(part->turn - (line(1) - line(0))) < 0.1);
      const std::size_t of_slice = 33;
      CHECK(part->samples.size() == (kSlices - static_cast<std::size_t>(covered)) * of_slice);
      for (const EdgeSample& sample : part->samples) {
        CHECK(static_cast<double>(sample.along) > 2.0 * covered / kSlices - 1);
      }
    }
  }
}

TEST_CASE("slices without the edge's contrast are left out") {
  std::vector<EdgeSample> samples = samples_of([](int, double along) { return line(along); });
  for (EdgeSample& sample : samples) {
    if (sample.along > 0.5F) sample.value = 50;
  }
  const auto part = shown_part(samples, kNoise);
  REQUIRE(part);
  CHECK(part->samples.size() == 12 * 33);
}

TEST_CASE("where fewer than half of the slices agree, no part is told") {
  CHECK_FALSE(shown_part(
      samples_of([](int slice, double) { return slice % 5 * 1.5 + slice % 3 * 2.1 - 5; }), kNoise));
  CHECK_FALSE(shown_part({}, kNoise));
}

TEST_CASE("a side that a torn corner has put askew is fitted where its edge shows") {
  SeenTag tag;
  tag.width = 500;
  tag.height = 300;
  tag.view = {{250.3, 150.2}, 3.6, 0.03, {0.0003, 0.0001}};
  constexpr double kGone = 12;  // modules
  for (double step = 0; step < kGone; ++step) {
    const double low = tag.bottom() - kGone + step;
    tag.covers.push_back({SeenTag::kLeft - 20, low, SeenTag::kLeft + step + 1, low + 20, 0.1});
  }
  Quad settled = tag.corners();
  settled[3].x += 2.5;  // the end that is torn
  settled[0].x += 1;
  const auto frame = refine_frame(tag.image().view(), settled);
  REQUIRE(frame);
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(i);
    CHECK(distance(frame->corners[i], tag.corners()[i]) < 0.01);
  }
}

}  // namespace tagsmith::detail::test
