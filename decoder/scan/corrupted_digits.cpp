// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/corrupted_digits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/scan/tuning.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kModules = DigitModules::kModules;
constexpr std::size_t kDigits = 10;

// Several digits side by side.
constexpr std::size_t kDigitLanes = 4;
static_assert(kDigitCount % kDigitLanes == 0);
using Lanes = Eigen::Array<double, kDigitLanes, 1>;
using Modules = std::array<Lanes, kModules>;
using Block = std::array<Modules, kModules>;

struct SideBySide {
  Modules residuals;
  Block products;
  std::array<Modules, kDigits> changes;  // of each digit's modules from these
};

SideBySide side_by_side(const std::array<DigitModules, kDigitCount>& modules,
                        const Characters& digits, std::size_t first) {
  SideBySide lanes;
  for (std::size_t k = 0; k < kDigitLanes; ++k) {
    const std::size_t position = first + k;
    const auto lane = static_cast<Eigen::Index>(k);
    const bool right_half = position >= 6;
    const auto& own = modules_of_character(right_half, digits[position]);
    for (std::size_t i = 0; i < kModules; ++i) {
      lanes.residuals[i][lane] = modules[position].residuals[i];
      for (std::size_t j = 0; j < kModules; ++j) {
        lanes.products[i][j][lane] = modules[position].products[i][j];
      }
    }
    for (std::size_t other = 0; other < kDigits; ++other) {
      const auto& others = modules_of_character(right_half, other);
      for (std::size_t i = 0; i < kModules; ++i) {
        lanes.changes[other][i][lane] =
            static_cast<double>(others[i]) - static_cast<double>(own[i]);
      }
    }
  }
  return lanes;
}

// The modules free to differ by so much: the lower factor of what holds them, and the logarithm of
// the share that they fill of the volume that they might.
struct Freed {
  Block lower;
  Modules per_diagonal;
  Lanes log_volume;
};

Freed free_modules(const Block& products, double sigma) {
  Freed freed;
  Lanes spread = Lanes::Ones();
  for (std::size_t j = 0; j < kModules; ++j) {
    Lanes square = products[j][j] + 1 / (sigma * sigma);
    for (std::size_t k = 0; k < j; ++k) square -= freed.lower[j][k] * freed.lower[j][k];
    const Lanes diagonal = square.sqrt();
    spread *= sigma * diagonal;
    freed.per_diagonal[j] = 1 / diagonal;
    for (std::size_t i = j + 1; i < kModules; ++i) {
      Lanes sum = products[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= freed.lower[i][k] * freed.lower[j][k];
      freed.lower[i][j] = sum * freed.per_diagonal[j];
    }
  }
  freed.log_volume = -spread.log();
  return freed;
}

// Logarithm of the likelihood of residuals, but for what they cost where nothing is free.
Lanes log_freed(const Freed& freed, const Modules& residuals) {
  Modules solved;
  Lanes square = Lanes::Zero();
  for (std::size_t i = 0; i < kModules; ++i) {
    Lanes value = residuals[i];
    for (std::size_t k = 0; k < i; ++k) value -= freed.lower[i][k] * solved[k];
    solved[i] = value * freed.per_diagonal[i];
    square += solved[i] * solved[i];
  }
  return square / 2 + freed.log_volume;
}

// Logarithms of likelihoods relative to the digit itself, all even.
struct LogLikelihoods {
  Lanes even, uneven, corrupted;       // the digit
  std::array<Lanes, kDigits> changed;  // other digits, corrupted
};

LogLikelihoods log_likelihoods(const SideBySide& digits) {
  LogLikelihoods logs;
  logs.even = log_freed(free_modules(digits.products, kOdds.even_sigma), digits.residuals);
  logs.uneven = log_freed(free_modules(digits.products, kOdds.uneven_sigma), digits.residuals);
  const Freed corrupted = free_modules(digits.products, kOdds.corrupted_sigma);
  logs.corrupted = log_freed(corrupted, digits.residuals);
  for (std::size_t other = 0; other < kDigits; ++other) {
    const Modules& change = digits.changes[other];
    Modules left;
    Lanes cost = Lanes::Zero();
    for (std::size_t i = 0; i < kModules; ++i) {
      Lanes pull = Lanes::Zero();
      for (std::size_t j = 0; j < kModules; ++j) pull += digits.products[i][j] * change[j];
      left[i] = digits.residuals[i] - pull;
      cost += change[i] * (pull - 2 * digits.residuals[i]);
    }
    logs.changed[other] = log_freed(corrupted, left) - cost / 2;
  }
  return logs;
}

double odds_against(const LogLikelihoods& logs, Eigen::Index lane, std::size_t digit) {
  const double log_even = logs.even[lane];
  const double log_uneven = std::log(kOdds.uneven) + logs.uneven[lane];
  const double log_spoilt = std::log(kOdds.corrupted) + logs.corrupted[lane];
  const double greatest = std::max({log_even, log_uneven, log_spoilt});
  const double right = std::exp(log_even - greatest) + std::exp(log_uneven - greatest) +
                       std::exp(log_spoilt - greatest);
  double wrong = 0;
  for (std::size_t other = 0; other < kDigits; ++other) {
    if (other != digit) wrong += kOdds.corrupted * std::exp(logs.changed[other][lane] - greatest);
  }
  return wrong / right;
}

// What a digit's modules leave unexplained when they are free, over what noise alone would leave of
// the two thirds of digits where it is least. Nothing where next to nothing of the digit is seen.
std::optional<double> unexplained_by(const DigitModules& digit) {
  using Square = Eigen::Matrix<double, kModules, kModules, Eigen::RowMajor>;
  constexpr double kLeastDegrees = 1;
  const Eigen::Map<const Square> products(digit.products.front().data());
  const Eigen::Map<const Eigen::Vector<double, kModules>> residuals(digit.residuals.data());
  Square free = products;
  free.diagonal().array() += 1 / (kOdds.corrupted_sigma * kOdds.corrupted_sigma);
  const Eigen::LLT<Square> factors(free);
  const double degrees = factors.solve(products).trace();
  if (!(degrees > kLeastDegrees)) return std::nullopt;
  // The mean of the lesser two thirds of chi-square variables over their degrees of freedom.
  const double expected = 1 - 0.745 / std::sqrt(degrees);
  return residuals.dot(factors.solve(residuals)) / degrees / expected;
}

// The noise in what the modules of digits tell, at least 1: what most digits leave unexplained
// there is no corruption. It is more than the noise of the symbol where errors are alike over two
// or three modules, which free modules show enlarged by what the blur took from them.
double noise_of_free_modules(const std::array<DigitModules, kDigitCount>& digits) {
  std::vector<double> ratios;
  for (const DigitModules& digit : digits) {
    if (const auto ratio = unexplained_by(digit)) ratios.push_back(*ratio);
  }
  std::ranges::sort(ratios);
  const std::size_t clear = ratios.size() * 2 / 3;
  if (clear == 0) return 1;
  const double sum =
      std::accumulate(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(clear), 0.0);
  return std::max(1.0, sum / static_cast<double>(clear));
}

std::array<DigitModules, kDigitCount> with_noise(std::array<DigitModules, kDigitCount> digits,
                                                 double noise) {
  for (DigitModules& digit : digits) {
    for (double& residual : digit.residuals) residual /= noise;
    for (auto& row : digit.products) {
      for (double& product : row) product /= noise;
    }
  }
  return digits;
}

}  // namespace

// Why: docs/decisions/0003-confidence-and-its-border.md.
std::array<double, kDigitCount> odds_of_corrupted_digits(
    const std::array<DigitModules, kDigitCount>& seen, const Characters& digits) {
  const std::array<DigitModules, kDigitCount> modules =
      with_noise(seen, noise_of_free_modules(seen));
  std::array<double, kDigitCount> odds{};
  for (std::size_t first = 0; first < kDigitCount; first += kDigitLanes) {
    const LogLikelihoods logs = log_likelihoods(side_by_side(modules, digits, first));
    for (std::size_t k = 0; k < kDigitLanes; ++k)
      odds[first + k] = odds_against(logs, static_cast<Eigen::Index>(k), digits[first + k]);
  }
  return odds;
}

}  // namespace tagsmith::detail
