// SPDX-License-Identifier: Apache-2.0
// The stages from a frame to its scan profile, each with a picture drawn for it.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/reader/common_darkness.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "decoder/reader/symbol_rows.hpp"
#include "tests/reader/drawn_symbol.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::DrawnSymbol;
using tagsmith::detail::test::kDrawnDigits;

namespace {

SymbolRows rows_of(const DrawnSymbol& symbol, RowHeight height) {
  return {symbol.image.view(), symbol.frame().corners, {}, SymbolLayout{}, height};
}

// The greatest difference between a profile and the modules of the digits, of places that are a
// third of a module from every edge and that say something; `least` places must.
double farthest_off(const ScanProfile& profile, std::size_t least = 190) {
  const auto modules = modules_of(kDrawnDigits);
  double worst = 0;
  std::size_t seen = 0;
  for (const ScanBin& bin : profile) {
    const double part = bin.at - std::floor(bin.at);
    if (bin.at < 0 || bin.at >= kModuleCount || part < 0.33 || part > 0.67) continue;
    if (bin.variance > 1) continue;
    ++seen;
    const int module = modules[static_cast<std::size_t>(bin.at)];
    worst = std::max(worst, std::abs(bin.darkness - module));
  }
  CHECK(seen >= least);
  return worst;
}

}  // namespace

TEST_CASE("a symbol's rows hold each pixel of the bars once, at its place") {
  const DrawnSymbol symbol(kDrawnDigits, 4);
  const SymbolRows rows = rows_of(symbol, RowHeight::fine);
  CHECK(rows.module_px == doctest::Approx(4));
  CHECK(rows.bins_per_module == 6);
  CHECK(rows.modules_before == 4);
  CHECK(rows.bins == 6 * 103);
  CHECK(rows.module_of(4 * 6) == doctest::Approx(0));
  CHECK(rows.width_share_of(4 * 6) == doctest::Approx(9.0 / 113));
  float pixels = 0;
  for (const float count : rows.count) pixels += count;
  // 103 modules of four pixels, in every row of pixels between top and bottom.
  const double lines = (rows.bottom - rows.top) * symbol.height();
  CHECK(pixels == doctest::Approx(4 * 103 * lines).epsilon(0.02));
  const auto modules = modules_of(kDrawnDigits);
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    const double at = rows.module_of(static_cast<double>(rows.middles[bin]));
    if (rows.middles[bin] < 0 || at < 0 || at >= kModuleCount) continue;
    const bool is_bar = modules[static_cast<std::size_t>(at)] == 1;
    CHECK((rows.cell(rows.rows / 2, bin).light < 0.3F) == is_bar);
  }
}

TEST_CASE("every bin of a large symbol holds pixels, those at both ends too") {
  const SymbolRows rows = rows_of(DrawnSymbol(kDrawnDigits, 8), RowHeight::fine);
  REQUIRE(rows.middles.size() == rows.bins);
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    CAPTURE(bin);
    CHECK(rows.middles[bin] >= static_cast<float>(bin));
    CHECK(rows.middles[bin] <= static_cast<float>(bin + 1));
  }
}

TEST_CASE("the slope of the common darkness is its change by the places of the bins' pixels") {
  // At four pixels a module two of three bins hold a column of pixels, at eight all do.
  for (const int module_px : {4, 8}) {
    CAPTURE(module_px);
    const SymbolRows rows = rows_of(DrawnSymbol(kDrawnDigits, module_px), RowHeight::fine);
    CommonDarkness common{std::vector<float>(rows.bins), std::vector<bool>(rows.bins), {}};
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      common.known[bin] = rows.middles[bin] >= 0;
      common.darkness[bin] = 0.3F - 0.02F * rows.middles[bin];
    }
    find_slopes(rows, common);
    std::size_t sloping = 0;
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      if (common.slope[bin] == 0) continue;
      ++sloping;
      CHECK(common.slope[bin] == doctest::Approx(-0.02).epsilon(1e-3));
    }
    // All that hold pixels but the outermost two.
    const auto held = std::ranges::count_if(rows.middles, [](float at) { return at >= 0; });
    CHECK(sloping + 2 == static_cast<std::size_t>(held));
  }
}

TEST_CASE("coarse rows are few, and take fewer pixels of a large frame") {
  const DrawnSymbol small(kDrawnDigits, 1), large(kDrawnDigits, 8);
  CHECK(rows_of(small, RowHeight::coarse).rows == 8);
  const SymbolRows coarse = rows_of(large, RowHeight::coarse);
  const SymbolRows fine = rows_of(large, RowHeight::fine);
  CHECK(coarse.rows == 16);
  CHECK(fine.rows == 64);
  const auto pixels_of = [](const SymbolRows& rows) {
    float pixels = 0;
    for (const float count : rows.count) pixels += count;
    return pixels;
  };
  CHECK(pixels_of(coarse) < pixels_of(fine) / 3);
}

TEST_CASE("what is plain where other rows show bars is left out, and nothing else") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  const int middle = symbol.height() / 2;
  symbol.fill(0, middle - 10, symbol.width(), middle + 10, 120);
  SymbolRows rows = rows_of(symbol, RowHeight::fine);
  leave_out_plain(rows);
  for (std::size_t row = 0; row < rows.rows; ++row) {
    const double off = std::abs(rows.height_of(row) * symbol.height() - middle);
    CAPTURE(off);
    float pixels = 0;
    for (std::size_t bin = 40; bin + 40 < rows.bins; ++bin) pixels += rows.cell(row, bin).count;
    if (off < 8) CHECK(pixels == 0);
    if (off > 13) CHECK(pixels > 300);
  }
}

TEST_CASE("rows that agree give the modules") {
  const DrawnSymbol symbol(kDrawnDigits, 3);
  const SymbolProfile profile =
      RobustProfile(symbol.image.view(), symbol.frame(), SymbolLayout{}).of_agreeing_rows();
  CHECK(profile.module_px == doctest::Approx(3));
  CHECK(profile.blur == doctest::Approx(0.1).epsilon(0.2));  // of 0.3 pixels, and the bins'
  CHECK(farthest_off(profile.bins, 95) < 1e-3);
  for (const ScanBin& bin : profile.bins) CHECK(bin.agreement == doctest::Approx(1));
}

TEST_CASE("an occluder over some rows is left out there without making the others doubtful") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  // A board over a quarter of the bars' height and twenty modules.
  const int top = static_cast<int>(0.2 * symbol.height());
  const int bottom = top + static_cast<int>(0.25 * 0.674 * symbol.height());
  symbol.fill(4 * 40, top, 4 * 60, bottom, DrawnSymbol::kBlack);
  const SymbolProfile profile =
      RobustProfile(symbol.image.view(), symbol.frame(), SymbolLayout{}).of_agreeing_rows();
  CHECK(farthest_off(profile.bins) < 0.05);
  for (const ScanBin& bin : profile.bins) {
    CAPTURE(bin.at);
    if (bin.at > 32.5 && bin.at < 49.5) CHECK(bin.agreement < 0.85);
    if (bin.at < 29 || bin.at > 53) CHECK(bin.agreement == doctest::Approx(1));
    const double part = bin.at - std::floor(bin.at);
    if (part > 0.33 && part < 0.67) CHECK(bin.variance < 0.01);
  }
}

TEST_CASE("a speck that is too small for an occluder makes its place doubtful") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  const auto modules = modules_of(kDrawnDigits);
  int space = 20;
  while (modules[static_cast<std::size_t>(space)] == 1) ++space;
  const int top = static_cast<int>(0.2 * symbol.height());
  const int bottom = top + static_cast<int>(0.3 * 0.674 * symbol.height());
  symbol.fill(4 * (9 + space), top, 4 * (10 + space), bottom, DrawnSymbol::kBlack);
  const SymbolProfile profile =
      RobustProfile(symbol.image.view(), symbol.frame(), SymbolLayout{}).of_agreeing_rows();
  CHECK(farthest_off(profile.bins) < 0.05);
  for (const ScanBin& bin : profile.bins) {
    CAPTURE(bin.at);
    if (bin.at > space + 0.3 && bin.at < space + 0.7) CHECK(bin.variance > 0.02);
    if (bin.at < space - 1 || bin.at > space + 2) CHECK(bin.variance < 0.01);
  }
}

TEST_CASE("half of the height can be asked alone") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  symbol.fill(0, 0, symbol.width(), symbol.height() / 2, DrawnSymbol::kWhite);
  const RobustProfile profile(symbol.image.view(), symbol.frame(), SymbolLayout{});
  CHECK(farthest_off(profile.of_agreeing_rows({0.5, 1}).bins) < 0.01);
  CHECK(farthest_off(profile.of_agreeing_rows({0, 0.5}).bins) > 0.9);
}

TEST_CASE("a fifth of the height in sight is enough for all rows together") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  const double bars = 0.674 * symbol.height();
  const int top = static_cast<int>(0.163 * symbol.height() + 0.2 * bars);
  symbol.fill(10, top, symbol.width() - 10, symbol.height() - 10, 130);
  const RobustProfile profile(symbol.image.view(), symbol.frame(), SymbolLayout{});
  CHECK(farthest_off(profile.of_all_rows(profile.rows_in_sight(), AddedLight::even).bins) < 0.1);
  CHECK(farthest_off(profile.of_agreeing_rows().bins, 0) > 0.3);
}

TEST_CASE("rows under light of their own follow what all have in common") {
  DrawnSymbol symbol(kDrawnDigits, 4);
  // A shadow that quarters the light of a third of the height, and glare that fills in another.
  const int third = symbol.height() / 3;
  for (int y = 0; y < symbol.height(); ++y) {
    for (int x = 0; x < symbol.width(); ++x) {
      auto& sample = symbol.image.samples[static_cast<std::size_t>(
          (y + DrawnSymbol::kMargin) * symbol.image.width + x + DrawnSymbol::kMargin)];
      if (y < third) sample = static_cast<std::uint8_t>(sample / 2);
      if (y > 2 * third) sample = static_cast<std::uint8_t>(150 + sample / 3);
    }
  }
  const SymbolRows rows = rows_of(symbol, RowHeight::fine);
  const SettledRows settled = settle(rows, AddedLight::even);
  const RowStretches stretches(rows, settled.common, AddedLight::even);
  const auto modules = modules_of(kDrawnDigits);
  std::size_t voting = 0;
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    const double at = rows.module_of(static_cast<double>(bin) + 0.5);
    const double part = at - std::floor(at);
    if (at < 0 || at >= kModuleCount || part < 0.33 || part > 0.67) continue;
    for (std::size_t row = 0; row < rows.rows; ++row) {
      const Vote vote = stretches.vote(rows, settled.common, row, bin);
      if (vote.weight == 0) continue;
      ++voting;
      const int module = modules[static_cast<std::size_t>(at)];
      CHECK(std::abs(vote.darkness - static_cast<float>(module)) < 0.15F);
    }
  }
  CHECK(voting > 90 * rows.rows);
}
