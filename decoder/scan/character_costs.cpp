// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/character_costs.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "tagsmith/base/normal.hpp"

namespace tagsmith {
namespace {

constexpr float kHalfLength = kModuleCount / 2.0F;
constexpr std::size_t kPositions = kDigitCount;
constexpr std::array<std::size_t, 6> kGuardBars{0, 2, 46, 48, 92, 94};

// The features, relative to a character's first module, that it switches on.
struct Active {
  std::array<std::uint8_t, 8> feature{};  // ascending
  std::size_t count = 0;
};

// Seven modules of a character; in the left half it starts with a space, in the right with a bar.
std::array<std::uint8_t, kModulesPerDigit> modules_of_character(bool right_half, std::size_t c) {
  std::array<std::uint8_t, kElementsPerDigit> widths = kDigitElements[c % 10];
  if (c >= 10) std::ranges::reverse(widths);
  std::array<std::uint8_t, kModulesPerDigit> modules{};
  std::size_t at = 0;
  std::uint8_t bar = right_half ? 1 : 0;
  for (const std::uint8_t width : widths) {
    for (int i = 0; i < width; ++i) modules[at++] = bar;
    bar ^= 1U;
  }
  return modules;
}

Active active_features(bool right_half, std::size_t c) {
  const auto modules = modules_of_character(right_half, c);
  Active active;
  for (std::size_t k = 0; k < modules.size(); ++k) {
    if (k > 0 && modules[k] != modules[k - 1]) {
      active.feature[active.count++] = static_cast<std::uint8_t>(2 * k - 1);
    }
    if (modules[k] != 0) active.feature[active.count++] = static_cast<std::uint8_t>(2 * k);
  }
  return active;
}

using Alphabet = std::array<std::array<Active, kCharacterCount>, 2>;

const Alphabet& alphabet() {
  static const Alphabet kAlphabet = [] {
    Alphabet all{};
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      all[0][c] = active_features(false, c);
      all[1][c] = active_features(true, c);
    }
    return all;
  }();
  return kAlphabet;
}

std::size_t first_feature(std::size_t position) {
  return 2 * static_cast<std::size_t>(first_module_of_digit(static_cast<int>(position))) + 1;
}

std::array<float, kModuleCount + 1> displaced_edges(const SymbolImage& image) {
  std::array<float, kModuleCount + 1> edges{};
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const float nominal = static_cast<float>(k) - kHalfLength;
    const float t = nominal / kHalfLength;
    edges[k] = static_cast<float>(k) + static_cast<float>(image.shift) +
               static_cast<float>(image.stretch) * nominal + static_cast<float>(image.bend) * t * t;
  }
  return edges;
}

// How far from an edge, in modules, a point spread of this standard deviation lets it matter.
float reach_of(const SymbolImage& image, float blur) {
  return std::min(14.0F, 4 * blur + static_cast<float>(std::abs(image.growth)) / 2);
}

}  // namespace

double CharacterCosts::of(const Characters& characters) const {
  double cost = constant + alone[0][characters[0]];
  for (std::size_t i = 1; i < kPositions; ++i) {
    cost += alone[i][characters[i]] + pair[i - 1][characters[i - 1]][characters[i]];
  }
  return cost;
}

float ModuleSystem::gram(std::size_t a, std::size_t b) const {
  const std::size_t low = std::min(a, b);
  const std::size_t high = std::max(a, b);
  return high - low < kBand ? gram_[low][high - low] : 0;
}

// Adds one place: its light is the sum over the edges within reach of a step, and of the modules
// between them. The mean of the steps of a bar's begin and of its end at the same nominal place
// belongs to the module, half their difference to the growth of the edge.
void ModuleSystem::add(const ScanBin& bin, const SymbolImage& image, const Pull* slack,
                       const std::array<float, kModuleCount + 1>& edges, std::size_t& first) {
  const NormalTable& normal = NormalTable::get();
  const float place = static_cast<float>(bin.at);
  const float blur = static_cast<float>(image.blur * bin.spread);
  const float reach = reach_of(image, blur);
  while (first < edges.size() && edges[first] < place - reach) ++first;
  const float contrast = static_cast<float>(image.black - image.white);
  const float t = (place - kHalfLength) / kHalfLength;
  const float value =
      (static_cast<float>(bin.darkness - image.white) - static_cast<float>(image.shading) * t) /
      contrast;
  const float weight = contrast * contrast / static_cast<float>(bin.variance);
  constant_ += weight * value * value;
  const float half_growth = static_cast<float>(image.growth) / 2;
  const float per_blur = 1 / blur;
  std::array<float, kBand> light{};
  const std::size_t begin = first == 0 ? 0 : 2 * first - 1;  // module before the first edge
  std::size_t count = 0;
  float before = 1;  // step of the edge before
  std::size_t k = first;
  for (; k < edges.size() && edges[k] < place + reach && count + 2 < kBand; ++k) {
    const float z = (place - edges[k]) * per_blur;
    float step = 0, growth = 0;
    if (half_growth == 0) {
      step = normal(z).integral;
    } else {
      const float widened = normal(z + half_growth * per_blur).integral;
      const float narrowed = normal(z - half_growth * per_blur).integral;
      step = (widened + narrowed) / 2;
      growth = (widened - narrowed) / 2;
    }
    if (k > 0) light[count++] = before - step;
    light[count++] = growth;
    before = step;
  }
  if (k < edges.size() && k > 0 && k > first) light[count++] = before;
  if (k == first && k > 0 && k < edges.size()) light[count++] = 1;  // in the midst of one module
  for (std::size_t i = 0; i < count; ++i) {
    const float weighted = weight * light[i];
    right_[begin + i] += weighted * value;
    for (std::size_t j = i; j < count; ++j) gram_[begin + i][j - i] += weighted * light[j];
    if (slack == nullptr) continue;
    const float pulling = weighted / contrast;
    for (std::size_t p = 0; p < kSlack; ++p) pull_[begin + i][p] += pulling * (*slack)[p];
  }
}

// Moves features that are known to be there from the unknowns into the residual.
void ModuleSystem::take_out(const std::array<std::uint8_t, kFeatures>& present) {
  for (std::size_t a = 0; a < kFeatures; ++a) {
    if (present[a] == 0) continue;
    constant_ += gram(a, a) - 2 * right_[a];
    const std::size_t begin = a + 1 < band_ ? 0 : a + 1 - band_;
    const std::size_t end = std::min(kFeatures, a + band_);
    for (std::size_t b = begin; b < a; ++b) right_[b] -= gram_[b][a - b];
    for (std::size_t b = a + 1; b < end; ++b) right_[b] -= gram_[a][b - a];
  }
}

ModuleSystem::ModuleSystem(const ScanProfile& profile, const SymbolImage& image,
                           const FitSlack& slack)
    : adapts_(!slack.empty()) {
  double widest = 1;
  for (const ScanBin& bin : profile) widest = std::max(widest, bin.spread);
  const float reach = reach_of(image, static_cast<float>(image.blur * widest));
  // Edges within reach of one place lie within twice the reach of each other.
  band_ = std::min(kBand, 2 * static_cast<std::size_t>(std::ceil(2.1F * reach)) + 3);
  const auto edges = displaced_edges(image);
  std::size_t first = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    add(profile[i], image, adapts_ ? &slack[i] : nullptr, edges, first);
  }
  std::array<std::uint8_t, kFeatures> present{};
  for (const std::size_t module : kGuardBars) {
    present[2 * module] = present[2 * module + 1] = present[2 * module + 2] = 1;
  }
  for (std::size_t position = 0; position < kPositions; ++position) {
    present[first_feature(position) - 1] = 1;
    present[first_feature(position) + kOwn] = 1;
  }
  take_out(present);
}

// What neighbouring characters exchange: first each feature of the left one with every character at
// `position`, then summed over the features of every left character.
void ModuleSystem::add_pair_costs(std::size_t position,
                                  std::array<CharacterCosts::Row, kCharacterCount>& pair) const {
  const std::size_t base = first_feature(position - 1);
  const std::size_t gap = first_feature(position) - base;
  if (gap >= band_ + kOwn) return;
  const std::size_t first = gap < band_ ? 0 : gap - band_ + 1;  // features before share nothing
  const auto& left = alphabet()[position - 1 < 6 ? 0 : 1];
  const auto& right = alphabet()[position < 6 ? 0 : 1];
  std::array<std::array<double, kCharacterCount>, kOwn> pull{};
  for (std::size_t j = first; j < kOwn; ++j) {
    const auto& gram = gram_[base + j];
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      float sum = 0;
      for (std::size_t i = 0; i < right[c].count; ++i) {
        const std::size_t distance = gap + right[c].feature[i] - j;
        if (distance >= band_) break;
        sum += gram[distance];
      }
      pull[j][c] = 2 * static_cast<double>(sum);
    }
  }
  for (std::size_t c = 0; c < kCharacterCount; ++c) {
    for (std::size_t i = 0; i < left[c].count; ++i) {
      if (left[c].feature[i] < first) continue;
      const auto& from = pull[left[c].feature[i]];
      for (std::size_t d = 0; d < kCharacterCount; ++d) pair[c][d] += from[d];
    }
  }
}

// What characters that are no neighbours share, with one of the two from the reference.
void ModuleSystem::add_far_costs(const Characters& reference, CharacterCosts& costs) const {
  const auto shared = [&](std::size_t i, std::size_t c, std::size_t j, std::size_t d) {
    const Active& left = alphabet()[i < 6 ? 0 : 1][c];
    const Active& right = alphabet()[j < 6 ? 0 : 1][d];
    float sum = 0;
    for (std::size_t a = left.count; a-- > 0;) {
      const std::size_t from = first_feature(i) + left.feature[a];
      if (first_feature(j) - from >= band_) break;
      for (std::size_t b = 0; b < right.count; ++b) {
        const std::size_t distance = first_feature(j) + right.feature[b] - from;
        if (distance >= band_) break;
        sum += gram_[from][distance];
      }
    }
    return 2 * static_cast<double>(sum);
  };
  for (std::size_t i = 0; i + 2 < kPositions; ++i) {
    for (std::size_t j = i + 2; j < kPositions; ++j) {
      if (first_feature(j) - first_feature(i) >= band_ + kOwn) break;
      for (std::size_t c = 0; c < kCharacterCount; ++c) {
        costs.alone[i][c] += shared(i, c, j, reference[j]);
        costs.alone[j][c] += shared(i, reference[i], j, c);
      }
      costs.constant -= shared(i, reference[i], j, reference[j]);
    }
  }
}

// What a fit of the picture to each symbol takes from its cost: the square of the pull of what
// differs from the reference, to which the picture is fitted already.
void ModuleSystem::adapt_picture(const Characters& reference, CharacterCosts& costs) const {
  std::array<std::array<Pull, kCharacterCount>, kPositions> pulls{};
  for (std::size_t i = 0; i < kPositions; ++i) {
    const auto& here = alphabet()[i < 6 ? 0 : 1];
    const auto add_pull = [&](Pull& pull, const Active& active, float sign) {
      for (std::size_t a = 0; a < active.count; ++a) {
        const Pull& own = pull_[first_feature(i) + active.feature[a]];
        for (std::size_t k = 0; k < kSlack; ++k) pull[k] += sign * own[k];
      }
    };
    Pull from{};
    add_pull(from, here[reference[i]], -1);
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      Pull& pull = pulls[i][c];
      pull = from;
      add_pull(pull, here[c], 1);
      for (const float value : pull) costs.alone[i][c] -= static_cast<double>(value * value);
      if (i == 0) continue;
      for (std::size_t b = 0; b < kCharacterCount; ++b) {
        float shared = 0;
        for (std::size_t k = 0; k < kSlack; ++k) shared += pulls[i - 1][b][k] * pull[k];
        costs.pair[i - 1][b][c] -= 2 * static_cast<double>(shared);
      }
    }
  }
}

CharacterCosts ModuleSystem::character_costs(const Characters* reference) const {
  CharacterCosts costs;
  costs.constant = static_cast<double>(constant_);
  const Alphabet& characters = alphabet();
  for (std::size_t position = 0; position < kPositions; ++position) {
    const std::size_t base = first_feature(position);
    const auto& here = characters[position < 6 ? 0 : 1];
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      const Active& active = here[c];
      float cost = 0;
      for (std::size_t i = 0; i < active.count; ++i) {
        const std::size_t a = base + active.feature[i];
        cost += gram_[a][0] - 2 * right_[a];
        for (std::size_t j = i + 1; j < active.count; ++j) {
          cost += 2 * gram_[a][active.feature[j] - active.feature[i]];
        }
      }
      costs.alone[position][c] = static_cast<double>(cost);
    }
    if (position == 0) continue;
    add_pair_costs(position, costs.pair[position - 1]);
  }
  if (reference != nullptr) add_far_costs(*reference, costs);
  if (reference != nullptr && adapts_) adapt_picture(*reference, costs);
  return costs;
}

// What a symbol of these characters leaves of each feature's light.
std::array<float, ModuleSystem::kFeatures> ModuleSystem::residuals_of(
    const Characters& characters) const {
  std::array<std::uint8_t, kFeatures> on{};
  for (std::size_t position = 0; position < kPositions; ++position) {
    const Active& active = alphabet()[position < 6 ? 0 : 1][characters[position]];
    for (std::size_t i = 0; i < active.count; ++i) {
      on[first_feature(position) + active.feature[i]] = 1;
    }
  }
  std::array<float, kFeatures> residuals = right_;
  for (std::size_t a = 0; a < kFeatures; ++a) {
    const std::size_t begin = a + 1 < band_ ? 0 : a + 1 - band_;
    const std::size_t end = std::min(kFeatures, a + band_);
    for (std::size_t b = begin; b < end; ++b) {
      if (on[b] != 0) residuals[a] -= gram(a, b);
    }
  }
  // take_out leaves what is taken out its own light.
  for (const std::size_t module : kGuardBars) {
    residuals[2 * module + 1] -= gram_[2 * module + 1][0];
  }
  return residuals;
}

std::array<float, kModuleCount> ModuleSystem::misfits(const Characters& characters) const {
  const std::array<float, kFeatures> residuals = residuals_of(characters);
  std::array<float, kModuleCount> misfits{};
  for (std::size_t k = 0; k < misfits.size(); ++k) {
    const std::size_t a = 2 * k + 1;
    if (gram_[a][0] > 0) misfits[k] = residuals[a] * residuals[a] / gram_[a][0];
  }
  return misfits;
}

// One place of a digit, whose modules may be of any darkness about a digit's own. The growth of the
// edges stays as it is: what one edge has of its own must not speak for a digit without it.
class ModuleSystem::SpoiltDigit {
 public:
  SpoiltDigit(const ModuleSystem& system, const std::array<float, kFeatures>& residuals,
              std::size_t position)
      : position_(position) {
    const std::size_t base = first_feature(position);
    for (std::size_t i = 0; i < kModulesPerDigit; ++i) {
      const std::size_t a = base + 2 * i;
      residuals_[static_cast<Eigen::Index>(i)] = static_cast<double>(residuals[a]);
      for (std::size_t j = 0; j < kModulesPerDigit; ++j) {
        const std::size_t b = base + 2 * j;
        double shared = static_cast<double>(system.gram(a, b));
        for (std::size_t k = 0; k < kSlack; ++k) {
          shared -= static_cast<double>(system.pull_[a][k] * system.pull_[b][k]);
        }
        gram_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = shared;
      }
    }
  }

  // That another digit was spoilt until it looked like this one. Shares beforehand and standard
  // deviations of the modules, in contrasts: print and light are never quite even; some digits have
  // a reflection or a smear; few are covered.
  double odds_against(std::size_t digit) const {
    constexpr double kUneven = 0.05, kSpoilt = 0.001;
    const Freed even = freed(0.06), uneven = freed(0.15), spoilt = freed(0.5);
    const Modules same = Modules::Zero();
    const double log_even = log_likelihood(even, same);
    const double log_uneven = std::log(kUneven) + log_likelihood(uneven, same);
    const double log_spoilt = std::log(kSpoilt) + log_likelihood(spoilt, same);
    const double greatest = std::max({log_even, log_uneven, log_spoilt});
    const double right = std::exp(log_even - greatest) + std::exp(log_uneven - greatest) +
                         std::exp(log_spoilt - greatest);
    double wrong = 0;
    for (std::size_t other = 0; other < 10; ++other) {
      if (other == digit) continue;
      const Modules change = modules_of(other) - modules_of(digit);
      wrong += kSpoilt * std::exp(log_likelihood(spoilt, change) - greatest);
    }
    return wrong / right;
  }

 private:
  using Modules = Eigen::Matrix<double, kModulesPerDigit, 1>;
  using Block = Eigen::Matrix<double, kModulesPerDigit, kModulesPerDigit>;

  // The modules free to differ by so much.
  struct Freed {
    Eigen::LLT<Block> root;
    double log_volume = 0;
  };

  Freed freed(double sigma) const {
    const Block block = gram_ + Block::Identity() / (sigma * sigma);
    Freed freed{Eigen::LLT<Block>(block), 0};
    const auto diagonal = freed.root.matrixLLT().diagonal();
    freed.log_volume = -(sigma * diagonal).array().log().sum();
    return freed;
  }

  // With the digit changed, relative to the digit itself, all even.
  double log_likelihood(const Freed& freed, const Modules& change) const {
    const Modules pull = gram_ * change;
    const Modules residual = residuals_ - pull;
    const double cost = change.dot(pull - 2 * residuals_);
    return residual.dot(freed.root.solve(residual)) / 2 + freed.log_volume - cost / 2;
  }

  Modules modules_of(std::size_t digit) const {
    const auto bars = modules_of_character(position_ >= 6, digit);
    Modules modules;
    for (std::size_t i = 0; i < bars.size(); ++i) {
      modules[static_cast<Eigen::Index>(i)] = static_cast<double>(bars[i]);
    }
    return modules;
  }

  std::size_t position_;
  Modules residuals_;
  Block gram_;
};

double ModuleSystem::odds_of_spoilt_digits(const Characters& characters) const {
  const std::array<float, kFeatures> residuals = residuals_of(characters);
  double odds = 0;
  for (std::size_t position = 0; position < kPositions; ++position) {
    odds += SpoiltDigit(*this, residuals, position).odds_against(characters[position]);
  }
  return odds;
}

}  // namespace tagsmith
