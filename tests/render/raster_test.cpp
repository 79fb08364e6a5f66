// SPDX-License-Identifier: Apache-2.0
// The files as printers see them: rasterised by two independent programs and measured.
#include "tests/render/raster.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/svg.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tests/render/sample_survey.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

constexpr double kTolerance = 0.05;  // mm

struct Rendering {
  std::string name;
  Page page;
  Raster raster;
};

std::string pdf_of(const Page& page) {
  const Sheet sheet = sheet_of(page);
  return render_pdf(std::span(&sheet, 1)).value();
}

// Both templates in both formats. 300 dpi, half of it for the large plate to keep the test quick.
const std::vector<Rendering>& renderings() {
  static const std::vector<Rendering> all = [] {
    std::vector<Rendering> list;
    for (const TagTemplate& tag : {small_template(), large_template()}) {
      const double dpi = tag.plate_length > 0.5 ? 150 : 300;
      const Page page = sample_page(tag);
      list.push_back({tag.name + " PDF", page, rasterize_pdf(pdf_of(page), dpi)});
      list.push_back({tag.name + " SVG", page, rasterize_svg(render_svg(sheet_of(page)), dpi)});
    }
    return list;
  }();
  return all;
}

// A strip across all bars at their middle height, from the plate's left edge to its right one.
Rectangle strip_across_bars(const Page& page) {
  const Rectangle& plate = page.tags[0].drawing.plate;
  const Rectangle& bar = page.tags[0].drawing.bars.front();
  return {plate.x, bar.y + bar.height / 2, plate.width, 0.002};
}

std::vector<double> horizontal_edges_expected(const Page& page) {
  const TagDrawing& tag = page.tags[0].drawing;
  const auto& [left, top, width, height] = tag.frame_outer;
  std::vector<double> edges{left, tag.frame_inner.x};
  for (const Rectangle& bar : tag.bars) edges.insert(edges.end(), {bar.x, bar.x + bar.width});
  edges.insert(edges.end(), {tag.frame_inner.x + tag.frame_inner.width, left + width});
  for (double& edge : edges) edge *= 1000;
  return edges;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST_CASE("the raster has the page's size to 0.1 mm") {
  for (const Rendering& rendering : renderings()) {
    CAPTURE(rendering.name);
    const auto& [image, pixels_per_mm] = rendering.raster;
    const double pixel = 1 / pixels_per_mm;  // rasterisers round up to whole pixels
    CHECK(std::abs(image.width / pixels_per_mm - rendering.page.width * 1000) < pixel);
    CHECK(std::abs(image.height / pixels_per_mm - rendering.page.height * 1000) < pixel);
  }
}

TEST_CASE("every element edge and the frame's sides are within 0.05 mm of the drawing") {
  for (const Rendering& rendering : renderings()) {
    CAPTURE(rendering.name);
    const Profile profile = profile_of(rendering.raster, strip_across_bars(rendering.page), false);
    const std::vector<double> expected = horizontal_edges_expected(rendering.page);
    REQUIRE(expected.size() == 64);
    const double difference = largest_difference(edges_mm(profile), expected);
    MESSAGE(rendering.name << ": element edges within " << difference << " mm");
    CHECK(difference < kTolerance);
  }
}

TEST_CASE("the ends of every bar are within 0.05 mm of the drawing") {
  for (const Rendering& rendering : renderings()) {
    const TagDrawing& tag = rendering.page.tags[0].drawing;
    CAPTURE(rendering.name);
    for (const Rectangle& bar : tag.bars) {
      const Rectangle strip{bar.x + 0.0005, tag.frame_inner.y + 0.002, bar.width - 0.001,
                            tag.frame_inner.height - 0.004};
      const std::vector<double> expected{bar.y * 1000, (bar.y + bar.height) * 1000};
      const std::vector<double> found = edges_mm(profile_of(rendering.raster, strip, true));
      CHECK(largest_difference(found, expected) < kTolerance);
    }
  }
}

TEST_CASE("the feature frame's inner corners are within 0.05 mm of the drawing") {
  for (const Rendering& rendering : renderings()) {
    const auto& [left, top, width, height] = rendering.page.tags[0].drawing.frame_inner;
    const Rectangle& outer = rendering.page.tags[0].drawing.frame_outer;
    CAPTURE(rendering.name);
    // Sides beside each corner, inside the white between frame and bars.
    for (const double y : {top + 0.001, top + height - 0.003}) {
      const Profile profile =
          profile_of(rendering.raster, {outer.x - 0.005, y, outer.width + 0.01, 0.002}, false);
      const std::vector<double> expected{outer.x * 1000, left * 1000, (left + width) * 1000,
                                         (outer.x + outer.width) * 1000};
      CHECK(largest_difference(edges_mm(profile), expected) < kTolerance);
    }
    for (const double x : {left + 0.001, left + width - 0.003}) {
      const Profile profile =
          profile_of(rendering.raster, {x, outer.y - 0.005, 0.002, outer.height + 0.01}, true);
      const std::vector<double> expected{outer.y * 1000, top * 1000, (top + height) * 1000,
                                         (outer.y + outer.height) * 1000};
      CHECK(largest_difference(edges_mm(profile), expected) < kTolerance);
    }
  }
}

TEST_CASE("the feature frame is one black without seams") {
  for (const Rendering& rendering : renderings()) {
    const TagDrawing& tag = rendering.page.tags[0].drawing;
    CAPTURE(rendering.name);
    const Rectangle upper{tag.frame_outer.x + 0.001, tag.frame_outer.y + 0.001,
                          tag.frame_outer.width - 0.002,
                          tag.frame_inner.y - tag.frame_outer.y - 0.002};
    const Profile profile = profile_of(rendering.raster, upper, false);
    CHECK(*std::ranges::min_element(profile.darkness) > 1 - 1e-9);
  }
}

TEST_CASE("the scale bars measure 100 mm in both directions") {
  for (const Rendering& rendering : renderings()) {
    const Page& page = rendering.page;
    CAPTURE(rendering.name);
    // Beside the bars' lines, where only the end ticks cross.
    const Rectangle below{0.02, page.height - 0.007, page.width - 0.04, 0.0006};
    const std::vector<double> across = lines_mm(profile_of(rendering.raster, below, false));
    REQUIRE(across.size() == 2);
    CHECK(across[1] - across[0] == Approx(100).epsilon(0.001));
    const Rectangle beside{0.0064, 0.02, 0.0006, page.height - 0.04};
    const std::vector<double> along = lines_mm(profile_of(rendering.raster, beside, true));
    REQUIRE(along.size() == 2);
    CHECK(along[1] - along[0] == Approx(100).epsilon(0.001));
  }
}

TEST_CASE("the element widths in the raster are the tag's digits") {
  for (const Rendering& rendering : renderings()) {
    CAPTURE(rendering.name);
    std::vector<double> edges =
        edges_mm(profile_of(rendering.raster, strip_across_bars(rendering.page), false));
    REQUIRE(edges.size() == 64);
    edges = {edges.begin() + 2, edges.end() - 2};  // without the frame's
    const double module = (edges.back() - edges.front()) / kModuleCount;
    std::array<std::uint8_t, kElementCount> elements{};
    for (std::size_t i = 0; i < elements.size(); ++i) {
      elements[i] = static_cast<std::uint8_t>(std::lround((edges[i + 1] - edges[i]) / module));
    }
    CHECK(elements == elements_of(*parse_digits("019012340400")));
  }
}

TEST_CASE("an independent reader, zbar, reads the same digits") {
  REQUIRE_MESSAGE(has_program("zbarimg"), "zbarimg is missing: install zbar-tools");
  for (const Rendering& rendering : renderings()) {
    CAPTURE(rendering.name);
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "page.png").string();
    REQUIRE(save_gray_image(path, rendering.raster.image.view()));
    const ProgramOutput output = run_shell("zbarimg --quiet --raw '" + path + "'");
    CHECK(output.out == "0019012340400\n");  // as EAN-13: with a leading 0
  }
}

TEST_CASE("ink of the label keeps its distance from the frame and 3 mm from the plate's edge") {
  const std::string names[] = {
      "corridor",
      "\u1ea4\u1ec6\u1ed6\u1ef4 g\u0323j\u0323y",  // stacked accents above, dots below
      "Z\u030d\u030e\u0304\u0305\u033f\u0311\u0306\u0316\u0317\u0318\u0319\u031c\u031d\u031e",
      "\u7164\u77ff\u5df7\u9053\u7b2c\u4e09\u6c34\u5e73",
      std::string(400, 'W'),
  };
  for (const TagTemplate& tag : {small_template(), large_template()}) {
    for (const std::string& name : names) {
      CAPTURE(tag.name);
      CAPTURE(name);
      const Page page = sample_page(tag, name);
      const Raster raster = rasterize_pdf(pdf_of(page), 75);
      const double pixel = 0.0254 / 75;
      const Rectangle& frame = page.tags[0].drawing.frame_outer;
      CHECK(darkest_between(raster, grown(frame, pixel),
                            grown(frame, label_clearance(tag) - pixel)) == 0);
      const Rectangle inside = grown(page.tags[0].drawing.plate, -0.003);
      CHECK(darkest_between(raster, grown(inside, pixel), page.tags[0].drawing.plate) == 0);
      CHECK(darkest_between(raster, grown(frame, label_clearance(tag)), inside) > 0.9);
    }
  }
}
