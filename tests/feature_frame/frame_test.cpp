// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/coarse_fit.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/tile_threshold.hpp"
#include "decoder/image/tone_curve.hpp"

using namespace tagsmith::detail;

namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 140;

// Light of a half plane at a signed distance from its edge: a lens of sigma 0.4 px, then the
// pixel's own width.
double coverage(double distance) {
  constexpr int kSteps = 9;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double offset = (i + 0.5) / kSteps - 0.5;
    sum += 0.5 * std::erfc(-(distance + offset) / (0.4 * std::sqrt(2.0)));
  }
  return sum / kSteps;
}

// A white plate with a black frame, stored with the sRGB curve. Inner corners at (left, top) and
// (right, bottom).
GrayImage draw_frame(double left, double top, double right, double bottom, double stroke) {
  const auto inside = [&](double x, double y, double grow) {
    return coverage(x - (left - grow)) * coverage(right + grow - x) * coverage(y - (top - grow)) *
           coverage(bottom + grow - y);
  };
  GrayImage image{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double ink = inside(x, y, stroke) - inside(x, y, 0);
      const double plate = inside(x, y, stroke + 12);
      const double light = 0.15 + plate * 0.55 - ink * 0.66;
      image.samples.push_back(
          static_cast<std::uint8_t>(std::lround(ToneCurve::srgb().sample_of(light))));
    }
  }
  return image;
}

}  // namespace

TEST_CASE("a homography maps the unit square to the quad and back") {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> jitter(-20, 20);
  for (int i = 0; i < 100; ++i) {
    const Quad quad{PixelPoint{50 + jitter(random), 40 + jitter(random)},
                    PixelPoint{200 + jitter(random), 50 + jitter(random)},
                    PixelPoint{190 + jitter(random), 160 + jitter(random)},
                    PixelPoint{40 + jitter(random), 150 + jitter(random)}};
    const Homography map = homography_to(quad);
    const Homography back = inverse(map);
    const double corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::size_t c = 0; c < 4; ++c) {
      CHECK(distance(map(corners[c][0], corners[c][1]), quad[c]) < 1e-9);
    }
    const PixelPoint middle = map(0.3, 0.7);
    CHECK(distance(back(middle.x, middle.y), {0.3, 0.7}) < 1e-9);
    // Of one whose last number is not 1 as well.
    const PixelPoint again = inverse(back)(0.3, 0.7);
    CHECK(distance(again, middle) < 1e-9);
  }
}

TEST_CASE("a quad holds what is between its sides, and is the same quad in any turn") {
  const Quad quad{PixelPoint{10, 10}, {60, 14}, {58, 40}, {8, 42}};
  CHECK(contains(quad, centre_of(quad)));
  CHECK(contains(quad, quad[1]));
  CHECK_FALSE(contains(quad, {60, 41}));
  CHECK_FALSE(contains(quad, {30, 10}));
  for (std::size_t turn = 0; turn < 4; ++turn) {
    Quad turned = quad;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(turn), turned.end());
    turned[0].x += 0.5;
    CHECK(nearly_equal(quad, turned, 0.6));
    CHECK_FALSE(nearly_equal(quad, turned, 0.4));
  }
}

TEST_CASE("a quad that turns back, or runs the other way round, is not convex") {
  const Quad quad{PixelPoint{10, 10}, {60, 14}, {58, 40}, {8, 42}};
  CHECK(is_convex(quad));
  CHECK_FALSE(is_convex(Quad{quad[3], quad[2], quad[1], quad[0]}));
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(i);
    Quad dented = quad;
    dented[i] = 0.6 * quad[(i + 2) % 4] + 0.4 * quad[i];
    CHECK_FALSE(is_convex(dented));
  }
}

TEST_CASE("the quad around a rounded hull keeps its four sides, and begins at its upper left") {
  const std::vector<PixelPoint> points{{12, 10}, {90, 12}, {99, 20}, {98, 60},
                                       {90, 69}, {15, 70}, {10, 64}, {10, 15}};
  const auto quad = enclosing_quad(convex_hull(points));
  REQUIRE(quad.has_value());
  CHECK(is_convex(*quad));
  for (const PixelPoint expected : {PixelPoint{10, 10}, PixelPoint{99, 12}, PixelPoint{98, 70}}) {
    const bool near = std::ranges::any_of(
        *quad, [&](const PixelPoint& corner) { return distance(corner, expected) < 3; });
    CHECK(near);
  }
  CHECK(distance((*quad)[0], {10, 10}) < 3);
  CHECK(distance((*quad)[1], {99, 12}) < 3);
}

TEST_CASE("the white inside of a frame is one region apart from the plate around it") {
  const GrayImage image = draw_frame(50, 40, 150, 90, 5);
  const auto regions = find_regions(image.view());
  const auto inside = std::ranges::find_if(regions, [](const Region& region) {
    return region.white && region.left >= 48 && region.right <= 152 && region.top >= 38;
  });
  REQUIRE(inside != regions.end());
  CHECK(inside->right - inside->left == doctest::Approx(100).epsilon(0.03));
  CHECK(inside->bottom - inside->top == doctest::Approx(50).epsilon(0.05));
  CHECK(inside->left > 0);
  CHECK(inside->top > 0);
  CHECK(inside->right < kWidth - 1);
  CHECK(inside->bottom < kHeight - 1);
}

TEST_CASE("an upright rectangle has the hull of its four corners, whatever stands beside it") {
  GrayImage image{96, 72, std::vector<std::uint8_t>(96 * 72, 230)};
  for (int y = 20; y < 50; ++y) {
    for (int x = 24; x < 70; ++x) image.samples[static_cast<std::size_t>(96 * y + x)] = 30;
  }
  const auto regions = find_regions(image.view());
  const auto dark = std::ranges::find(regions, false, &Region::white);
  REQUIRE(dark != regions.end());
  CHECK(dark->hull.size() == 4);
  CHECK(area_of(dark->hull) == (69 - 24) * (49 - 20));
}

TEST_CASE(
    "what is dark far to the right of a wide picture is where it is, and nothing else is dark") {
  constexpr int kColumns = 200, kRows = 80;
  GrayImage image{kColumns, kRows, std::vector<std::uint8_t>(kColumns * kRows, 230)};
  for (int y = 20; y < 50; ++y) {
    for (int x = 140; x < 180; ++x) {
      image.samples[static_cast<std::size_t>(kColumns * y + x)] = 30;
    }
  }
  const auto regions = find_regions(image.view());
  REQUIRE(std::ranges::count(regions, false, &Region::white) == 1);
  const auto dark = std::ranges::find(regions, false, &Region::white);
  CHECK(dark->left == 140);
  CHECK(dark->right == 179);
  CHECK(dark->top == 20);
  CHECK(dark->bottom == 49);
}

TEST_CASE("plain rows below a dark band belong to the white under it, not to that above it") {
  constexpr int kColumns = 80, kRows = 120;
  GrayImage image{kColumns, kRows, std::vector<std::uint8_t>(kColumns * kRows, 230)};
  std::fill(image.samples.begin() + 20 * kColumns, image.samples.begin() + 28 * kColumns,
            std::uint8_t{30});
  const auto regions = find_regions(image.view());
  REQUIRE(regions.size() == 2);
  CHECK(regions[0].white);
  CHECK(regions[0].top == 0);
  CHECK(regions[0].bottom == 19);
  CHECK(regions[1].white);
  CHECK(regions[1].top == 28);
  CHECK(regions[1].bottom == kRows - 1);
}

TEST_CASE("the tiles of a picture reach to its last column and row and no farther") {
  for (const int size : {31, 32, 33, 39, 40}) {
    CAPTURE(size);
    const auto pixels = static_cast<std::size_t>(size * size);
    const GrayImage image{size, size, std::vector<std::uint8_t>(pixels, 128)};
    const TileExtremes extremes = tile_extremes(image.view());
    const int tiles = static_cast<int>(std::ceil(size / 8.0));
    CHECK(extremes.columns == tiles);
    CHECK(extremes.rows == tiles);
    CHECK(extremes.low == std::vector<std::uint8_t>(static_cast<std::size_t>(tiles * tiles), 128));
  }
}

TEST_CASE("noise that is alike in neighbouring pixels makes the sides of a sharpened frame vary") {
  // The stroke is so thick that its outer edge is not looked at, sharpened or not.
  const Quad corners{PixelPoint{50, 40}, {150, 40}, {150, 90}, {50, 90}};
  const GrayImage plain = draw_frame(50, 40, 150, 90, 14);
  std::mt19937 random(3);
  std::normal_distribution<double> draw(0, 12);
  std::vector<double> fine(plain.samples.size());
  for (double& level : fine) level = draw(random);
  // By how much the fit says that a side varies more when undone sharpening has left such noise.
  const auto factor_of = [&](int reach) {
    GrayImage image = plain;
    for (int y = reach; y < kHeight - reach; ++y) {
      for (int x = reach; x < kWidth - reach; ++x) {
        double sum = 0;
        for (int j = -reach; j <= reach; ++j) {
          for (int i = -reach; i <= reach; ++i) {
            sum += fine[static_cast<std::size_t>((y + j) * kWidth + x + i)];
          }
        }
        std::uint8_t& sample = image.samples[static_cast<std::size_t>(y * kWidth + x)];
        sample = static_cast<std::uint8_t>(
            std::clamp(std::lround(sample + sum / (2 * reach + 1)), 0L, 255L));
      }
    }
    const auto stored = refine_frame(image.view(), corners);
    const auto sharpened = refine_frame(image.view(), corners, {}, {}, true);
    REQUIRE(stored);
    REQUIRE(sharpened);
    double factor = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      factor += sharpened->sides[i].covariance.trace() / stored->sides[i].covariance.trace() / 4;
    }
    return factor;
  };
  const double of_fine = factor_of(0), of_coarse = factor_of(4);
  CHECK(of_fine >= 1);
  CHECK(of_fine < 1.3);
  CHECK(of_coarse > 1.3);
}

TEST_CASE("refined corners are exact to a fiftieth of a pixel whatever their fraction") {
  for (const double fraction : {0.0, 0.13, 0.25, 0.5, 0.77}) {
    for (const double stroke : {3.0, 6.4, 11.0}) {
      CAPTURE(fraction);
      CAPTURE(stroke);
      const double left = 50 + fraction, top = 40 + fraction / 2;
      const double right = 150 - fraction, bottom = 90 + fraction;
      const GrayImage image = draw_frame(left, top, right, bottom, stroke);
      const Quad rough{PixelPoint{left + 1.2, top - 0.7}, PixelPoint{right + 0.9, top + 0.8},
                       PixelPoint{right - 1.1, bottom - 1}, PixelPoint{left - 0.8, bottom + 0.9}};
      const auto settled = fit_frame_coarsely(image.view(), rough);
      REQUIRE(settled.has_value());
      const auto frame = refine_frame(image.view(), settled->corners);
      REQUIRE(frame.has_value());
      const Quad expected{PixelPoint{left, top}, PixelPoint{right, top}, PixelPoint{right, bottom},
                          PixelPoint{left, bottom}};
      for (std::size_t i = 0; i < 4; ++i) {
        CHECK(distance(frame->corners[i], expected[i]) < 0.02);
      }
    }
  }
}

TEST_CASE("sharp sides are found to a seventh of a pixel from several pixels away") {
  // Black and white of a scan along the pixels: the frame's inside has its corners between pixels.
  GrayImage image{1200, 800, {}};
  const Quad corners{PixelPoint{199.5, 199.5}, {999.5, 199.5}, {999.5, 599.5}, {199.5, 599.5}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto within = [&](int grow) {
        return x >= 200 - grow && x < 1000 + grow && y >= 200 - grow && y < 600 + grow;
      };
      image.samples.push_back(within(30) && !within(0) ? 0 : 255);
    }
  }
  const FrameShape shape{800, 400, 30};
  for (const double off : {-5.0, -2.0, 2.0, 5.0}) {
    CAPTURE(off);
    Quad settled = corners;
    settled[2].y += off;
    settled[3].y += off;
    const auto frame = refine_frame(image.view(), settled, {}, shape);
    REQUIRE(frame.has_value());
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(distance(frame->corners[i], corners[i]) < 0.15);
    }
  }
}

TEST_CASE("no frame, no corners") {
  GrayImage flat{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 128)};
  const Quad rough{PixelPoint{50, 40}, PixelPoint{150, 40}, PixelPoint{150, 90},
                   PixelPoint{50, 90}};
  CHECK_FALSE(looks_framed(flat.view(), rough));
  CHECK_FALSE(fit_frame_coarsely(flat.view(), rough).has_value());
}
