// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "decoder/reader/cell_grid.hpp"
#include "decoder/reader/point_spread.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr std::size_t kMaxBands = 16;

// Bins side by side, in the compiler's own vectors.
constexpr std::size_t kLanes = 8;
using Floats = float __attribute__((vector_size(4 * kLanes)));

inline __attribute__((always_inline)) void load(const float* from, Floats& lanes) {
  std::memcpy(&lanes, from, sizeof lanes);
}

// The bins that pixels fell into.
std::vector<std::size_t> seen_bins(const CellGrid& grid) {
  std::vector<std::size_t> seen;
  seen.reserve(grid.bins);
  for (std::size_t bin = 0; bin < grid.bins; ++bin) {
    std::size_t band = 0;
    while (band < grid.bands && grid.at(band, bin).count == 0) ++band;
    if (band < grid.bands) seen.push_back(bin);
  }
  return seen;
}

// Copies cells of a band, taken by their bins, to arrays of their quantities: four at a time.
void copy_by_quantity(const Cell* cells, const std::vector<std::size_t>& bins, float* darkness,
                      float* squares, float* places, float* counts) {
  using Four = float __attribute__((vector_size(sizeof(Cell))));
  const std::size_t size = bins.size();
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4) {
    Four a, b, c, d;
    std::memcpy(&a, cells + bins[i], sizeof a);
    std::memcpy(&b, cells + bins[i + 1], sizeof b);
    std::memcpy(&c, cells + bins[i + 2], sizeof c);
    std::memcpy(&d, cells + bins[i + 3], sizeof d);
    const Four low_ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Four low_cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Four high_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Four high_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    const Four of_darkness = __builtin_shufflevector(low_ab, low_cd, 0, 1, 4, 5);
    const Four of_squares = __builtin_shufflevector(low_ab, low_cd, 2, 3, 6, 7);
    const Four of_places = __builtin_shufflevector(high_ab, high_cd, 0, 1, 4, 5);
    const Four of_counts = __builtin_shufflevector(high_ab, high_cd, 2, 3, 6, 7);
    std::memcpy(darkness + i, &of_darkness, sizeof a);
    std::memcpy(squares + i, &of_squares, sizeof a);
    std::memcpy(places + i, &of_places, sizeof a);
    std::memcpy(counts + i, &of_counts, sizeof a);
  }
  for (; i < size; ++i) {
    const Cell& cell = cells[bins[i]];
    darkness[i] = cell.darkness;
    squares[i] = cell.squares;
    places[i] = cell.place;
    counts[i] = cell.count;
  }
}

// The cells of the bins that pixels fell into, quantity by quantity and band by band: row k holds
// band k of all these bins. Padded with empty cells to whole vectors.
class SeenCells {
 public:
  explicit SeenCells(const CellGrid& grid)
      : bands_(grid.bands),
        bins_per_module_(grid.bins_per_module),
        bins_(seen_bins(grid)),
        stride_((bins_.size() + kLanes - 1) / kLanes * kLanes),
        values_(4 * bands_ * stride_) {
    for (std::size_t band = 0; band < bands_; ++band) {
      float* to = &values_[4 * band * stride_];
      copy_by_quantity(&grid.at(band, 0), bins_, to, to + stride_, to + 2 * stride_,
                       to + 3 * stride_);
    }
  }

  std::size_t bands() const { return bands_; }
  std::size_t size() const { return bins_.size(); }  // bins
  std::size_t padded_size() const { return stride_; }
  int bins_per_module() const { return bins_per_module_; }
  double bin_width() const { return 1.0 / bins_per_module_; }  // modules
  std::size_t bin(std::size_t i) const { return bins_[i]; }    // of the grid

  const float* darkness(std::size_t band) const { return &values_[4 * band * stride_]; }
  const float* squares(std::size_t band) const { return darkness(band) + stride_; }
  const float* places(std::size_t band) const { return darkness(band) + 2 * stride_; }
  const float* counts(std::size_t band) const { return darkness(band) + 3 * stride_; }

  Cell at(std::size_t band, std::size_t i) const {
    return {darkness(band)[i], squares(band)[i], places(band)[i], counts(band)[i]};
  }

 private:
  std::size_t bands_;
  int bins_per_module_;
  std::vector<std::size_t> bins_;
  std::size_t stride_;
  std::vector<float> values_;
};

// Variance of one pixel's darkness, pooled over the cells.
TAGSMITH_WIDE double pixel_variance(const SeenCells& cells) {
  // Half as many as are taken at a time: the compiler is at a loss with longer vectors.
  using HalfFloats = float __attribute__((vector_size(2 * kLanes)));
  using Doubles = double __attribute__((vector_size(4 * kLanes)));
  Doubles squares{}, freedom{};
  for (std::size_t band = 0; band < cells.bands(); ++band) {
    for (std::size_t i = 0; i < cells.padded_size(); i += kLanes / 2) {
      HalfFloats sums, of_squares, counts;
      std::memcpy(&sums, cells.darkness(band) + i, sizeof sums);
      std::memcpy(&of_squares, cells.squares(band) + i, sizeof of_squares);
      std::memcpy(&counts, cells.counts(band) + i, sizeof counts);
      const HalfFloats spread = of_squares - sums * sums / (counts < 1 ? 1 : counts);
      squares += __builtin_convertvector(counts < 2 ? HalfFloats{} : spread, Doubles);
      freedom += __builtin_convertvector(counts < 2 ? HalfFloats{} : counts - 1, Doubles);
    }
  }
  constexpr double kLeast = 1e-4;  // 1 % of the contrast: quantisation alone
  double all_squares = 0, all_freedom = 0;
  for (std::size_t k = 0; k < kLanes / 2; ++k) {
    all_squares += squares[k];
    all_freedom += freedom[k];
  }
  return all_freedom > 0 ? std::max(kLeast, all_squares / all_freedom) : 4e-4;
}

// Variance of one pixel's darkness in a cell that nothing hides in part: the middle one of the
// cells' own.
double clear_variance(const CellGrid& grid, double otherwise) {
  constexpr double kLeast = 1e-4;
  constexpr std::size_t kStep = 5;  // thousands of cells: every fifth tells the middle as well
  std::vector<float> variances;
  variances.reserve(grid.cells.size() / kStep + 1);
  for (std::size_t i = 0; i < grid.cells.size(); i += kStep) {
    const Cell& cell = grid.cells[i];
    if (cell.count < 3) continue;
    const float mean = cell.darkness / cell.count;
    variances.push_back((cell.squares - mean * cell.darkness) / (cell.count - 1));
  }
  if (variances.empty()) return otherwise;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return std::max(kLeast, static_cast<double>(*middle));
}

// The middle one of a bin's bands that have pixels there.
float median_of_bands(const SeenCells& cells, std::size_t i) {
  std::array<float, kMaxBands> means{};
  std::size_t count = 0;
  for (std::size_t band = 0; band < cells.bands(); ++band) {
    const Cell cell = cells.at(band, i);
    if (cell.count > 0) means[count++] = cell.darkness / cell.count;
  }
  const auto middle = means.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(means.begin(), middle, means.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

// The pairs that sort a list of `Count` values when each is put in order in turn (Batcher 1968,
// "Sorting networks and their applications"): no branch depends on the values.
template <std::size_t Count>
constexpr auto sorting_network() {
  struct Network {
    std::array<std::array<std::uint8_t, 2>, Count * Count / 2> pairs{};
    std::size_t size = 0;
  } network;
  for (std::size_t p = 1; p < Count; p *= 2) {
    for (std::size_t k = p; k >= 1; k /= 2) {
      for (std::size_t j = k % p; j + k < Count; j += 2 * k) {
        for (std::size_t i = j; i < j + k && i + k < Count; ++i) {
          if (i / (2 * p) != (i + k) / (2 * p)) continue;
          network.pairs[network.size++] = {static_cast<std::uint8_t>(i),
                                           static_cast<std::uint8_t>(i + k)};
        }
      }
    }
  }
  return network;
}

using Lanes = std::array<float, kLanes>;

// The means of `Count` bands of the bins from `first` on, all of whose cells have pixels, sorted.
template <std::size_t Count>
inline __attribute__((always_inline)) Lanes middle_of_bands(const SeenCells& cells,
                                                            std::size_t first) {
  static constexpr auto kNetwork = sorting_network<Count>();
  std::array<Floats, Count> means;
  for (std::size_t band = 0; band < Count; ++band) {
    Floats sums, counts;
    load(cells.darkness(band) + first, sums);
    load(cells.counts(band) + first, counts);
    means[band] = sums / counts;
  }
  for (std::size_t i = 0; i < kNetwork.size; ++i) {
    const auto [upper, lower] = kNetwork.pairs[i];
    const Floats a = means[upper], b = means[lower];
    means[upper] = a < b ? a : b;
    means[lower] = a < b ? b : a;
  }
  Lanes middle;
  std::memcpy(&middle, &means[Count / 2], sizeof middle);
  return middle;
}

TAGSMITH_WIDE Lanes middle_of_all_bands(const SeenCells& cells, std::size_t first) {
  return cells.bands() == kMaxBands ? middle_of_bands<kMaxBands>(cells, first)
                                    : middle_of_bands<kMaxBands / 2>(cells, first);
}

bool have_pixels(const SeenCells& cells, std::size_t first) {
  bool all = true;
  for (std::size_t band = 0; band < cells.bands(); ++band) {
    const float* counts = cells.counts(band) + first;
    for (std::size_t k = 0; k < kLanes; ++k) all &= counts[k] > 0;
  }
  return all;
}

// The medians of all bins' bands.
std::vector<float> medians_of_bands(const SeenCells& cells) {
  std::vector<float> medians(cells.padded_size());
  for (std::size_t first = 0; first < cells.size(); first += kLanes) {
    if (have_pixels(cells, first)) {
      std::ranges::copy(middle_of_all_bands(cells, first), &medians[first]);
      continue;
    }
    const std::size_t end = std::min(cells.size(), first + kLanes);
    for (std::size_t i = first; i < end; ++i) medians[i] = median_of_bands(cells, i);
  }
  return medians;
}

// What the bins' bands agree on, before covers are known.
struct Consensus {
  double median = 0;
  double steepest = 0;  // change of darkness to either neighbouring bin
  double slope = 0;     // mean change of darkness from bin to bin there
};

std::vector<Consensus> consensus_of(const SeenCells& cells) {
  std::vector<Consensus> all(cells.size());
  const std::vector<float> medians = medians_of_bands(cells);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto median = static_cast<double>(medians[i]);
    const auto before = static_cast<double>(medians[i == 0 ? 0 : i - 1]);
    const auto after = static_cast<double>(medians[std::min(i + 1, all.size() - 1)]);
    all[i] = {median, std::max(std::abs(median - before), std::abs(after - median)),
              (after - before) / 2};
  }
  return all;
}

constexpr double kShading = 0.1;   // of the contrast: differences along a clean bar
constexpr double kSlanted = 0.35;  // of the steepest change: what a slope does not tell of a bend

// Whether a cell shows what the other bands agree on at its pixels' mean place.
bool agrees(const SeenCells& cells, std::size_t band, std::size_t i, const Consensus& with,
            double variance) {
  const Cell cell = cells.at(band, i);
  const double per_pixel = 1 / static_cast<double>(cell.count);
  const double offset = static_cast<double>(cell.place) * per_pixel * cells.bins_per_module() -
                        static_cast<double>(cells.bin(i)) - 0.5;
  const double expected = with.median + with.slope * offset;
  const double off = std::abs(static_cast<double>(cell.darkness) * per_pixel - expected);
  const double systematic = kShading + kSlanted * with.steepest;
  return off <= systematic || (off - systematic) * (off - systematic) <= 16 * variance * per_pixel;
}

// Whether cells are so near what the bands agree on that agrees() holds for certain.
class NearConsensus {
 public:
  NearConsensus(const SeenCells& cells, const std::vector<Consensus>& consensus)
      : cells_(cells), flags_(cells.padded_size() / kLanes) {
    for (std::vector<float>* of : {&bins_, &medians_, &slopes_, &tolerances_}) {
      of->resize(cells.padded_size());
    }
    for (std::size_t i = 0; i < consensus.size(); ++i) {
      // Below what single precision can be off by.
      constexpr double kPrecision = 1e-5, kPlacePrecision = 1e-3;
      const Consensus& at = consensus[i];
      bins_[i] = static_cast<float>(cells.bin(i)) + 0.5F;
      medians_[i] = static_cast<float>(at.median);
      slopes_[i] = static_cast<float>(at.slope);
      tolerances_[i] = static_cast<float>(kShading + kSlanted * at.steepest - kPrecision -
                                          3 * kPrecision * std::abs(at.median) -
                                          kPlacePrecision * std::abs(at.slope));
    }
  }

  // One flag for each kLanes bins of a band: zero where it is certain of all. Empty cells are near.
  TAGSMITH_WIDE const std::vector<std::uint8_t>& doubtful(std::size_t band) {
    const Floats per_module = Floats{} + static_cast<float>(cells_.bins_per_module());
    for (std::size_t i = 0; i < cells_.padded_size(); i += kLanes) {
      Floats sums, places, counts, bins, medians, slopes, tolerances;
      load(cells_.darkness(band) + i, sums);
      load(cells_.places(band) + i, places);
      load(cells_.counts(band) + i, counts);
      load(&bins_[i], bins);
      load(&medians_[i], medians);
      load(&slopes_[i], slopes);
      load(&tolerances_[i], tolerances);
      const Floats per_pixel = 1 / (counts < 1 ? 1 : counts);
      const Floats off =
          sums * per_pixel - (medians + slopes * (places * per_pixel * per_module - bins));
      const auto doubted = (counts > 0) & ~((off <= tolerances) & (-off <= tolerances));
      std::array<std::uint64_t, sizeof doubted / 8> words;
      std::memcpy(&words, &doubted, sizeof doubted);
      flags_[i / kLanes] = (words[0] | words[1] | words[2] | words[3]) != 0;
    }
    return flags_;
  }

 private:
  const SeenCells& cells_;
  std::vector<float> bins_, medians_, slopes_, tolerances_;
  std::vector<std::uint8_t> flags_;
};

// The bins of a band whose cells disagree with the other bands.
std::vector<std::size_t> odd_bins(const SeenCells& cells, std::size_t band,
                                  const std::vector<Consensus>& consensus, double variance,
                                  NearConsensus& near) {
  std::vector<std::size_t> odd;
  const std::vector<std::uint8_t>& doubtful = near.doubtful(band);
  for (std::size_t first = 0; first < consensus.size(); first += kLanes) {
    if (doubtful[first / kLanes] == 0) continue;
    for (std::size_t i = first; i < std::min(first + kLanes, consensus.size()); ++i) {
      if (cells.counts(band)[i] == 0 || agrees(cells, band, i, consensus[i], variance)) continue;
      odd.push_back(i);
    }
  }
  return odd;
}

// The states of all cells, band by band.
class CellStates {
 public:
  static constexpr std::uint8_t kOdd = 1;      // disagrees with the other bands
  static constexpr std::uint8_t kCovered = 2;  // lies on a stretch of its band that shows something
                                               // in front of the bars

  explicit CellStates(const SeenCells& cells)
      : size_(cells.size()), states_(cells.bands() * cells.size()), striking_(cells.size()) {}

  void add(std::size_t band, std::size_t i, std::uint8_t state) {
    states_[band * size_ + i] |= state;
    striking_[i] |= state;
    all_ |= state;
  }

  bool is_odd(std::size_t band, std::size_t i) const {
    return (states_[band * size_ + i] & kOdd) != 0;
  }
  bool is_covered(std::size_t band, std::size_t i) const {
    return (states_[band * size_ + i] & kCovered) != 0;
  }
  // Whether a bin has an odd or covered cell.
  bool is_striking(std::size_t i) const { return striking_[i] != 0; }
  bool any_covered() const { return (all_ & kCovered) != 0; }

 private:
  std::size_t size_;
  std::uint8_t all_ = 0;
  std::vector<std::uint8_t> states_;
  std::vector<std::uint8_t> striking_;  // any state of a bin's cells
};

// Marks what lies between the odd cells of a band, given in order, where they stand close.
void mark_covers(const SeenCells& cells, std::size_t band, const std::vector<std::size_t>& odd,
                 CellStates& states) {
  constexpr double kBridge = 4.5;     // modules: more than the widest element
  constexpr double kLeastRun = 2;     // modules
  constexpr double kLeastOdd = 0.12;  // of a stretch's cells
  const auto bridge = static_cast<std::size_t>(kBridge / cells.bin_width());
  std::size_t begin = 0;  // of a stretch, among the odd ones
  for (std::size_t k = 1; k <= odd.size(); ++k) {
    if (k < odd.size() && cells.bin(odd[k]) - cells.bin(odd[k - 1]) <= bridge) continue;
    const std::size_t first = cells.bin(odd[begin]), last = cells.bin(odd[k - 1]);
    const auto run = static_cast<double>(last + 1 - first);
    const bool is_cover =
        run * cells.bin_width() >= kLeastRun && static_cast<double>(k - begin) >= kLeastOdd * run;
    // A pixel's width of the cover's outline belongs to it too.
    const std::size_t before =
        odd[begin] - (odd[begin] > 0 && cells.bin(odd[begin] - 1) + 1 == first);
    for (std::size_t i = before; is_cover && i < cells.size() && cells.bin(i) <= last + 1; ++i) {
      states.add(band, i, CellStates::kCovered);
    }
    begin = k;
  }
}

// Where something in front of the bars hides them. It disagrees with the other bands in spaces, if
// it is dark, and on bars, if it is light, so its stretch of a band is what lies between odd cells.
// Where it hides most of the height, the bands that are still clear look odd instead; they lie
// between its own odd cells, so all bands are taken for covered there.
CellStates states_of(const SeenCells& cells, const std::vector<Consensus>& consensus,
                     double variance) {
  CellStates states(cells);
  NearConsensus near(cells, consensus);
  for (std::size_t band = 0; band < cells.bands(); ++band) {
    const std::vector<std::size_t> odd = odd_bins(cells, band, consensus, variance, near);
    for (const std::size_t i : odd) states.add(band, i, CellStates::kOdd);
    mark_covers(cells, band, odd, states);
  }
  return states;
}

struct Sums {
  double darkness = 0;
  double place = 0;
  double count = 0;

  void add(const Cell& cell) {
    darkness += static_cast<double>(cell.darkness);
    place += static_cast<double>(cell.place);
    count += static_cast<double>(cell.count);
  }
};

// One bin's cells by state.
struct BinSums {
  Sums clear;              // neither odd nor covered
  Sums even;               // not odd
  Sums covered;            // odd or not
  double odd = 0;          // pixels
  double odd_outside = 0;  // of them, outside of covers
  double seen = 0;
};

BinSums sums_by_state(const SeenCells& cells, const CellStates& states, std::size_t i) {
  BinSums sums;
  for (std::size_t band = 0; band < cells.bands(); ++band) {
    const Cell cell = cells.at(band, i);
    const bool odd = states.is_odd(band, i), covered = states.is_covered(band, i);
    const auto count = static_cast<double>(cell.count);
    sums.seen += count;
    if (covered) sums.covered.add(cell);
    if (!odd) sums.even.add(cell);
    if (!odd && !covered) sums.clear.add(cell);
    if (odd) sums.odd += count;
    if (odd && !covered) sums.odd_outside += count;
  }
  return sums;
}

using LaneSums = std::array<std::array<double, kLanes>, 3>;  // darkness, place, count

// Sums over all bands of the bins from `first` on.
TAGSMITH_WIDE LaneSums sums_of_bands(const SeenCells& cells, std::size_t first) {
  LaneSums sums{};
  for (std::size_t band = 0; band < cells.bands(); ++band) {
    const float* darkness = cells.darkness(band) + first;
    const float* places = cells.places(band) + first;
    const float* counts = cells.counts(band) + first;
    for (std::size_t k = 0; k < kLanes; ++k) sums[0][k] += static_cast<double>(darkness[k]);
    for (std::size_t k = 0; k < kLanes; ++k) sums[1][k] += static_cast<double>(places[k]);
    for (std::size_t k = 0; k < kLanes; ++k) sums[2][k] += static_cast<double>(counts[k]);
  }
  return sums;
}

std::vector<BinSums> sums_of(const SeenCells& cells, const CellStates& states) {
  std::vector<BinSums> all(cells.size());
  for (std::size_t first = 0; first < cells.size(); first += kLanes) {
    const LaneSums lanes = sums_of_bands(cells, first);
    for (std::size_t k = 0; k < kLanes && first + k < cells.size(); ++k) {
      const std::size_t i = first + k;
      if (states.is_striking(i)) {
        all[i] = sums_by_state(cells, states, i);
        continue;
      }
      const Sums sums{lanes[0][k], lanes[1][k], lanes[2][k]};
      all[i].clear = all[i].even = sums;
      all[i].seen = sums.count;
    }
  }
  return all;
}

// Variance along the symbol, over a window.
class Modulation {
 public:
  void add(double value, double sign) {
    count_ += sign;
    sum_ += sign * value;
    squares_ += sign * value * value;
  }

  double variance() const {
    return count_ < 2 ? 0 : std::max(0.0, squares_ / count_ - sum_ * sum_ / (count_ * count_));
  }

 private:
  double count_ = 0, sum_ = 0, squares_ = 0;
};

// Whether a bin's covered cells are to be left out: where they are plain along the symbol and the
// clear ones show bars, for no seven modules are without both bars and spaces. Where it is the
// other way round, the clear cells are the cover.
std::vector<bool> certain_covers(const std::vector<BinSums>& sums, double bin_width) {
  constexpr double kWindow = 4;     // modules to either side
  constexpr double kPlainer = 0.4;  // variance of covered cells against that of clear ones
  const auto reach = static_cast<std::size_t>(kWindow / bin_width);
  std::vector<bool> certain(sums.size());
  Modulation clear, covered;
  const auto count_in = [&](const BinSums& bin, double sign) {
    if (bin.clear.count > 0) clear.add(bin.clear.darkness / bin.clear.count, sign);
    if (bin.covered.count > 0) covered.add(bin.covered.darkness / bin.covered.count, sign);
  };
  for (std::size_t i = 0; i < std::min(reach, sums.size()); ++i) count_in(sums[i], 1);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (i + reach < sums.size()) count_in(sums[i + reach], 1);
    if (i > reach) count_in(sums[i - reach - 1], -1);
    certain[i] = covered.variance() < kPlainer * clear.variance();
  }
  return certain;
}

// The bins from the bands that agree.
ScanProfile combine_all(const CellGrid& grid) {
  constexpr double kModelError = 0.02;  // of the contrast: what averaging cannot take away
  constexpr double kHidden = 4;         // variance that says nothing
  constexpr double kLeastUsed = 0.2;    // of the bars' height
  const SeenCells cells(grid);
  const double variance = pixel_variance(cells);
  const std::vector<Consensus> consensus = consensus_of(cells);
  const CellStates states = states_of(cells, consensus, clear_variance(grid, variance));
  const std::vector<BinSums> sums = sums_of(cells, states);
  // Without covers a bin's clear cells are its even ones.
  const std::vector<bool> certain = states.any_covered() ? certain_covers(sums, cells.bin_width())
                                                         : std::vector<bool>(sums.size());
  ScanProfile profile;
  profile.reserve(consensus.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const BinSums& bin = sums[i];
    const Sums& used = certain[i] ? bin.clear : bin.even;
    const double odd = certain[i] ? bin.odd_outside : bin.odd;
    if (used.count < kLeastUsed * bin.seen) {
      const double middle = (static_cast<double>(cells.bin(i)) + 0.5) * cells.bin_width();
      profile.push_back({middle - kCellsBeyond, consensus[i].median, kHidden, 0});
      continue;
    }
    // Where the height disagrees with itself the median may have taken the wrong side: the doubt
    // grows from nothing at full agreement to the whole contrast where half disagrees.
    const double doubt = std::min(1.0, 2 * odd / (odd + used.count));
    profile.push_back(
        {used.place / used.count - kCellsBeyond, used.darkness / used.count,
         variance / used.count + kModelError * kModelError + doubt * doubt * doubt * doubt,
         used.count / bin.seen});
  }
  return profile;
}

// Width of a module in the middle of the frame, pixels.
double module_at_middle(const FrameMap& image_from_unit, const SymbolLayout& layout) {
  const double half = 0.5 / (kModuleCount + 2 * layout.quiet_zone_modules);
  return distance(image_from_unit(0.5 - half, 0.5), image_from_unit(0.5 + half, 0.5));
}

}  // namespace

TurnedFrame turned_to(const RefinedFrame& frame, std::size_t first_corner) {
  TurnedFrame turned;
  for (std::size_t i = 0; i < 4; ++i) {
    turned.corners[i] = frame.corners[(first_corner + i) % 4];
    turned.sides[i] = frame.sides[(first_corner + i) % 4];
  }
  return turned;
}

double blur_across(const std::array<FrameSide, 4>& sides, double module_px, double bin_width) {
  const double blur_px = (sides[1].blur_px + sides[3].blur_px) / 2;
  return std::sqrt(std::pow(blur_px / std::max(module_px, 1e-3), 2) + bin_width * bin_width / 12);
}

SymbolProfile profile_symbol(const GrayView& image, const RefinedFrame& frame,
                             std::size_t first_corner, const SymbolLayout& layout) {
  const auto [corners, sides] = turned_to(frame, first_corner);
  const FrameMap image_from_unit(corners, frame.lens);
  SymbolProfile profile;
  profile.module_px = module_at_middle(image_from_unit, layout);
  const double frame_height =
      (distance(corners[0], corners[3]) + distance(corners[1], corners[2])) / 2;
  // Two bins a pixel and six a module lose nothing; more than 40 to 80 rows of pixels add little.
  const int bins_per_module =
      std::clamp(static_cast<int>(std::lround(2.5 * profile.module_px)), 3, 6);
  const auto [scan_top, scan_bottom] = scanned_height(layout);
  const int skip = std::max(1, static_cast<int>(frame_height * (scan_bottom - scan_top) / 40));
  const PlateLevels levels{
      {sides[0].white_begin, sides[0].white_end, sides[2].white_begin, sides[2].white_end},
      {sides[0].black_begin, sides[0].black_end, sides[2].black_begin, sides[2].black_end}};
  const double rows = frame_height * (scan_bottom - scan_top) / skip;
  const std::size_t bands = rows < 40 ? kMaxBands / 2 : kMaxBands;
  const CellGrid grid =
      collect_cells(image, image_from_unit, levels, layout, {bins_per_module, bands, skip});
  profile.bins = combine_all(grid);
  set_spreads(image_from_unit, layout, profile.bins);
  profile.blur = blur_across(sides, profile.module_px, 1.0 / bins_per_module);
  return profile;
}

}  // namespace tagsmith
