// SPDX-License-Identifier: Apache-2.0
// What a printer does to what it is told to print.
#pragma once

#include <string>

namespace tagsmith::detail {

// Printed length over drawn length, across and down the page as it leaves the printer.
struct PrinterScale {
  double right = 1;
  double down = 1;

  bool is_true() const { return right == 1 && down == 1; }
};

// Scales beyond this, either way, are no printer's but a page fitted to its paper.
inline constexpr double kMostPrinterScale = 0.03;

struct PrinterProfile {
  std::string name;
  PrinterScale scale{};
  double growth_right = 0;  // metres that a bar is too wide, across and down the page
  double growth_down = 0;
  double dot_gain = 0;  // share of the area that a tone of one half covers beyond one half
};

// What takes the growth away, metres: a bar stands across or down the page, so the mean of both.
double bar_adjustment_for(const PrinterProfile& profile);

}  // namespace tagsmith::detail
