// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/robust_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "decoder/reader/occluders.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/reader/uneven_light.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// ---- Rows that agree.

namespace {

constexpr double kModelVariance = kProfile.model_error * kProfile.model_error;

using Bins = Eigen::ArrayXf;
using Cells = DarkRows::Cells;
using CellFlags = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

// The light of the plate's white and of the frame's black at the ends of the frame's upper and
// lower sides: at (0,0) (1,0) (1,1) (0,1) of the unit square.
struct PlateLevels {
  std::array<double, 4> white{};
  std::array<double, 4> black{};
};

// A quantity over the frame, bilinear between its corners.
double bilinear(const std::array<double, 4>& at, double u, double v) {
  return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * at[3] + u * at[2]);
}

// A light of the plate in each bin of a row; along a row it changes evenly.
Bins level_along(const SymbolRows& rows, const std::array<double, 4>& light, double v) {
  const auto bins = static_cast<Eigen::Index>(rows.bins);
  const auto at = [&](double bin) {
    return static_cast<float>(bilinear(light, rows.width_share_of(bin), v));
  };
  return Bins::LinSpaced(bins, at(0.5), at(static_cast<double>(bins) - 0.5));
}

// Keeps some of the bins of each row.
void keep_bins(const std::vector<Eigen::Index>& kept, Cells& cells) {
  const auto count = static_cast<Eigen::Index>(kept.size());
  Cells fewer(count, cells.cols());
  for (Eigen::Index row = 0; row < cells.cols(); ++row) {
    const float* from = cells.col(row).data();
    float* to = fewer.col(row).data();
    for (Eigen::Index i = 0; i < count; ++i) to[i] = from[kept[static_cast<std::size_t>(i)]];
  }
  cells = std::move(fewer);
}

void leave_out_empty(DarkRows& rows) {
  Bins pixels = Bins::Zero(rows.count.rows());
  for (Eigen::Index row = 0; row < rows.count.cols(); ++row) pixels += rows.count.col(row);
  std::vector<Eigen::Index> kept, bins;
  for (Eigen::Index bin = 0; bin < pixels.size(); ++bin) {
    if (!(pixels[bin] > 0)) continue;
    kept.push_back(bin);
    bins.push_back(rows.bins[static_cast<std::size_t>(bin)]);
  }
  if (std::cmp_equal(kept.size(), pixels.size())) return;
  rows.bins = std::move(bins);
  for (Cells* of : {&rows.darkness, &rows.place, &rows.count}) keep_bins(kept, *of);
}

DarkRows dark_rows(const SymbolRows& rows, const PlateLevels& levels) {
  constexpr float kLeastContrast = 1e-3F;
  const auto bins = static_cast<Eigen::Index>(rows.bins);
  const auto count = static_cast<Eigen::Index>(rows.rows);
  const auto cells = [&](const std::vector<float>& of) {
    return Eigen::Map<const Cells>(of.data(), bins, count);
  };
  DarkRows dark{cells(rows.light), cells(rows.place), cells(rows.count),
                std::vector<Eigen::Index>(rows.bins)};
  std::iota(dark.bins.begin(), dark.bins.end(), Eigen::Index{0});
  for (Eigen::Index row = 0; row < count; ++row) {
    const double v = rows.height_of(static_cast<std::size_t>(row));
    const Bins white = level_along(rows, levels.white, v);
    const Bins black = level_along(rows, levels.black, v);
    dark.darkness.col(row) = (white - dark.darkness.col(row)) / (white - black).max(kLeastContrast);
  }
  leave_out_empty(dark);
  return dark;
}

// Some rows that follow one another.
struct RowRange {
  Eigen::Index first = 0;
  Eigen::Index end = 0;
};

// The rows within two heights, shares of the frame's inner height.
RowRange rows_between(const SymbolRows& rows, const std::array<double, 2>& heights) {
  RowRange range{0, static_cast<Eigen::Index>(rows.rows)};
  const auto height = [&](Eigen::Index row) {
    return rows.height_of(static_cast<std::size_t>(row));
  };
  while (range.first < range.end && height(range.first) < heights[0]) ++range.first;
  while (range.first < range.end && height(range.end - 1) > heights[1]) --range.end;
  return range;
}

DarkRows part_of(const DarkRows& dark, const RowRange& range) {
  const Eigen::Index count = range.end - range.first;
  DarkRows part{dark.darkness.middleCols(range.first, count),
                dark.place.middleCols(range.first, count),
                dark.count.middleCols(range.first, count), dark.bins};
  leave_out_empty(part);
  return part;
}

// Sums over some of the pixels of each bin.
struct PixelSums {
  Bins darkness, place, count;
};

// Row after row, so that rounding is the same on every machine.
PixelSums sums_of(const DarkRows& rows, const Cells& pixels, const RowRange& range) {
  const Bins none = Bins::Zero(pixels.rows());
  PixelSums sums{none, none, none};
  for (Eigen::Index row = range.first; row < range.end; ++row) {
    sums.darkness += pixels.col(row) * rows.darkness.col(row);
    sums.place += pixels.col(row) * rows.place.col(row);
    sums.count += pixels.col(row);
  }
  return sums;
}

PixelSums sums_of(const DarkRows& rows, const Cells& pixels) {
  return sums_of(rows, pixels, {0, pixels.cols()});
}

// What the rows agree on in each bin.
struct Consensus {
  Bins median;
  Bins place;      // mean place of the bin's pixels, bins
  Bins slope;      // change of darkness a bin
  Bins tolerated;  // difference of darkness that is no disagreement
};

float median_of(const DarkRows& rows, Eigen::Index bin, std::vector<float>& seen) {
  seen.clear();
  for (Eigen::Index row = 0; row < rows.count.cols(); ++row) {
    if (rows.count(bin, row) > 0) seen.push_back(rows.darkness(bin, row));
  }
  return quantile(seen, 0.5);
}

// What changes before each bin, and behind the last one: zero beside the first and the last.
Bins changes_of(const Bins& values) {
  const Eigen::Index size = values.size();
  Bins changes = Bins::Zero(size + 1);
  changes.segment(1, size - 1) = values.tail(size - 1) - values.head(size - 1);
  return changes;
}

Consensus consensus_of(const DarkRows& rows, const PixelSums& all) {
  Consensus consensus;
  consensus.place = all.place / all.count;
  // Where all rows show nearly the same, this is the mean, which is quicker.
  consensus.median = all.darkness / all.count;
  Cells shown = rows.darkness;
  for (Eigen::Index row = 0; row < shown.cols(); ++row) {
    shown.col(row) = (rows.count.col(row) > 0).select(shown.col(row), consensus.median);
  }
  const Bins spread = shown.rowwise().maxCoeff() - shown.rowwise().minCoeff();
  std::vector<float> seen;
  for (Eigen::Index bin = 0; bin < spread.size(); ++bin) {
    if (spread[bin] > static_cast<float>(kProfile.shading))
      consensus.median[bin] = median_of(rows, bin, seen);
  }
  const Eigen::Index size = spread.size();
  const Bins rises = changes_of(consensus.median), runs = changes_of(consensus.place);
  const auto before = rises.head(size), after = rises.tail(size);
  const Bins run = runs.head(size) + runs.tail(size);
  consensus.slope = (before + after) / run.max(0.5F);
  consensus.tolerated = static_cast<float>(kProfile.shading) +
                        static_cast<float>(kProfile.slanted) * before.abs().max(after.abs());
  return consensus;
}

// How far cells are from what the rows agree on at their pixels' mean place.
Cells differences(const DarkRows& rows, const Consensus& consensus) {
  Cells expected = rows.place.colwise() - consensus.place;
  expected.colwise() *= consensus.slope;
  expected.colwise() += consensus.median;
  return rows.darkness - expected;
}

// Variance of one pixel's darkness: from the median of what cells are off.
double pixel_variance(const DarkRows& rows, const Cells& off) {
  constexpr double kMedianChi2 = 0.455;  // of one degree of freedom
  constexpr Eigen::Index kEvery = 4;     // bins: some 2,000 cells determine it to 3 %
  std::vector<float> squares;
  for (Eigen::Index row = 0; row < off.cols(); ++row) {
    for (Eigen::Index bin = 0; bin < off.rows(); bin += kEvery) {
      const float count = rows.count(bin, row);
      if (count > 0) squares.push_back(off(bin, row) * off(bin, row) * count);
    }
  }
  if (squares.empty()) return kModelVariance;
  return std::max(kModelVariance, static_cast<double>(quantile(squares, 0.5)) / kMedianChi2);
}

// The cells that differ by more than noise and shading allow.
CellFlags odd_cells(const DarkRows& rows, const Consensus& consensus, const Cells& off,
                    double variance) {
  const Cells beyond = (off.abs().colwise() - consensus.tolerated).max(0.0F);
  return beyond.square() * rows.count > static_cast<float>(kBeyondNoise * kBeyondNoise * variance);
}

// Marks what lies in front of a row. A dark occluder disagrees in spaces, a light one on bars: its
// stretch of the row is what lies between differing cells that are close together.
void mark_covers(const DarkRows& rows, const std::vector<Eigen::Index>& odd, int per_module,
                 CellFlags::ColXpr covered) {
  const auto bin = [&](std::size_t k) { return rows.bins[static_cast<std::size_t>(odd[k])]; };
  for (std::size_t begin = 0, k = 1; k <= odd.size(); ++k) {
    if (k < odd.size() && static_cast<double>(bin(k) - bin(k - 1)) <= kNearModules * per_module) {
      continue;
    }
    const auto run = static_cast<double>(bin(k - 1) + 1 - bin(begin));
    if (run >= kProfile.least_run * per_module &&
        static_cast<double>(k - begin) >= kProfile.least_used * run) {
      // A pixel's width of the occluder's outline belongs to it too.
      const Eigen::Index first = std::max<Eigen::Index>(odd[begin] - 1, 0);
      const Eigen::Index last = std::min(odd[k - 1] + 1, covered.size() - 1);
      covered.segment(first, last - first + 1) = true;
    }
    begin = k;
  }
}

// Which cells lie on a stretch of their row with something in front.
CellFlags covered_cells(const DarkRows& rows, const CellFlags& odd, int per_module) {
  CellFlags covered = CellFlags::Constant(odd.rows(), odd.cols(), false);
  for (Eigen::Index row = 0; row < odd.cols(); ++row) {
    std::vector<Eigen::Index> bins;
    for (Eigen::Index bin = 0; bin < odd.rows(); ++bin) {
      if (odd(bin, row)) bins.push_back(bin);
    }
    if (!bins.empty()) mark_covers(rows, bins, per_module, covered.col(row));
  }
  return covered;
}

// The bins' rows by state; a cell is odd where it differs from what the rows agree on.
struct RowsByState {
  PixelSums clear;    // not odd, not covered
  PixelSums even;     // not odd
  PixelSums covered;  // odd or not
  Bins odd;           // pixels
  Bins odd_outside;   // of them, outside of covered stretches
};

RowsByState rows_by_state(const DarkRows& rows, const PixelSums& all, const CellFlags& odd,
                          int per_module) {
  const Bins none = Bins::Zero(all.count.size());
  if (!odd.any()) return {all, all, {none, none, none}, none, none};
  const CellFlags covered = covered_cells(rows, odd, per_module);
  const auto pixels = [&](const CellFlags& which) -> Cells { return which.select(rows.count, 0); };
  return {sums_of(rows, pixels(!odd && !covered)), sums_of(rows, pixels(!odd)),
          sums_of(rows, pixels(covered)), sums_of(rows, pixels(odd)).count,
          sums_of(rows, pixels(odd && !covered)).count};
}

// Variance of the darkness along the symbol, over a window.
class Modulation {
 public:
  void count(const PixelSums& pixels, Eigen::Index bin, double sign) {
    if (pixels.count[bin] == 0) return;
    const auto darkness = static_cast<double>(pixels.darkness[bin] / pixels.count[bin]);
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
std::vector<bool> certain_covers(const RowsByState& rows, int per_module) {
  const Eigen::Index reach = Eigen::Index{kNearModules} * per_module, size = rows.odd.size();
  std::vector<bool> certain;
  Modulation clear, covered;
  const auto count = [&](Eigen::Index bin, double sign) {
    clear.count(rows.clear, bin, sign);
    covered.count(rows.covered, bin, sign);
  };
  for (Eigen::Index i = 0; i < std::min(reach, size); ++i) count(i, 1);
  for (Eigen::Index i = 0; i < size; ++i) {
    if (i + reach < size) count(i + reach, 1);
    if (i > reach) count(i - reach - 1, -1);
    certain.push_back(covered.variance() < kProfile.plainer * clear.variance());
  }
  return certain;
}

ScanBin bin_of(const SymbolRows& symbol, const Consensus& consensus, const RowsByState& rows,
               Eigen::Index bin, bool certain, double variance) {
  const PixelSums& used = certain ? rows.clear : rows.even;
  const auto count = static_cast<double>(used.count[bin]);
  const auto odd = static_cast<double>(certain ? rows.odd_outside[bin] : rows.odd[bin]);
  const auto seen = static_cast<double>(rows.even.count[bin] + rows.odd[bin]);
  if (count < kProfile.least_used * seen) {
    return {symbol.module_of(static_cast<double>(consensus.place[bin])),
            static_cast<double>(consensus.median[bin]), kHiddenVariance, 0};
  }
  // Where the rows over the height disagree, the median may have taken the wrong side: the doubt
  // grows from zero at full agreement to the whole contrast where half disagrees.
  const double doubt = std::min(1.0, 2 * odd / (odd + count));
  return {symbol.module_of(static_cast<double>(used.place[bin]) / count),
          static_cast<double>(used.darkness[bin]) / count,
          variance / count + kModelVariance + doubt * doubt * doubt * doubt, count / seen};
}

// A profile, and the variance of a pixel's darkness where no cell is odd.
struct AgreeingRows {
  ScanProfile profile;
  std::optional<double> pixel_variance;
};

// For each bin the mean darkness of those rows that are near their median, with the doubt that the
// other rows cause.
AgreeingRows profile_of_agreeing(const SymbolRows& rows, const DarkRows& dark) {
  if (dark.bins.empty()) return {};
  const PixelSums all = sums_of(dark, dark.count);
  const Consensus consensus = consensus_of(dark, all);
  const Cells off = differences(dark, consensus);
  const double variance = pixel_variance(dark, off);
  const CellFlags odd = odd_cells(dark, consensus, off, variance);
  const RowsByState by_state = rows_by_state(dark, all, odd, rows.bins_per_module);
  const std::vector<bool> certain = certain_covers(by_state, rows.bins_per_module);
  ScanProfile profile;
  profile.reserve(certain.size());
  for (std::size_t i = 0; i < certain.size(); ++i) {
    profile.push_back(
        bin_of(rows, consensus, by_state, static_cast<Eigen::Index>(i), certain[i], variance));
  }
  return {std::move(profile), odd.any() ? std::nullopt : std::optional(variance)};
}

// The same of some of the rows where no cell of all is odd.
ScanProfile profile_of_even_rows(const SymbolRows& rows, const DarkRows& dark,
                                 const RowRange& range, double pixel_variance) {
  const PixelSums sums = sums_of(dark, dark.count, range);
  ScanProfile profile;
  profile.reserve(dark.bins.size());
  for (Eigen::Index bin = 0; bin < sums.count.size(); ++bin) {
    const auto count = static_cast<double>(sums.count[bin]);
    if (count == 0) continue;
    profile.push_back({rows.module_of(static_cast<double>(sums.place[bin]) / count),
                       static_cast<double>(sums.darkness[bin]) / count,
                       pixel_variance / count + kModelVariance, 1});
  }
  return profile;
}

}  // namespace

// ---- The point spread along the symbol.

namespace {

// Distance in the image between bars that are one unit apart, which determines a module's width.
// Why: docs/decisions/0002-likelihood-decoding.md.
double width_across(const FrameHomography& image_from_frame, double u) {
  constexpr double kStep = 1e-3;
  const PixelPoint by_u = image_from_frame(u + kStep, 0.5) - image_from_frame(u - kStep, 0.5);
  const PixelPoint by_v = image_from_frame(u, 0.5 + kStep) - image_from_frame(u, 0.5 - kStep);
  return std::abs(cross(by_u, by_v)) / std::max(std::hypot(by_v.x, by_v.y), 1e-12);
}

}  // namespace

void set_spreads(const FrameHomography& image_from_frame, const SymbolLayout& layout,
                 ScanProfile& profile) {
  if (profile.empty()) return;
  const double middle = width_across(image_from_frame, 0.5);
  const auto [least, most] = std::ranges::minmax(profile, {}, &ScanBin::at);
  const double first = std::floor(least.at);
  // From module to module the spread is linear to a hundred thousandth.
  std::vector<double> spreads(static_cast<std::size_t>(most.at - first) + 2);
  for (std::size_t k = 0; k < spreads.size(); ++k) {
    const double at = layout.width_share(first + static_cast<double>(k));
    spreads[k] = middle / std::max(width_across(image_from_frame, at), 1e-12);
  }
  for (ScanBin& bin : profile) {
    const auto before = static_cast<std::size_t>(bin.at - first);
    bin.spread = std::lerp(spreads[before], spreads[before + 1], bin.at - std::floor(bin.at));
  }
}

// ---- The profile.

namespace {

// Width of a pixel across the bars, pixels along the symbol, where it is wider than a module; else
// 0: then it is part of the point spread, as in the fit of the frame's sides, whose corners the
// bars may move. A pixel's area, projected across the bars, is a box averaged over another; the
// wider one counts here, the other is part of the point spread.
double pixel_across(const SymbolRows& rows) {
  if (rows.module_px > 1) return 0;
  const PixelPoint along = rows.image_from_frame(1, 0.5) - rows.image_from_frame(0, 0.5);
  const PixelPoint down = rows.image_from_frame(0.5, 1) - rows.image_from_frame(0.5, 0);
  const double height = std::hypot(down.x, down.y);
  const double sine = cross(along, down) / (std::hypot(along.x, along.y) * height);
  return std::max(std::abs(down.x), std::abs(down.y)) / (height * std::abs(sine));
}

// Standard deviation of the point spread across the bars, pixels, without a pixel of this width; at
// least half of the value with one. `sides`: of a frame turned to P.
double blur_across(const std::array<FrameSide, 4>& sides, double pixel) {
  const double blur = (sides[1].blur_px + sides[3].blur_px) / 2;
  return std::sqrt(std::max(blur * blur - pixel * pixel / 12, blur * blur / 4));
}

void hide_behind(std::span<const Occluder> occluders, SymbolRows& rows) {
  for (std::size_t row = 0; row < rows.rows; ++row) {
    for (const Occluder& occluder : occluders) {
      const auto [begin, end] = hidden_width(occluder, rows.height_of(row));
      for (std::size_t bin = 0; bin < rows.bins; ++bin) {
        const double u = rows.width_share_of(static_cast<double>(bin) + 0.5);
        if (begin <= u && u <= end) rows.count[row * rows.bins + bin] = 0;
      }
    }
  }
}

ScanProfile profile_of(const SymbolRows& rows, const std::vector<Agreed>& agreed) {
  ScanProfile profile;
  for (std::size_t bin = 0; bin < agreed.size(); ++bin) {
    const Agreed& at = agreed[bin];
    if (rows.middles[bin] < 0) continue;
    const double place = rows.module_of(static_cast<double>(rows.middles[bin]));
    if (at.shown < kProfile.least_shown) {
      profile.push_back({place, 0.5, kHiddenVariance, 1});
      continue;
    }
    const float few = static_cast<float>(kProfile.shading) * (1 - at.shown) * (1 - at.shown);
    const float doubt = std::min(1.0F, 2 * at.doubt);
    const float variance = 1 / at.weight + kProfile.model_error * kProfile.model_error + few * few +
                           doubt * doubt * doubt * doubt;
    profile.push_back({place, static_cast<double>(at.darkness), static_cast<double>(variance), 1});
  }
  return profile;
}

// First and last height of the rows that are used of a part of the bars' height, shares of the
// frame's: the bars' ends, which the frame's blur and its corners' error may reach, are left out.
std::array<double, 2> used_heights(HeightShare part, const SymbolLayout& layout) {
  const double bars = layout.bar_height();
  return {layout.bars_top + std::max(part.begin, kProfile.ends) * bars,
          layout.bars_top + std::min(part.end, 1 - kProfile.ends) * bars};
}

// Evens out the rows of a frame, and returns the light of its white.
double evened(const RefinedFrame& frame, SymbolRows& rows) {
  return even_out(rows, blur_across(frame.sides, 0) / std::max(rows.module_px, 1e-3));
}

PlateLevels levels_of(const RefinedFrame& frame) {
  const FrameSide &upper = frame.sides[0], &lower = frame.sides[2];
  return {{upper.white_begin, upper.white_end, lower.white_begin, lower.white_end},
          {upper.black_begin, upper.black_end, lower.black_begin, lower.black_end}};
}

// The same for a plate of this white everywhere, whose ink reflects as much of it as before.
PlateLevels even_levels(const RefinedFrame& frame, double white) {
  PlateLevels levels = levels_of(frame);
  const double black = std::accumulate(levels.black.begin(), levels.black.end(), 0.0);
  const double bright = std::accumulate(levels.white.begin(), levels.white.end(), 0.0);
  levels.white.fill(white);
  levels.black.fill(black / bright * white);
  return levels;
}

bool are_same(const Quad& a, const Quad& b) {
  return std::ranges::equal(a, b,
                            [](PixelPoint p, PixelPoint q) { return p.x == q.x && p.y == q.y; });
}

}  // namespace

double middle_height(HeightShare part, const SymbolLayout& layout) {
  const auto [top, bottom] = used_heights(part, layout);
  return (top + bottom) / 2;
}

RobustProfile::RobustProfile(const GrayView& image, const RefinedFrame& frame,
                             const SymbolLayout& layout, bool even_out_light)
    : image_(image),
      frame_(frame),
      rows_(image, frame.corners, frame.lens, layout, RowHeight::coarse) {
  if (even_out_light) white_ = evened(frame, rows_);
  dark_ = dark_rows(rows_, white_ ? even_levels(frame, *white_) : levels_of(frame));
}

bool RobustProfile::is_of(const GrayView& image, const RefinedFrame& frame,
                          const SymbolLayout& layout, bool evened) const {
  return image.row(0) == image_.row(0) && are_same(frame.corners, frame_.corners) &&
         layout == rows_.layout && evened == white_.has_value();
}

SymbolProfile RobustProfile::finished(ScanProfile bins, const SymbolRows& rows) const {
  set_spreads(rows.image_from_frame, rows.layout, bins);
  const double per_px = 1 / std::max(rows.module_px, 1e-3);
  const double pixel = pixel_across(rows);
  const double bin = 1.0 / rows.bins_per_module;
  const double blur = blur_across(frame_.sides, pixel) * per_px;
  return {std::move(bins), rows.module_px, std::sqrt(blur * blur + bin * bin / 12), pixel * per_px,
          white_.has_value()};
}

SymbolProfile RobustProfile::of_agreeing_rows(HeightShare part) const {
  const RowRange range = rows_between(rows_, used_heights(part, rows_.layout));
  AgreeingRows agreeing = profile_of_agreeing(rows_, part_of(dark_, range));
  SymbolProfile profile = finished(std::move(agreeing.profile), rows_);
  profile.pixel_variance = agreeing.pixel_variance;
  return profile;
}

SymbolProfile RobustProfile::of_agreeing_rows(HeightShare part, const SymbolProfile& whole) const {
  if (!whole.pixel_variance) return of_agreeing_rows(part);
  const RowRange range = rows_between(rows_, used_heights(part, rows_.layout));
  return finished(profile_of_even_rows(rows_, dark_, range, *whole.pixel_variance), rows_);
}

SymbolRows RobustProfile::rows_in_sight() const {
  SymbolRows rows(image_, frame_.corners, frame_.lens, rows_.layout, RowHeight::fine);
  hide_behind(find_occluders(image_, frame_, rows_.layout), rows);
  if (white_) evened(frame_, rows);
  return rows;
}

SymbolProfile RobustProfile::of_all_rows(SymbolRows in_sight, AddedLight added) const {
  // A part that a highlight bleaches is plain too: there its rows' own light decides.
  if (added == AddedLight::even) leave_out_plain(in_sight);
  return finished(profile_of(in_sight, settle(in_sight, added).agreed), in_sight);
}

}  // namespace tagsmith::detail
