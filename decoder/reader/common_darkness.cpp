// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/common_darkness.hpp"

#include <algorithm>
#include <cmath>

#include "decoder/reader/tuning.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// Weighted sums along a row, up to each bin.
struct RunningSums {
  double w = 0, d = 0, dd = 0, l = 0, ll = 0, dl = 0, x = 0, xx = 0, dx = 0, lx = 0;
  int cells = 0;

  void add(double weight, double bin, double darkness, double light) {
    w += weight;
    x += weight * bin;
    xx += weight * bin * bin;
    dx += weight * darkness * bin;
    lx += weight * light * bin;
    d += weight * darkness;
    dd += weight * darkness * darkness;
    l += weight * light;
    ll += weight * light * light;
    dl += weight * darkness * light;
    ++cells;
  }
};

std::optional<RowStretch> fit_stretch(const RunningSums& a, const RunningSums& b,
                                      AddedLight added) {
  const double w = b.w - a.w;
  const int cells = b.cells - a.cells;
  if (cells < 8 || w <= 0) return std::nullopt;
  const double d = (b.d - a.d) / w;
  const double l = (b.l - a.l) / w;
  const double x = (b.x - a.x) / w;
  const double dd = (b.dd - a.dd) / w - d * d;
  const double ll = (b.ll - a.ll) / w - l * l;
  const double dl = (b.dl - a.dl) / w - d * l;
  if (!(dd > 0)) return std::nullopt;
  const auto stretch = [&](double contrast, double gradient, double left) {
    return RowStretch{static_cast<float>(l + contrast * d), static_cast<float>(gradient),
                      static_cast<float>(x), static_cast<float>(contrast),
                      static_cast<float>(std::max(0.0, left))};
  };
  const double even = ll - dl * dl / dd;
  const RowStretch evenly = stretch(-dl / dd, 0, even * w / (cells - 2));
  if (added == AddedLight::even) return evenly;
  // Partial regression: what the gradient does not explain.
  const double xx = (b.xx - a.xx) / w - x * x;
  if (!(xx > 0)) return evenly;
  const double dx = (b.dx - a.dx) / w - d * x;
  const double lx = (b.lx - a.lx) / w - l * x;
  const double dd_left = dd - dx * dx / xx;
  const double dl_left = dl - dx * lx / xx;
  if (!(dd_left > 0)) return evenly;
  const double slanted = ll - lx * lx / xx - dl_left * dl_left / dd_left;
  const double slope = dl_left / dd_left;
  return stretch(-slope, (lx - slope * dx) / xx, slanted * w / (cells - 3));
}

}  // namespace

void find_slopes(const SymbolRows& rows, CommonDarkness& common) {
  common.slope.assign(rows.bins, 0);
  std::vector<std::size_t> known;
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    if (common.known[bin]) known.push_back(bin);
  }
  for (std::size_t i = 1; i + 1 < known.size(); ++i) {
    const float run = rows.middles[known[i + 1]] - rows.middles[known[i - 1]];
    const float rise = common.darkness[known[i + 1]] - common.darkness[known[i - 1]];
    if (run < 4) common.slope[known[i]] = rise / std::max(run, 0.5F);
  }
}

RowStretches::RowStretches(const SymbolRows& rows, const CommonDarkness& common, AddedLight added) {
  stride_ = static_cast<std::size_t>(rows.bins_per_module);
  reach_ = kNearModules * stride_;
  per_row_ = (rows.bins + stride_ - 1) / stride_;
  for (std::size_t row = 0; row < rows.rows; ++row) fit_row(rows, common, added, row);
  std::vector<float> contrasts, variances;
  for (const std::optional<RowStretch>& stretch : all_) {
    if (!stretch) continue;
    contrasts.push_back(stretch->contrast);
    variances.push_back(stretch->variance);
  }
  best_.resize(all_.size(), nullptr);
  if (contrasts.empty()) return;
  contrast_ = quantile(contrasts, 0.6);
  variance_ = std::max(1e-6F, quantile(variances, 0.4));
  for (std::size_t row = 0; row < rows.rows; ++row) find_best(row);
}

void RowStretches::fit_row(const SymbolRows& rows, const CommonDarkness& common, AddedLight added,
                           std::size_t row) {
  std::vector<RunningSums> sums(rows.bins + 1);
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    sums[bin + 1] = sums[bin];
    const RowCell cell = rows.cell(row, bin);
    if (cell.count == 0 || !common.known[bin]) continue;
    sums[bin + 1].add(static_cast<double>(cell.count), static_cast<double>(bin),
                      static_cast<double>(common.at(rows, bin, cell.place)),
                      static_cast<double>(cell.light));
  }
  for (std::size_t i = 0; i < per_row_; ++i) {
    const std::size_t middle = i * stride_;
    const std::size_t begin = middle > reach_ ? middle - reach_ : 0;
    const std::size_t end = std::min(rows.bins, middle + reach_ + 1);
    all_.push_back(fit_stretch(sums[begin], sums[end], added));
  }
}

// Whether a stretch shows the common darkness.
bool RowStretches::follows(const RowStretch& stretch) const {
  return stretch.contrast > kPlace.least_contrast * contrast_ &&
         stretch.variance < kProfile.most_variance * variance_ +
                                kProfile.model_variance * stretch.contrast * stretch.contrast;
}

// For each stretch of a row, the one near its middle that follows best, if any follows.
void RowStretches::find_best(std::size_t row) {
  const std::size_t reach = reach_ / stride_;
  for (std::size_t here = 0; here < per_row_; ++here) {
    const std::size_t begin = here > reach ? here - reach + 1 : 0;
    const std::size_t end = std::min(per_row_, here + reach);
    const RowStretch*& chosen = best_[row * per_row_ + here];
    for (std::size_t i = begin; i < end; ++i) {
      const std::optional<RowStretch>& stretch = all_[row * per_row_ + i];
      if (!stretch || !follows(*stretch)) continue;
      if (chosen == nullptr || stretch->variance * chosen->contrast * chosen->contrast <
                                   chosen->variance * stretch->contrast * stretch->contrast) {
        chosen = &*stretch;
      }
    }
  }
}

Vote RowStretches::vote(const SymbolRows& rows, const CommonDarkness& common, std::size_t row,
                        std::size_t bin) const {
  const RowCell cell = rows.cell(row, bin);
  const RowStretch* best = best_[row * per_row_ + bin / stride_];
  if (cell.count == 0 || best == nullptr) return {};
  const float off = cell.place - rows.middles[bin];
  const float variance = std::max(variance_, best->variance);
  const float white = best->white + best->gradient * (static_cast<float>(bin) - best->middle);
  return {(white - cell.light) / best->contrast - off * common.slope[bin],
          cell.count * best->contrast * best->contrast / variance};
}

namespace {

float weighted_median(std::vector<Vote>& votes) {
  if (votes.empty()) return 0;
  std::ranges::sort(votes, {}, &Vote::darkness);
  float total = 0;
  for (const Vote& vote : votes) total += vote.weight;
  float sum = 0;
  for (const Vote& vote : votes) {
    sum += vote.weight;
    if (sum >= total / 2) return vote.darkness;
  }
  return votes.back().darkness;
}

Agreed agree(std::vector<Vote>& votes, std::size_t rows) {
  Agreed agreed;
  if (votes.empty()) return agreed;
  const float middle = weighted_median(votes);
  float sum = 0, odd = 0;
  std::size_t used = 0;
  for (const Vote& vote : votes) {
    if (std::abs(vote.darkness - middle) >
        static_cast<float>(kProfile.odd) + 3 / std::sqrt(vote.weight)) {
      odd += vote.weight;
      continue;
    }
    sum += vote.weight * vote.darkness;
    agreed.weight += vote.weight;
    ++used;
  }
  agreed.darkness = sum / agreed.weight;
  agreed.doubt = odd / (odd + agreed.weight);
  agreed.shown = static_cast<float>(used) / static_cast<float>(rows);
  return agreed;
}

std::vector<Agreed> agree_on_all(const SymbolRows& rows, const RowStretches& stretches,
                                 const CommonDarkness& common) {
  std::vector<Agreed> agreed;
  std::vector<Vote> votes;
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    votes.clear();
    for (std::size_t row = 0; row < rows.rows; ++row) {
      const Vote vote = stretches.vote(rows, common, row, bin);
      if (vote.weight > 0) votes.push_back(vote);
    }
    agreed.push_back(agree(votes, rows.rows));
  }
  return agreed;
}

// Values along the symbol, of bins that may be unknown.
struct Values {
  std::vector<float> value;
  std::vector<bool> known;
};

// Levels near a place.
struct Levels {
  float low = 0;
  float high = 0;
};

// Computed from the known values within `reach_modules` of every bin, farther inside at the ends,
// once a module.
std::vector<Levels> levels_near(const Values& values, std::size_t reach_modules,
                                std::size_t per_module) {
  const std::size_t size = values.value.size(), reach = reach_modules * per_module;
  // The length is the same everywhere: a quiet zone and a guard alone show little black.
  const std::size_t length = std::min(size, 2 * reach + 1);
  std::vector<Levels> levels(size);
  std::vector<float> near;
  for (std::size_t begin = 0; begin < size; begin += per_module) {
    const std::size_t end = std::min(size, begin + per_module);
    const std::size_t bin = (begin + end) / 2;
    const std::size_t first = std::min(bin > reach ? bin - reach : 0, size - length);
    near.clear();
    for (std::size_t i = first; i < first + length; ++i) {
      if (values.known[i]) near.push_back(values.value[i]);
    }
    if (near.empty()) continue;
    const auto [low, high] = std::ranges::minmax(near);
    for (std::size_t i = begin; i < end; ++i) levels[i] = {low, high};
  }
  return levels;
}

// Mean light of a few rows, bin by bin, with their pixels.
struct Band {
  Values light;
  std::vector<float> count;
};

Band band_of(const SymbolRows& rows, std::size_t first, std::size_t end) {
  Band band{{std::vector<float>(rows.bins), std::vector<bool>(rows.bins)},
            std::vector<float>(rows.bins)};
  for (std::size_t row = first; row < end; ++row) {
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      const RowCell cell = rows.cell(row, bin);
      band.light.value[bin] += cell.count * cell.light;
      band.count[bin] += cell.count;
    }
  }
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    band.light.known[bin] = band.count[bin] > 0;
    if (band.light.known[bin]) band.light.value[bin] /= band.count[bin];
  }
  return band;
}

// A band's darkness between the white and the black near by, weighted by how far these are apart:
// hardly where the bars do not show.
struct LocalDarkness {
  std::vector<Vote> votes;
  std::vector<float> contrast;
};

LocalDarkness local_darkness_of(const Band& band, std::size_t per_module) {
  const std::size_t bins = band.count.size();
  LocalDarkness local{std::vector<Vote>(bins), std::vector<float>(bins)};
  const auto levels = levels_near(band.light, kNearModules, per_module);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    if (!band.light.known[bin]) continue;
    const float contrast = levels[bin].high - levels[bin].low;
    local.contrast[bin] = contrast;
    local.votes[bin] = {(levels[bin].high - band.light.value[bin]) / std::max(contrast, 1e-4F),
                        band.count[bin] * contrast * contrast};
  }
  return local;
}

// The median of what a few rows at a time show, those with clear bars before others.
CommonDarkness first_guess(const SymbolRows& rows) {
  std::vector<LocalDarkness> seen;
  std::vector<float> contrasts;
  const std::size_t step = std::max<std::size_t>(2, rows.rows / kProfile.bands);
  for (std::size_t row = 0; row + step <= rows.rows; row += step) {
    seen.push_back(local_darkness_of(band_of(rows, row, row + step),
                                     static_cast<std::size_t>(rows.bins_per_module)));
    contrasts.insert(contrasts.end(), seen.back().contrast.begin(), seen.back().contrast.end());
  }
  const float least = kPlace.least_contrast * quantile(contrasts, 0.6);
  CommonDarkness common{std::vector<float>(rows.bins), std::vector<bool>(rows.bins), {}};
  std::vector<Vote> votes;
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    votes.clear();
    for (const LocalDarkness& band : seen) {
      if (band.contrast[bin] >= least && band.votes[bin].weight > 0) {
        votes.push_back(band.votes[bin]);
      }
    }
    common.darkness[bin] = weighted_median(votes);
    common.known[bin] = !votes.empty();
  }
  find_slopes(rows, common);
  return common;
}

// Rows are fitted to their common darkness, and this is computed from the rows again. The level and
// the contrast of it can drift, so both are set again from the elements near by.
void anchor(std::vector<Agreed>& agreed, std::size_t per_module) {
  Values values;
  for (const Agreed& at : agreed) {
    values.value.push_back(at.darkness);
    values.known.push_back(at.weight > 0);
  }
  const auto levels = levels_near(values, std::size_t{2} * kNearModules, per_module);
  for (std::size_t bin = 0; bin < agreed.size(); ++bin) {
    if (agreed[bin].weight == 0) continue;
    const float contrast = std::max(levels[bin].high - levels[bin].low, 0.1F);
    agreed[bin].darkness = (agreed[bin].darkness - levels[bin].low) / contrast;
    agreed[bin].weight *= contrast * contrast;
  }
}

void take_over(const SymbolRows& rows, const std::vector<Agreed>& agreed, CommonDarkness& common) {
  for (std::size_t bin = 0; bin < agreed.size(); ++bin) {
    common.known[bin] = agreed[bin].weight > 0;
    if (common.known[bin]) common.darkness[bin] = agreed[bin].darkness;
  }
  find_slopes(rows, common);
}

}  // namespace

SettledRows settle(const SymbolRows& rows, AddedLight added) {
  SettledRows settled{{}, first_guess(rows)};
  for (int round = 0; round < kDecode.rounds; ++round) {
    const RowStretches stretches(rows, settled.common, added);
    settled.agreed = agree_on_all(rows, stretches, settled.common);
    anchor(settled.agreed, static_cast<std::size_t>(rows.bins_per_module));
    take_over(rows, settled.agreed, settled.common);
  }
  return settled;
}

}  // namespace tagsmith::detail
