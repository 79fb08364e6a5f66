// SPDX-License-Identifier: Apache-2.0
// Scan profiles worked out from the definition: bars under a Gaussian point spread, by erf.
#pragma once

#include <cmath>
#include <cstddef>

#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/profile.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail::test {

// Share of the light that bars take at a point, modules.
inline double share_at_point(const Digits& digits, const ImagingModel& image, double at,
                             double spread = 1) {
  const auto edge_at = [&](double nominal, double widening) {
    const double from_middle = nominal - kModuleCount / 2.0;
    const double t = 2 * from_middle / kModuleCount;
    return nominal + image.shift + image.stretch * from_middle + image.bend * t * t + widening;
  };
  const auto step = [&](double edge) {
    return 0.5 * (1 + std::erf((at - edge) / (std::sqrt(2.0) * image.blur * spread)));
  };
  double share = 0;
  int nominal = 0;
  const auto elements = elements_of(digits);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const int end = nominal + elements[i];
    if (i % 2 == 0) {
      share += step(edge_at(nominal, -image.growth / 2)) - step(edge_at(end, image.growth / 2));
    }
    nominal = end;
  }
  return share;
}

// The same over the width of a pixel, by summing points.
inline double share_of_bars(const Digits& digits, const ImagingModel& image, double at,
                            double spread = 1) {
  constexpr int kPoints = 400;
  if (image.pixel == 0) return share_at_point(digits, image, at, spread);
  double sum = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double off = ((i + 0.5) / kPoints - 0.5) * image.pixel * spread;
    sum += share_at_point(digits, image, at + off, spread);
  }
  return sum / kPoints;
}

// Places so far apart (modules), four modules beyond the symbol on both sides.
inline ScanProfile profile_of(const Digits& digits, const ImagingModel& image,
                              double variance = 1e-3, double apart = 0.2) {
  ScanProfile profile;
  for (double at = apart / 2 - 4; at < kModuleCount + 4; at += apart) {
    const double share = share_of_bars(digits, image, at);
    const double t = (at - kModuleCount / 2.0) / (kModuleCount / 2.0);
    const double darkness = image.white + (image.black - image.white) * share + image.shading * t;
    profile.push_back({at, darkness, variance, 1, 1});
  }
  return profile;
}

}  // namespace tagsmith::detail::test
