// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <doctest/doctest.h>

#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::SeenTag;

namespace {

// Bars alone, on white.
SeenTag turned_bars(double turn = 0) {
  SeenTag tag;
  tag.framed = false;
  tag.width = tag.height = 300;
  tag.view = {{150, 140}, 2, turn, {}};
  return tag;
}

}  // namespace

TEST_CASE("lines run across the bars, beyond them by half of their length") {
  for (const double turn : {0.0, 0.6, 2.5}) {
    CAPTURE(turn);
    SeenTag tag = turned_bars(turn);
    tag.width = tag.height = 600;
    tag.view.middle = {300, 300};
    const GrayImage image = tag.image();
    SampledLight light(image.view());
    const LineFrame frame = line_frame_for(light, tag.region());
    CHECK(distance(frame.centre, tag.region().centre) < 1e-9);
    CHECK(distance(frame.across, {std::cos(turn), std::sin(turn)}) < 1e-9);
    CHECK(distance(frame.along, {-std::sin(turn), std::cos(turn)}) < 1e-9);
    CHECK(frame.step == doctest::Approx(190.0 / 95 / 5));
    CHECK(frame.begin == doctest::Approx(-190));
    CHECK(static_cast<double>(frame.count) * frame.step == doctest::Approx(380).epsilon(0.01));
    // The first bar begins half of the symbol from its centre.
    const double place = (-95 - frame.begin) / frame.step;
    const PixelPoint begin =
        tag.view.pixel({-47.5, (tag.bars_top + tag.bars_bottom) / 2}) + 7 * frame.along;
    CHECK(distance(frame.pixel(place, 7), begin) < 1e-9);
  }
}

TEST_CASE("lines end where the picture does") {
  SeenTag tag = turned_bars();
  tag.view.middle = {120, 140};
  const GrayImage image = tag.image();
  SampledLight light(image.view());
  const LineFrame frame = line_frame_for(light, tag.region());
  CHECK(frame.pixel(0, 0).x == doctest::Approx(-0.5));
  const double end = frame.pixel(static_cast<double>(frame.count), 0).x;
  CHECK(end <= 299.5);
  CHECK(end > 299.5 - 2 * frame.step);
}

TEST_CASE("bars that lean from the region's own direction are followed to a degree") {
  for (const double lean : {-0.1, 0.05, 0.12}) {
    CAPTURE(lean);
    const SeenTag tag = turned_bars(lean);
    BarRegion region = tag.region();
    region.across = {1, 0};
    const GrayImage image = tag.image();
    SampledLight light(image.view());
    const LineFrame frame = line_frame_for(light, region);
    const double angle = std::atan2(-frame.along.x, frame.along.y);
    CHECK(std::abs(angle - lean) < 0.018);
  }
}

TEST_CASE("a line holds the light of the picture, averaged along the bars") {
  const SeenTag tag = turned_bars(0.4);
  const GrayImage image = tag.image();
  SampledLight light(image.view());
  const LineFrame frame = line_frame_for(light, tag.region());
  for (const double offset : {-15.0, 0.0, 11.3}) {
    CAPTURE(offset);
    const ScanLine line = light_along(light, frame, offset, 8);
    REQUIRE(line.size() == frame.count);
    double worst = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const PixelPoint at = frame.pixel(static_cast<double>(i) + 0.5, offset);
      if (at.x < 2 || at.y < 2 || at.x > 297 || at.y > 297) continue;
      worst = std::max(worst, std::abs(static_cast<double>(line[i]) - tag.light_at(at)));
    }
    CHECK(worst < 0.03);
  }
  // Across the bars' end half of the thickness shows bars.
  const double end = distance(tag.region().centre, tag.view.pixel({0, tag.bars_bottom}));
  const ScanLine amid = light_along(light, frame, 0, 8);
  const ScanLine at_end = light_along(light, frame, end, 8);
  for (std::size_t i = 0; i < amid.size(); i += 3) {
    const double half = 0.5 * (static_cast<double>(amid[i]) + tag.white);
    CHECK(static_cast<double>(at_end[i]) == doctest::Approx(half).epsilon(0.05));
  }
}

TEST_CASE("a symbol has bars, also where half of it is covered") {
  SeenTag tag = turned_bars(0.3);
  const auto has = [](const SeenTag& seen) {
    const GrayImage image = seen.image();
    return has_bars(image.view(), seen.region(), 10);
  };
  CHECK(has(tag));
  tag.covers = {{-60, -40, -8, 40, 0.3}};
  CHECK(has(tag));
}

TEST_CASE("blurred narrow bars count although they stand between wide ones") {
  SeenTag tag = turned_bars();
  tag.digits = *parse_digits("072527272703");
  tag.view.module_px = 1.4;
  tag.blur_px = 1;
  const GrayImage image = tag.image();
  CHECK(has_bars(image.view(), tag.region(), 10));
}

TEST_CASE("a region has as many bars as lines across it turn dark") {
  constexpr int kWidth = 300, kHeight = 120;
  BarRegion region{{150, 60}, {1, 0}, 190, 80};
  const auto has = [&](const auto& is_dark, int least) {
    GrayImage image{kWidth, kHeight, {}};
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        image.samples.push_back(is_dark(x, y) ? std::uint8_t{60} : std::uint8_t{210});
      }
    }
    return has_bars(image.view(), region, least);
  };
  const auto bars_of = [](int period) {
    return [period](int x, int) { return x % period < period / 2; };
  };
  for (const auto& [period, count] : {std::pair{8, 24}, {16, 12}, {24, 8}}) {
    CAPTURE(period);
    CHECK(has(bars_of(period), count - 1));
    CHECK_FALSE(has(bars_of(period), count + 2));
  }
  CHECK_FALSE(has([](int, int) { return false; }, 1));
}
