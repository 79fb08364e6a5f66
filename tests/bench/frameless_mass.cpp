// SPDX-License-Identifier: Apache-2.0
// Looks for wrong readings of symbols without a frame: rendered UPC-A symbols degraded at random in
// every way at once, and other patterns of bars: EAN-13, wrong check digits, random bars of UPC-A's
// length, Code 128 and UPC-E like bars. Tables the stated confidence against what was right. Usage:
// bench_frameless_mass [SYMBOLS] [SEED]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "decoder/reader/frameless.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tests/support/bar_picture.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::BarPicture;

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

int integer(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

enum class Kind { upca, wrong_check, ean13, random_bars, eleven_modules, short_symbol, count };
constexpr std::array<const char*, 6> kNames{"UPC-A",       "wrong check digit", "EAN-13",
                                            "random bars", "Code 128 like",     "UPC-E like"};

Digits random_code(Random& random) {
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(integer(random, 0, 9));
  digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
  return digits;
}

std::vector<int> elements(const Digits& digits) {
  const auto widths = elements_of(digits);
  return {widths.begin(), widths.end()};
}

std::vector<int> ean13(const Digits& digits, Random& random) {
  std::vector<int> widths = elements(digits);
  std::array<int, 5> places{1, 2, 3, 4, 5};
  std::ranges::shuffle(places, random);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto first = widths.begin() + first_element_of_digit(places[k]);
    std::reverse(first, first + kElementsPerDigit);
  }
  return widths;
}

// Characters of six elements and eleven modules, as Code 128 has them, and a stop.
std::vector<int> eleven_modules(Random& random) {
  std::vector<int> widths;
  const int characters = integer(random, 5, 12);
  for (int c = 0; c < characters; ++c) {
    std::array<int, 6> character{1, 1, 1, 1, 1, 1};
    for (int left = 5; left > 0;) {
      int& width = character[static_cast<std::size_t>(integer(random, 0, 5))];
      if (width == 4) continue;
      ++width;
      --left;
    }
    widths.insert(widths.end(), character.begin(), character.end());
  }
  widths.insert(widths.end(), {2, 3, 3, 1, 1, 1, 2});
  return widths;
}

std::vector<int> short_symbol(const Digits& digits) {
  std::vector<int> widths = elements(digits);
  widths.resize(3 + 6 * kElementsPerDigit);
  widths.insert(widths.end(), {1, 1, 1, 1, 1, 1});
  return widths;
}

std::vector<int> widths_of(Kind kind, Digits& digits, Random& random) {
  switch (kind) {
    case Kind::wrong_check:
      digits.back() = static_cast<std::uint8_t>((digits.back() + integer(random, 1, 9)) % 10);
      return elements(digits);
    case Kind::ean13:
      return ean13(digits, random);
    case Kind::random_bars: {
      std::vector<int> widths(59);
      for (int& width : widths) width = integer(random, 1, integer(random, 2, 4));
      return widths;
    }
    case Kind::eleven_modules:
      return eleven_modules(random);
    case Kind::short_symbol:
      return short_symbol(digits);
    default:
      return elements(digits);
  }
}

BarPicture random_picture(Random& random) {
  const auto sometimes = [&](double share, double low, double high) {
    return uniform(random, 0, 1) < share ? uniform(random, low, high) : 0.0;
  };
  BarPicture how;
  how.module_px = std::exp(uniform(random, std::log(0.8), std::log(4.0)));
  how.height_modules = uniform(random, 15, 70);
  how.margin_modules = uniform(random, 4, 15);
  how.roll = uniform(random, 0, 1) < 0.5 ? uniform(random, -0.2, 0.2)
                                         : uniform(random, -std::numbers::pi, std::numbers::pi);
  how.incidence = sometimes(0.5, -0.9, 0.9);
  how.bend = sometimes(0.3, 0, 0.9);
  how.crumple = sometimes(0.3, 0, 3);
  how.blur_px = how.module_px * uniform(random, 0.15, 0.9);
  how.noise = uniform(random, 0, 1) < 0.2 ? uniform(random, 5, 25) : uniform(random, 0, 5);
  how.growth = sometimes(0.4, -0.7, 0.7);
  how.ink = uniform(random, 0.02, 0.2);
  how.paper = uniform(random, 0.3, 0.95);
  how.glare = sometimes(0.2, 0, 0.8);
  how.seed = random();
  return how;
}

struct Tally {
  int shown = 0;
  int right = 0;
  int wrong = 0;
};

// Stated confidence, as the power of ten of its complement, against right and wrong best guesses.
using Reliability = std::map<int, std::array<int, 2>>;

class Trials {
 public:
  void run(std::uint64_t seed) {
    Random random(seed);
    const Kind kind =
        uniform(random, 0, 1) < 0.5
            ? Kind::upca
            : static_cast<Kind>(integer(random, 1, static_cast<int>(Kind::count) - 1));
    Digits digits = random_code(random);
    const std::vector<int> widths = widths_of(kind, digits, random);
    const BarPicture how = random_picture(random);
    const GrayImage image = tagsmith::detail::test::picture_of(widths, how);
    ReadOptions options;
    options.min_confidence = 0.5;
    const FramelessResult result = read_frameless(image.view(), options);
    note(kind, digits, result, seed);
  }

  void print() const {
    fmt::print("{:20} {:>8} {:>8} {:>8}\n", "shown", "symbols", "right", "wrong");
    for (std::size_t i = 0; i < tallies_.size(); ++i) {
      fmt::print("{:20} {:8} {:8} {:8}\n", kNames[i], tallies_[i].shown, tallies_[i].right,
                 tallies_[i].wrong);
    }
    fmt::print("\nconfidence          right    wrong\n");
    for (const auto& [power, counts] : reliability_) {
      fmt::print("1 - 1e-{:<2}        {:8} {:8}\n", power, counts[0], counts[1]);
    }
  }

 private:
  void note(Kind kind, const Digits& digits, const FramelessResult& result, std::uint64_t seed) {
    const std::lock_guard lock(mutex_);
    Tally& tally = tallies_[static_cast<std::size_t>(kind)];
    ++tally.shown;
    for (const FramelessReading& reading : result.read) {
      const bool right = kind == Kind::upca && reading.digits == digits;
      const int power =
          std::min(15, static_cast<int>(-std::log10(std::max(1e-16, 1 - reading.confidence))));
      ++reliability_[power][right ? 0 : 1];
      if (reading.confidence < kSureWithoutFrame) continue;
      ++(right ? tally.right : tally.wrong);
      if (!right) {
        fmt::print("seed {}: {} read as {} ({}), confidence 1 - {:.1e}\n", seed, to_string(digits),
                   to_string(reading.digits), kNames[static_cast<std::size_t>(kind)],
                   1 - reading.confidence);
      }
    }
  }

  std::mutex mutex_;
  std::array<Tally, static_cast<std::size_t>(Kind::count)> tallies_{};
  Reliability reliability_;
};

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 2000;
  const std::uint64_t first_seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  Trials trials;
  tbb::parallel_for(0, count,
                    [&](int i) { trials.run(first_seed + static_cast<std::uint64_t>(i)); });
  trials.print();
}
