// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/decode.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/scan/explanation.hpp"
#include "tagsmith/symbology/upca.hpp"

using namespace tagsmith::detail;

namespace {

// Darkness along a symbol by brute force: box-sampled modules, blurred by summing a fine Gaussian.
// Independent of the code under test on purpose.
double blurred_modules(const Digits& digits, double place, double blur) {
  const auto modules = modules_of(digits);
  constexpr int kSteps = 200;
  double sum = 0, weight = 0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double offset = 5 * blur * i / kSteps;
    const double w = std::exp(-0.5 * offset * offset / (blur * blur));
    const double at = place + offset;
    if (at >= 0 && at < kModuleCount) sum += w * modules[static_cast<std::size_t>(at)];
    weight += w;
  }
  return sum / weight;
}

Digits random_code(std::mt19937& random, CheckDigit scheme) {
  std::uniform_int_distribution<int> digit(0, 9);
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(digit(random));
  digits.back() = check_digit(scheme, std::span(digits).first<11>());
  return digits;
}

struct Degradation {
  double blur = 0.4;
  double noise = 0.02;
  double shift = 0;
  double stretch = 0;
  double per_module = 4;
};

ScanProfile make_profile(const Digits& digits, const Degradation& how, std::mt19937& random) {
  std::normal_distribution<double> noise(0, how.noise);
  ScanProfile profile;
  for (double at = -4; at < 99; at += 1 / how.per_module) {
    const double place = (at - how.shift - 47.5) / (1 + how.stretch) + 47.5;
    profile.push_back(
        {at, blurred_modules(digits, place, how.blur) + noise(random), how.noise * how.noise, 1});
  }
  return profile;
}

ImagingModel start_with(double blur) {
  ImagingModel start;
  start.blur = blur;
  return start;
}

}  // namespace

TEST_CASE("profiles are decoded under blur, noise and small misplacement") {
  struct Case {
    const char* name;
    Degradation how;
  };
  const Case cases[] = {
      {"sharp", {0.15, 0.01, 0, 0, 8}},
      {"blurred by a module", {1.0, 0.01, 0, 0, 4}},
      {"noisy", {0.4, 0.12, 0, 0, 6}},
      {"shifted a quarter module", {0.4, 0.02, 0.25, 0, 4}},
      {"stretched by half a percent", {0.4, 0.02, 0, 0.005, 4}},
      {"half a sample a module", {1.2, 0.004, 0, 0, 1.5}},
  };
  std::mt19937 random(7);
  for (const Case& example : cases) {
    CAPTURE(example.name);
    for (const CheckDigit scheme : {CheckDigit::sum10, CheckDigit::gs1}) {
      for (int i = 0; i < 5; ++i) {
        const Digits digits = random_code(random, scheme);
        CAPTURE(to_string(digits));
        const ScanProfile profile = make_profile(digits, example.how, random);
        DecodeOptions options;
        options.check = scheme;
        const auto decoding = decode_profile(profile, start_with(example.how.blur), options);
        REQUIRE(decoding.has_value());
        CHECK(to_string(decoding->digits) == to_string(digits));
        CHECK(decoding->confidence > 0.999);
      }
    }
  }
}

TEST_CASE("bars that are blurred three times as much as the frame's sides are decoded") {
  std::mt19937 random(31);
  const double of_sides = 0.3;
  for (int i = 0; i < 5; ++i) {
    const Digits digits = random_code(random, CheckDigit::gs1);
    CAPTURE(to_string(digits));
    const ScanProfile profile = make_profile(digits, {3 * of_sides, 0.005, 0, 0, 4}, random);
    const auto decoding = decode_profile(profile, start_with(of_sides), {});
    REQUIRE(decoding.has_value());
    CHECK(to_string(decoding->digits) == to_string(digits));
    CHECK(decoding->fit.image.blur == doctest::Approx(3 * of_sides).epsilon(0.05));
  }
}

TEST_CASE("a symbol whose check digit fails is never certain") {
  std::mt19937 random(8);
  for (int i = 0; i < 20; ++i) {
    Digits digits = random_code(random, CheckDigit::gs1);
    digits[4] = static_cast<std::uint8_t>((digits[4] + 1) % 10);
    CAPTURE(to_string(digits));
    DecodeOptions options;
    options.check = CheckDigit::gs1;
    const auto decoding =
        decode_profile(make_profile(digits, {}, random), start_with(0.4), options);
    if (decoding) CHECK(decoding->confidence < 1e-6);
  }
}

TEST_CASE("a corrupted digit can make a code of the other scheme unless both hold") {
  std::mt19937 random(17);
  int both = 0;
  for (int i = 0; i < 60; ++i) {
    const Digits code = random_code(random, CheckDigit::gs1);
    const ScanProfile profile = make_profile(code, {0.8, 0.05}, random);
    const auto named = decode_profile(profile, start_with(0.8), {CheckDigit::gs1, {}});
    const auto either = decode_profile(profile, start_with(0.8), {});
    REQUIRE(named);
    REQUIRE(either);
    REQUIRE(named->digits == code);
    REQUIRE(either->digits == code);
    if (has_check_digit(CheckDigit::sum10, code)) {
      ++both;
      CHECK(either->doubt.corrupted_digits == doctest::Approx(named->doubt.corrupted_digits));
    } else {
      CHECK(either->doubt.corrupted_digits > 10 * named->doubt.corrupted_digits);
    }
  }
  CHECK(both > 0);
}

TEST_CASE("a single digit that is a little off in a clean symbol is doubted") {
  constexpr double kBlur = 1.1;
  const Digits code = *parse_digits("019002400404"), other = *parse_digits("019002700404");
  std::mt19937 random(19);
  // The code's digit goes so far towards the other's.
  const auto odds_of = [&](double share) {
    ScanProfile profile = make_profile(code, {kBlur, 0.004, 0, 0, 3}, random);
    for (ScanBin& bin : profile) {
      bin.darkness +=
          share * (blurred_modules(other, bin.at, kBlur) - blurred_modules(code, bin.at, kBlur));
    }
    const auto decoding = decode_profile(profile, start_with(kBlur), {});
    REQUIRE(decoding);
    REQUIRE(decoding->digits == code);
    return decoding->doubt.corrupted_digits;
  };
  CHECK(odds_of(0) < 1e-9);
  CHECK(odds_of(0.15) > 5e-6);
  CHECK(odds_of(0.25) > 2e-4);
}

TEST_CASE("a code book decides what the profile alone cannot, and hides nothing") {
  std::mt19937 random(9);
  std::vector<Digits> book;
  for (int i = 0; i < 16; ++i) book.push_back(random_code(random, CheckDigit::sum10));
  const Degradation far{2.0, 0.01, 0, 0, 1};
  DecodeOptions with_book;
  with_book.code_book = book;
  for (const Digits& digits : book) {
    CAPTURE(to_string(digits));
    const auto decoding =
        decode_profile(make_profile(digits, far, random), start_with(far.blur), with_book);
    REQUIRE(decoding.has_value());
    CHECK(to_string(decoding->digits) == to_string(digits));
    CHECK(decoding->confidence > 0.99);
  }
  const Digits stranger = random_code(random, CheckDigit::sum10);
  const auto decoding =
      decode_profile(make_profile(stranger, {}, random), start_with(0.4), with_book);
  if (decoding) CHECK((decoding->confidence < 1e-6 || decoding->fit.explained < 0.8));
}

TEST_CASE("growth is measured, not mistaken for other digits") {
  std::mt19937 random(10);
  for (const double growth : {-0.4, -0.2, 0.2, 0.4}) {
    CAPTURE(growth);
    const Digits digits = *parse_digits("172817281724");
    REQUIRE(has_check_digit(CheckDigit::sum10, digits) == false);
    Digits code = digits;
    code.back() = check_digit(CheckDigit::sum10, std::span(code).first<11>());
    ImagingModel grown = start_with(0.3);
    grown.growth = growth;
    ScanProfile profile = make_profile(code, {0.3, 0.01, 0, 0, 6}, random);
    const std::vector<double> expected = expected_darkness(grown, code, profile);
    for (std::size_t i = 0; i < profile.size(); ++i) profile[i].darkness = expected[i];
    DecodeOptions options;
    options.check = CheckDigit::sum10;
    const auto decoding = decode_profile(profile, start_with(0.3), options);
    REQUIRE(decoding.has_value());
    CHECK(to_string(decoding->digits) == to_string(code));
    CHECK(decoding->fit.image.growth == doctest::Approx(growth).epsilon(0.05));
  }
}

TEST_CASE("profiles without a symbol are refused or doubted") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < 50; ++i) {
    ScanProfile profile;
    double level = 0;
    for (double at = -4; at < 99; at += 0.25) {
      if (any(random) < 0.15) level = 1 - level;
      profile.push_back({at, level, 1e-4, 1});
    }
    const auto decoding = decode_profile(profile, start_with(0.3), {});
    if (decoding) CHECK((decoding->fit.explained < 0.9 || decoding->guards < 0.8));
  }
  CHECK_FALSE(decode_profile({}, start_with(0.3), {}).has_value());
}

TEST_CASE("a profile of a symbol contradicts the digits of another alone, either way up") {
  std::mt19937 random(72);
  const Degradation how{0.4, 0.05, 0, 0, 4};
  for (int i = 0; i < 5; ++i) {
    const Digits digits = random_code(random, CheckDigit::gs1);
    CAPTURE(to_string(digits));
    Digits other = digits;
    other[4] = static_cast<std::uint8_t>((other[4] + 1) % 10);
    const ScanProfile shown = make_profile(digits, how, random);
    ScanProfile same = make_profile(digits, how, random);
    ScanProfile odd = make_profile(other, how, random);
    const auto decoding = decode_profile(shown, start_with(how.blur), {});
    REQUIRE(decoding.has_value());
    REQUIRE(decoding->digits == digits);
    CHECK(log_odds_of_another(same, *decoding) < 1);
    CHECK(log_odds_of_another(odd, *decoding) > 10);
    Decoding turned = *decoding;
    turned.upside_down = true;
    for (ScanProfile* profile : {&same, &odd}) {
      std::ranges::reverse(*profile);
      for (ScanBin& bin : *profile) bin.at = kModuleCount - bin.at;
    }
    CHECK(log_odds_of_another(same, turned) < 1);
    CHECK(log_odds_of_another(odd, turned) > 10);
  }
}
