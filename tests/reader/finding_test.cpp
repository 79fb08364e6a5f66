// SPDX-License-Identifier: Apache-2.0
// Finding feature frames: the steps against plain implementations, and frames that are hard to see.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/tile_threshold.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;

namespace {

GrayImage noise(int width, int height, std::mt19937& random) {
  GrayImage image{width, height, {}};
  std::uniform_int_distribution<int> level(0, 255);
  for (int i = 0; i < width * height; ++i) {
    image.samples.push_back(static_cast<std::uint8_t>(level(random)));
  }
  return image;
}

// Black rectangles and white ones on top of each other, small enough that no tile is amid black
// alone.
GrayImage blocks(int width, int height, std::mt19937& random) {
  GrayImage image{width, height, {}};
  image.samples.assign(static_cast<std::size_t>(width * height), 255);
  const auto below = [&](int end) {
    return std::uniform_int_distribution<int>(0, end - 1)(random);
  };
  for (int k = 0; k < 90; ++k) {
    const int left = below(width), top = below(height);
    const int right = std::min(width, left + 1 + below(12));
    const int bottom = std::min(height, top + 1 + below(12));
    for (int y = top; y < bottom; ++y) {
      std::fill(image.samples.begin() + y * width + left, image.samples.begin() + y * width + right,
                static_cast<std::uint8_t>(k % 2 == 0 ? 0 : 255));
    }
  }
  return image;
}

bool is_dark(const DarkPixels& dark, int x, int y) {
  return (dark.row(y)[x / 64] >> (x % 64) & 1U) != 0;
}

// As tile_threshold.hpp says it, pixel by pixel.
bool is_dark_by_definition(const GrayImage& image, int x, int y, int min_contrast) {
  int low = 255;
  int high = 0;
  const int left = (x / kTile - 1) * kTile, top = (y / kTile - 1) * kTile;
  for (int v = std::max(top, 0); v < std::min(top + 3 * kTile, image.height); ++v) {
    for (int u = std::max(left, 0); u < std::min(left + 3 * kTile, image.width); ++u) {
      low = std::min<int>(low, image.view().at(u, v));
      high = std::max<int>(high, image.view().at(u, v));
    }
  }
  return high - low >= min_contrast && image.view().at(x, y) < (low + high + 1) / 2;
}

using Box = std::array<int, 5>;  // white, left, top, right, bottom

// The regions of a black and white image by flooding: dark ones that do not touch its border, white
// ones that do not touch all four sides of it.
std::set<Box> flooded_regions(const GrayImage& image) {
  std::set<Box> boxes;
  std::vector<bool> seen(image.samples.size());
  const auto index = [&](int x, int y) { return static_cast<std::size_t>(y * image.width + x); };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (seen[index(x, y)]) continue;
      const bool white = image.samples[index(x, y)] > 127;
      Box box{white ? 1 : 0, x, y, x, y};
      std::vector<std::pair<int, int>> queue{{x, y}};
      seen[index(x, y)] = true;
      while (!queue.empty()) {
        const auto [u, v] = queue.back();
        queue.pop_back();
        box = {box[0], std::min(box[1], u), std::min(box[2], v), std::max(box[3], u),
               std::max(box[4], v)};
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            const int a = u + dx, b = v + dy;
            if (a < 0 || b < 0 || a >= image.width || b >= image.height) continue;
            if (white && dx != 0 && dy != 0) continue;
            if (seen[index(a, b)] || (image.samples[index(a, b)] > 127) != white) continue;
            seen[index(a, b)] = true;
            queue.emplace_back(a, b);
          }
        }
      }
      const std::array<bool, 4> touched{box[1] == 0, box[2] == 0, box[3] + 1 == image.width,
                                        box[4] + 1 == image.height};
      if (std::ranges::count(touched, true) <= (white ? 3 : 0)) boxes.insert(box);
    }
  }
  return boxes;
}

const Digits kShownCode{0, 1, 9, 0, 0, 0, 0, 0, 0, 4, 0, 4};

// A tag in the middle of a picture, turned about its vertical by `incidence`.
struct Shot {
  Camera camera;
  ScenePlate plate;
  ViewOptions view;
};

Shot shot_of_tag(double module_px, double incidence_deg, double roll_deg = 5) {
  Shot shot;
  shot.camera.width = 640;
  shot.camera.height = 480;
  shot.camera.fx = shot.camera.fy = 1600;
  shot.camera.cx = 319.5;
  shot.camera.cy = 239.5;
  shot.plate.drawing = draw_tag(test::corridor_template(), kShownCode);
  const double incidence = radians(incidence_deg);
  const double distance =
      shot.camera.fx * shot.plate.drawing.module * std::cos(incidence) / module_px;
  shot.plate.camera_from_plate =
      camera_from_turned_plate(shot.camera, shot.plate.drawing, {319.5, 239.5}, distance, incidence,
                               radians(3.0), radians(roll_deg));
  shot.view.sensor.exposure = 0.85;
  shot.view.seed = 3;
  return shot;
}

View render(const Shot& shot) {
  return render_view(shot.camera, std::span(&shot.plate, 1), shot.view);
}

bool is_read(const View& view, const ReadOptions& options = {}) {
  const ReadResult result = read_tags(view.image.view(), options);
  return result.tags.size() == 1 && result.tags.front().digits == kShownCode;
}

}  // namespace

TEST_CASE("an image at half its size is the mean of four pixels, whatever its width") {
  std::mt19937 random(3);
  for (const int width : {2, 3, 15, 16, 17, 33, 64, 131}) {
    CAPTURE(width);
    const GrayImage image = noise(width, 9, random);
    const GrayImage half = half_size(image.view());
    REQUIRE(half.width == width / 2);
    REQUIRE(half.height == 4);
    for (int y = 0; y < half.height; ++y) {
      for (int x = 0; x < half.width; ++x) {
        const GrayView v = image.view();
        const int sum = v.at(2 * x, 2 * y) + v.at(2 * x + 1, 2 * y) + v.at(2 * x, 2 * y + 1) +
                        v.at(2 * x + 1, 2 * y + 1);
        REQUIRE(half.view().at(x, y) == (sum + 2) / 4);
      }
    }
  }
}

TEST_CASE("dark pixels are those below the middle of the tiles around, whatever the image's size") {
  std::mt19937 random(5);
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 9}, {64, 16}, {77, 20}, {130, 33}}) {
    CAPTURE(width);
    GrayImage image = noise(width, height, random);
    // A calm part, so that the contrast matters.
    for (int y = 0; y < height; ++y) {
      for (int x = width / 2; x < width; ++x) {
        std::uint8_t& sample = image.samples[static_cast<std::size_t>(y * width + x)];
        sample = static_cast<std::uint8_t>(100 + sample / 16);
      }
    }
    const DarkPixels dark = mark_dark(
        image.view(), tile_thresholds(tile_extremes(image.view()), 20), image.samples.size());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        REQUIRE(is_dark(dark, x, y) == is_dark_by_definition(image, x, y, 20));
      }
    }
  }
}

TEST_CASE("a picture full of noise keeps about as many changes of colour as are allowed") {
  std::mt19937 random(7);
  GrayImage image = noise(320, 240, random);
  for (std::size_t i = 0; i < image.samples.size(); ++i) {  // contrast grows to the right
    image.samples[i] = static_cast<std::uint8_t>(image.samples[i] * (i % 320) / 320);
  }
  const DarkPixels dark =
      mark_dark(image.view(), tile_thresholds(tile_extremes(image.view()), 20), 5000);
  int changes = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 1; x < image.width; ++x) {
      changes += is_dark(dark, x, y) != is_dark(dark, x - 1, y) ? 1 : 0;
    }
  }
  CHECK(changes > 2000);
  CHECK(changes < 6000);
  CHECK_FALSE(is_dark(dark, 40, 120));
}

TEST_CASE("regions are those that flooding finds") {
  std::mt19937 random(11);
  for (int i = 0; i < 40; ++i) {
    const GrayImage image = blocks(100 + i, 80 + i / 2, random);
    RegionOptions options;
    options.min_width = options.min_height = 1;
    std::set<Box> found;
    for (const Region& region : find_regions(image.view(), options)) {
      found.insert({region.white ? 1 : 0, region.left, region.top, region.right, region.bottom});
      for (const PixelPoint& point : region.hull) {
        REQUIRE(point.x >= region.left);
        REQUIRE(point.x <= region.right);
        REQUIRE(point.y >= region.top);
        REQUIRE(point.y <= region.bottom);
      }
    }
    CAPTURE(i);
    CHECK(found == flooded_regions(image));
  }
}

TEST_CASE(
    "a tile's texture is the sum of differences to its neighbours, whatever the image's size") {
  std::mt19937 random(17);
  for (const auto& [width, height] : {std::pair{7, 9}, {8, 8}, {16, 16}, {48, 24}, {77, 20}}) {
    CAPTURE(width);
    const GrayImage image = noise(width, height, random);
    const GrayView view = image.view();
    const TextureGrid grid = texture_of(view);
    REQUIRE(grid.columns == (width + kTile - 1) / kTile);
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        Texture sum;
        const bool whole = (column + 1) * kTile <= width && (row + 1) * kTile <= height;
        for (int y = row * kTile; whole && y < (row + 1) * kTile; y += 2) {
          for (int x = column * kTile; x < std::min((column + 1) * kTile, width - 1); ++x) {
            const auto add = [&](std::uint16_t& to, std::uint8_t a, std::uint8_t b) {
              to = static_cast<std::uint16_t>(to + std::abs(a - b));
            };
            add(sum.right, view.at(x, y), view.at(x + 1, y));
            add(sum.down, view.at(x, y), view.at(x, y + 1));
            add(sum.falling, view.at(x, y), view.at(x + 1, y + 1));
            add(sum.rising, view.at(x + 1, y), view.at(x, y + 1));
          }
        }
        const Texture& found = grid.tiles[static_cast<std::size_t>(row * grid.columns + column)];
        CHECK(std::array{found.right, found.down, found.falling, found.rising} ==
              std::array{sum.right, sum.down, sum.falling, sum.rising});
      }
    }
  }
}

TEST_CASE("a gradient's direction is told from differences in four directions") {
  for (int angle_deg = 0; angle_deg < 360; angle_deg += 5) {
    CAPTURE(angle_deg);
    const double angle = radians(angle_deg);
    GrayImage ramp{32, 32, {}};
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        const double level = 128 + 2.8 * ((x - 16) * std::cos(angle) + (y - 16) * std::sin(angle));
        ramp.samples.push_back(static_cast<std::uint8_t>(std::lround(level)));
      }
    }
    const Gradient gradient = gradient_of(texture_of(ramp.view()).tiles[5]);
    const double off =
        std::remainder(std::atan2(gradient.sin2, gradient.cos2) - 2 * angle, 2 * std::acos(-1.0));
    CHECK(std::abs(off) < radians(12));
    CHECK(is_directed(gradient, 60));
  }
}

TEST_CASE("the tiles near bars hold the whole frame of small tags, and no walls") {
  for (const double module_px : {0.5, 1.0, 2.0}) {
    for (const double roll_deg : {0.0, 20.0, 45.0, 110.0}) {
      CAPTURE(module_px);
      CAPTURE(roll_deg);
      const View view = render(shot_of_tag(module_px, 20, roll_deg));
      const TileMask mask = tiles_near_bars(texture_of(view.image.view()));
      for (const auto& corner : view.plates.front().corners) {
        const int column = static_cast<int>(corner->x() / kTile);
        const int row = static_cast<int>(corner->y() / kTile);
        CHECK(mask.tiles.at(static_cast<std::size_t>(row * mask.columns + column)) == 1);
      }
    }
  }
  std::mt19937 random(19);
  const GrayImage wall = noise(640, 480, random);
  const TileMask mask = tiles_near_bars(texture_of(wall.view()));
  CHECK(std::ranges::count(mask.tiles, 1) < static_cast<std::ptrdiff_t>(mask.tiles.size() / 50));
}

TEST_CASE("bars that are known have no tiles near them") {
  const View view = render(shot_of_tag(1, 10));
  const TextureGrid texture = texture_of(view.image.view());
  REQUIRE(std::ranges::count(tiles_near_bars(texture).tiles, 1) > 0);
  const std::vector<Quad> all{{PixelPoint{0, 0}, {640, 0}, {640, 480}, {0, 480}}};
  CHECK(std::ranges::count(tiles_near_bars(texture, all).tiles, 1) == 0);
}

TEST_CASE("the tiles of a row in a quadrilateral are those whose centres it holds") {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> off(-20, 20);
  for (int i = 0; i < 50; ++i) {
    const auto corner = [&](double x, double y) {
      return PixelPoint{x + off(random), y + off(random)};
    };
    const Quad quad{corner(40, 40), corner(160, 40), corner(160, 120), corner(40, 120)};
    for (int row = 0; row < 20; ++row) {
      const auto [begin, end] = tiles_in_row(quad, row, 18);
      for (int column = 0; column < 18; ++column) {
        const PixelPoint centre{kTile * (column + 0.5), kTile * (row + 0.5)};
        bool inside = true;
        for (std::size_t k = 0; k < 4; ++k) {
          inside = inside && cross(quad[(k + 1) % 4] - quad[k], centre - quad[k]) > 0;
        }
        CHECK((column >= begin && column < end) == inside);
      }
    }
  }
}

TEST_CASE("the parts of a level outside the searched tiles show no regions") {
  const View view = render(shot_of_tag(2, 10));
  const PyramidLevel level{view.image.view(), 1, 20};
  TileMask mask = tiles_near_bars(texture_of(view.image.view()));
  CandidateOptions options;
  options.searched = &mask;
  CHECK_FALSE(find_candidates(level, options).empty());
  std::ranges::fill(mask.tiles, std::uint8_t{0});
  CHECK(find_candidates(level, options).empty());
}

TEST_CASE("most gradients in a quadrilateral point across its bars, whatever is around them") {
  for (const double angle : {0.0, 0.3, 1.2, -0.8}) {
    CAPTURE(angle);
    const PixelPoint across{std::cos(angle), std::sin(angle)};
    GrayImage image{240, 240, {}};
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const PixelPoint at{x - 120.0, y - 120.0};
        const bool inside = std::abs(at.x) < 70 && std::abs(at.y) < 70;
        const double place = inside ? dot(at, across) : at.x + at.y;
        image.samples.push_back(static_cast<std::uint8_t>(130 + 80 * std::sin(place)));
      }
    }
    const Quad quad{{{60, 60}, {180, 60}, {180, 180}, {60, 180}}};
    const PixelPoint found = main_gradient(image.view(), quad);
    CHECK(std::abs(dot(found, across)) > 0.99);
  }
}

TEST_CASE("bars at the border of a picture run off it") {
  const GrayView image{nullptr, 640, 480, 640};
  const BarRegion whole{{320, 240}, {1, 0}, 400, 120};
  CHECK_FALSE(runs_off(image, whole));
  BarRegion cut = whole;
  cut.centre.x = 435;
  CHECK(runs_off(image, cut));
  BarRegion long_bars = whole;  // along the bars only their ends are lost
  long_bars.height = 480;
  CHECK_FALSE(runs_off(image, long_bars));
}

TEST_CASE("known parts of a picture show no regions") {
  const View view = render(shot_of_tag(2, 10));
  const PyramidLevel level{view.image.view(), 1, 20};
  REQUIRE_FALSE(find_candidates(level).empty());
  CandidateOptions options;
  options.known = {{PixelPoint{0, 0}, {640, 0}, {640, 480}, {0, 480}}};
  CHECK(find_candidates(level, options).empty());
}

TEST_CASE("the frame is found around its bars when it does not show as one piece") {
  Shot shot = shot_of_tag(2.5, 20);
  // A board of the plate's colour before the whole plate, across the bars.
  shot.plate.finish.cover = {{-0.1, 0.1, 0.6, 0.02}, 0.8};
  const View view = render(shot);
  const GrayView image = view.image.view();
  // As the reader looks for them, in the image at half its size.
  const GrayImage half = half_size(image);
  const std::vector<BarRegion> found = find_bar_regions(texture_of(half.view()));
  const auto around = [&](const BarRegion& region) {
    const auto quad = frame_around(image, scaled(region, 2));
    if (!quad) return false;
    double farthest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& corner = view.plates.front().corners[i];
      farthest = std::max(farthest, distance((*quad)[i], {corner->x(), corner->y()}));
    }
    return farthest < 4;
  };
  CHECK(std::ranges::any_of(found, around));
  CHECK(is_read(view));
}

TEST_CASE("tags are read at incidences that make the frame higher than wide") {
  ReadOptions options;
  options.check = CheckDigit::sum10;
  for (const double incidence_deg : {0.0, 50.0, 70.0, 76.0}) {
    CAPTURE(incidence_deg);
    CHECK(is_read(render(shot_of_tag(1.0, incidence_deg)), options));
  }
}

TEST_CASE("a tag of another survey is refused by its digits") {
  const View view = render(shot_of_tag(1.2, 20));
  ReadOptions options;
  options.code_book = {*parse_digits("019000800408"), *parse_digits("000001140406")};
  const ReadResult result = read_tags(view.image.view(), options);
  CHECK(result.tags.empty());
  REQUIRE(result.rejected.size() == 1);
  CHECK(result.rejected.front().reason == RejectionReason::stranger);
  CHECK(describe(result.rejected.front()) ==
        "the digits " + to_string(kShownCode) + " are in none of the given surveys");
}
