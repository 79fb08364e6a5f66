// SPDX-License-Identifier: Apache-2.0
// Reading one scan line whose symbol is registered only roughly: the digits and the line's own
// distortion together. Method: deformable templates of whole digits, chained by dynamic programming
// (Gallo and Manduchi, "Reading 1D barcodes with mobile phones using deformable templates", IEEE
// PAMI 33(9), 2011), here with blur and bar growth in the templates and with each digit's rivals.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "decoder/scan/symbol_places.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// How bars look on the line.
struct BarShape {
  double blur = 0.5;  // standard deviation of the point spread, modules
  double growth = 0;  // widening of every bar, modules

  bool operator==(const BarShape&) const = default;
};

// The patterns of guards and digits as they look with such bars; made once for many lines.
class BarTemplates {
 public:
  explicit BarTemplates(const BarShape& shape);

  struct Template {
    std::vector<float> samples;  // darkness
    float squares = 0;           // of the samples, summed
  };

  // A kind of segment (0 start guard, 1 centre guard, 2 left and 3 right half, 4 end guard) at one
  // of its local module widths.
  const Template& shown(std::size_t kind, int pattern, int ratio) const;

 private:
  std::array<std::vector<Template>, 5> templates_;
};

// How a symbol lies on a line.
struct ElasticAlignment {
  // Begins of the start guard, six digits, centre guard, six digits and end guard, and the end:
  // samples of the line.
  std::array<double, 16> boundaries{};
  // Sum of squared residuals of the darkness (0 space, 1 bar) per module of the line, over the
  // variance that a good line has; a symbol costs less than about 2, other patterns more.
  double cost_per_module = 0;
};

// The most likely reading of a line, and what every other digit would cost.
struct ElasticReading {
  Digits digits{};
  ElasticAlignment alignment;
  // The increase of the whole line's cost when a digit is forced, with its neighbours and the
  // distortion free to adapt: 0 for the best digit.
  std::array<std::array<double, 10>, kDigitCount> extra_cost{};
  // The same when a digit of the left half is forced to even parity, as EAN-13 has it in three of
  // six (GS1 General Specifications 5.2.1.2); negative when that suits better.
  std::array<double, 6> even_parity_cost{};
};

// Costs per module above this are of no interest.
inline constexpr double kAnyCost = 1e6;

// Reads the symbol near the line's place: its boundaries may lie 5 modules from where the place's
// even modules put them, its local module width may vary by a ninth. Nothing, detected early, when
// the reading costs more than `worst` per module.
std::optional<ElasticReading> read_elastic(const PlacedLine& line, const BarTemplates& templates,
                                           double worst = kAnyCost);

// The cost per module of that reading alone, in a third of the time; very large when it is more
// than `worst`.
double elastic_cost(const PlacedLine& line, const BarTemplates& templates, double worst = kAnyCost);

// Only the boundaries of that reading, in half the time.
std::optional<ElasticAlignment> align_elastic(const PlacedLine& line, const BarTemplates& templates,
                                              double worst = kAnyCost);

// The same for digits that are known.
std::optional<ElasticAlignment> align_elastic(const ScanLine& line, const SymbolPlace& place,
                                              const BarTemplates& templates, const Digits& digits);

}  // namespace tagsmith::detail
