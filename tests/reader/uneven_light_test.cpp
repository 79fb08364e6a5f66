// SPDX-License-Identifier: Apache-2.0
// Plates on which shadows lie.
#include "decoder/reader/uneven_light.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <doctest/doctest.h>

#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/occluders.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "tests/bench/mass_picture.hpp"
#include "tests/reader/drawn_symbol.hpp"

namespace tagsmith::detail::test {
namespace {

// Leaves of the light at each pixel the share that `left_at` gives for it, by its place from P.
template <class Left>
void shade(DrawnSymbol& symbol, const Left& left_at) {
  const ToneCurve& tone = ToneCurve::srgb();
  for (int y = 0; y < symbol.image.height; ++y) {
    for (int x = 0; x < symbol.image.width; ++x) {
      auto& sample = symbol.image.samples[static_cast<std::size_t>(y * symbol.image.width + x)];
      const double left = left_at(x - DrawnSymbol::kMargin, y - DrawnSymbol::kMargin);
      sample = static_cast<std::uint8_t>(std::lround(tone.sample_of(left * tone.light_of(sample))));
    }
  }
}

bool is_uneven(const DrawnSymbol& symbol) {
  return is_unevenly_lit(symbol.image.view(), symbol.frame(), SymbolLayout{});
}

// By how much the middles of modules are off their darkness in the profile, at most.
double farthest_off(const DrawnSymbol& symbol, bool evened) {
  const RobustProfile rows(symbol.image.view(), symbol.frame(), SymbolLayout{}, evened);
  const SymbolProfile profile = rows.of_agreeing_rows();
  CHECK(profile.is_evened == evened);
  const auto modules = modules_of(kDrawnDigits);
  double worst = 0;
  for (const ScanBin& bin : profile.bins) {
    const double part = bin.at - std::floor(bin.at);
    if (bin.at < 0 || bin.at >= kModuleCount || part < 0.33 || part > 0.67) continue;
    worst = std::max(worst, std::abs(bin.darkness - modules[static_cast<std::size_t>(bin.at)]));
  }
  return worst;
}

}  // namespace

TEST_CASE("a plate lit alike, or less from one end to the other, has no shadow") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  CHECK_FALSE(is_uneven(symbol));
  shade(symbol, [&](int x, int) { return 1 - 0.3 * x / symbol.width(); });
  CHECK_FALSE(is_uneven(symbol));
}

TEST_CASE("a cable in front is no shadow, noise is none") {
  DrawnSymbol cable(kDrawnDigits, 4);
  cable.fill(200, -DrawnSymbol::kMargin, 216, cable.height() + DrawnSymbol::kMargin, 20);
  CHECK_FALSE(is_uneven(cable));
  DrawnSymbol noise(kDrawnDigits, 4);
  unsigned lot = 1;
  for (std::uint8_t& sample : noise.image.samples) {
    lot = lot * 1664525U + 1013904223U;
    sample = static_cast<std::uint8_t>(sample / 2 + lot % 100U - lot % 100U / 2);
  }
  CHECK_FALSE(is_uneven(noise));
}

TEST_CASE("rows are evened out under shadows that lie across, along and over the bars") {
  const double slopes[] = {0, 0.5, 2};
  for (const double slope : slopes) {
    for (const double left : {0.5, 0.3, 0.2}) {
      CAPTURE(slope);
      CAPTURE(left);
      DrawnSymbol symbol(kDrawnDigits, 4);
      shade(symbol, [&](int x, int y) { return x - slope * y > 150 ? left : 1.0; });
      CHECK(is_uneven(symbol));
      CHECK(farthest_off(symbol, false) > 0.3);
      CHECK(farthest_off(symbol, true) < 0.15);
    }
  }
}

TEST_CASE("pixels beside a shadow's edge weigh less than those farther from it") {
  constexpr double kEdge = 160;
  DrawnSymbol symbol(kDrawnDigits, 4);
  shade(symbol, [&](int x, int) { return x > kEdge ? 0.3 : 1.0; });
  const SymbolRows seen(symbol.image.view(), symbol.frame().corners, {}, SymbolLayout{},
                        RowHeight::coarse);
  SymbolRows evened = seen;
  even_out(evened, 0.2);
  int less = 0;
  for (std::size_t row = 0; row < seen.rows; ++row) {
    for (std::size_t bin = 0; bin < seen.bins; ++bin) {
      const double at = seen.width_share_of(static_cast<double>(bin) + 0.5) * symbol.width();
      const float before = seen.cell(row, bin).count, after = evened.cell(row, bin).count;
      if (std::abs(at - kEdge) > 24) CHECK(after >= 0.9F * before);
      less += after < 0.4F * before ? 1 : 0;
      CHECK((after > 0) == (before > 0));
    }
  }
  CHECK(less > static_cast<int>(seen.rows));
}

TEST_CASE("a broad shadow in which bars show is no strip that hides them") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  shade(symbol, [](int x, int) { return x > 160 && x < 220 ? 0.3 : 1.0; });
  CHECK(strips_along_bars(symbol.image.view(), symbol.frame(), SymbolLayout{}).empty());
}

TEST_CASE(
    "a shadow that goes on to one side is no strip along the bars, a cable at its edge is one") {
  for (const double left : {0.3, 0.1}) {
    for (int edge = 90; edge < 360; edge += 6) {
      CAPTURE(edge);
      DrawnSymbol symbol(kDrawnDigits, 4);
      shade(symbol, [&](int x, int) { return x > edge ? left : 1.0; });
      CHECK(strips_along_bars(symbol.image.view(), symbol.frame(), SymbolLayout{}).empty());
    }
  }
  DrawnSymbol symbol(kDrawnDigits, 4);
  constexpr int kEdge = 212;
  symbol.fill(kEdge - 12, 0, kEdge, symbol.height(), DrawnSymbol::kBlack);
  shade(symbol, [&](int x, int) { return x > kEdge ? 0.3 : 1.0; });
  const auto strips = strips_along_bars(symbol.image.view(), symbol.frame(), SymbolLayout{});
  REQUIRE(strips.size() == 1);
  const HiddenWidth hidden = hidden_width(strips[0], 0.5);
  CHECK(hidden.begin * symbol.width() == doctest::Approx(kEdge - 12).epsilon(0.02));
  CHECK(hidden.end * symbol.width() == doctest::Approx(kEdge).epsilon(0.02));
}

// A lamp's spot in the middle of the plate's height leaves a third of its light at the bars' ends.
TEST_CASE("the bars' ends show where the light of a lamp falls off along the bars") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  shade(symbol, [&](int, int y) {
    const double off = 2.0 * y / symbol.height() - 1;
    return 0.05 + 0.9 * std::exp(-2.5 * off * off);
  });
  const Quad corners = symbol.frame().corners;
  const SymbolLayout layout;
  const BothEnds both = find_both_ends(symbol.image.view(), bar_field(corners, layout, {}, true));
  CHECK(judge_by_bar_ends(symbol.image.view(), both, corners, layout).kind == EndsVerdict::suited);
  const auto ends = [&](bool in_shadow) {
    return find_bar_ends(symbol.image.view(), bar_field(corners, layout, {}, in_shadow),
                         layout.bars_top + 0.2, layout.bars_top - 0.1);
  };
  CHECK_FALSE(ends(false));
  REQUIRE(ends(true));
  CHECK(std::abs(ends(true)->at(0.5) - layout.bars_top) * symbol.height() < 0.7);
}

TEST_CASE("most tags in shadow are read, none wrongly") {
  int tags = 0, read = 0;
  for (std::uint64_t number = 0; number < 90; ++number) {
    const mass::Picture picture = mass::draw_troubled(mass::Trouble::shadow, 7'000'000 + number);
    const ReadResult result = read_tags(picture.image.view());
    const bool is_tag = picture.kind == mass::Kind::tag && !picture.odd_margins;
    tags += is_tag ? 1 : 0;
    for (const Reading& tag : result.tags) {
      CHECK(mass::may_be_read(picture.kind));
      CHECK(tag.digits == picture.code);
      read += is_tag ? 1 : 0;
    }
  }
  MESSAGE(read << " of " << tags);
  CHECK(read > 0.55 * tags);
}

}  // namespace tagsmith::detail::test
