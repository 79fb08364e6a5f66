// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/occluders.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/feature_frame/quad.hpp"
#include "tests/reader/drawn_symbol.hpp"

namespace tagsmith::detail::test {
namespace {

// Whether one of the strips hides a row at this height from `begin` to `end`, and a hundredth of
// the width more at most.
bool hides(const std::vector<Occluder>& strips, double v, double begin, double end) {
  return std::ranges::any_of(strips, [&](const Occluder& strip) {
    const HiddenWidth hidden = hidden_width(strip, v);
    return hidden.begin <= begin && hidden.begin > begin - 0.01 && hidden.end >= end &&
           hidden.end < end + 0.01;
  });
}

}  // namespace

TEST_CASE("a strap that shines brighter than the plate is found from side to side") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  for (std::uint8_t& sample : symbol.image.samples) sample = static_cast<std::uint8_t>(sample / 2);
  const int height = symbol.height(), top = height * 2 / 5, bottom = height / 2;
  symbol.fill(-DrawnSymbol::kMargin, top, symbol.width() + DrawnSymbol::kMargin, bottom, 250);
  const std::vector<Occluder> strips =
      find_occluders(symbol.image.view(), symbol.frame(), SymbolLayout{});
  CHECK(std::ranges::any_of(strips, [](const Occluder& strip) {
    const HiddenWidth above = hidden_width(strip, 0.38), within = hidden_width(strip, 0.45),
                      below = hidden_width(strip, 0.52);
    return within.begin < 0.05 && within.end > 0.95 && above.end < above.begin &&
           below.end < below.begin;
  }));
}

TEST_CASE("a strip along the bars is found by the white above and below them") {
  for (const int module : {30, 60}) {
    CAPTURE(module);
    DrawnSymbol symbol(kDrawnDigits, 4);
    // Four modules wide, and all of it inside of the frame.
    const int left = 4 * (9 + module), right = left + 16, height = symbol.height();
    symbol.fill(left, height / 50, right, height - height / 50, DrawnSymbol::kBlack);
    const std::vector<Occluder> strips =
        strips_along_bars(symbol.image.view(), symbol.frame(), SymbolLayout{});
    const auto share = [&](int x) { return static_cast<double>(x) / symbol.width(); };
    CHECK(hides(strips, 0.5, share(left), share(right)));
  }
  const DrawnSymbol clear(kDrawnDigits, 4);
  CHECK(strips_along_bars(clear.image.view(), clear.frame(), SymbolLayout{}).empty());
}

TEST_CASE("an occluder hides the places of a row that lie inside it") {
  // A cable that slants from the upper side to the lower one, and beyond both.
  const Occluder cable{{{0.30, -0.05}, {0.42, -0.05}, {0.62, 1.05}, {0.50, 1.05}}};
  for (const double v : {0.0, 0.213, 0.5, 0.997}) {
    CAPTURE(v);
    const HiddenWidth hidden = hidden_width(cable, v);
    CHECK(hidden.end - hidden.begin == doctest::Approx(0.12));
    for (int i = 0; i < 131; ++i) {
      const double u = (i + 0.5) / 131;
      CAPTURE(u);
      CHECK((hidden.begin <= u && u <= hidden.end) == contains(cable, {u, v}));
    }
  }
}

TEST_CASE("an occluder hides nothing above and below itself") {
  const Occluder board{{{0.2, 0.3}, {0.6, 0.3}, {0.6, 0.5}, {0.2, 0.5}}};
  for (const double v : {0.29, 0.51, 2.0}) {
    const HiddenWidth hidden = hidden_width(board, v);
    CHECK(hidden.end < hidden.begin);
  }
  const HiddenWidth within = hidden_width(board, 0.4);
  CHECK(within.begin == doctest::Approx(0.2));
  CHECK(within.end == doctest::Approx(0.6));
}

}  // namespace tagsmith::detail::test
