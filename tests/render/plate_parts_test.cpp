// SPDX-License-Identifier: Apache-2.0
// Logos, QR symbols and labels in other words, as printed.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/render/logo.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/png.hpp"
#include "tagsmith/render/qr_symbol.hpp"
#include "tagsmith/render/svg.hpp"
#include "tests/render/sample_survey.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

std::filesystem::path written(const TemporaryFolder& folder, const std::string& svg) {
  const std::filesystem::path path = folder.path() / "logo.svg";
  std::ofstream(path) << svg;
  return path;
}

std::string picture(const std::string& view, const std::string& content) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"" + view + "\">" + content + "</svg>";
}

// Inside an odd number of outlines: clockwise and anticlockwise areas differ in sign.
double area_of(const LogoDrawing& logo) {
  double twice = 0;
  for (const auto& outline : logo.outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const PlatePoint& a = outline[i];
      const PlatePoint& b = outline[(i + 1) % outline.size()];
      twice += a.x * b.y - b.x * a.y;
    }
  }
  return std::abs(twice) / 2;
}

// The page of a plate of 0.4 x 0.32 m with a QR symbol of the content.
Page page_with_qr(const std::string& content, bool white_on_black) {
  TagTemplate tag = small_template();
  tag.plate_height = 0.32;
  tag.frame_offset_up = 0.02;
  tag.qr.size = 0.04;
  tag.white_on_black = white_on_black;
  const Survey survey = sample_survey(tag);
  const PlacedTag placed = sample_tag(survey, {1.9, 12.34, 0.4});
  TagDrawing drawing = draw_tag(tag, placed.digits, tag_text(survey, placed));
  drawing.qr = qr_symbol(content, drawing.qr.value().box).value();
  return lay_out_page(placed.name, drawing, page_notes(survey, placed));
}

std::string read_by_zbar(const std::filesystem::path& picture) {
  return run_shell("zbarimg --quiet --raw -Sdisable -Sqrcode.enable '" + picture.string() +
                   "' 2> /dev/null")
      .out;
}

}  // namespace

TEST_CASE("zbar reads the QR symbol of a plate of either kind, as PNG and as SVG") {
  REQUIRE_MESSAGE(has_program("zbarimg"), "zbarimg is missing: install zbar-tools");
  const TemporaryFolder folder;
  const std::string content = "https://mine.example/tags/019012340404";
  for (const bool white_on_black : {false, true}) {
    CAPTURE(white_on_black);
    const Sheet sheet = sheet_of(page_with_qr(content, white_on_black));
    const std::filesystem::path png = folder.path() / "page.png";
    std::ofstream(png, std::ios::binary) << render_png(sheet, 150, PngColours::grey).value();
    CHECK(read_by_zbar(png) == content + "\n");
    const std::filesystem::path svg = folder.path() / "page.svg";
    std::ofstream(svg) << render_svg(sheet);
    REQUIRE(run_shell("rsvg-convert -o '" + png.string() + "' '" + svg.string() + "'").exit_code ==
            0);
    CHECK(read_by_zbar(png) == content + "\n");
  }
}

TEST_CASE("a QR symbol of twelve digits has 21 modules and a quiet zone of four") {
  const Rectangle box{1, 2, 0.029, 0.029};
  const QrDrawing symbol = qr_symbol("019012340404", box).value();
  const Rectangle& corner = symbol.modules.front();  // the finder pattern's upper side, 7 modules
  CHECK(corner.x == Approx(1.004));
  CHECK(corner.y == Approx(2.004));
  CHECK(corner.width == Approx(0.007));
  CHECK(corner.height == Approx(0.001));
}

TEST_CASE("a QR symbol that phones cannot read is refused with the size that they can") {
  const Result<QrDrawing> symbol = qr_symbol("019012340404", {0, 0, 0.01, 0.01});
  REQUIRE_FALSE(symbol);
  CHECK(symbol.error().message.find("size_mm of 12 or more") != std::string::npos);
  CHECK(qr_symbol("019012340404", {0, 0, 0.012, 0.012}));
  CHECK_FALSE(qr_symbol(std::string(3000, 'a'), {0, 0, 1, 1}));
}

TEST_CASE("a logo's outlines are those of its dark areas, as large as the room allows") {
  const TemporaryFolder folder;
  // A ring of radii 40 and 20 in a picture of 200 x 100, a light area and a thin line beside it.
  const auto file =
      written(folder, picture("0 0 200 100",
                              "<circle cx='50' cy='50' r='40' fill='#203060'/>"
                              "<circle cx='50' cy='50' r='20' fill='#ffff80'/>"
                              "<path d='M120 50 H180' stroke='black' stroke-width='10'/>"));
  const LogoDrawing logo = load_logo(file, 0.1, 0.1).value();
  const double unit = 0.1 / 200;  // the room's width; its height is twice what is needed
  constexpr double kPi = 3.14159265358979;
  CHECK(area_of(logo) == Approx((kPi * (1600 - 400) + 600) * unit * unit).epsilon(1e-3));
  CHECK(logo.outlines.size() == 3);
  double left = 1, right = 0, top = 1, bottom = 0;
  for (const auto& outline : logo.outlines) {
    for (const PlatePoint& p : outline) {
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  }
  CHECK(left == Approx(10 * unit).epsilon(0.01));
  CHECK(right == Approx(180 * unit).epsilon(0.002));
  CHECK(top == Approx(0.025 + 10 * unit).epsilon(0.002));
  CHECK(bottom == Approx(0.025 + 90 * unit).epsilon(0.002));
  const LogoDrawing moved = in_room(logo, {3, 4, 0.1, 0.1});
  CHECK(moved.outlines[0][0].x == Approx(logo.outlines[0][0].x + 3));
  CHECK(area_of(moved) == Approx(area_of(logo)));
}

TEST_CASE("what is no logo is refused by the file's name") {
  const TemporaryFolder folder;
  std::string nested;
  for (int i = 0; i < 20'000; ++i) nested += "<g>";
  struct Case {
    std::string content;
    std::string expected;
  };
  for (const Case& bad :
       {Case{"", "no SVG"}, Case{"\x89PNG\r\n", "no SVG"}, Case{"<svg", "no SVG"},
        Case{picture("0 0 10 10", ""), "darker"},
        Case{picture("0 0 10 10", "<rect width='10' height='10' fill='#ddd'/>"), "darker"},
        Case{picture("0 0 0 10", "<rect width='10' height='10' fill='white'/>"), "darker"},
        Case{picture("0 0 10 10", "<image href='/etc/hostname' width='9' height='9'/>"), "darker"},
        Case{nested, "no SVG"}, Case{std::string(2'000'001, ' '), "2 MB"}}) {
    const auto file = written(folder, bad.content);
    const Result<LogoDrawing> logo = load_logo(file, 0.05, 0.02);
    REQUIRE_FALSE(logo);
    CAPTURE(logo.error().message);
    CHECK(logo.error().message.starts_with(file.string()));
    CHECK(logo.error().message.find(bad.expected) != std::string::npos);
  }
  CHECK_FALSE(load_logo(folder.path() / "none.svg", 0.05, 0.02));
}

TEST_CASE("a label says what the template's lines say, in the words of its language") {
  TagTemplate tag = small_template();
  tag.label.lines = {"{name} {side} {digits}",
                     "{survey} {revision}: {chainage} {x} {y} {z} {other"};
  tag.label.left = "links";
  tag.qr.content = "https://mine.example/{name}?{digits}";
  const Survey survey = sample_survey(tag);
  const PlacedTag placed = sample_tag(survey, {1.9, 12.34, 0.4});
  const std::vector<std::string> lines = tag_text(survey, placed, "abc").lines;
  REQUIRE(lines.size() == 2);
  CHECK(lines[0] == "000L links " + grouped_digits(survey.code, placed.digits));
  CHECK(lines[1] == "corridor abc: 0.000 1.900 12.340 0.400 {other");
  CHECK(qr_content(survey, placed, "") == "https://mine.example/000L?" + to_string(placed.digits));
}
