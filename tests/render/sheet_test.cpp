// SPDX-License-Identifier: Apache-2.0
// Sketches at a scale on sheets, and the sheets as files.
#include <algorithm>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/png.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/svg.hpp"
#include "tests/render/raster.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;
using Eigen::Vector2d;

namespace {

// A square of 5 m with a dimension and a word.
DrawingView square_view() {
  DrawingView view;
  view.title = "Square";
  view.sketch.layer("outline").add(Polyline{
      {Vector2d(0, 0), Vector2d(5, 0), Vector2d(5, 5), Vector2d(0, 5)}, {.width = kWide}, true});
  view.sketch.layer("dimensions")
      .add(Dimension{.from = Vector2d(0, 0), .to = Vector2d(5, 0), .offset = -0.008, .text = "5"});
  view.sketch.layer("words").add(Words{.text = "a < b", .at = Vector2d(2.5, 2.5), .angle = 0.5});
  return view;
}

std::vector<Sheet> sheets_of(const std::vector<DrawingView>& views,
                             const DrawingStyle& style = {}) {
  return lay_out_sheets({"Title", "Subject", {{"Survey", "s.yaml"}}}, views, style).value();
}

const SheetLayer& layer_named(const Sheet& sheet, std::string_view name) {
  const auto found = std::ranges::find(sheet.layers, name, &SheetLayer::name);
  REQUIRE(found != sheet.layers.end());
  return *found;
}

std::vector<std::string> texts_of(const Sheet& sheet) {
  std::vector<std::string> texts;
  for (const SheetLayer& layer : sheet.layers) {
    for (const SheetItem& item : layer.items) {
      if (const auto* text = std::get_if<SheetText>(&item)) texts.push_back(text->text);
    }
  }
  return texts;
}

bool says(const Sheet& sheet, const std::string& text) {
  return std::ranges::count(texts_of(sheet), text) > 0;
}

// Middles of the left and right sides of the square, in mm, just above its lower side.
std::vector<double> sides_mm(const Raster& raster, const Sheet& sheet) {
  const auto& square = std::get<SheetLine>(layer_named(sheet, "outline").items.front()).points;
  const Rectangle strip{square[0].x() - 0.004, square[0].y() - 0.006,
                        square[1].x() - square[0].x() + 0.008, 0.003};
  return lines_mm(profile_of(raster, strip, false));
}

}  // namespace

TEST_CASE("scales are round, and the next coarser one is taken") {
  struct Row {
    double asked;
    double expected;
    const char* text;
  };
  for (const Row& row :
       {Row{1, 1, "1 : 1"}, Row{1.2, 2, "1 : 2"}, Row{2.1, 5, "1 : 5"}, Row{11, 20, "1 : 20"},
        Row{21, 25, "1 : 25"}, Row{26, 50, "1 : 50"}, Row{100, 100, "1 : 100"},
        Row{201, 250, "1 : 250"}, Row{999, 1000, "1 : 1000"}, Row{0.3, 0.5, "2 : 1"}}) {
    CAPTURE(row.asked);
    CHECK(round_scale(row.asked) == Approx(row.expected));
    CHECK(scale_text(round_scale(row.asked)) == row.text);
  }
}

TEST_CASE("lengths are true to the scale that the title block says, in PDF and SVG") {
  const std::vector<Sheet> sheets = sheets_of({square_view()}, {.paper = Paper::a4});
  REQUIRE(sheets.size() == 1);
  REQUIRE(says(sheets[0], "1 : 50"));
  const double dpi = 200;
  for (const Raster& raster : {rasterize_pdf(render_pdf(sheets).value(), dpi),
                               rasterize_svg(render_svg(sheets[0]), dpi)}) {
    CHECK(raster.image.width / raster.pixels_per_mm == Approx(297).epsilon(0.001));
    const std::vector<double> sides = sides_mm(raster, sheets[0]);
    REQUIRE(sides.size() == 2);
    CHECK(sides[1] - sides[0] == Approx(100).epsilon(0.001));
  }
}

TEST_CASE("a dashed line has its gaps in PDF and SVG") {
  DrawingView view;
  view.scale = 1;
  view.sketch.layer("dashes").add(
      Polyline{{Vector2d(0, 0), Vector2d(0.039, 0)}, {.width = kWide, .dashes = dashed()}});
  const std::vector<Sheet> sheets = sheets_of({view});
  const auto& line = std::get<SheetLine>(layer_named(sheets[0], "dashes").items.front()).points;
  const Rectangle strip{line[0].x() - 0.001, line[0].y() - 1e-4, 0.041, 2e-4};
  for (const Raster& raster : {rasterize_pdf(render_pdf(sheets).value(), 300),
                               rasterize_svg(render_svg(sheets[0]), 300)}) {
    CHECK(lines_mm(profile_of(raster, strip, false)).size() == 10);
  }
}

TEST_CASE("the same sheets give the same bytes, the formats their own files") {
  const std::vector<Sheet> one = sheets_of({square_view()});
  const std::vector<Sheet> two{one[0], one[0]};
  for (const char* name : {"out/d.pdf", "out/d.svg", "out/d.PNG"}) {
    CAPTURE(name);
    const auto first = render_sheets(two, name).value();
    const auto second = render_sheets(two, name).value();
    REQUIRE(first.size() == second.size());
    for (std::size_t i = 0; i < first.size(); ++i) CHECK(first[i].bytes == second[i].bytes);
    CHECK(first[0].bytes.size() > 1000);
  }
  CHECK(render_sheets(two, "out/d.pdf").value().size() == 1);
  CHECK(render_sheets(two, "out/d.svg").value()[1].path == "out/d-2.svg");
  CHECK(render_sheets(one, "out/d.png").value()[0].path == "out/d.png");
  CHECK(render_sheets(one, "out/d.png").value()[0].bytes.substr(1, 3) == "PNG");
  CHECK_FALSE(render_sheets(one, "out/d.dwg"));
  CHECK_FALSE(render_sheets(one, "out/d"));
  CHECK_FALSE(render_sheets({}, "out/d.svg"));
  CHECK_FALSE(render_pdf({}));
}

TEST_CASE("an SVG has the layers as groups and its words escaped") {
  const std::string svg = render_svg(sheets_of({square_view()})[0]);
  CHECK(svg.find("<g id=\"outline\">") != std::string::npos);
  CHECK(svg.find("<title>a &lt; b</title>") != std::string::npos);
}

TEST_CASE("views that do not fit one sheet at the coarsest scale go on to more sheets") {
  const std::vector<DrawingView> views(40, square_view());
  CHECK(sheets_of(views).size() == 1);
  const std::vector<Sheet> sheets = sheets_of(views, {.coarsest_scale = 50});
  CHECK(sheets.size() > 3);
  CHECK(says(sheets[0], "1 : 50"));
  CHECK(says(sheets[0], "1 of " + std::to_string(sheets.size())));
  std::size_t count = 0;
  for (const Sheet& sheet : sheets) count += layer_named(sheet, "outline").items.size();
  CHECK(count == 40);
}

TEST_CASE("everything stays inside the drawing border") {
  for (const Paper paper : {Paper::a4, Paper::a3}) {
    for (const Sheet& sheet : sheets_of(std::vector<DrawingView>(7, square_view()), {paper, 50})) {
      for (const SheetLayer& layer : sheet.layers) {
        for (const SheetItem& item : layer.items) {
          const auto* line = std::get_if<SheetLine>(&item);
          for (const Vector2d& point : line != nullptr ? line->points : std::vector<Vector2d>{}) {
            CHECK(point.x() >= 0.02 - 1e-9);
            CHECK(point.y() >= 0.01 - 1e-9);
            CHECK(point.x() <= sheet.width - 0.01 + 1e-9);
            CHECK(point.y() <= sheet.height - 0.01 + 1e-9);
          }
        }
      }
    }
  }
}

TEST_CASE("a dimension without room has its arrows outside and its text beyond") {
  DrawingView view = square_view();
  view.sketch.layer("short").add(
      Dimension{.from = Vector2d(0, 5), .to = Vector2d(0.1, 5), .offset = 0.005, .text = "0.100"});
  const Sheet sheet = sheets_of({view}, {.paper = Paper::a4})[0];
  const auto& square = std::get<SheetLine>(layer_named(sheet, "outline").items.front()).points;
  for (const SheetItem& item : layer_named(sheet, "short").items) {
    const auto* text = std::get_if<SheetText>(&item);
    if (text == nullptr) continue;
    CHECK(text->at.x() > square[0].x() + 0.1 / 50);
    CHECK(text->angle == Approx(0));
  }
}

TEST_CASE("a drawing of nothing, and of points that are nowhere, is refused") {
  CHECK_FALSE(lay_out_sheets({"t", "s"}, std::vector<DrawingView>{}));
  DrawingView view = square_view();
  view.sketch.layer("outline").add(Dot{Vector2d(0, std::nan("")), 0.001, {}});
  CHECK_FALSE(lay_out_sheets({"t", "s"}, std::vector{view}));
}

TEST_CASE("a sketch by itself is as large as its ink, with a margin") {
  Sketch sketch;
  const Eigen::Vector2d from(-0.010, -0.020), to(0.030, 0.005);
  sketch.layer("a").add(
      Area{{from, Eigen::Vector2d(to.x(), from.y()), to, Eigen::Vector2d(from.x(), to.y())}, {}});
  const Sheet sheet = picture_sheet(sketch, "areas");
  CHECK(sheet.title == "areas");
  CHECK(sheet.width == doctest::Approx(0.044));
  CHECK(sheet.height == doctest::Approx(0.029));
  REQUIRE(sheet.layers.size() == 1);
  const auto& area = std::get<SheetArea>(sheet.layers[0].items.at(0));
  CHECK(area.outlines.at(0).at(0).isApprox(Eigen::Vector2d(0.002, 0.027)));
  CHECK(picture_sheet({}, "").width == 0);
}

TEST_CASE("a picture stands in PNG as its pixels and in SVG as its JPEG") {
  DrawingView view;
  view.scale = 1;
  Picture picture;
  picture.width = 0.02;
  picture.height = 0.01;
  picture.columns = 8;
  picture.rows = 1;
  picture.samples = {0, 0, 0, 0, 255, 255, 255, 255};
  picture.jpeg = "jpeg";
  view.sketch.layer("pictures").add(picture);
  const std::vector<Sheet> sheets = sheets_of({view});
  const SheetLayer& layer = layer_named(sheets.front(), "pictures");
  REQUIRE(layer.items.size() == 1);
  const auto& placed = std::get<SheetPicture>(layer.items.front());
  const GrayImage page =
      decode_gray_image("sheet", render_png(sheets.front(), 254, PngColours::rgb).value()).value();
  const auto pixel = [&](double x, double y) {
    return page.view().at(static_cast<int>(1e4 * (placed.at.x() + x)),
                          static_cast<int>(1e4 * (placed.at.y() + y)));
  };
  CHECK(pixel(0.003, 0.005) < 40);
  CHECK(pixel(0.017, 0.005) > 215);
  const std::string svg = render_svg(sheets.front());
  CHECK(svg.find("href=\"data:image/jpeg;base64,anBlZw==\"") != std::string::npos);
}
