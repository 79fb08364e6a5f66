// SPDX-License-Identifier: Apache-2.0
// What the rows of a symbol have in common, found together with each row's own white and contrast.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "decoder/reader/symbol_rows.hpp"

namespace tagsmith::detail {

// What the light in front of a row adds within ten modules: the same everywhere, or, under a
// highlight, what changes from bar to bar.
enum class AddedLight { even, slanted };

// The darkness at the middle of every bin's pixels.
struct CommonDarkness {
  std::vector<float> darkness;
  std::vector<bool> known;
  std::vector<float> slope;  // change of darkness a bin

  // At a place in a bin.
  float at(const SymbolRows& rows, std::size_t bin, float place) const {
    return darkness[bin] + slope[bin] * (place - rows.middles[bin]);
  }
};

// Sets the slopes from the known bins on both sides of each.
void find_slopes(const SymbolRows& rows, CommonDarkness& common);

// How the common darkness d shows on ten modules of a row: light = white + gradient x - contrast d,
// x bins from the stretch's middle. A highlight adds light that changes from bar to bar.
struct RowStretch {
  float white = 0;
  float gradient = 0;
  float middle = 0;  // bins
  float contrast = 0;
  float variance = 0;  // of a pixel's light about that
};

// A cell's darkness by the stretch around it that follows the common darkness best.
struct Vote {
  float darkness = 0;
  float weight = 0;  // inverse variance; 0 = there is none
};

// The stretches of every row, one a module, fitted to the common darkness by least squares.
class RowStretches {
 public:
  RowStretches(const SymbolRows& rows, const CommonDarkness& common, AddedLight added);

  Vote vote(const SymbolRows& rows, const CommonDarkness& common, std::size_t row,
            std::size_t bin) const;

 private:
  void fit_row(const SymbolRows& rows, const CommonDarkness& common, AddedLight added,
               std::size_t row);
  bool follows(const RowStretch& stretch) const;
  void find_best(std::size_t row);

  std::size_t per_row_;
  std::size_t reach_;   // bins to both sides of a stretch's middle
  std::size_t stride_;  // bins from one middle to the next
  std::vector<std::optional<RowStretch>> all_;
  std::vector<const RowStretch*> best_;  // around each, of those that follow; null = none does
  float contrast_ = 0;                   // usual
  float variance_ = 0;
};

// A bin's rows put together.
struct Agreed {
  float darkness = 0;
  float weight = 0;  // inverse variance; 0 = no row shows it
  float doubt = 0;   // share of the weight that disagrees
  float shown = 0;   // share of the rows
};

struct SettledRows {
  std::vector<Agreed> agreed;  // bin by bin
  CommonDarkness common;
};

// Fits the rows and their common darkness in turn, starting from the median of what a few rows at a
// time show between their own white and black.
SettledRows settle(const SymbolRows& rows, AddedLight added);

}  // namespace tagsmith::detail
