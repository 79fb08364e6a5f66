// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/module_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/scan/tuning.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {

// ---- Corrupted digits.

namespace {

using Modules = DigitModules::Modules;
using Square = DigitModules::Square;

Modules modules_of(bool right_half, std::size_t digit) {
  const auto& modules = modules_of_character(right_half, digit);
  return Eigen::Map<const Eigen::Vector<std::uint8_t, kModulesPerDigit>>(modules.data())
      .cast<double>();
}

// Modules that may differ by so much from those of a digit.
class Freed {
 public:
  Freed(const Square& products, double sigma)
      : information_(products + 1 / (sigma * sigma) * Square::Identity()),
        log_volume_(-(sigma * information_.matrixLLT().diagonal().array()).log().sum()) {}

  // Logarithm of the likelihood of residuals, without their cost where no module is free.
  double log_likelihood(const Modules& residuals) const {
    return information_.matrixL().solve(residuals).squaredNorm() / 2 + log_volume_;
  }

 private:
  Eigen::LLT<Square> information_;
  double log_volume_;  // the share that they fill of the volume that they might
};

double odds_against(const DigitModules& seen, bool right_half, std::size_t digit) {
  const Freed corrupted(seen.products, kOdds.corrupted_sigma);
  // All relative to the digit itself with its modules even.
  const std::array<double, 3> logs{
      Freed(seen.products, kOdds.even_sigma).log_likelihood(seen.residuals),
      Freed(seen.products, kOdds.uneven_sigma).log_likelihood(seen.residuals) +
          std::log(kOdds.uneven),
      corrupted.log_likelihood(seen.residuals) + std::log(kOdds.corrupted)};
  const double greatest = std::ranges::max(logs);
  double right = 0, wrong = 0;
  for (const double log : logs) right += std::exp(log - greatest);
  for (std::size_t other = 0; other < 10; ++other) {
    if (other == digit) continue;
    const Modules change = modules_of(right_half, other) - modules_of(right_half, digit);
    const Modules pull = seen.products * change;
    const double cost = change.dot(pull - 2 * seen.residuals);
    wrong += kOdds.corrupted *
             std::exp(corrupted.log_likelihood(seen.residuals - pull) - cost / 2 - greatest);
  }
  return wrong / right;
}

// The part that a digit's modules leave unexplained when they are free, divided by what noise alone
// would leave in the two thirds of digits with the least. Nothing where almost nothing of the digit
// is seen.
std::optional<double> unexplained_by(const DigitModules& digit) {
  constexpr double kLeastDegrees = 1;
  Square free = digit.products;
  free.diagonal().array() += 1 / (kOdds.corrupted_sigma * kOdds.corrupted_sigma);
  const Eigen::LLT<Square> factors(free);
  const double degrees = factors.solve(digit.products).trace();
  if (!(degrees > kLeastDegrees)) return std::nullopt;
  // The mean of the lesser two thirds of chi-square variables over their degrees of freedom.
  const double expected = 1 - 0.745 / std::sqrt(degrees);
  return digit.residuals.dot(factors.solve(digit.residuals)) / degrees / expected;
}

// The noise in the modules of digits, at least 1: the part that most digits leave unexplained there
// is no corruption. It is more than the noise of the symbol where errors are correlated over two or
// three modules, because free modules enlarge errors by as much as blur reduces contrast.
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

}  // namespace

// Why: docs/decisions/0003-confidence-and-refusal.md.
std::array<double, kDigitCount> odds_of_corrupted_digits(
    const std::array<DigitModules, kDigitCount>& seen, const Characters& digits) {
  const double noise = noise_of_free_modules(seen);
  std::array<double, kDigitCount> odds{};
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    const DigitModules modules{seen[i].residuals / noise, seen[i].products / noise};
    odds[i] = odds_against(modules, i >= kDigitCount / 2, digits[i]);
  }
  return odds;
}

// ---- The equations.

namespace {

constexpr std::array<std::size_t, 6> kGuardBars{0, 2, 46, 48, 92, 94};
constexpr std::size_t kLanes = ModuleLight::kLanes;

using Floats = Eigen::Array<float, kLanes, 1>;

auto floats_at(const float* from) { return Eigen::Map<const Floats>(from); }
auto floats_at(float* from) { return Eigen::Map<Floats>(from); }

}  // namespace

ModuleNormalEquations::ModuleNormalEquations(const ScanProfile& profile, const ModuleLight& light,
                                             const NuisanceCovariance& slack)
    : band_(light.band()), adapts_(!slack.empty()), pull_(kFeatures, Pull::Zero()) {
  static_assert(kSlack == kLanes);
  std::size_t most = band_;
  for (const ModuleLight::Place& place : light.places()) most = std::max(most, place.count);
  stride_ = (most + kLanes - 1) / kLanes * kLanes;
  gram_.resize(kFeatures * stride_);
  add_places(profile, light, slack);
  std::array<std::uint8_t, kFeatures> present{};
  for (const std::size_t module : kGuardBars) {
    present[2 * module] = present[2 * module + 1] = present[2 * module + 2] = 1;
  }
  for (std::size_t position = 0; position < kCharacterPlaces; ++position) {
    present[first_feature(position) - 1] = 1;
    present[first_feature(position) + kOwnFeatures] = 1;
  }
  take_out(present);
}

void ModuleNormalEquations::add_places(const ScanProfile& profile, const ModuleLight& light,
                                       const NuisanceCovariance& slack) {
  const float contrast = light.contrast();
  std::vector<float> weights(profile.size());
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const float value = light.places()[i].value;
    weights[i] = contrast * contrast / static_cast<float>(profile[i].variance);
    constant_ += weights[i] * value * value;
  }
  for (std::size_t i = 0; i < profile.size(); ++i) {
    add_place(light.places()[i], light.light(light.places()[i]), weights[i]);
    if (adapts_)
      add_pull(light.places()[i], light.light(light.places()[i]), weights[i] / contrast, slack[i]);
  }
}

// Adds one place of the weight: products of its features' light with each other and with its
// darkness.
void ModuleNormalEquations::add_place(const ModuleLight::Place& place, const float* light,
                                      float weight) {
  for (std::size_t first = 0; first < place.count; first += kLanes) {
    const Floats weighted = weight * floats_at(light + first);
    floats_at(right_.data() + place.begin + first) += weighted * place.value;
    const std::size_t end = std::min(kLanes, place.count - first);
    for (std::size_t i = 0; i < end; ++i) {
      float* row = gram_.data() + (place.begin + first + i) * stride_;
      for (std::size_t j = first + i; j < place.count; j += kLanes) {
        floats_at(row + (j - first - i)) +=
            weighted[static_cast<Eigen::Index>(i)] * floats_at(light + j);
      }
    }
  }
}

// Adds products of the light with the slack of the picture there.
void ModuleNormalEquations::add_pull(const ModuleLight::Place& place, const float* light,
                                     float weight, const Pull& slack) {
  for (std::size_t i = 0; i < place.count; ++i) {
    pull_[place.begin + i] += weight * light[i] * slack;
  }
}

float ModuleNormalEquations::gram(std::size_t a, std::size_t b) const {
  const std::size_t low = std::min(a, b);
  const std::size_t high = std::max(a, b);
  return high - low < band_ ? gram_row(low)[high - low] : 0;
}

// Moves features that are known to be present from the unknowns into the residual.
void ModuleNormalEquations::take_out(const std::array<std::uint8_t, kFeatures>& present) {
  for (std::size_t a = 0; a < kFeatures; ++a) {
    if (present[a] == 0) continue;
    constant_ += gram(a, a) - 2 * right_[a];
    const std::size_t begin = a + 1 < band_ ? 0 : a + 1 - band_;
    const std::size_t end = std::min(kFeatures, a + band_);
    for (std::size_t b = begin; b < a; ++b) right_[b] -= gram_row(b)[a - b];
    for (std::size_t b = a + 1; b < end; ++b) right_[b] -= gram_row(a)[b - a];
  }
}

namespace {

// The costs of characters from the products of their features: coefficients of each feature and of
// each pair of features, feature by feature.
TAGSMITH_WIDE CharacterLanes costs_of_features(const Alphabet& alphabet, const float* gram,
                                               std::size_t stride, std::size_t band,
                                               const float* right) {
  CharacterLanes costs{};
  for (std::size_t i = 0; i < kOwnFeatures; ++i) {
    const float* row = gram + i * stride;
    const float own = row[0] - 2 * right[i];
    const CharacterLanes& first = alphabet.switched[i];
    for (std::size_t c = 0; c < kCharacterLanes; ++c) costs[c] += own * first[c];
    for (std::size_t j = i + 1; j < std::min(kOwnFeatures, i + band); ++j) {
      const float both = 2 * row[j - i];
      const CharacterLanes& second = alphabet.switched[j];
      for (std::size_t c = 0; c < kCharacterLanes; ++c) costs[c] += both * (first[c] * second[c]);
    }
  }
  return costs;
}

// The overlap of a feature with the characters that begin `gap` features after it.
TAGSMITH_WIDE CharacterLanes shared_with(const Alphabet& alphabet, const float* gram,
                                         std::size_t gap, std::size_t band) {
  CharacterLanes shared{};
  for (std::size_t f = 0; f < kOwnFeatures && gap + f < band; ++f) {
    const float both = gram[gap + f];
    for (std::size_t c = 0; c < kCharacterLanes; ++c) shared[c] += both * alphabet.switched[f][c];
  }
  return shared;
}

using Pairs = std::array<CharacterCosts::Row, kCharacterCount>;

// The overlap of each character on the left of a pair with all on the right: sums over its features
// from `first` on.
void set_shared(const Alphabet& alphabet, std::size_t first,
                const std::array<CharacterCosts::Row, kOwnFeatures>& shared, Pairs& pair) {
  using Row = Eigen::Array<double, kCharacterCount, 1>;
  for (std::size_t c = 0; c < kCharacterCount; ++c) {
    const Alphabet::Active& active = alphabet.active[c];
    Row costs = Row::Zero();
    for (std::size_t i = 0; i < active.count; ++i) {
      if (active.feature[i] < first) continue;
      costs += Eigen::Map<const Row>(shared[active.feature[i]].data());
    }
    Eigen::Map<Row>(pair[c].data()) = costs;
  }
}

// How strongly all characters at a position act on the picture's parameters, one by one.
using LanePulls = std::array<CharacterLanes, 8>;

TAGSMITH_WIDE void subtract_squares(const LanePulls& pulls, CharacterCosts::Row& alone) {
  for (const CharacterLanes& pull : pulls) {
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      alone[c] -= static_cast<double>(pull[c] * pull[c]);
    }
  }
}

TAGSMITH_WIDE void subtract_products(const LanePulls& before, const LanePulls& pulls, Pairs& pair) {
  for (std::size_t b = 0; b < kCharacterCount; ++b) {
    CharacterLanes shared{};
    for (std::size_t k = 0; k < pulls.size(); ++k) {
      const float pull = before[k][b];
      for (std::size_t c = 0; c < kCharacterLanes; ++c) shared[c] += pull * pulls[k][c];
    }
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      pair[b][c] -= 2 * static_cast<double>(shared[c]);
    }
  }
}

}  // namespace

CharacterLanes ModuleNormalEquations::costs_alone(std::size_t position) const {
  const std::size_t base = first_feature(position);
  return costs_of_features(alphabet_at(position), gram_row(base), stride_, band_,
                           right_.data() + base);
}

// The overlap of neighbouring characters: first each feature of the left one with every character
// at `position`, then summed over the features of every left character.
void ModuleNormalEquations::set_pair_costs(
    std::size_t position, std::array<CharacterCosts::Row, kCharacterCount>& pair) const {
  const std::size_t base = first_feature(position - 1);
  const std::size_t gap = first_feature(position) - base;
  if (gap >= band_ + kOwnFeatures) return;
  const std::size_t first = gap < band_ ? 0 : gap - band_ + 1;  // earlier features have no overlap
  std::array<CharacterCosts::Row, kOwnFeatures> pull;
  for (std::size_t j = first; j < kOwnFeatures; ++j) {
    const CharacterLanes shared =
        shared_with(alphabet_at(position), gram_row(base + j), gap - j, band_);
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      pull[j][c] = 2 * static_cast<double>(shared[c]);
    }
  }
  set_shared(alphabet_at(position - 1), first, pull, pair);
}

// The overlap of characters that are no neighbours, with one of the two from the reference.
void ModuleNormalEquations::add_far_costs(const Characters& reference,
                                          CharacterCosts& costs) const {
  const auto shared = [&](std::size_t i, std::size_t c, std::size_t j, std::size_t d) {
    const Alphabet::Active& left = alphabet_at(i).active[c];
    const Alphabet::Active& right = alphabet_at(j).active[d];
    float sum = 0;
    for (std::size_t a = left.count; a-- > 0;) {
      const std::size_t from = first_feature(i) + left.feature[a];
      if (first_feature(j) - from >= band_) break;
      for (std::size_t b = 0; b < right.count; ++b) {
        const std::size_t distance = first_feature(j) + right.feature[b] - from;
        if (distance >= band_) break;
        sum += gram_row(from)[distance];
      }
    }
    return 2 * static_cast<double>(sum);
  };
  for (std::size_t i = 0; i + 2 < kCharacterPlaces; ++i) {
    for (std::size_t j = i + 2; j < kCharacterPlaces; ++j) {
      if (first_feature(j) - first_feature(i) >= band_ + kOwnFeatures) break;
      for (std::size_t c = 0; c < kCharacterCount; ++c) {
        costs.alone[i][c] += shared(i, c, j, reference[j]);
        costs.alone[j][c] += shared(i, reference[i], j, c);
      }
      costs.constant -= shared(i, reference[i], j, reference[j]);
    }
  }
}

// How much a fit of the picture to each symbol lowers its cost: the square of the pull of the part
// that differs from the reference, to which the picture is already fitted.
void ModuleNormalEquations::adapt_picture(const Characters& reference,
                                          CharacterCosts& costs) const {
  static_assert(std::tuple_size_v<LanePulls> == kSlack);
  LanePulls before{};
  for (std::size_t i = 0; i < kCharacterPlaces; ++i) {
    const Alphabet& here = alphabet_at(i);
    const auto add_pull = [&](Pull& pull, std::size_t c, float sign) {
      const Alphabet::Active& active = here.active[c];
      for (std::size_t a = 0; a < active.count; ++a) {
        const Pull& own = pull_[first_feature(i) + active.feature[a]];
        pull += sign * own;
      }
    };
    Pull from = Pull::Zero();
    add_pull(from, reference[i], -1);
    LanePulls pulls{};
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      Pull pull = from;
      add_pull(pull, c, 1);
      for (std::size_t k = 0; k < kSlack; ++k) pulls[k][c] = pull[static_cast<Eigen::Index>(k)];
    }
    subtract_squares(pulls, costs.alone[i]);
    if (i > 0) subtract_products(before, pulls, costs.pair[i - 1]);
    before = pulls;
  }
}

CharacterCosts ModuleNormalEquations::character_costs(const Characters* reference) const {
  CharacterCosts costs;
  costs.constant = static_cast<double>(constant_);
  for (std::size_t position = 0; position < kCharacterPlaces; ++position) {
    const CharacterLanes alone = costs_alone(position);
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      costs.alone[position][c] = static_cast<double>(alone[c]);
    }
    if (position > 0) set_pair_costs(position, costs.pair[position - 1]);
  }
  if (reference != nullptr) add_far_costs(*reference, costs);
  if (reference != nullptr && adapts_) adapt_picture(*reference, costs);
  return costs;
}

// The rest of each feature's light that a symbol of these characters leaves.
std::array<float, kFeatures> ModuleNormalEquations::residuals_of(
    const Characters& characters) const {
  std::array<float, kFeatures> residuals;
  std::copy_n(right_.begin(), kFeatures, residuals.begin());
  const auto subtract = [&](std::size_t on) {
    const std::size_t begin = on + 1 < band_ ? 0 : on + 1 - band_;
    const std::size_t end = std::min(kFeatures, on + band_);
    for (std::size_t a = begin; a < on; ++a) residuals[a] -= gram_row(a)[on - a];
    for (std::size_t a = on; a < end; ++a) residuals[a] -= gram_row(on)[a - on];
  };
  for (std::size_t position = 0; position < kCharacterPlaces; ++position) {
    const Alphabet::Active& active = alphabet_at(position).active[characters[position]];
    for (std::size_t i = 0; i < active.count; ++i) {
      subtract(first_feature(position) + active.feature[i]);
    }
  }
  // take_out leaves the removed features their own light.
  for (const std::size_t module : kGuardBars) {
    residuals[2 * module + 1] -= gram_row(2 * module + 1)[0];
  }
  return residuals;
}

std::array<float, kModuleCount> ModuleNormalEquations::misfits(const Characters& characters) const {
  const std::array<float, kFeatures> residuals = residuals_of(characters);
  std::array<float, kModuleCount> misfits{};
  for (std::size_t k = 0; k < misfits.size(); ++k) {
    const std::size_t a = 2 * k + 1;
    const float own = gram_row(a)[0];
    if (own > 0) misfits[k] = residuals[a] * residuals[a] / own;
  }
  return misfits;
}

std::array<double, kDigitCount> ModuleNormalEquations::odds_of_corrupted_digits(
    const Characters& characters) const {
  const std::array<float, kFeatures> residuals = residuals_of(characters);
  std::array<DigitModules, kCharacterPlaces> digits{};
  for (std::size_t position = 0; position < kCharacterPlaces; ++position) {
    const std::size_t base = first_feature(position);
    DigitModules& digit = digits[position];
    for (Eigen::Index i = 0; i < kModulesPerDigit; ++i) {
      const std::size_t a = base + 2 * static_cast<std::size_t>(i);
      digit.residuals[i] = static_cast<double>(residuals[a]);
      for (Eigen::Index j = i; j < kModulesPerDigit; ++j) {
        const std::size_t b = base + 2 * static_cast<std::size_t>(j);
        const double shared =
            static_cast<double>(gram(a, b)) - static_cast<double>(pull_[a].dot(pull_[b]));
        digit.products(i, j) = digit.products(j, i) = shared;
      }
    }
  }
  return tagsmith::detail::odds_of_corrupted_digits(digits, characters);
}

}  // namespace tagsmith::detail
