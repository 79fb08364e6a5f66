// SPDX-License-Identifier: Apache-2.0
// The stages from a scan profile to digits, each with inputs made for it.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/scan/characters.hpp"
#include "decoder/scan/decode.hpp"
#include "decoder/scan/decode_part.hpp"
#include "decoder/scan/decoding.hpp"
#include "decoder/scan/edge_step.hpp"
#include "decoder/scan/elastic_scan.hpp"
#include "decoder/scan/explanation.hpp"
#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/module_equations.hpp"
#include "decoder/scan/module_light.hpp"
#include "decoder/scan/place_rows.hpp"
#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_edges.hpp"
#include "decoder/scan/symbol_fit.hpp"
#include "decoder/scan/symbol_places.hpp"
#include "decoder/scan/tuning.hpp"
#include "tests/scan/made_profile.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::profile_of;
using tagsmith::detail::test::share_of_bars;

namespace {

const Digits kDigits = *parse_digits("019000700401");

ImagingModel bent_image() {
  ImagingModel image;
  image.blur = 0.45;
  image.shift = 0.2;
  image.stretch = 0.003;
  image.bend = -0.15;
  image.growth = 0.2;
  image.white = 0.06;
  image.black = 0.93;
  image.shading = 0.04;
  return image;
}

double squares_left(const ScanProfile& profile, const Digits& digits, const ImagingModel& image) {
  double sum = 0;
  for (const ScanBin& bin : profile) {
    const double share = share_of_bars(digits, image, bin.at);
    const double off = bin.darkness - image.white - (image.black - image.white) * share;
    sum += off * off / bin.variance;
  }
  return sum;
}

// The same through pixels of two modules' width.
ImagingModel coarse_image() {
  ImagingModel image = bent_image();
  image.pixel = 2;
  return image;
}

// A line of light of a symbol, in samples of a tenth of `module`.
ScanLine line_of(const Digits& digits, double module, double begin, int size) {
  ScanLine line;
  ImagingModel image;
  image.blur = 0.5;
  for (int i = 0; i < size; ++i) {
    const double at = (i + 0.5 - begin) / module;
    line.push_back(static_cast<float>(0.8 - 0.7 * share_of_bars(digits, image, at)));
  }
  return line;
}

}  // namespace

TEST_CASE("the edges' shares of light are those of the definition") {
  for (const ImagingModel& image : {bent_image(), coarse_image()}) {
    const ScanProfile profile = profile_of(kDigits, image);
    const ScanPlaces places(profile);
    const std::vector<float> shares = SymbolEdges(image, kDigits).shares_at(places);
    REQUIRE(shares.size() == profile.size());
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const double expected = share_of_bars(kDigits, image, profile[i].at);
      CHECK(static_cast<double>(shares[i]) == doctest::Approx(expected).epsilon(1e-4));
    }
  }
}

TEST_CASE("a symbol of half a pixel a module is read by what its pixels measure") {
  // Each pixel holds two modules, as where bars stand along the pixels' columns.
  ImagingModel image;
  image.blur = 0.25;
  image.pixel = 2;
  image.shift = 0.15;
  ScanProfile profile = profile_of(kDigits, image, 4e-4, 2);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.004);
  for (ScanBin& bin : profile) bin.darkness += noise(random);
  ImagingModel start;
  start.blur = 0.7;
  // Without the pixels' width no normal point spread explains them, which looks like noise.
  const auto by_points = decode_profile(profile, start, {CheckDigit::sum10, {}});
  start.pixel = 2;
  const auto by_pixels = decode_profile(profile, start, {CheckDigit::sum10, {}});
  REQUIRE(by_pixels);
  CHECK(by_pixels->digits == kDigits);
  CHECK(by_pixels->confidence > 0.999);
  CHECK(by_pixels->fit.image.blur == doctest::Approx(0.25).epsilon(0.2));
  REQUIRE(by_points);
  CHECK(by_points->noise > 4 * by_pixels->noise);
}

TEST_CASE("the derivatives of the shares are those of small changes") {
  for (const ImagingModel& image : {bent_image(), coarse_image()}) {
    const ScanProfile profile = profile_of(kDigits, image);
    const ScanPlaces places(profile);
    const std::vector<BarShare> shares = SymbolEdges(image, kDigits).with_derivatives_at(places);
    constexpr double kStep = 1e-3;
    const auto change = [&](double ImagingModel::*parameter, double at) {
      ImagingModel more = image, less = image;
      more.*parameter += kStep;
      less.*parameter -= kStep;
      return (share_of_bars(kDigits, more, at) - share_of_bars(kDigits, less, at)) / (2 * kStep);
    };
    for (std::size_t i = 40; i < shares.size(); i += 7) {
      const double at = profile[i].at;
      const BarShare& share = shares[i];
      CHECK(std::abs(static_cast<double>(share.by_shift) - change(&ImagingModel::shift, at)) <
            2e-3);
      CHECK(std::abs(static_cast<double>(share.by_growth) - change(&ImagingModel::growth, at)) <
            2e-3);
      CHECK(std::abs(static_cast<double>(share.by_bend) - change(&ImagingModel::bend, at)) < 2e-3);
      CHECK(std::abs(static_cast<double>(share.by_stretch) - change(&ImagingModel::stretch, at)) <
            0.1);  // the ends are 47 modules from the middle
      CHECK(std::abs(static_cast<double>(share.by_log_blur) -
                     image.blur * change(&ImagingModel::blur, at)) < 2e-3);
    }
  }
}

TEST_CASE("a fit finds the picture that a profile was made with") {
  const ImagingModel image = coarse_image();
  ImagingModel start;
  start.blur = 0.6;
  start.pixel = 2;
  const SymbolFit fit = fit_symbol(profile_of(kDigits, image, 1e-6), kDigits, start);
  CHECK(fit.image.blur == doctest::Approx(image.blur).epsilon(0.01));
  CHECK(fit.image.shift == doctest::Approx(image.shift).epsilon(0.01));
  CHECK(fit.image.stretch == doctest::Approx(image.stretch).epsilon(0.02));
  CHECK(fit.image.bend == doctest::Approx(image.bend).epsilon(0.02));
  CHECK(fit.image.growth == doctest::Approx(image.growth).epsilon(0.02));
  CHECK(fit.image.white == doctest::Approx(image.white).epsilon(0.02));
  CHECK(fit.image.black == doctest::Approx(image.black).epsilon(0.01));
  CHECK(fit.image.shading == doctest::Approx(image.shading).epsilon(0.02));
  CHECK(fit.explained > 0.9999);
}

TEST_CASE("a fit to other digits explains less, and does not bend the symbol into them") {
  const ScanProfile profile = profile_of(kDigits, bent_image());
  ImagingModel start;
  start.blur = 0.45;
  const double right = fit_symbol(profile, kDigits, start).explained;
  const SymbolFit other = fit_symbol(profile, *parse_digits("019000700418"), start);
  CHECK(right > 0.99);
  CHECK(other.explained < 0.95);
  CHECK(std::abs(other.image.shift) < 0.6);
}

TEST_CASE("what a fit leaves open is small where the profile is sure") {
  const ImagingModel image = bent_image();
  for (const double variance : {1e-4, 1e-2}) {
    const ScanProfile profile = profile_of(kDigits, image, variance);
    const NuisanceCovariance slack =
        nuisance_covariance(profile, image, bar_shares(profile, image, kDigits));
    REQUIRE(slack.size() == profile.size());
    // Eight parameters of some 500 places: together 8 places' worth of variance.
    double sum = 0;
    for (const auto& open : slack) sum += static_cast<double>(open.squaredNorm()) / variance;
    CHECK(sum > 4);
    CHECK(sum < 8.01);
  }
}

TEST_CASE("modules and the growth of edges add up to the light of a symbol") {
  const ImagingModel image = bent_image();
  const ScanProfile profile = profile_of(kDigits, image);
  const ModuleLight light(profile, image);
  const auto modules = modules_of(kDigits);
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const ModuleLight::Place& place = light.places()[i];
    double share = 0;
    for (std::size_t k = 0; k < place.count; ++k) {
      const std::size_t feature = place.begin + k;
      const auto here = static_cast<double>(light.light(place)[k]);
      const auto module = feature / 2;
      const bool before = module > 0 && modules[module - 1] == 1;
      const bool after = module < modules.size() && modules[module] == 1;
      if (feature % 2 == 1) share += after ? here : 0;
      if (feature % 2 == 0) share += before != after ? here : 0;
    }
    CHECK(share == doctest::Approx(share_of_bars(kDigits, image, profile[i].at)).epsilon(0.002));
  }
}

TEST_CASE("the cost of characters is the sum of the squares that their symbol leaves") {
  ImagingModel image;
  image.blur = 0.5;
  const ScanProfile profile = profile_of(kDigits, image);
  const ModuleNormalEquations system(profile, ModuleLight(profile, image));
  for (const char* text : {"019000700401", "019000700418", "119000700401", "987654321098"}) {
    CAPTURE(text);
    const Digits digits = *parse_digits(text);
    const Characters characters = characters_of(digits);
    const double cost = system.character_costs(&characters).of(characters);
    const double left = squares_left(profile, digits, image);
    CHECK(std::abs(cost - left) < 0.1 + 0.01 * left);
  }
}

TEST_CASE("characters are the ways to hold two bars and two spaces in seven modules") {
  for (const bool right_half : {false, true}) {
    std::vector<std::array<std::uint8_t, kModulesPerDigit>> seen;
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      const auto& modules = modules_of_character(right_half, c);
      CHECK(modules.front() == (right_half ? 1 : 0));
      CHECK(modules.back() == (right_half ? 0 : 1));
      int changes = 0;
      for (std::size_t i = 1; i < modules.size(); ++i) changes += modules[i] != modules[i - 1];
      CHECK(changes == 3);
      CHECK(std::ranges::find(seen, modules) == seen.end());
      seen.push_back(modules);
    }
  }
  const auto whole = modules_of(kDigits);
  for (std::size_t position = 0; position < kDigitCount; ++position) {
    const auto& modules = modules_of_character(position >= 6, kDigits[position]);
    const auto first = static_cast<std::size_t>(first_module_of_digit(static_cast<int>(position)));
    for (std::size_t i = 0; i < modules.size(); ++i) CHECK(modules[i] == whole[first + i]);
    CHECK(first_feature(position) == 2 * first + 1);
  }
}

TEST_CASE("the cost of a symbol adds what its characters cost and what neighbours share") {
  CharacterCosts costs;
  costs.constant = 100;
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    for (std::size_t c = 0; c < kCharacterCount; ++c) costs.alone[i][c] = static_cast<double>(c);
  }
  costs.pair[4][7][3] = -5;
  Characters characters{};
  CHECK(costs.of(characters) == 100);
  characters[4] = 7;
  CHECK(costs.of(characters) == 107);
  characters[5] = 3;
  CHECK(costs.of(characters) == 105);
}

namespace {

// The greatest odds that a digit of kDigits, of which this is the profile, is corrupted.
double odds_of_corrupted(const ScanProfile& profile, const ImagingModel& image) {
  const ModuleLight light(profile, image);
  const NuisanceCovariance slack =
      nuisance_covariance(profile, image, bar_shares(profile, image, kDigits));
  return std::ranges::max(ModuleNormalEquations(profile, light, slack)
                              .odds_of_corrupted_digits(characters_of(kDigits)));
}

// The profile with waves of 2.5 modules from one digit to another.
ScanProfile with_waves(ScanProfile profile, double amplitude, int first_digit, int last_digit) {
  const int from = first_module_of_digit(first_digit), to = first_module_of_digit(last_digit) + 7;
  for (ScanBin& bin : profile) {
    const bool is_there = bin.at > from && bin.at < to;
    if (is_there) bin.darkness += amplitude * std::sin(2 * std::numbers::pi * bin.at / 2.5);
  }
  return profile;
}

}  // namespace

TEST_CASE("a corrupted digit makes the reading doubtful, a clear one does not") {
  ImagingModel image;
  image.blur = 0.4;
  const auto odds_of = [&](const ScanProfile& profile) {
    return odds_of_corrupted(profile, image);
  };
  const ScanProfile clear = profile_of(kDigits, image, 1e-4);
  CHECK(odds_of(clear) < 1e-9);
  // Two modules of one digit at half of the contrast: it may have been another one.
  ScanProfile corrupted = clear;
  for (ScanBin& bin : corrupted) {
    const int first = first_module_of_digit(2);
    if (bin.at > first + 2 && bin.at < first + 4) bin.darkness = 0.5;
  }
  CHECK(odds_of(corrupted) > 1e-3);
}

TEST_CASE("what most digits show alike is noise, in one alone it makes the reading doubtful") {
  ImagingModel image;
  image.blur = 0.8;
  const ScanProfile clear = profile_of(kDigits, image, 1e-4);
  const double of_one = odds_of_corrupted(with_waves(clear, 0.1, 3, 3), image);
  const double of_all = odds_of_corrupted(with_waves(clear, 0.1, 0, 11), image);
  CHECK(of_one > 0.01);
  CHECK(of_all < of_one / 1000);
}

TEST_CASE("a clear profile leaves one way in which its symbol may run") {
  ImagingModel image;
  image.blur = 0.4;
  const ScanProfile clear = profile_of(kDigits, image, 1e-4);
  const PossibleWays ways = possible_ways(clear, DecodingStart(clear, image).costs);
  CHECK(ways.up);
  CHECK_FALSE(ways.down);
  const ScanProfile reversed = turned(clear);
  CHECK(reversed.front().at == doctest::Approx(kModuleCount - clear.back().at));
  const PossibleWays other = possible_ways(reversed, DecodingStart(reversed, image).costs);
  CHECK_FALSE(other.up);
  CHECK(other.down);
}

TEST_CASE("the noise of a part is that of the modules it shows") {
  std::array<float, kModuleCount> misfits{};
  ModulesShown shown{};
  for (std::size_t k = 0; k < misfits.size(); ++k) {
    shown[k] = k < 40;
    misfits[k] = shown[k] ? 1.0F : 100.0F;
  }
  const VarianceFactors factors = variance_factors_of(misfits, shown);
  CHECK(factors.common == doctest::Approx(1 / 0.44));
  // About the last module shown no hidden one counts.
  CHECK(factors.local[39] > 1);
  CHECK(factors.local[39] < factors.common);
  CHECK(variance_factors_of(misfits, all_modules()).common > 10 * factors.common);
}

TEST_CASE("a part of a symbol says the digits that are certain, and what contradicts a code") {
  ImagingModel image;
  image.blur = 0.4;
  const ScanProfile clear = profile_of(kDigits, image, 1e-4);
  const std::vector<Digits> book{kDigits, *parse_digits("050806630604")};
  const DecodeOptions options{{}, book};
  const auto changed = [&](int digit, const auto& change) {
    ScanProfile profile = clear;
    for (ScanBin& bin : profile) {
      const double into = bin.at - first_module_of_digit(digit);
      if (into > 2 && into < 4) change(bin);
    }
    return decode_part(profile, image, options);
  };
  const auto whole = decode_part(clear, image, options);
  REQUIRE(whole);
  CHECK(std::ranges::count(whole->certain, true) == 12);
  CHECK(whole->candidates.size() == 1);
  // Two modules that nothing shows, and two of mid grey, which may have been anything.
  const auto hidden = changed(2, [](ScanBin& bin) { bin.variance = kHiddenVariance; });
  const auto grey = changed(2, [](ScanBin& bin) { bin.darkness = 0.5; });
  for (const auto& part : {hidden, grey}) {
    REQUIRE(part);
    CHECK_FALSE(part->certain[2]);
    CHECK(std::ranges::count(part->certain, true) >= 10);
    CHECK(part->candidates.front().digits == kDigits);
    CHECK(part->decoding.confidence > 1 - 1e-6);
  }
  // The same modules of the other colour are no digit of this code.
  const auto other = changed(2, [](ScanBin& bin) { bin.darkness = 1 - bin.darkness; });
  REQUIRE(other);
  CHECK(other->decoding.confidence < 0.99);
}

TEST_CASE("what nothing is known of may be any digit") {
  std::array<DigitModules, kDigitCount> nothing{};
  Characters digits{};
  // Nine others, each as likely as it is that a digit is corrupted: a thousandth.
  for (const double odds : odds_of_corrupted_digits(nothing, digits)) {
    CHECK(odds == doctest::Approx(9 * 0.001 / 1.021).epsilon(1e-6));
  }
}

TEST_CASE("loops over rows of places do what plain loops do") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(0, 1);
  std::vector<float> darkness(120), shown(30);
  for (float& at : darkness) at = value(random);
  for (float& at : shown) at = value(random);
  const PlaceRow row = products(darkness.data(), shown.data(), shown.size());
  for (std::size_t i = 0; i < kPlaceRow; ++i) {
    const float sum = std::inner_product(shown.begin(), shown.end(),
                                         darkness.begin() + static_cast<std::ptrdiff_t>(i), 0.0F);
    CHECK(row[i] == doctest::Approx(sum));
  }
  PlaceRows costs = filled_rows(kFarCost);
  WidthPenalties penalties{};
  for (std::size_t width = 0; width < kWidthCount; ++width) {
    for (std::size_t i = 0; i < kPlaceCount; ++i) costs[width][i] = value(random);
    for (float& penalty : penalties[width]) penalty = value(random);
  }
  const PlaceRows least = least_onwards(costs, penalties);
  float least_of_all = kFarCost;
  for (std::size_t from = 0; from < kWidthCount; ++from) {
    for (std::size_t i = 0; i < kPlaceCount; ++i) {
      float expected = kFarCost;
      for (std::size_t to = 0; to < kWidthCount; ++to) {
        expected = std::min(expected, costs[to][i] + penalties[from][to]);
      }
      CHECK(least[from][i] == expected);
      least_of_all = std::min(least_of_all, costs[from][i]);
    }
  }
  CHECK(least_of(costs) == least_of_all);
  CHECK(least_sum(costs[0], costs[1]) <= costs[0][5] + costs[1][5]);
}

TEST_CASE("a symbol's place on a line is where its first bar begins") {
  for (const double module : {2.0, 3.3}) {
    CAPTURE(module);
    const ScanLine line = line_of(kDigits, module, 40 * module, static_cast<int>(180 * module));
    const auto places = find_symbol_places(line, 0.7 * module, 1.4 * module, 3);
    REQUIRE(!places.empty());
    CHECK(places[0].begin == doctest::Approx(40 * module).epsilon(0.01));
    CHECK(std::abs(places[0].module) == doctest::Approx(module).epsilon(0.01));
    CHECK(places[0].cost < 0.5 * kPlace.worst);
  }
  ScanLine empty(400, 0.5F);
  CHECK(find_symbol_places(empty, 1, 4, 3).empty());
}

TEST_CASE("a line that is registered roughly is read with its digits' rivals") {
  constexpr double kModule = 4;
  const ScanLine line = line_of(kDigits, kModule, 120, 640);
  const BarTemplates templates({0.5, 0});
  // Two modules and two percent off.
  const SymbolPlace rough{128, 1.02 * kModule, 0};
  const auto placed = placed_line(line, rough);
  REQUIRE(placed);
  const auto reading = read_elastic(*placed, templates);
  REQUIRE(reading);
  CHECK(reading->digits == kDigits);
  CHECK(reading->alignment.cost_per_module < 2);
  CHECK(std::abs(reading->alignment.boundaries.front() - 120) < kModule / 2);
  CHECK(std::abs(reading->alignment.boundaries.back() - (120 + 95 * kModule)) < kModule / 2);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    for (std::size_t d = 0; d < 10; ++d) {
      if (d == kDigits[i]) CHECK(reading->extra_cost[i][d] == doctest::Approx(0));
      if (d != kDigits[i]) CHECK(reading->extra_cost[i][d] > 3);
    }
  }
  CHECK(elastic_cost(*placed, templates) ==
        doctest::Approx(reading->alignment.cost_per_module).epsilon(1e-3));
  const auto known = align_elastic(line, rough, templates, kDigits);
  REQUIRE(known);
  for (std::size_t i = 0; i < known->boundaries.size(); ++i) {
    CHECK(known->boundaries[i] == doctest::Approx(reading->alignment.boundaries[i]).epsilon(1e-3));
  }
  CHECK(!placed_line(line, {600, kModule, 0}));
}
