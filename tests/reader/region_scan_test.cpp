// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/region_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::SeenTag;

namespace {

SeenTag slanted_bars(double turn = 0) {
  SeenTag tag;
  tag.framed = false;
  tag.width = 460;
  tag.height = 200;
  tag.view = {{230, 100}, 2.5, turn, {0.001, 0.001}};
  return tag;
}

// A picture of a symbol with its light and the lines across its bars.
struct Lines {
  explicit Lines(const SeenTag& tag)
      : seen(tag), image(tag.image()), light(image.view()), region(tag.region()) {}

  std::optional<FirstLine> first(Wanted wanted = Wanted::digits) {
    return first_line(light, region, wanted);
  }

  RegionScan scan(Wanted wanted = Wanted::digits) {
    auto line = first(wanted);
    REQUIRE(line);
    return scan_region(light, region, *std::move(line), wanted);
  }

  SeenTag seen;
  GrayImage image;
  SampledLight light;
  BarRegion region;
};

// How far a line's boundaries lie from where the plane has them, modules at most.
double farthest_off(const Lines& lines, const LineFrame& frame, const ReadLine& line) {
  double worst = 0;
  for (std::size_t i = 0; i < kBoundaryModules.size(); ++i) {
    const PixelPoint at = frame.pixel(line.reading.alignment.boundaries[i], line.offset);
    worst = std::max(worst, std::abs(lines.seen.view.plane(at).x + 47.5 - kBoundaryModules[i]));
  }
  return worst;
}

}  // namespace

TEST_CASE("boundaries are where guards and digits begin") {
  for (int digit = 0; digit < 12; ++digit) {
    const auto at = static_cast<std::size_t>(digit < 6 ? 1 + digit : 2 + digit);
    CHECK(kBoundaryModules[at] == first_module_of_digit(digit));
  }
  CHECK(kBoundaryModules.back() == kModuleCount);
  ElasticAlignment alignment;
  for (std::size_t i = 0; i < 16; ++i) alignment.boundaries[i] = 40 - 0.4 * kBoundaryModules[i];
  CHECK(place_of(alignment).begin == doctest::Approx(40));
  CHECK(place_of(alignment).module == doctest::Approx(-0.4));
}

TEST_CASE("the first line reads the symbol, in whichever direction it runs") {
  for (const double turn : {0.0, 0.2, std::numbers::pi}) {
    CAPTURE(turn);
    Lines lines(slanted_bars(turn));
    if (turn > 3) {  // seen from the other end
      lines.region.across = -1 * lines.region.across;
    }
    const auto first = lines.first();
    REQUIRE(first);
    CHECK(first->line.reading.digits == lines.seen.digits);
    CHECK((place_of(first->line.reading.alignment).module < 0) == (turn > 3));
    CHECK(farthest_off(lines, first->frame, first->line) < 0.3);
    CHECK(std::abs(first->line.offset) <= lines.region.height / 4);
  }
}

TEST_CASE("the first line is one that is not covered") {
  SeenTag tag = slanted_bars();
  const double middle = (tag.bars_top + tag.bars_bottom) / 2;
  const double height = tag.bars_bottom - tag.bars_top;
  tag.covers = {{-60, middle - 0.4 * height, 60, middle + 0.1 * height, 0.4}};
  Lines lines(tag);
  const auto first = lines.first();
  REQUIRE(first);
  CHECK(first->line.offset > 0.1 * lines.region.height);
  CHECK(first->line.reading.digits == tag.digits);
}

TEST_CASE("the first line reads symbols whose modules are twice as wide at one end") {
  for (const double slant : {-0.004, -0.003, -0.002, -0.001, 0.0, 0.001, 0.002, 0.003, 0.004}) {
    CAPTURE(slant);
    SeenTag tag = slanted_bars();
    tag.view.slant = {slant, 0.001};
    Lines lines(tag);
    const auto first = lines.first();
    REQUIRE(first);
    CHECK(first->line.reading.digits == tag.digits);
    CHECK(farthest_off(lines, first->frame, first->line) < 0.35);
    CHECK((first->frame.foreshortening == 0) == (std::abs(slant) < 0.0015));
  }
}

TEST_CASE("what is no symbol, or not of the region's size, has no first line") {
  SeenTag tag = slanted_bars();
  tag.covers = {{-60, -40, 60, 40, 0.4}};
  CHECK(!Lines(tag).first());
  tag = slanted_bars();
  tag.covers = {{-60, -40, -6, 40, 0.4}, {6, -40, 60, 40, 0.4}};
  CHECK(!Lines(tag).first());
  Lines lines(slanted_bars());
  lines.region.length *= 3;
  CHECK(!lines.first());
}

TEST_CASE("lines are read over the whole height of the bars, each where it lies") {
  Lines lines(slanted_bars(0.1));
  const RegionScan scan = lines.scan();
  CHECK(scan.spacing == doctest::Approx(lines.region.height / 10));
  REQUIRE(scan.lines.size() >= 9);
  CHECK(scan.lines.size() <= 12);
  double last = scan.lines.front().offset - scan.spacing;
  for (const ReadLine& line : scan.lines) {
    CAPTURE(line.offset);
    CHECK(line.offset == doctest::Approx(last + scan.spacing));
    last = line.offset;
    CHECK(line.reading.digits == lines.seen.digits);
    CHECK(farthest_off(lines, scan.frame, line) < 0.35);
  }
  CHECK(scan.lines.front().offset < -0.4 * lines.region.height);
  CHECK(scan.lines.back().offset > 0.4 * lines.region.height);
}

TEST_CASE("lines follow bars that lean by more than one line could be off") {
  Lines lines(slanted_bars(0.1));
  auto first = lines.first();
  REQUIRE(first);
  first->frame.along = {std::sin(0.35), std::cos(0.35)};
  first->line.offset = 0;
  first->line.light = light_along(lines.light, first->frame, 0, lines.region.height / 8);
  const RegionScan scan = scan_region(lines.light, lines.region, *first, Wanted::digits);
  // From end to end the symbol moves along the lines by so many modules.
  const double moved = std::tan(0.45) * lines.region.height / 2.5;
  CHECK(moved > 15);
  REQUIRE(scan.lines.size() >= 9);
  for (const ReadLine& line : scan.lines) CHECK(farthest_off(lines, scan.frame, line) < 1.2);
}

TEST_CASE("a line that reads much worse than most is left out") {
  SeenTag tag = slanted_bars();
  const double middle = (tag.bars_top + tag.bars_bottom) / 2;
  tag.covers = {{-26, middle + 7, -2, middle + 12, tag.black}};
  Lines lines(tag);
  const double covered = 2.5 * 9.5;
  for (const ReadLine& line : lines.scan(Wanted::alignment).lines) {
    CAPTURE(line.reading.alignment.cost_per_module);
    CHECK(std::abs(line.offset - covered) > 4);
  }
}

TEST_CASE("lines in dirt are left out, and those beyond it are read") {
  SeenTag tag = slanted_bars();
  const double middle = (tag.bars_top + tag.bars_bottom) / 2;
  tag.covers = {{-60, middle - 12, 10, middle - 6, 0.4}};
  Lines lines(tag);
  const RegionScan scan = lines.scan(Wanted::alignment);
  const double covered = 2.5 * -9;  // pixels from the middle
  bool beyond = false;
  for (const ReadLine& line : scan.lines) {
    CAPTURE(line.offset);
    CHECK(std::abs(line.offset - covered) > 4);
    CHECK(farthest_off(lines, scan.frame, line) < 0.5);
    beyond = beyond || line.offset < covered - 8;
  }
  CHECK(beyond);
}

TEST_CASE("the look of the bars is the one that suits them") {
  for (const double growth : {-0.3, 0.0, 0.3}) {
    CAPTURE(growth);
    SeenTag tag = slanted_bars();
    tag.growth = growth;
    tag.blur_px = 1.25;  // half of a module
    Lines lines(tag);
    const RegionScan scan = lines.scan(Wanted::alignment);
    REQUIRE(scan.look != nullptr);
    CHECK(scan.look->bars.growth == growth);
  }
}
