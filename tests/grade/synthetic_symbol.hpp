// SPDX-License-Identifier: Apache-2.0
// Symbols whose grade is known by construction.
#pragma once

#include <vector>

#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail::test {

inline const Digits kDigits = *parse_digits("036000291452");  // gs1; has 1, 2 and no 7, 8
inline constexpr int kPerModule = 20;
inline constexpr double kWhite = 0.90;
inline constexpr double kBlack = 0.10;

// The positions of the 60 edges in modules from the first bar.
inline std::vector<double> edges_of(const Digits& digits) {
  std::vector<double> edges{0};
  for (const auto width : elements_of(digits)) edges.push_back(edges.back() + width);
  return edges;
}

// A profile with quiet zones of `quiet` modules and sharp edges at these places.
inline std::vector<double> profile_of(const std::vector<double>& edges, double quiet = 9) {
  std::vector<double> profile;
  const auto samples = static_cast<int>((kModuleCount + 2 * quiet) * kPerModule);
  std::size_t next = 0;
  for (int i = 0; i < samples; ++i) {
    const double place = (i + 0.5) / kPerModule - quiet;
    while (next < edges.size() && edges[next] <= place) ++next;
    profile.push_back(next % 2 == 1 ? kBlack : kWhite);
  }
  return profile;
}

// Sets the reflectance between two places in modules from the first bar.
inline void paint(std::vector<double>& profile, double from, double to, double reflectance,
                  double quiet = 9) {
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double place = (static_cast<double>(i) + 0.5) / kPerModule - quiet;
    if (place >= from && place < to) profile[i] = reflectance;
  }
}

}  // namespace tagsmith::detail::test
