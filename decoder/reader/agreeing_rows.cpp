// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/agreeing_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "decoder/reader/tuning.hpp"
#include "tagsmith/base/normal.hpp"
#include "tagsmith/base/quantile.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kModelVariance = kProfile.model_error * kProfile.model_error;

// A quantity over the frame, bilinear between its corners.
double bilinear(const std::array<double, 4>& at, double u, double v) {
  return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * at[3] + u * at[2]);
}

// Light along a row, and its change a bin.
struct RowLevels {
  float white = 1, white_step = 0;
  float black = 0, black_step = 0;
};

// Along a row the levels change evenly.
RowLevels levels_along(const SymbolRows& rows, const PlateLevels& levels, double v) {
  const double begin = rows.width_share_of(0.5);
  const double next = rows.width_share_of(1.5);
  const auto level = [&](const std::array<double, 4>& of, double u) {
    return static_cast<float>(bilinear(of, u, v));
  };
  const float white = level(levels.white, begin), black = level(levels.black, begin);
  return {white, level(levels.white, next) - white, black, level(levels.black, next) - black};
}

// Cells of one row, or of all, each quantity by itself for the compiler's vectors. Darkness: 0 =
// the plate's white, 1 = the frame's black; place and count as in a RowCell.
template <class Float>
struct DarkCells {
  Float* darkness;
  Float* place;
  Float* count;
};

TAGSMITH_WIDE void darken(const RowCell* cells, int size, const RowLevels& levels,
                          const DarkCells<float>& to) {
  constexpr float kLeastContrast = 1e-3F;
  const auto [white, white_step, black, black_step] = levels;
  TAGSMITH_INDEPENDENT_TURNS
  for (int bin = 0; bin < size; ++bin) {
    const auto at = static_cast<float>(bin);
    const float here = white + at * white_step;
    const float contrast = here - (black + at * black_step);
    to.darkness[bin] =
        (here - cells[bin].light) / (contrast > kLeastContrast ? contrast : kLeastContrast);
    to.place[bin] = cells[bin].place;
    to.count[bin] = cells[bin].count;
  }
}

// The rows of a part of the bars' height, and which bins they are of: those that pixels fell into.
class DarkRows {
 public:
  DarkRows(const SymbolRows& rows, const PlateLevels& levels, double top, double bottom)
      : bins_(rows.bins) {
    std::iota(bins_.begin(), bins_.end(), std::size_t{0});
    for (std::size_t row = 0; row < rows.rows; ++row) {
      const double v = rows.height_of(row);
      if (v < top || v > bottom) continue;
      const std::size_t begin = rows_ * rows.bins;
      for (std::vector<float>* of : {&darkness_, &place_, &count_}) of->resize(begin + rows.bins);
      darken(&rows.cell(row, 0), static_cast<int>(rows.bins), levels_along(rows, levels, v),
             {darkness_.data() + begin, place_.data() + begin, count_.data() + begin});
      ++rows_;
    }
    leave_out_empty();
  }

  std::size_t rows() const { return rows_; }
  const std::vector<std::size_t>& bins() const { return bins_; }
  DarkCells<const float> row(std::size_t row) const {
    const std::size_t begin = row * bins_.size();
    return {darkness_.data() + begin, place_.data() + begin, count_.data() + begin};
  }

 private:
  void leave_out_empty() {
    std::vector<std::size_t> filled;
    for (const std::size_t bin : bins_) {
      std::size_t row = 0;
      while (row < rows_ && count_[row * bins_.size() + bin] == 0) ++row;
      if (row < rows_) filled.push_back(bin);
    }
    if (filled.size() == bins_.size()) return;
    for (std::vector<float>* of : {&darkness_, &place_, &count_}) {
      std::size_t to = 0;
      for (std::size_t row = 0; row < rows_; ++row) {
        for (const std::size_t bin : filled) (*of)[to++] = (*of)[row * bins_.size() + bin];
      }
    }
    bins_ = std::move(filled);
  }

  std::size_t rows_ = 0;
  std::vector<std::size_t> bins_;
  std::vector<float> darkness_, place_, count_;  // row by row
};

// What a bin's cells show together.
struct BinTotals {
  explicit BinTotals(std::size_t size)
      : least(size, std::numeric_limits<float>::max()),
        most(size, std::numeric_limits<float>::lowest()),
        sum(size),
        cells(size),
        darkness(size),
        place(size),
        count(size) {}

  std::vector<float> least, most, sum, cells;  // of darkness; cells that hold pixels
  std::vector<double> darkness, place, count;  // sums over pixels
};

TAGSMITH_WIDE void add_extremes(const DarkCells<const float>& row, int size, float* least,
                                float* most, float* sum, float* cells) {
  TAGSMITH_INDEPENDENT_TURNS
  for (int i = 0; i < size; ++i) {
    const float darkness = row.darkness[i];
    const bool is_seen = row.count[i] > 0;
    least[i] = is_seen && darkness < least[i] ? darkness : least[i];
    most[i] = is_seen && darkness > most[i] ? darkness : most[i];
    sum[i] += is_seen ? darkness : 0.0F;
    cells[i] += is_seen ? 1.0F : 0.0F;
  }
}

TAGSMITH_WIDE void add_pixels(const DarkCells<const float>& row, int size, double* darkness,
                              double* place, double* count) {
  TAGSMITH_INDEPENDENT_TURNS
  for (int i = 0; i < size; ++i) {
    const auto pixels = static_cast<double>(row.count[i]);
    darkness[i] += pixels * static_cast<double>(row.darkness[i]);
    place[i] += pixels * static_cast<double>(row.place[i]);
    count[i] += pixels;
  }
}

BinTotals totals_of(const DarkRows& rows) {
  BinTotals all(rows.bins().size());
  const auto size = static_cast<int>(rows.bins().size());
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    add_extremes(rows.row(row), size, all.least.data(), all.most.data(), all.sum.data(),
                 all.cells.data());
    add_pixels(rows.row(row), size, all.darkness.data(), all.place.data(), all.count.data());
  }
  return all;
}

// What the rows agree on in each bin.
struct Consensus {
  explicit Consensus(std::size_t size) : median(size), place(size), slope(size), tolerated(size) {}

  std::vector<float> median;
  std::vector<float> place;      // mean place of the bin's pixels, bins
  std::vector<float> slope;      // change of darkness a bin
  std::vector<float> tolerated;  // difference of darkness that is no disagreement
};

// The median of what rows show of a bin; where all are alike, their mean, which is quicker.
float middle_of(const DarkRows& rows, const BinTotals& totals, std::size_t i,
                std::vector<float>& seen) {
  if (totals.most[i] - totals.least[i] <= static_cast<float>(kProfile.shading))
    return totals.sum[i] / totals.cells[i];
  seen.clear();
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    const DarkCells cells = rows.row(row);
    if (cells.count[i] > 0) seen.push_back(cells.darkness[i]);
  }
  return quantile(seen, 0.5);
}

Consensus consensus_of(const DarkRows& rows, const BinTotals& totals) {
  const std::size_t size = rows.bins().size();
  Consensus all(size);
  std::vector<float> seen;
  for (std::size_t i = 0; i < size; ++i) {
    all.median[i] = middle_of(rows, totals, i, seen);
    all.place[i] = static_cast<float>(totals.place[i] / totals.count[i]);
  }
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, size - 1);
    const float run = std::max(0.5F, all.place[after] - all.place[before]);
    const float rise = all.median[i] - all.median[before], next = all.median[after] - all.median[i];
    all.slope[i] = (rise + next) / run;
    all.tolerated[i] =
        static_cast<float>(kProfile.shading) +
        static_cast<float>(kProfile.slanted) * std::max(std::abs(rise), std::abs(next));
  }
  return all;
}

// Variance of one pixel's darkness: from the median of what cells are off.
double pixel_variance(const DarkRows& rows, const Consensus& consensus) {
  constexpr double kMedianChi2 = 0.455;  // of one degree of freedom
  constexpr std::size_t kEvery = 4;      // bins: some 2,000 cells tell it to 3 %
  std::vector<float> squares;
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    const DarkCells cells = rows.row(row);
    for (std::size_t i = 0; i < rows.bins().size(); i += kEvery) {
      if (cells.count[i] == 0) continue;
      const float expected =
          consensus.median[i] + consensus.slope[i] * (cells.place[i] - consensus.place[i]);
      const float off = cells.darkness[i] - expected;
      squares.push_back(off * off * cells.count[i]);
    }
  }
  if (squares.empty()) return kModelVariance;
  return std::max(kModelVariance, static_cast<double>(quantile(squares, 0.5)) / kMedianChi2);
}

// Marks the cells of a row that are farther from what the rows agree on, at their pixels' mean
// place, than noise and shading allow. `most`: of the squared difference times the pixels.
TAGSMITH_WIDE void mark_odd(const DarkCells<const float>& row, int size, const float* median,
                            const float* place, const float* slope, const float* tolerated,
                            float most, std::uint8_t* odd) {
  TAGSMITH_INDEPENDENT_TURNS
  for (int i = 0; i < size; ++i) {
    const float off = row.darkness[i] - (median[i] + slope[i] * (row.place[i] - place[i]));
    const float beyond = (off < 0 ? -off : off) - tolerated[i];
    odd[i] = beyond > 0 && beyond * beyond * row.count[i] > most ? 1 : 0;
  }
}

// Which cells to leave out, row by row.
class CellStates {
 public:
  CellStates(const DarkRows& rows, const Consensus& consensus, double variance, int per_module)
      : bins_(rows.bins()), states_(rows.rows() * bins_.size()) {
    const auto most = static_cast<float>(kBeyondNoise * kBeyondNoise * variance);
    for (std::size_t row = 0; row < rows.rows(); ++row) {
      const std::span<std::uint8_t> states = states_of(row);
      mark_odd(rows.row(row), static_cast<int>(states.size()), consensus.median.data(),
               consensus.place.data(), consensus.slope.data(), consensus.tolerated.data(), most,
               states.data());
      if (is_clear(row)) continue;
      std::vector<std::size_t> odd;
      for (std::size_t i = 0; i < states.size(); ++i) {
        if (states[i] == kOdd) odd.push_back(i);
      }
      mark_covers(states, odd, per_module);
    }
  }

  // Whether no cell of a row is odd.
  bool is_clear(std::size_t row) const {
    const auto begin = states_.begin() + static_cast<std::ptrdiff_t>(row * bins_.size());
    const auto end = begin + static_cast<std::ptrdiff_t>(bins_.size());
    return std::find_if(begin, end, [](std::uint8_t state) { return state != 0; }) == end;
  }
  // Whether a cell disagrees with the other rows.
  bool is_odd(std::size_t row, std::size_t i) const {
    return (states_[row * bins_.size() + i] & kOdd) != 0;
  }
  // Whether it lies on a stretch of its row with something in front.
  bool is_covered(std::size_t row, std::size_t i) const {
    return (states_[row * bins_.size() + i] & kCovered) != 0;
  }

 private:
  static constexpr std::uint8_t kOdd = 1;
  static constexpr std::uint8_t kCovered = 2;

  std::span<std::uint8_t> states_of(std::size_t row) {
    return std::span(states_).subspan(row * bins_.size(), bins_.size());
  }

  // An occluder disagrees in spaces, if it is dark, and on bars, if it is light: its stretch of a
  // row is what lies between odd cells that stand close.
  void mark_covers(std::span<std::uint8_t> states, const std::vector<std::size_t>& odd,
                   int per_module) const {
    const auto bin = [&](std::size_t k) { return bins_[odd[k]]; };
    for (std::size_t begin = 0, k = 1; k <= odd.size(); ++k) {
      if (k < odd.size() && static_cast<double>(bin(k) - bin(k - 1)) <= kNearModules * per_module) {
        continue;
      }
      const auto run = static_cast<double>(bin(k - 1) + 1 - bin(begin));
      if (run >= kProfile.least_run * per_module &&
          static_cast<double>(k - begin) >= kProfile.least_used * run) {
        // A pixel's width of the occluder's outline belongs to it too.
        const std::size_t first = odd[begin] - (odd[begin] > 0 ? 1 : 0);
        const std::size_t last = std::min(odd[k - 1] + 1, states.size() - 1);
        for (std::size_t i = first; i <= last; ++i) states[i] |= kCovered;
      }
      begin = k;
    }
  }

  const std::vector<std::size_t>& bins_;
  std::vector<std::uint8_t> states_;
};

// Sums over pixels of a bin's rows.
struct PixelSums {
  double darkness = 0, place = 0, count = 0;

  void add(const DarkCells<const float>& row, std::size_t i, double sign = 1) {
    const double pixels = sign * static_cast<double>(row.count[i]);
    darkness += pixels * static_cast<double>(row.darkness[i]);
    place += pixels * static_cast<double>(row.place[i]);
    count += pixels;
  }
};

// A bin's rows by state.
struct BinSums {
  PixelSums clear;         // neither odd nor covered
  PixelSums even;          // not odd
  PixelSums covered;       // odd or not
  double odd = 0;          // pixels
  double odd_outside = 0;  // of them, outside of covered stretches
};

std::vector<BinSums> sums_of(const DarkRows& rows, const BinTotals& totals,
                             const CellStates& states) {
  std::vector<BinSums> all(rows.bins().size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].even = {totals.darkness[i], totals.place[i], totals.count[i]};
    all[i].clear = all[i].even;
  }
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    if (states.is_clear(row)) continue;
    const DarkCells cells = rows.row(row);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool odd = states.is_odd(row, i), covered = states.is_covered(row, i);
      if (!odd && !covered) continue;
      all[i].clear.add(cells, i, -1);
      if (covered) all[i].covered.add(cells, i);
      if (!odd) continue;
      all[i].even.add(cells, i, -1);
      all[i].odd += static_cast<double>(cells.count[i]);
      if (!covered) all[i].odd_outside += static_cast<double>(cells.count[i]);
    }
  }
  return all;
}

// Variance of the darkness along the symbol, over a window.
class Modulation {
 public:
  void count(const PixelSums& pixels, double sign) {
    if (pixels.count == 0) return;
    const double darkness = pixels.darkness / pixels.count;
    count_ += sign;
    sum_ += sign * darkness;
    squares_ += sign * darkness * darkness;
  }

  double variance() const {
    return count_ < 2 ? 0 : std::max(0.0, squares_ / count_ - sum_ * sum_ / (count_ * count_));
  }

 private:
  double count_ = 0, sum_ = 0, squares_ = 0;
};

// Whether a bin's covered cells are to be left out: where they are plain along the symbol and the
// clear ones show bars, for no seven modules are without both bars and spaces. Where it is the
// other way round, the clear cells are the occluder.
std::vector<bool> certain_covers(const std::vector<BinSums>& sums, int per_module) {
  const std::size_t reach = kNearModules * static_cast<std::size_t>(per_module);
  std::vector<bool> certain(sums.size());
  Modulation clear, covered;
  const auto count = [&](const BinSums& bin, double sign) {
    clear.count(bin.clear, sign);
    covered.count(bin.covered, sign);
  };
  for (std::size_t i = 0; i < std::min(reach, sums.size()); ++i) count(sums[i], 1);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (i + reach < sums.size()) count(sums[i + reach], 1);
    if (i > reach) count(sums[i - reach - 1], -1);
    certain[i] = covered.variance() < kProfile.plainer * clear.variance();
  }
  return certain;
}

ScanBin bin_of(const SymbolRows& symbol, float median, float place, const BinSums& sums,
               bool certain, double variance) {
  const PixelSums& used = certain ? sums.clear : sums.even;
  const double odd = certain ? sums.odd_outside : sums.odd;
  const double seen = sums.even.count + sums.odd;
  if (used.count < kProfile.least_used * seen) {
    return {symbol.module_of(static_cast<double>(place)), static_cast<double>(median),
            kHiddenVariance, 0};
  }
  // Where the height disagrees with itself the median may have taken the wrong side: the doubt
  // grows from nothing at full agreement to the whole contrast where half disagrees.
  const double doubt = std::min(1.0, 2 * odd / (odd + used.count));
  return {symbol.module_of(used.place / used.count), used.darkness / used.count,
          variance / used.count + kModelVariance + doubt * doubt * doubt * doubt,
          used.count / seen};
}

}  // namespace

ScanProfile profile_of_agreeing(const SymbolRows& rows, const PlateLevels& levels, double top,
                                double bottom) {
  const DarkRows dark(rows, levels, top, bottom);
  const BinTotals totals = totals_of(dark);
  const Consensus consensus = consensus_of(dark, totals);
  const double variance = pixel_variance(dark, consensus);
  const CellStates states(dark, consensus, variance, rows.bins_per_module);
  const std::vector<BinSums> sums = sums_of(dark, totals, states);
  const std::vector<bool> certain = certain_covers(sums, rows.bins_per_module);
  ScanProfile profile;
  profile.reserve(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    profile.push_back(
        bin_of(rows, consensus.median[i], consensus.place[i], sums[i], certain[i], variance));
  }
  return profile;
}

}  // namespace tagsmith::detail
