// SPDX-License-Identifier: Apache-2.0
// Costs of characters and sums over symbols against direct computation.
#include "decoder/scan/characters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/scan/decode.hpp"
#include "decoder/scan/explanation.hpp"
#include "decoder/scan/module_equations.hpp"
#include "decoder/scan/symbol_search.hpp"

using namespace tagsmith::detail;

namespace {

Digits random_code(std::mt19937& random) {
  std::uniform_int_distribution<int> digit(0, 9);
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(digit(random));
  digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
  return digits;
}

// What the image of these digits gives, with noise.
ScanProfile profile_of(const ImagingModel& image, const Digits& digits, double per_module,
                       std::mt19937& random) {
  constexpr double kSigma = 0.03;
  std::normal_distribution<double> noise(0, kSigma);
  ScanProfile profile;
  for (double at = -4; at < 99; at += 1 / per_module) profile.push_back({at, 0, 9e-4, 1});
  const std::vector<double> expected = expected_darkness(image, digits, profile);
  for (std::size_t i = 0; i < profile.size(); ++i) {
    profile[i].darkness = expected[i] + noise(random);
  }
  return profile;
}

ModuleNormalEquations system_of(const ScanProfile& profile, const ImagingModel& image,
                                const NuisanceCovariance& slack = {}) {
  return ModuleNormalEquations(profile, ModuleLight(profile, image), slack);
}

// The darkness of a symbol whose digit at `position` has its widths reversed, unblurred beyond the
// profile's own sampling: exact area of bars in each place.
ScanProfile foreign_profile(const Digits& digits, int position, double per_module) {
  auto elements = elements_of(digits);
  const auto first = elements.begin() + first_element_of_digit(position);
  std::reverse(first, first + kElementsPerDigit);
  ScanProfile profile;
  for (double at = -4; at < 99; at += 1 / per_module) {
    const double begin = at - 0.5 / per_module, end = at + 0.5 / per_module;
    double edge = 0, dark = 0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const double next = edge + elements[i];
      if (i % 2 == 0) dark += std::max(0.0, std::min(end, next) - std::max(begin, edge));
      edge = next;
    }
    profile.push_back({at, dark * per_module, 4e-4, 1});
  }
  return profile;
}

}  // namespace

TEST_CASE("costs of characters add up to the sum of squared residuals") {
  std::mt19937 random(21);
  for (const double blur : {0.25, 0.6, 1.2}) {
    for (const double growth : {-0.4, 0.0, 0.4}) {
      CAPTURE(blur);
      CAPTURE(growth);
      const ImagingModel image{blur, 0.1, 0.002, -0.1, growth, 0.05, 0.95, 0.03};
      const Digits shown = random_code(random);
      const ScanProfile profile = profile_of(image, shown, 3, random);
      const CharacterCosts costs = system_of(profile, image).character_costs();
      for (int i = 0; i < 5; ++i) {
        const Digits digits = i == 0 ? shown : random_code(random);
        const std::vector<double> expected = expected_darkness(image, digits, profile);
        double direct = 0;
        for (std::size_t k = 0; k < profile.size(); ++k) {
          const double residual = profile[k].darkness - expected[k];
          direct += residual * residual / profile[k].variance;
        }
        // Blur beyond the next character is left out, which matters where it is widest.
        const double tolerance = 0.5 + (blur > 1 ? 0.01 : 1e-3) * direct;
        CHECK(std::abs(costs.of(characters_of(digits)) - direct) < tolerance);
      }
    }
  }
}

TEST_CASE("the best symbol is found among all, and its code among the valid ones") {
  std::mt19937 random(22);
  for (int i = 0; i < 20; ++i) {
    const Digits digits = random_code(random);
    ImagingModel image;
    image.blur = 0.5;
    const CharacterCosts costs =
        system_of(profile_of(image, digits, 3, random), image).character_costs();
    const Characters characters = characters_of(digits);
    CHECK(best_symbol(costs, SymbolClass::upright).characters == characters);
    CHECK(best_symbol(costs, SymbolClass::any).characters == characters);
    CHECK(best_code(costs, CheckDigit::gs1).characters == characters);
    CHECK(best_symbol(costs, SymbolClass::upside_down).cost > costs.of(characters));
  }
}

TEST_CASE("sums over symbols are those of independent characters where pairs cost nothing") {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> any(0, 12);
  CharacterCosts costs;
  for (auto& row : costs.alone) {
    for (double& cost : row) cost = any(random);
  }
  const BestSymbol best = best_symbol(costs, SymbolClass::upright);
  const CharacterWeights weights{0.5, 0.1};
  double product = 1;
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    double sum = 0;
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      const double weight =
          c == best.characters[i] ? 1 : (c < 10 ? weights.digit : weights.foreign);
      const double excess = costs.alone[i][c] - costs.alone[i][best.characters[i]];
      sum += weight * std::exp(-excess / 2);
    }
    product *= sum;
  }
  CHECK(sum_of_symbols(costs, best, weights) == doctest::Approx(product).epsilon(1e-6));
  // A tenth of all strings of digits holds under a scheme when all are alike.
  CharacterCosts flat;
  const BestSymbol zeros{};
  for (const CheckDigit scheme : {CheckDigit::sum10, CheckDigit::gs1}) {
    CHECK(sum_of_codes(flat, zeros, scheme) == doctest::Approx(1e11));
  }
}

TEST_CASE("the least cost of all other symbols is that without one of the symbol's characters") {
  std::mt19937 random(25);
  std::uniform_real_distribution<double> any(0, 12);
  for (int trial = 0; trial < 20; ++trial) {
    CAPTURE(trial);
    CharacterCosts costs;
    for (auto& row : costs.alone) {
      for (double& cost : row) cost = any(random);
    }
    for (auto& rows : costs.pair) {
      for (auto& row : rows) {
        for (double& cost : row) cost = any(random);
      }
    }
    const BestSymbol best = best_symbol(costs, SymbolClass::any);
    double least = 1e300;
    for (std::size_t i = 0; i < kDigitCount; ++i) {
      CharacterCosts without = costs;
      without.alone[i][best.characters[i]] = 1e6;
      least = std::min(least, best_symbol(without, SymbolClass::any).cost);
    }
    CHECK(least_other_cost(costs, best.characters) == doctest::Approx(least));
    const Characters zeros{};
    CHECK(least_other_cost(costs, zeros) == doctest::Approx(best.cost));
  }
}

TEST_CASE("a character that is no digit is doubted at every place, with and without a book") {
  std::mt19937 random(24);
  for (int position = 0; position < kDigitCount; ++position) {
    CAPTURE(position);
    const Digits digits = random_code(random);
    const std::vector<Digits> book{digits, random_code(random)};
    for (const bool with_book : {false, true}) {
      CAPTURE(with_book);
      DecodeOptions options;
      if (with_book) options.code_book = book;
      ImagingModel start;
      start.blur = 0.2;
      const auto decoding = decode_profile(foreign_profile(digits, position, 4), start, options);
      if (decoding) CHECK(decoding->confidence < 0.5);
    }
  }
}

TEST_CASE("costs about a reference hold where blur reaches beyond the next character") {
  std::mt19937 random(26);
  const ImagingModel image{1.9, 0.1, 0.002, -0.1, 0.1, 0.05, 0.95, 0.03};
  const Digits shown = random_code(random);
  const ScanProfile profile = profile_of(image, shown, 3, random);
  const Characters reference = characters_of(shown);
  const CharacterCosts costs = system_of(profile, image).character_costs(&reference);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    Digits digits = shown;
    digits[i] = static_cast<std::uint8_t>((digits[i] + 3) % 10);
    const std::vector<double> expected = expected_darkness(image, digits, profile);
    double direct = 0;
    for (std::size_t k = 0; k < profile.size(); ++k) {
      const double residual = profile[k].darkness - expected[k];
      direct += residual * residual / profile[k].variance;
    }
    CHECK(costs.of(characters_of(digits)) == doctest::Approx(direct).epsilon(0.003));
  }
}

TEST_CASE("with slack, the picture adapts to every symbol as a fit does") {
  std::mt19937 random(27);
  ImagingModel image;
  image.blur = 1.8;
  const Digits shown = random_code(random);
  ScanProfile profile = profile_of(image, shown, 3, random);
  for (ScanBin& bin : profile) bin.variance *= 10;  // a fit moves little: it is nearly linear
  const SymbolFit fit = fit_symbol(profile, shown, image);
  const NuisanceCovariance slack =
      nuisance_covariance(profile, fit.image, bar_shares(profile, fit.image, shown));
  const Characters reference = characters_of(shown);
  const auto adapted = system_of(profile, fit.image, slack).character_costs(&reference);
  const auto rigid = system_of(profile, fit.image).character_costs(&reference);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    Digits digits = shown;
    digits[i] = static_cast<std::uint8_t>((digits[i] + 1) % 10);
    const double fitted = fit_symbol(profile, digits, fit.image).cost;
    const Characters characters = characters_of(digits);
    CAPTURE(i);
    CHECK(adapted.of(characters) < rigid.of(characters));
    CHECK(adapted.of(characters) == doctest::Approx(fitted).epsilon(0.15));
  }
  CHECK(adapted.of(reference) == doctest::Approx(rigid.of(reference)));
}

TEST_CASE("a digit between two digits may be either") {
  std::mt19937 random(25);
  ImagingModel image;
  image.blur = 0.3;
  const Digits digits = random_code(random);
  const Characters characters = characters_of(digits);
  const ScanProfile profile = profile_of(image, digits, 4, random);
  CHECK(std::ranges::max(system_of(profile, image).odds_of_corrupted_digits(characters)) < 1e-8);
  Digits other = digits;
  other[4] = static_cast<std::uint8_t>((other[4] + 5) % 10);
  const std::vector<double> there = expected_darkness(image, other, profile);
  ScanProfile between = profile;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    between[i].darkness = 0.55 * profile[i].darkness + 0.45 * there[i];
  }
  CHECK(system_of(between, image).odds_of_corrupted_digits(characters)[4] > 0.01);
}

TEST_CASE("the noise that the symbol leaves decides how sure it is") {
  std::mt19937 random(28);
  const Digits digits = random_code(random);
  ImagingModel image;
  image.blur = 1.3;
  const auto doubt_with = [&](double noise) {
    std::mt19937 draw(29);
    std::normal_distribution<double> deviate(0, noise);
    ScanProfile profile = profile_of(image, digits, 3, draw);
    for (ScanBin& bin : profile) {
      bin.darkness += deviate(draw);
      bin.variance = 1e-4;
    }
    const auto decoding = decode_profile(profile, image, {CheckDigit::gs1, {}});
    return decoding && decoding->digits == digits ? 1 - decoding->confidence : 1.0;
  };
  CHECK(doubt_with(0.01) < 1e-4);
  CHECK(doubt_with(0.2) > 0.01);
}
