// SPDX-License-Identifier: Apache-2.0
// What stands on sheets beside the tags: marks, windows, contours, resolutions.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/render/board_page.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/png.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/render/tiled_pages.hpp"
#include "tests/render/sample_survey.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

TagDrawing small_tag() { return draw_tag(small_template(), *parse_digits("019012340400")); }

std::vector<SheetLine> lines_of(const Sheet& sheet, const std::string& layer_name) {
  std::vector<SheetLine> lines;
  for (const SheetLayer& layer : sheet.layers) {
    if (layer.name != layer_name) continue;
    for (const SheetItem& item : layer.items) {
      if (const auto* line = std::get_if<SheetLine>(&item)) lines.push_back(*line);
    }
  }
  return lines;
}

std::size_t number_at(const std::string& bytes, std::size_t at) {
  std::size_t number = 0;
  for (std::size_t i = at; i < at + 4; ++i) {
    number = number << 8U | static_cast<unsigned char>(bytes[i]);
  }
  return number;
}

}  // namespace

TEST_CASE("a PNG says how many of its pixels a metre takes") {
  const Sheet sheet = sheet_of(lay_out_page("000L", small_tag(), {}));
  for (const double dpi : {100.0, 254.0}) {
    const std::string png = render_png(sheet, dpi, PngColours::grey).value();
    const std::size_t chunk = png.find("pHYs");
    REQUIRE(chunk != std::string::npos);
    CHECK(number_at(png, chunk + 4) == static_cast<std::size_t>(std::lround(dpi / 0.0254)));
    CHECK(number_at(png, chunk + 8) == static_cast<std::size_t>(std::lround(dpi / 0.0254)));
    CHECK(png[chunk + 12] == 1);  // ISO/IEC 15948, 11.3.5.3: the unit is the metre
    // IHDR
    CHECK(static_cast<double>(number_at(png, 16)) ==
          Approx(sheet.width * dpi / 0.0254).epsilon(0.01));
  }
}

TEST_CASE("the assembly sheet shows every tile's window, dashed") {
  const TagDrawing tag = small_tag();
  const TilePlan plan = plan_tiles(tag.plate, parse_print_paper("A4").value(), 0.010, 0).value();
  REQUIRE(plan.tiles() == 4);
  const Page assembly = lay_out_tiles("000L", tag, {"t", "s"}, plan).front();
  const auto dashed = std::ranges::count_if(assembly.lines, &PageLine::dashed);
  CHECK(dashed == 4 * plan.tiles());
  for (const char* address : {"A1", "A2", "B1", "B2"}) {
    CHECK(std::ranges::any_of(assembly.texts,
                              [&](const TextItem& item) { return item.text == address; }));
  }
  for (const SheetLine& line : lines_of(sheet_of(assembly), "marks")) {
    if (line.line.dashes.empty()) continue;
    // Strokes and gaps are seen as such: some millimetres at most.
    REQUIRE(line.line.dashes.size() == 2);
    CHECK(line.line.dashes[0] <= 0.004);
    CHECK(line.line.dashes[1] < line.line.dashes[0]);
  }
}

TEST_CASE("a plate with round corners is cut a radius away from each corner's centre") {
  TagDrawing tag = small_tag();
  tag.cut_contour = true;
  tag.corner_radius = 0.012;
  const Rectangle& plate = tag.plate;
  const Sheet sheet = sheet_of(lay_out_page("000L", tag, {}));
  const auto contours = lines_of(sheet, kCutContour);
  REQUIRE_FALSE(contours.empty());
  const auto& points = contours.front().points;
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const auto& point : points) {
    left = std::min(left, point.x()), right = std::max(right, point.x());
    top = std::min(top, point.y()), bottom = std::max(bottom, point.y());
  }
  CHECK(right - left == Approx(plate.width));
  CHECK(bottom - top == Approx(plate.height));
  int in_corners = 0;
  for (const auto& point : points) {
    const double x = std::min(point.x() - left, right - point.x());
    const double y = std::min(point.y() - top, bottom - point.y());
    CHECK(std::min(x, y) >= -1e-9);
    if (x > 0.012 || y > 0.012) continue;
    ++in_corners;
    CHECK(std::hypot(0.012 - x, 0.012 - y) == Approx(0.012).epsilon(1e-6));
  }
  CHECK(in_corners >= 16);
}

TEST_CASE("a board's notes stand on either side of its scale bar, inside the sheet") {
  const Board board = make_board({"trial", 0, 0.297, 0.21, board_room(0.297, 0.21)}).value();
  const Page page = lay_out_board(board, {"A4", "tagsmith 0", "trial.yaml", true});
  int left = 0, right = 0;
  for (const TextItem& item : page.texts) {
    if (!item.centred || item.y < page.height - 0.02) continue;
    CAPTURE(item.text);
    const double half = std::min(text_width(item.text, item.height), item.max_width) / 2;
    CHECK(item.x - half >= 0.005);
    CHECK(item.x + half <= page.width - 0.005);
    if (item.x + half < page.width / 2 - kScaleBarLength / 2) ++left;
    if (item.x - half > page.width / 2 + kScaleBarLength / 2) ++right;
  }
  CHECK(left >= 1);
  CHECK(right == left);
}
