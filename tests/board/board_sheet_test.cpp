// SPDX-License-Identifier: Apache-2.0
// A board's sheet as printers see it: rasterised by two programs, measured, and read by our reader
// and by zbar.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/svg.hpp"
#include "tests/board/seen_board.hpp"
#include "tests/render/raster.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

const BoardNotes kNotes{"A4", "tagsmith 0", "trial.yaml", true};

Page page_of(const Board& board) { return lay_out_board(board, kNotes); }

std::string pdf_of(const Page& page) {
  const Sheet sheet = sheet_of(page);
  return render_pdf(std::span(&sheet, 1)).value();
}

// A row or column of samples, `step` apart, blurred as a lens does: Gaussian of 1 px.
void blur_line(std::uint8_t* first, int count, int step) {
  constexpr std::array kWeights{0.3991, 0.2421, 0.0540, 0.0044};  // from the middle outwards
  std::vector<double> line;
  for (int i = 0; i < count; ++i) line.push_back(first[i * step]);
  const auto at = [&](int i) {
    return line[static_cast<std::size_t>(std::clamp(i, 0, count - 1))];
  };
  for (int i = 0; i < count; ++i) {
    double sum = kWeights[0] * at(i);
    for (int k = 1; k <= 3; ++k)
      sum += kWeights[static_cast<std::size_t>(k)] * (at(i - k) + at(i + k));
    first[i * step] = static_cast<std::uint8_t>(std::lround(std::min(sum, 255.0)));
  }
}

// Half the pixels a side, each the mean of four: pdftoppm's grey levels place an edge to a quarter
// of a pixel only.
Raster halved(const Raster& raster) {
  const GrayImage& whole = raster.image;
  Raster half{{whole.width / 2, whole.height / 2, {}}, raster.pixels_per_mm / 2};
  for (int y = 0; y < half.image.height; ++y) {
    for (int x = 0; x < half.image.width; ++x) {
      const auto at = [&](int right, int down) {
        return int{whole.view().at(2 * x + right, 2 * y + down)};
      };
      const int sum = at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1);
      half.image.samples.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
    }
  }
  return half;
}

// No camera gives steps as sharp as a raster's, and edges are measured in what a lens leaves.
Raster through_lens(Raster raster) {
  GrayImage& image = raster.image;
  for (int y = 0; y < image.height; ++y) {
    blur_line(image.samples.data() + static_cast<std::ptrdiff_t>(y) * image.width, image.width, 1);
  }
  for (int x = 0; x < image.width; ++x) {
    blur_line(image.samples.data() + x, image.height, image.width);
  }
  return raster;
}

// How far any corner was read from where the board says, in pixels; a tag that is not read is far.
double farthest_corner(const Board& board, const Raster& raster) {
  ReadOptions options;
  options.layouts = {layout_of(board.tag)};
  const ReadResult result = read_tags(raster.image.view(), options);
  if (result.tags.size() != board.tags.size()) return 1e3;
  double farthest = 0;
  for (const BoardTag& tag : board.tags) {
    const Reading* reading = reading_of(result, tag.digits);
    if (reading == nullptr) return 1e3;
    const auto corners = corners_of(board, tag);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      // Pixel (0, 0) is the centre of the upper left pixel.
      const double x = corners[i].x * 1e3 * raster.pixels_per_mm - 0.5;
      const double y = corners[i].y * 1e3 * raster.pixels_per_mm - 0.5;
      farthest =
          std::max(farthest, std::hypot(reading->corners[i].x - x, reading->corners[i].y - y));
    }
  }
  return farthest;
}

struct NamedSheet {
  const char* name;
  double width;
  double height;
  double dpi;  // that makes a module about three pixels
};

const NamedSheet kSheets[] = {{"A4", 0.297, 0.210, 150},
                              {"Letter", 0.2794, 0.2159, 150},
                              {"A4 upright", 0.210, 0.297, 180},
                              {"A2", 0.594, 0.420, 75}};

}  // namespace

TEST_CASE("every tag of a printed board reads as its place, its corners within 0.3 px of it") {
  for (const NamedSheet& sheet : kSheets) {
    CAPTURE(sheet.name);
    const Board board = board_on(sheet.width, sheet.height, 123);
    const Page page = page_of(board);
    CHECK(farthest_corner(board, through_lens(halved(rasterize_pdf(pdf_of(page), 2 * sheet.dpi)))) <
          0.3);
    CHECK(farthest_corner(board, through_lens(halved(rasterize_svg(render_svg(sheet_of(page)),
                                                                   2 * sheet.dpi)))) < 0.3);
  }
}

TEST_CASE("the frames of a printed board stand where it says, measured by grey coverage") {
  for (const NamedSheet& sheet : kSheets) {
    CAPTURE(sheet.name);
    const Board board = board_on(sheet.width, sheet.height);
    const Raster raster = rasterize_pdf(pdf_of(page_of(board)), 2 * sheet.dpi);
    const double length = board.tag.frame_inner_length;
    const double height = board.tag.frame_inner_height;
    const double module = module_width(board.tag);
    const double tolerance = 0.5 * 25.4 / (2 * sheet.dpi);  // half a pixel
    for (const BoardTag& tag : board.tags) {
      // Above the bars, and left of them.
      const auto across = edges_mm(profile_of(
          raster,
          {tag.corner.x - 5 * module, tag.corner.y + 2 * module, length + 10 * module, 5 * module},
          false));
      const auto down = edges_mm(profile_of(
          raster,
          {tag.corner.x + 2 * module, tag.corner.y - 5 * module, 5 * module, height + 10 * module},
          true));
      REQUIRE(across.size() == 4);
      REQUIRE(down.size() == 4);
      CHECK(std::abs(across[1] - tag.corner.x * 1e3) < tolerance);
      CHECK(std::abs(across[2] - (tag.corner.x + length) * 1e3) < tolerance);
      CHECK(std::abs(down[1] - tag.corner.y * 1e3) < tolerance);
      CHECK(std::abs(down[2] - (tag.corner.y + height) * 1e3) < tolerance);
    }
  }
}

TEST_CASE("every tag of a board reads down to 1.3 px a module, its equal neighbours beside it") {
  const Board board = board_on(0.297, 0.210, 5);
  const std::string pdf = pdf_of(page_of(board));
  for (const double dpi : {100.0, 65.0}) {
    CAPTURE(dpi);
    CHECK(read_tags(rasterize_pdf(pdf, dpi).image.view()).tags.size() == 20);
  }
}

TEST_CASE("a board's page has its sheet's size, and nothing is printed in the tags' clearance") {
  for (const NamedSheet& sheet : kSheets) {
    CAPTURE(sheet.name);
    const Board board = board_on(sheet.width, sheet.height);
    const Page page = page_of(board);
    const Raster raster = rasterize_pdf(pdf_of(page), sheet.dpi);
    CHECK(std::abs(raster.image.width - sheet.width / 0.0254 * sheet.dpi) < 1);
    CHECK(std::abs(raster.image.height - sheet.height / 0.0254 * sheet.dpi) < 1);
    const double pixel = 0.0254 / sheet.dpi;
    for (const PageTag& tag : page.tags) {
      const Rectangle& frame = tag.drawing.frame_outer;
      CHECK(darkest_between(raster, grown(frame, 1.5 * pixel),
                            grown(frame, board_clearance(board.tag) - pixel)) == 0);
    }
    const double blank = 0.005;  // where printers do not print
    CHECK(darkest_between(raster, {blank, blank, sheet.width - 2 * blank, sheet.height - 2 * blank},
                          {0, 0, sheet.width, sheet.height}) == 0);
  }
}

TEST_CASE("a PDF of a board says its sheet's size to 0.01 mm and forbids scaling") {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "board.pdf").string();
  REQUIRE(write_file(path, pdf_of(page_of(board_on(0.2794, 0.2159)))));
  const ProgramOutput output = run_shell("pdfinfo '" + path + "'");
  const std::string words = "Page size:";
  const std::size_t at = output.out.find(words);
  REQUIRE(at != std::string::npos);
  std::size_t used = 0;
  const std::string numbers = output.out.substr(at + words.size());
  const double width = std::stod(numbers, &used);
  const double height = std::stod(numbers.substr(used + 3));
  CHECK(std::abs(width / 72 * 25.4 - 279.4) < 0.01);
  CHECK(std::abs(height / 72 * 25.4 - 215.9) < 0.01);
  CHECK(read_file(path)->find("/PrintScaling /None") != std::string::npos);
}

TEST_CASE("scale bars and crosses stand where the sheet says") {
  const Board board = board_on(0.297, 0.210);
  const Raster raster = rasterize_pdf(pdf_of(page_of(board)), 600);
  // Across the lower halves of the bar's ticks, and the crosses' upper and left arms.
  const std::vector<double> bar =
      lines_mm(profile_of(raster, {0.09, 0.210 - 0.0075, 0.117, 0.0008}, false));
  REQUIRE(bar.size() == 2);
  CHECK(bar[1] - bar[0] == doctest::Approx(100).epsilon(2e-4));
  const auto marks = board_marks(board.width, board.height);
  const auto drawn = drawn_distances(board.width, board.height);
  const auto upper_arm = [&](const PlatePoint& mark) {
    const auto lines =
        lines_mm(profile_of(raster, {mark.x - 0.002, mark.y - 0.002, 0.004, 0.001}, false));
    REQUIRE(lines.size() == 1);
    return lines.front();
  };
  const auto left_arm = [&](const PlatePoint& mark) {
    const auto lines =
        lines_mm(profile_of(raster, {mark.x - 0.002, mark.y - 0.002, 0.001, 0.004}, true));
    REQUIRE(lines.size() == 1);
    return lines.front();
  };
  CHECK(upper_arm(marks[1]) - upper_arm(marks[0]) == doctest::Approx(drawn[0] * 1e3).epsilon(1e-4));
  CHECK(upper_arm(marks[3]) - upper_arm(marks[2]) == doctest::Approx(drawn[0] * 1e3).epsilon(1e-4));
  CHECK(left_arm(marks[2]) - left_arm(marks[0]) == doctest::Approx(drawn[1] * 1e3).epsilon(1e-4));
  CHECK(drawn[0] == doctest::Approx(0.281));
  CHECK(drawn[1] == doctest::Approx(0.194));
}

TEST_CASE("an independent reader, zbar, reads every code of a board") {
  REQUIRE_MESSAGE(has_program("zbarimg"), "zbarimg is missing: install zbar-tools");
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "page.png").string();
  const Board board = board_on(0.297, 0.210, 42);
  const Raster raster = rasterize_pdf(pdf_of(page_of(board)), 300);
  REQUIRE(save_gray_image(path, raster.image.view()));
  const ProgramOutput output = run_shell("zbarimg --quiet --raw '" + path + "'");
  CHECK(std::ranges::count(output.out, '\n') == 20);
  for (const BoardTag& tag : board.tags) {
    CHECK(output.out.find("0" + to_string(tag.digits) + "\n") != std::string::npos);  // as EAN-13
  }
}
