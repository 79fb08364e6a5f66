// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/agreeing_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "decoder/reader/tuning.hpp"
#include "tagsmith/base/normal.hpp"
#include "tagsmith/base/quantile.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kModelVariance = kProfile.model_error * kProfile.model_error;

// A quantity over the frame, bilinear between its corners.
double bilinear(const std::array<double, 4>& at, double u, double v) {
  return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * at[3] + u * at[2]);
}

// The rows of a part of the bars' height with their darkness: 0 = the plate's white, 1 = the
// frame's black.
struct DarkRows {
  std::size_t rows = 0;
  std::size_t bins = 0;
  std::vector<RowCell> cells;  // row by row; `light` is the darkness

  const RowCell& at(std::size_t row, std::size_t bin) const { return cells[row * bins + bin]; }
};

DarkRows dark_rows(const SymbolRows& rows, const PlateLevels& levels, double top, double bottom) {
  constexpr float kLeastContrast = 1e-3F;
  DarkRows dark{0, rows.bins, {}};
  for (std::size_t row = 0; row < rows.rows; ++row) {
    const double v = rows.height_of(row);
    if (v < top || v > bottom) continue;
    const auto level = [&](const std::array<double, 4>& of, double u) {
      return static_cast<float>(bilinear(of, u, v));
    };
    // Along a row the levels change evenly.
    const double begin = rows.width_share_of(0.5);
    const double step = rows.width_share_of(1.5) - begin;
    const float white = level(levels.white, begin), black = level(levels.black, begin);
    const float white_step = level(levels.white, begin + step) - white;
    const float black_step = level(levels.black, begin + step) - black;
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      RowCell cell = rows.cell(row, bin);
      const auto at = static_cast<float>(bin);
      const float here = white + at * white_step;
      const float contrast = std::max(kLeastContrast, here - (black + at * black_step));
      cell.light = (here - cell.light) / contrast;
      dark.cells.push_back(cell);
    }
    ++dark.rows;
  }
  return dark;
}

// What the rows agree on in a bin that pixels fell into.
struct BinConsensus {
  std::size_t bin = 0;
  double median = 0;
  double place = 0;     // mean place of its pixels, bins
  double slope = 0;     // change of darkness a bin
  double steepest = 0;  // change of darkness to either neighbour
};

// The median of what rows show of a bin; where all are alike, their mean, which is quicker.
double middle_of(std::vector<float>& seen) {
  const auto [least, most] = std::ranges::minmax(seen);
  if (most - least > static_cast<float>(kProfile.shading))
    return static_cast<double>(quantile(seen, 0.5));
  return static_cast<double>(std::accumulate(seen.begin(), seen.end(), 0.0F)) /
         static_cast<double>(seen.size());
}

std::vector<BinConsensus> consensus_of(const DarkRows& rows) {
  std::vector<BinConsensus> all;
  all.reserve(rows.bins);
  std::vector<float> seen;
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    seen.clear();
    float place = 0, count = 0;
    for (std::size_t row = 0; row < rows.rows; ++row) {
      const RowCell& cell = rows.at(row, bin);
      if (cell.count == 0) continue;
      seen.push_back(cell.light);
      place += cell.count * cell.place;
      count += cell.count;
    }
    if (seen.empty()) continue;
    all.push_back({bin, middle_of(seen), static_cast<double>(place / count)});
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const BinConsensus& before = all[i == 0 ? 0 : i - 1];
    const BinConsensus& after = all[std::min(i + 1, all.size() - 1)];
    const double run = std::max(0.5, after.place - before.place);
    all[i].slope = (after.median - before.median) / run;
    all[i].steepest =
        std::max(std::abs(all[i].median - before.median), std::abs(after.median - all[i].median));
  }
  return all;
}

// How far a cell is from what the rows agree on at its pixels' mean place.
double distance_from(const BinConsensus& consensus, const RowCell& cell) {
  const double expected =
      consensus.median + consensus.slope * (static_cast<double>(cell.place) - consensus.place);
  return std::abs(static_cast<double>(cell.light) - expected);
}

// Variance of one pixel's darkness: from the median of what cells are off.
double pixel_variance(const DarkRows& rows, const std::vector<BinConsensus>& consensus) {
  constexpr double kMedianChi2 = 0.455;  // of one degree of freedom
  constexpr std::size_t kEvery = 4;      // bins: some 2,000 cells tell it to 3 %
  std::vector<float> squares;
  for (std::size_t i = 0; i < consensus.size(); i += kEvery) {
    const BinConsensus& at = consensus[i];
    for (std::size_t row = 0; row < rows.rows; ++row) {
      const RowCell& cell = rows.at(row, at.bin);
      if (cell.count == 0) continue;
      const double off = distance_from(at, cell);
      squares.push_back(static_cast<float>(off * off * static_cast<double>(cell.count)));
    }
  }
  if (squares.empty()) return kModelVariance;
  return std::max(kModelVariance, static_cast<double>(quantile(squares, 0.5)) / kMedianChi2);
}

// Whether a cell is as near what the rows agree on as noise and shading allow.
bool agrees(const BinConsensus& with, const RowCell& cell, double variance) {
  const double beyond =
      distance_from(with, cell) - kProfile.shading - kProfile.slanted * with.steepest;
  return beyond <= 0 || beyond * beyond <= kBeyondNoise * kBeyondNoise * variance /
                                               static_cast<double>(cell.count);
}

// Which cells to leave out, row by row.
class CellStates {
 public:
  CellStates(const DarkRows& rows, const std::vector<BinConsensus>& consensus, double variance,
             int per_module)
      : size_(consensus.size()), states_(rows.rows * size_) {
    for (std::size_t row = 0; row < rows.rows; ++row) {
      std::vector<std::size_t> odd;
      for (std::size_t i = 0; i < size_; ++i) {
        const RowCell& cell = rows.at(row, consensus[i].bin);
        if (cell.count == 0 || agrees(consensus[i], cell, variance)) continue;
        states_[row * size_ + i] |= kOdd;
        odd.push_back(i);
      }
      mark_covers(row, odd, consensus, per_module);
    }
  }

  bool is_odd(std::size_t row, std::size_t i) const {
    return (states_[row * size_ + i] & kOdd) != 0;
  }
  bool is_covered(std::size_t row, std::size_t i) const {
    return (states_[row * size_ + i] & kCovered) != 0;
  }

 private:
  static constexpr std::uint8_t kOdd = 1;      // disagrees with the other rows
  static constexpr std::uint8_t kCovered = 2;  // on a stretch of its row with something in front

  // An occluder disagrees in spaces, if it is dark, and on bars, if it is light: its stretch of a
  // row is what lies between odd cells that stand close.
  void mark_covers(std::size_t row, const std::vector<std::size_t>& odd,
                   const std::vector<BinConsensus>& consensus, int per_module) {
    const auto bin = [&](std::size_t k) { return consensus[odd[k]].bin; };
    for (std::size_t begin = 0, k = 1; k <= odd.size(); ++k) {
      if (k < odd.size() && static_cast<double>(bin(k) - bin(k - 1)) <= kNearModules * per_module) {
        continue;
      }
      const auto run = static_cast<double>(bin(k - 1) + 1 - bin(begin));
      if (run >= kProfile.least_run * per_module &&
          static_cast<double>(k - begin) >= kProfile.least_used * run) {
        // A pixel's width of the occluder's outline belongs to it too.
        const std::size_t first = odd[begin] - (odd[begin] > 0 ? 1 : 0);
        const std::size_t last = std::min(odd[k - 1] + 1, size_ - 1);
        for (std::size_t i = first; i <= last; ++i) states_[row * size_ + i] |= kCovered;
      }
      begin = k;
    }
  }

  std::size_t size_;
  std::vector<std::uint8_t> states_;
};

// Sums over pixels of a bin's rows.
struct PixelSums {
  double darkness = 0, place = 0, count = 0;

  void add(const RowCell& cell) {
    const auto pixels = static_cast<double>(cell.count);
    darkness += pixels * static_cast<double>(cell.light);
    place += pixels * static_cast<double>(cell.place);
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

std::vector<BinSums> sums_of(const DarkRows& rows, const std::vector<BinConsensus>& consensus,
                             const CellStates& states) {
  std::vector<BinSums> all(consensus.size());
  for (std::size_t row = 0; row < rows.rows; ++row) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const RowCell& cell = rows.at(row, consensus[i].bin);
      if (cell.count == 0) continue;
      const bool odd = states.is_odd(row, i), covered = states.is_covered(row, i);
      const auto count = static_cast<double>(cell.count);
      if (covered) all[i].covered.add(cell);
      if (!odd) all[i].even.add(cell);
      if (!odd && !covered) all[i].clear.add(cell);
      if (odd) all[i].odd += count;
      if (odd && !covered) all[i].odd_outside += count;
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

ScanBin bin_of(const SymbolRows& symbol, const BinConsensus& at, const BinSums& sums, bool certain,
               double variance) {
  const PixelSums& used = certain ? sums.clear : sums.even;
  const double odd = certain ? sums.odd_outside : sums.odd;
  const double seen = sums.even.count + sums.odd;
  if (used.count < kProfile.least_used * seen)
    return {symbol.module_of(at.place), at.median, kHiddenVariance, 0};
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
  const DarkRows dark = dark_rows(rows, levels, top, bottom);
  const std::vector<BinConsensus> consensus = consensus_of(dark);
  const double variance = pixel_variance(dark, consensus);
  const CellStates states(dark, consensus, variance, rows.bins_per_module);
  const std::vector<BinSums> sums = sums_of(dark, consensus, states);
  const std::vector<bool> certain = certain_covers(sums, rows.bins_per_module);
  ScanProfile profile;
  profile.reserve(consensus.size());
  for (std::size_t i = 0; i < consensus.size(); ++i) {
    profile.push_back(bin_of(rows, consensus[i], sums[i], certain[i], variance));
  }
  return profile;
}

}  // namespace tagsmith::detail
