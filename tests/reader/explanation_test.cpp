// SPDX-License-Identifier: Apache-2.0
// The picture that tells why a picture was read as it was.
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/explain.hpp"

using namespace tagsmith;

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
    for (const std::size_t named : {0, 1, 3}) {
      CHECK(differing_at_letter(a, b, one.corners[named]) == 0);
    }
  }
}
