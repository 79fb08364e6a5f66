// SPDX-License-Identifier: Apache-2.0
// The picture that tells why a picture was read as it was.
#include <algorithm>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/explain.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;

namespace {

constexpr int kWidth = 1600;  // drawn pixel by pixel
constexpr int kHeight = 600;

// The symbol with these corners, as the first or the second of two.
GrayImage drawn_as(std::size_t number, const std::array<PixelPoint, 4>& corners) {
  const GrayImage gray{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 128)};
  std::vector<ExplainedSymbol> symbols(2);
  symbols[0].outline = symbols[1].outline = {{{1300, 500}, {1400, 500}, {1400, 550}, {1300, 550}}};
  symbols[number - 1].outline = corners;
  const auto png = draw_explanation(gray.view(), {.symbols = symbols, .passed_over = {}});
  REQUIRE(png);
  const auto picture = decode_gray_image("drawn.png", *png);
  REQUIRE(picture);
  return *picture;
}

// Pixels that differ within the 16 x 16 right above and beside a corner, where its letter stands.
int differing_at_letter(const GrayImage& a, const GrayImage& b, PixelPoint corner) {
  int differing = 0;
  for (int y = static_cast<int>(corner.y) - 18; y < static_cast<int>(corner.y) - 2; ++y) {
    for (int x = static_cast<int>(corner.x) + 4; x < static_cast<int>(corner.x) + 20; ++x) {
      differing += a.view().at(x, y) != b.view().at(x, y) ? 1 : 0;
    }
  }
  return differing;
}

}  // namespace

TEST_CASE("the number of a symbol leaves its corners' letters alone") {
  struct Case {
    std::string name;
    std::array<PixelPoint, 4> corners;  // from P, clockwise on the plate
  };
  const std::vector<Case> cases{
      {"P highest", {{{400, 200}, {800, 220}, {800, 440}, {400, 430}}}},
      {"F highest", {{{400, 230}, {800, 200}, {800, 440}, {400, 430}}}},
      {"turned by half", {{{800, 440}, {400, 430}, {400, 200}, {800, 220}}}},
      {"at the picture's upper edge", {{{400, 24}, {800, 30}, {800, 300}, {400, 290}}}},
      {"at it, turned by half", {{{800, 300}, {400, 290}, {400, 24}, {800, 30}}}}};
  for (const Case& one : cases) {
    CAPTURE(one.name);
    const GrayImage a = drawn_as(1, one.corners);
    const GrayImage b = drawn_as(2, one.corners);
    CHECK(a.samples != b.samples);
    for (const std::size_t named : {0U, 1U, 3U}) {
      CHECK(differing_at_letter(a, b, one.corners[named]) == 0);
    }
  }
}

TEST_CASE("a refused symbol is explained the right way up, however it hangs") {
  Camera camera;
  camera.width = 400;
  camera.height = 400;
  camera.fx = camera.fy = 1600;
  camera.cx = camera.cy = 199.5;
  ScenePlate plate;
  plate.drawing = draw_tag(test::corridor_template(), *parse_digits("019000800402"));
  for (const double roll : {0.0, 0.5, 1.0, 1.5}) {
    CAPTURE(roll);
    plate.camera_from_plate = camera_from_turned_plate(
        camera, plate.drawing, Eigen::Vector2d(200, 200), camera.fx * plate.drawing.module / 2, 0.3,
        0.1, roll * std::numbers::pi);
    const View view = render_view(camera, std::span(&plate, 1), ViewOptions{});
    ReadOptions options;
    options.min_confidence = 1.1;  // refuses all
    const ReadResult result = read_tags(view.image.view(), options);
    REQUIRE(result.tags.empty());
    const Explanation explanation = explain(result);
    const auto right = std::ranges::find_if(explanation.symbols, [](const ExplainedSymbol& symbol) {
      return to_string(symbol.digits) == "019000800402";
    });
    REQUIRE(right != explanation.symbols.end());
    CHECK(std::ranges::min(right->margins) > 10);
  }
}
