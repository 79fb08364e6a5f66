// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/covered_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

#include "decoder/reader/cover_strips.hpp"
#include "decoder/reader/light_grid.hpp"
#include "decoder/reader/point_spread.hpp"
#include "decoder/reader/sorted_window.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr double kBeyond = 4;  // modules of quiet zone taken on both sides
constexpr double kHidden = 4;  // variance that says nothing

// The cells of the bars' height with what is known of each.
struct BarRows {
  LightGrid grid;
  std::size_t first_row = 0;
  std::size_t rows = 0;
  std::size_t first_bin = 0;
  std::size_t bins = 0;
  std::vector<float> counts;   // pixels that may be used: 0 under a cover
  std::vector<float> middles;  // mean place of a bin's pixels over all rows, bins; -1 = no pixel

  const LightCell& cell(std::size_t row, std::size_t bin) const {
    return grid.at(first_row + row, first_bin + bin);
  }
  float count(std::size_t row, std::size_t bin) const { return counts[row * bins + bin]; }
  // Place of a cell's pixels, in bins from the first one.
  float position(std::size_t row, std::size_t bin) const {
    return cell(row, bin).place * static_cast<float>(grid.per_module) -
           static_cast<float>(first_bin);
  }
};

double quantile(std::vector<double>& values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// Where the bars run along the columns of pixels, a bin's pixels all lie off its middle.
float middle_of(const BarRows& rows, std::size_t bin) {
  float sum = 0, count = 0;
  for (std::size_t row = 0; row < rows.rows; ++row) {
    const float here = rows.cell(row, bin).count;
    if (here > 0) sum += here * rows.position(row, bin);
    count += here;
  }
  return count > 0 ? sum / count : -1.0F;
}

// `height` is the frame's, in pixels. A row that reaches over the bars' ends shows them with less
// contrast, which its stretches allow for; often only the ends show what a cover hides.
BarRows bar_rows(LightGrid grid, const SymbolLayout& layout, std::span<const CoverStrip> strips,
                 double height) {
  constexpr double kClear = 0.06;  // of the bars' height at each end, at most
  constexpr double kClearPx = 2;   // pixels: their blur
  const double clear = std::min(kClear * (layout.bars_bottom - layout.bars_top), kClearPx / height);
  const auto row_at = [&](double v) {
    return static_cast<std::size_t>(std::lround(v * static_cast<double>(grid.rows)));
  };
  const double modules = kModuleCount + 2 * layout.quiet_zone_modules;
  BarRows rows;
  rows.first_row = row_at(layout.bars_top + clear);
  rows.rows = row_at(layout.bars_bottom - clear) - rows.first_row;
  const double begin = std::max(0.0, layout.quiet_zone_modules - kBeyond) * grid.per_module;
  rows.first_bin = static_cast<std::size_t>(std::ceil(begin));
  rows.bins = std::min(grid.bins - 2 * rows.first_bin,
                       static_cast<std::size_t>((kModuleCount + 2 * kBeyond) * grid.per_module));
  rows.grid = std::move(grid);
  rows.counts.resize(rows.rows * rows.bins);
  std::vector<double> places(rows.bins);
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    places[bin] = rows.grid.place_of(rows.first_bin + bin) / modules;
  }
  std::vector<std::int64_t> covered(rows.bins);
  for (std::size_t row = 0; row < rows.rows; ++row) {
    const double v = rows.grid.height_of(rows.first_row + row);
    std::ranges::fill(covered, 0);
    for (const CoverStrip& strip : strips) {
      if (reaches(strip, v)) add_covered(strip, v, places, covered);
    }
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      if (covered[bin] == 0) rows.counts[row * rows.bins + bin] = rows.cell(row, bin).count;
    }
  }
  for (std::size_t bin = 0; bin < rows.bins; ++bin) rows.middles.push_back(middle_of(rows, bin));
  return rows;
}

// How far the light of every window of a row is from an even slope: the variance that is left. A
// window reaches from its bin on.
std::vector<float> unevenness_of(const BarRows& rows, std::size_t row, std::size_t window) {
  struct Sums {
    double w = 0, x = 0, xx = 0, l = 0, ll = 0, lx = 0;
  };
  std::vector<Sums> sums(rows.bins + 1);
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    const auto w = static_cast<double>(rows.count(row, bin));
    const auto x = static_cast<double>(bin);
    const auto l = static_cast<double>(rows.cell(row, bin).light);
    const Sums& s = sums[bin];
    sums[bin + 1] = {s.w + w,     s.x + w * x,      s.xx + w * x * x,
                     s.l + w * l, s.ll + w * l * l, s.lx + w * l * x};
  }
  std::vector<float> left(rows.bins, -1.0F);
  for (std::size_t begin = 0; begin + window <= rows.bins; ++begin) {
    const Sums& a = sums[begin];
    const Sums& b = sums[begin + window];
    const double w = b.w - a.w;
    if (w < static_cast<double>(window) / 4) continue;
    const double x = (b.x - a.x) / w, l = (b.l - a.l) / w;
    const double xx = (b.xx - a.xx) / w - x * x;
    const double lx = (b.lx - a.lx) / w - l * x;
    const double ll = (b.ll - a.ll) / w - l * l;
    left[begin] = static_cast<float>(std::max(0.0, ll - (xx > 0 ? lx * lx / xx : 0)));
  }
  return left;
}

// Leaves out what is plain where other rows show bars: no element is wider than four modules, so a
// window of more shows bars and spaces or something in front of them, be it over most of the rows.
// Why: docs/decisions/0004-occlusion.md.
void leave_out_plain(BarRows& rows) {
  constexpr double kWindow = 5.5;    // modules
  constexpr double kOutline = 0.25;  // modules to both sides: a cover's blurred edge
  constexpr double kShowing = 0.93;  // of the rows at a place, the one taken to show bars
  constexpr double kPlain = 0.08;    // of its variance
  // Of the usual variance where bars show: less is a margin, more the outline of a highlight.
  constexpr double kLeastBars = 0.3, kMostBars = 1.5;
  const auto window = static_cast<std::size_t>(kWindow * rows.grid.per_module);
  const auto outline = static_cast<std::size_t>(kOutline * rows.grid.per_module);
  std::vector<std::vector<float>> uneven;
  for (std::size_t row = 0; row < rows.rows; ++row) {
    uneven.push_back(unevenness_of(rows, row, window));
  }
  std::vector<double> showing(rows.bins), known;
  for (std::size_t begin = 0; begin < rows.bins; ++begin) {
    std::vector<double> here;
    for (const auto& row : uneven) {
      if (row[begin] >= 0) here.push_back(static_cast<double>(row[begin]));
    }
    if (here.empty()) continue;
    showing[begin] = quantile(here, kShowing);
    known.push_back(showing[begin]);
  }
  if (known.empty()) return;
  const double usual = quantile(known, 0.5);
  for (std::size_t row = 0; row < rows.rows; ++row) {
    for (std::size_t begin = 0; begin + window <= rows.bins; ++begin) {
      if (uneven[row][begin] < 0 || showing[begin] < kLeastBars * usual) continue;
      const double bars = std::min(showing[begin], kMostBars * usual);
      if (static_cast<double>(uneven[row][begin]) > kPlain * bars) continue;
      const std::size_t first = begin > outline ? begin - outline : 0;
      const std::size_t end = std::min(rows.bins, begin + window + outline);
      std::fill(rows.counts.begin() + static_cast<std::ptrdiff_t>(row * rows.bins + first),
                rows.counts.begin() + static_cast<std::ptrdiff_t>(row * rows.bins + end), 0.0F);
    }
  }
}

// What the rows have in common: the darkness at the middle of every bin's pixels.
struct Common {
  std::vector<float> darkness;
  std::vector<float> certainty;  // 0 where nothing is known
  std::vector<float> slope;      // change of darkness a bin

  // At a place in a bin.
  float at(const BarRows& rows, std::size_t bin, float position) const {
    return darkness[bin] + slope[bin] * (position - rows.middles[bin]);
  }
};

// Slopes from the known bins on both sides of each.
void find_slopes(const BarRows& rows, Common& common) {
  common.slope.assign(rows.bins, 0);
  std::vector<std::size_t> known;
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    if (common.certainty[bin] > 0 && rows.middles[bin] >= 0) known.push_back(bin);
  }
  for (std::size_t i = 1; i + 1 < known.size(); ++i) {
    const float run = rows.middles[known[i + 1]] - rows.middles[known[i - 1]];
    const float rise = common.darkness[known[i + 1]] - common.darkness[known[i - 1]];
    if (run < 4) common.slope[known[i]] = rise / std::max(run, 0.5F);
  }
}

// How the common darkness d shows on a stretch of a row: light = white + gradient x - contrast d,
// x bins from the stretch's middle. A highlight adds light that changes from bar to bar.
struct Stretch {
  float white = 0;
  float gradient = 0;
  float middle = 0;  // bins
  float contrast = 0;
  float variance = 0;  // of a pixel's light about that
};

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

std::optional<Stretch> fit_stretch(const RunningSums& a, const RunningSums& b, AddedLight added) {
  constexpr double kLeastModulation = 0.03;  // variance of the common darkness
  constexpr double kMuchLess = 0.5;          // of what is left without a gradient
  const double w = b.w - a.w;
  const int cells = b.cells - a.cells;
  if (cells < 8 || w <= 0) return std::nullopt;
  const double d = (b.d - a.d) / w;
  const double l = (b.l - a.l) / w;
  const double x = (b.x - a.x) / w;
  const double dd = (b.dd - a.dd) / w - d * d;
  const double ll = (b.ll - a.ll) / w - l * l;
  const double dl = (b.dl - a.dl) / w - d * l;
  if (dd < kLeastModulation) return std::nullopt;
  const auto stretch = [&](double contrast, double gradient, double left) {
    return Stretch{static_cast<float>(l + contrast * d), static_cast<float>(gradient),
                   static_cast<float>(x), static_cast<float>(contrast),
                   static_cast<float>(std::max(0.0, left))};
  };
  const double even = ll - dl * dl / dd;
  const Stretch evenly = stretch(-dl / dd, 0, even * w / (cells - 2));
  if (added == AddedLight::even) return evenly;
  // Partial regression: what no gradient explains.
  const double xx = (b.xx - a.xx) / w - x * x;
  if (!(xx > 0)) return evenly;
  const double dx = (b.dx - a.dx) / w - d * x;
  const double lx = (b.lx - a.lx) / w - l * x;
  const double dd_left = dd - dx * dx / xx;
  const double dl_left = dl - dx * lx / xx;
  if (dd_left < kLeastModulation) return evenly;
  const double slanted = ll - lx * lx / xx - dl_left * dl_left / dd_left;
  if (slanted > kMuchLess * even) return evenly;
  const double slope = dl_left / dd_left;
  return stretch(-slope, (lx - slope * dx) / xx, slanted * w / (cells - 3));
}

// The stretches of every row, one a module, each ten modules long.
struct Stretches {
  std::size_t per_row = 0;
  std::size_t reach = 0;   // bins to both sides of a stretch's middle
  std::size_t stride = 0;  // bins from one middle to the next
  std::vector<std::optional<Stretch>> all;
  float contrast = 0;  // usual
  float variance = 0;

  const std::optional<Stretch>& at(std::size_t row, std::size_t i) const {
    return all[row * per_row + i];
  }
};

Stretches fit_stretches(const BarRows& rows, const Common& common, AddedLight added) {
  constexpr double kHalf = 5;  // modules
  Stretches result;
  result.stride = static_cast<std::size_t>(rows.grid.per_module);
  result.reach = static_cast<std::size_t>(kHalf * rows.grid.per_module);
  result.per_row = (rows.bins + result.stride - 1) / result.stride;
  std::vector<RunningSums> sums(rows.bins + 1);
  std::vector<double> contrasts, variances;
  for (std::size_t row = 0; row < rows.rows; ++row) {
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      sums[bin + 1] = sums[bin];
      const float count = rows.count(row, bin);
      if (count == 0 || common.certainty[bin] == 0) continue;
      const float darkness = common.at(rows, bin, rows.position(row, bin));
      sums[bin + 1].add(static_cast<double>(count), static_cast<double>(bin),
                        static_cast<double>(darkness),
                        static_cast<double>(rows.cell(row, bin).light));
    }
    for (std::size_t i = 0; i < result.per_row; ++i) {
      const std::size_t middle = i * result.stride;
      const std::size_t begin = middle > result.reach ? middle - result.reach : 0;
      const std::size_t end = std::min(rows.bins, middle + result.reach + 1);
      result.all.push_back(fit_stretch(sums[begin], sums[end], added));
      if (!result.all.back()) continue;
      contrasts.push_back(static_cast<double>(result.all.back()->contrast));
      variances.push_back(static_cast<double>(result.all.back()->variance));
    }
  }
  if (contrasts.empty()) return result;
  result.contrast = static_cast<float>(quantile(contrasts, 0.6));
  result.variance = std::max(1e-6F, static_cast<float>(quantile(variances, 0.4)));
  return result;
}

// Whether a stretch follows the common darkness.
bool follows(const Stretch& stretch, const Stretches& all) {
  constexpr float kLeastContrast = 0.2F;  // of the usual one
  constexpr float kMostVariance = 3;      // times the usual one
  constexpr float kModel = 0.006F;        // of the contrast squared: 8 % off anywhere
  return stretch.contrast > kLeastContrast * all.contrast &&
         stretch.variance <
             kMostVariance * all.variance + kModel * stretch.contrast * stretch.contrast;
}

// A cell's darkness by the stretch around it that follows best.
struct Vote {
  float darkness = 0;
  float weight = 0;
};

// For each stretch of a row the one around its middle that follows best, if any does.
std::vector<const Stretch*> best_around(const Stretches& stretches, std::size_t row) {
  std::vector<const Stretch*> following(stretches.per_row, nullptr);
  for (std::size_t i = 0; i < following.size(); ++i) {
    const std::optional<Stretch>& stretch = stretches.at(row, i);
    if (stretch && follows(*stretch, stretches)) following[i] = &*stretch;
  }
  const std::size_t reach = stretches.reach / stretches.stride;
  std::vector<const Stretch*> best(stretches.per_row, nullptr);
  for (std::size_t here = 0; here < best.size(); ++here) {
    const std::size_t begin = here > reach ? here - reach + 1 : 0;
    const std::size_t end = std::min(stretches.per_row, here + reach);
    const Stretch*& chosen = best[here];
    for (std::size_t i = begin; i < end; ++i) {
      const Stretch* stretch = following[i];
      if (stretch == nullptr) continue;
      if (chosen == nullptr || stretch->variance * chosen->contrast * chosen->contrast <
                                   chosen->variance * stretch->contrast * stretch->contrast) {
        chosen = stretch;
      }
    }
  }
  return best;
}

// The same for all rows.
std::vector<std::vector<const Stretch*>> best_in_rows(const BarRows& rows,
                                                      const Stretches& stretches) {
  std::vector<std::vector<const Stretch*>> best;
  best.reserve(rows.rows);
  for (std::size_t row = 0; row < rows.rows; ++row) best.push_back(best_around(stretches, row));
  return best;
}

Vote vote_of(const BarRows& rows, const Stretches& stretches, const Stretch* best, std::size_t row,
             std::size_t bin, const Common& common) {
  const float count = rows.count(row, bin);
  if (count == 0 || best == nullptr) return {};
  const float off = rows.position(row, bin) - rows.middles[bin];
  const float variance = std::max(stretches.variance, best->variance);
  const float white = best->white + best->gradient * (static_cast<float>(bin) - best->middle);
  return {(white - rows.cell(row, bin).light) / best->contrast - off * common.slope[bin],
          count * best->contrast * best->contrast / variance};
}

// For every value how many of the others are less.
using Ranks = std::vector<std::int32_t>;

TAGSMITH_WIDE void count_less(const float* values, std::size_t count, std::int32_t* ranks) {
  constexpr std::size_t kTogether = 32;  // in the machine's vectors
  for (std::size_t begin = 0; begin < count; begin += kTogether) {
    std::array<std::int32_t, kTogether> less{};
    for (std::size_t other = 0; other < count; ++other) {
      const float value = values[other];
      for (std::size_t i = 0; i < kTogether; ++i) less[i] += value < values[begin + i] ? 1 : 0;
    }
    std::ranges::copy(less, ranks + begin);
  }
}

// Sorts votes by darkness. A cell's fifty to a hundred are put where their ranks say: comparing all
// with all has no branches to guess wrong.
class VoteSorter {
 public:
  void sort(std::vector<Vote>& votes) {
    constexpr std::size_t kPadding = 32;
    const std::size_t padded = (votes.size() + kPadding - 1) / kPadding * kPadding;
    darkness_.resize(padded);
    ranks_.resize(padded);
    std::ranges::transform(votes, darkness_.begin(), &Vote::darkness);
    count_less(darkness_.data(), votes.size(), ranks_.data());
    sorted_.resize(votes.size());
    taken_.assign(votes.size(), 0);
    for (std::size_t i = 0; i < votes.size(); ++i) {
      const auto rank = static_cast<std::size_t>(ranks_[i]);
      sorted_[rank + taken_[rank]++] = votes[i];
    }
    votes.swap(sorted_);
  }

 private:
  std::vector<float> darkness_;
  Ranks ranks_;
  std::vector<std::size_t> taken_;  // places of equal votes
  std::vector<Vote> sorted_;
};

float weighted_median(std::vector<Vote>& votes, VoteSorter& sorter) {
  sorter.sort(votes);
  float total = 0;
  for (const Vote& vote : votes) total += vote.weight;
  float sum = 0;
  for (const Vote& vote : votes) {
    sum += vote.weight;
    if (sum >= total / 2) return vote.darkness;
  }
  return votes.empty() ? 0.0F : votes.back().darkness;
}

// A bin's rows put together.
struct Agreed {
  float darkness = 0;
  float weight = 0;  // inverse variance; 0 = no row shows it
  float doubt = 0;   // share of the weight that disagrees
  float shown = 0;   // share of the rows
};

Agreed agree(std::vector<Vote>& votes, std::size_t rows, VoteSorter& sorter) {
  constexpr float kTolerance = 0.2F;  // of the contrast
  Agreed agreed;
  if (votes.empty()) return agreed;
  const float middle = weighted_median(votes, sorter);
  float sum = 0, odd = 0;
  std::size_t used = 0;
  for (const Vote& vote : votes) {
    if (std::abs(vote.darkness - middle) > kTolerance + 3 / std::sqrt(vote.weight)) {
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

// Mean light of a few rows, bin by bin, and which bins it is known for.
struct Band {
  std::vector<float> light;
  std::vector<float> count;
};

Band band_of(const BarRows& rows, std::size_t first, std::size_t end) {
  Band band{std::vector<float>(rows.bins), std::vector<float>(rows.bins)};
  for (std::size_t row = first; row < end; ++row) {
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      band.light[bin] += rows.count(row, bin) * rows.cell(row, bin).light;
      band.count[bin] += rows.count(row, bin);
    }
  }
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    if (band.count[bin] > 0) band.light[bin] /= band.count[bin];
  }
  return band;
}

// Levels near a place.
struct Levels {
  float low = 0;
  float high = 0;
};

// Of the known values within `reach_modules` of every bin, farther inside at the ends, found once a
// module; noise and single outliers left out.
std::vector<Levels> levels_near(const std::vector<float>& values, const std::vector<float>& known,
                                double reach_modules, double per_module) {
  constexpr double kLeftOut = 0.1;
  const auto reach = static_cast<std::size_t>(reach_modules * per_module);
  const auto stride = static_cast<std::size_t>(per_module);
  // Of one length everywhere: a quiet zone and a guard alone show little black.
  const std::size_t length = std::min(values.size(), 2 * reach + 1);
  std::vector<Levels> levels(values.size());
  SortedWindow<float> near;
  std::size_t removed = 0, added = 0;  // values up to these were
  for (std::size_t begin = 0; begin < values.size(); begin += stride) {
    const std::size_t end = std::min(values.size(), begin + stride);
    const std::size_t bin = (begin + end) / 2;
    const std::size_t first = std::min(bin > reach ? bin - reach : 0, values.size() - length);
    for (; added < first + length; ++added) {
      if (known[added] > 0) near.add(values[added]);
    }
    for (; removed < first; ++removed) {
      if (known[removed] > 0) near.remove(values[removed]);
    }
    if (near.empty()) continue;
    const Levels here{near.quantile(kLeftOut), near.quantile(1 - kLeftOut)};
    std::fill(levels.begin() + static_cast<std::ptrdiff_t>(begin),
              levels.begin() + static_cast<std::ptrdiff_t>(end), here);
  }
  return levels;
}

constexpr double kLevelsReach = 7;  // modules: two digits, which hold wide elements

// Darkness between the white and the black near by; how far these are apart within a digit's
// length: hardly where the bars do not show.
struct LocalDarkness {
  std::vector<float> darkness;
  std::vector<float> contrast;
};

LocalDarkness local_darkness_of(const Band& band, double per_module) {
  constexpr double kContrastReach = 4;  // modules
  const std::size_t bins = band.light.size();
  LocalDarkness result{std::vector<float>(bins), std::vector<float>(bins)};
  const auto levels = levels_near(band.light, band.count, kLevelsReach, per_module);
  const auto close = levels_near(band.light, band.count, kContrastReach, per_module);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    if (band.count[bin] == 0) continue;
    result.contrast[bin] = close[bin].high - close[bin].low;
    result.darkness[bin] =
        (levels[bin].high - band.light[bin]) / std::max(levels[bin].high - levels[bin].low, 1e-4F);
  }
  return result;
}

// The first guess: the middle of what a few rows at a time show between their own white and black,
// those with clear bars before others.
Common first_guess(const BarRows& rows) {
  constexpr std::size_t kBands = 14;
  constexpr float kLeastContrast = 0.2F;  // of the usual one
  std::vector<Band> bands;
  std::vector<LocalDarkness> seen;
  std::vector<double> contrasts;
  const std::size_t step = std::max<std::size_t>(2, rows.rows / kBands);
  for (std::size_t row = 0; row + step <= rows.rows; row += step) {
    bands.push_back(band_of(rows, row, row + step));
    seen.push_back(local_darkness_of(bands.back(), rows.grid.per_module));
    for (const float contrast : seen.back().contrast) {
      contrasts.push_back(static_cast<double>(contrast));
    }
  }
  Common common{std::vector<float>(rows.bins), std::vector<float>(rows.bins), {}};
  const auto least = kLeastContrast * static_cast<float>(quantile(contrasts, 0.6));
  std::vector<Vote> votes;
  VoteSorter sorter;
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    votes.clear();
    for (std::size_t i = 0; i < bands.size(); ++i) {
      const float contrast = seen[i].contrast[bin];
      if (bands[i].count[bin] == 0 || contrast < least) continue;
      votes.push_back({seen[i].darkness[bin], bands[i].count[bin] * contrast * contrast});
    }
    common.darkness[bin] = weighted_median(votes, sorter);
    common.certainty[bin] = votes.empty() ? 0.0F : 1.0F;
  }
  find_slopes(rows, common);
  return common;
}

std::vector<Agreed> agree_on_all(const BarRows& rows, const Stretches& stretches,
                                 const Common& common) {
  constexpr std::size_t kTogether = 16;  // bins: a row's cells of these lie side by side
  std::vector<Agreed> agreed;
  agreed.reserve(rows.bins);
  const auto best = best_in_rows(rows, stretches);
  std::array<std::vector<Vote>, kTogether> votes;
  VoteSorter sorter;
  for (std::size_t first = 0; first < rows.bins; first += kTogether) {
    const std::size_t count = std::min(kTogether, rows.bins - first);
    for (std::vector<Vote>& of_bin : votes) of_bin.clear();
    for (std::size_t row = 0; row < rows.rows; ++row) {
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t bin = first + i;
        const Stretch* stretch = best[row][bin / stretches.stride];
        const Vote vote = vote_of(rows, stretches, stretch, row, bin, common);
        if (vote.weight > 0) votes[i].push_back(vote);
      }
    }
    for (std::size_t i = 0; i < count; ++i) agreed.push_back(agree(votes[i], rows.rows, sorter));
  }
  return agreed;
}

// Rows are fitted to what they have in common and that is made of them again, which leaves its
// level and contrast adrift: they are set anew from the elements near by.
void anchor(std::vector<Agreed>& agreed, double per_module) {
  std::vector<float> values, known;
  for (const Agreed& at : agreed) {
    values.push_back(at.darkness);
    known.push_back(at.weight);
  }
  constexpr double kReach =
      10;  // modules: the drift is slow, and many elements tell the levels well
  const auto levels = levels_near(values, known, kReach, per_module);
  for (std::size_t bin = 0; bin < agreed.size(); ++bin) {
    if (agreed[bin].weight == 0) continue;
    const float contrast = std::max(levels[bin].high - levels[bin].low, 0.1F);
    agreed[bin].darkness = (agreed[bin].darkness - levels[bin].low) / contrast;
    agreed[bin].weight *= contrast * contrast;
  }
}

Common common_of(const BarRows& rows, const std::vector<Agreed>& agreed, const Common& before) {
  Common common = before;
  for (std::size_t bin = 0; bin < agreed.size(); ++bin) {
    common.certainty[bin] = agreed[bin].weight > 0 ? 1.0F : 0.0F;
    if (agreed[bin].weight > 0) common.darkness[bin] = agreed[bin].darkness;
  }
  find_slopes(rows, common);
  return common;
}

ScanProfile profile_of(const BarRows& rows, const std::vector<Agreed>& agreed,
                       const SymbolLayout& layout) {
  constexpr float kModelError = 0.02F;  // of the contrast
  constexpr float kFewRows = 0.1F;      // of the contrast where hardly a row shows
  constexpr float kLeastShown = 0.05F;
  ScanProfile profile;
  for (std::size_t bin = 0; bin < agreed.size(); ++bin) {
    const Agreed& at = agreed[bin];
    if (rows.middles[bin] < 0) continue;
    const double place =
        (static_cast<double>(rows.first_bin) + static_cast<double>(rows.middles[bin])) /
            rows.grid.per_module -
        layout.quiet_zone_modules;
    if (at.weight == 0 || at.shown < kLeastShown) {
      profile.push_back({place, 0.5, kHidden, 1});
      continue;
    }
    const float few = kFewRows * (1 - at.shown) * (1 - at.shown);
    const float doubt = std::min(1.0F, 2 * at.doubt);
    const float variance =
        1 / at.weight + kModelError * kModelError + few * few + doubt * doubt * doubt * doubt;
    profile.push_back({place, static_cast<double>(at.darkness), static_cast<double>(variance), 1});
  }
  return profile;
}

// A symbol's rows, cut out of the picture.
struct RowsOfSymbol {
  BarRows rows;
  double module_px = 0;
  int bins_per_module = 0;
};

// `corners` from P on; `stroke_px` is the frame's.
RowsOfSymbol rows_of_symbol(const GrayView& image, const Quad& corners, double stroke_px,
                            const SymbolLayout& layout, const FrameMap& image_from_unit) {
  constexpr double kRowHeight = 2.5;  // pixels: enough for most bins to hold one
  const double modules = kModuleCount + 2 * layout.quiet_zone_modules;
  RowsOfSymbol result;
  result.module_px = distance(image_from_unit(0.5 - 0.5 / modules, 0.5),
                              image_from_unit(0.5 + 0.5 / modules, 0.5));
  const double height = (distance(corners[0], corners[3]) + distance(corners[1], corners[2])) / 2;
  const auto row_count =
      static_cast<std::size_t>(std::clamp(std::lround(height / kRowHeight), 24L, 96L));
  result.bins_per_module = std::clamp(static_cast<int>(std::lround(2.5 * result.module_px)), 3, 6);
  const std::vector<CoverStrip> strips =
      find_cover_strips(image, image_from_unit, layout, stroke_share(corners, stroke_px));
  result.rows =
      bar_rows(light_grid(image, image_from_unit, modules, result.bins_per_module, row_count),
               layout, strips, height);
  return result;
}

// What a symbol's rows have in common, at last.
struct SettledRows {
  std::vector<Agreed> agreed;
  Common common;
};

SettledRows settle(const BarRows& rows, AddedLight added) {
  constexpr int kRounds = 4;
  SettledRows settled{{}, first_guess(rows)};
  for (int round = 0; round < kRounds; ++round) {
    const Stretches stretches = fit_stretches(rows, settled.common, added);
    settled.agreed = agree_on_all(rows, stretches, settled.common);
    anchor(settled.agreed, rows.grid.per_module);
    settled.common = common_of(rows, settled.agreed, settled.common);
  }
  return settled;
}

// By how many modules the symbol's begin and end move from the frame's upper side to its lower one,
// against the frame.
struct Lean {
  double at_begin = 0;
  double at_end = 0;
};

// A row that is moved by m modules against the others differs from them by m times their slope:
// least squares over all cells of stretches that follow, each bin's rows against their own mean.
std::optional<Lean> lean_of(const BarRows& rows) {
  constexpr float kMostOff = 0.35F;  // of the contrast: what is more is something else
  constexpr double kLeastInformation = 1e-6;
  const Common common = settle(rows, AddedLight::even).common;
  const Stretches stretches = fit_stretches(rows, common, AddedLight::even);
  const auto best = best_in_rows(rows, stretches);
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    if (common.slope[bin] == 0) continue;
    double w = 0, v = 0, r = 0, vv = 0, vr = 0;
    for (std::size_t row = 0; row < rows.rows; ++row) {
      const Stretch* stretch = best[row][bin / stretches.stride];
      const Vote vote = vote_of(rows, stretches, stretch, row, bin, common);
      const float off = vote.darkness - common.darkness[bin];
      if (vote.weight == 0 || std::abs(off) > kMostOff) continue;
      const double weight = static_cast<double>(vote.weight);
      const double height = rows.grid.height_of(rows.first_row + row);
      w += weight;
      v += weight * height;
      r += weight * static_cast<double>(off);
      vv += weight * height * height;
      vr += weight * height * static_cast<double>(off);
    }
    if (w == 0) continue;
    // Darkness falls where the row is moved towards darker places.
    const double slope = -static_cast<double>(common.slope[bin]) * rows.grid.per_module;
    const double t = (static_cast<double>(bin) + 0.5) / static_cast<double>(rows.bins);
    const double share = (t * (kModuleCount + 2 * kBeyond) - kBeyond) / kModuleCount;
    const Eigen::Vector2d row{slope * (1 - share), slope * share};
    normal += (vv - v * v / w) * row * row.transpose();
    right += (vr - v * r / w) * row;
  }
  if (!(normal.determinant() > kLeastInformation * normal.squaredNorm())) return std::nullopt;
  const Eigen::Vector2d lean = normal.ldlt().solve(right);
  return Lean{lean[0], lean[1]};
}

}  // namespace

struct CoveredSymbol::Seen {
  FrameMap image_from_unit;
  SymbolLayout layout;
  RowsOfSymbol symbol;
  double blur = 0;  // modules
};

CoveredSymbol::CoveredSymbol(const GrayView& image, const RefinedFrame& frame,
                             std::size_t first_corner, const SymbolLayout& layout) {
  const auto [corners, sides] = turned_to(frame, first_corner);
  const FrameMap image_from_unit(corners, frame.lens);
  RowsOfSymbol symbol = rows_of_symbol(
      image, corners, (sides[0].stroke_px + sides[2].stroke_px) / 2, layout, image_from_unit);
  const double blur = blur_across(sides, symbol.module_px, 1.0 / symbol.bins_per_module);
  seen_ = std::make_unique<Seen>(Seen{image_from_unit, layout, std::move(symbol), blur});
}

CoveredSymbol::CoveredSymbol(CoveredSymbol&&) noexcept = default;
CoveredSymbol& CoveredSymbol::operator=(CoveredSymbol&&) noexcept = default;
CoveredSymbol::~CoveredSymbol() = default;

SymbolProfile CoveredSymbol::profile(AddedLight added) {
  BarRows& rows = seen_->symbol.rows;
  const std::vector<float> counts = rows.counts;
  // What a highlight bleaches is plain too: there its rows' own light decides.
  if (added == AddedLight::even) leave_out_plain(rows);
  SymbolProfile profile;
  profile.module_px = seen_->symbol.module_px;
  profile.bins = profile_of(rows, settle(rows, added).agreed, seen_->layout);
  rows.counts = counts;
  set_spreads(seen_->image_from_unit, seen_->layout, profile.bins);
  profile.blur = seen_->blur;
  return profile;
}

Quad aligned_to_bars(const GrayView& image, const Quad& corners, double stroke_px,
                     const SymbolLayout& layout, const LensBend& lens) {
  constexpr int kRounds = 4;
  constexpr double kStill = 0.02;  // modules
  constexpr double kMostLean = 2;  // modules: the outer rows are then two thirds of one off
  const double modules = kModuleCount + 2 * layout.quiet_zone_modules;
  Quad aligned = corners;
  for (int round = 0; round < kRounds; ++round) {
    const FrameMap map(aligned, lens);
    BarRows rows = rows_of_symbol(image, aligned, stroke_px, layout, map).rows;
    leave_out_plain(rows);
    const auto lean = lean_of(rows);
    if (!lean) return corners;
    // At the frame's sides, beyond the bars.
    const double growth = (lean->at_end - lean->at_begin) / kModuleCount;
    const double left = lean->at_begin - growth * layout.quiet_zone_modules;
    const double right = lean->at_end + growth * layout.quiet_zone_modules;
    if (std::max(std::abs(left), std::abs(right)) > kMostLean) return corners;
    aligned = {map(-left / 2 / modules, 0), map(1 - right / 2 / modules, 0),
               map(1 + right / 2 / modules, 1), map(left / 2 / modules, 1)};
    if (std::max(std::abs(left), std::abs(right)) < kStill) break;
  }
  return aligned;
}

}  // namespace tagsmith
