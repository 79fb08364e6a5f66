// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/as_built_place.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {

std::string rounded_text(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return fmt::format("{:.{}f}", std::round(value * unit) / unit + 0.0, decimals);
}

std::string point_text(const Eigen::Vector3d& p) {
  return fmt::format("[{}, {}, {}]", rounded_text(p.x(), 4), rounded_text(p.y(), 4),
                     rounded_text(p.z(), 4));
}

PlacedKeys measured_keys(const AsBuiltPlace& place) {
  constexpr double kLeastSigma = 1e-4;  // metres: the last digit that is written of a coordinate
  PlacedKeys values{{"p", point_text(place.p_in_grid)},
                    {"sigma", rounded_text(std::max(place.sigma, kLeastSigma), 4)}};
  if (!place.date.empty()) values.emplace_back("date", place.date);
  const auto& [facing, tilt, roll] = place.attitude;
  values.emplace_back("facing", rounded_text(std::fmod(degrees(facing.value_or(0)) + 360, 360), 3));
  values.emplace_back("tilt", rounded_text(degrees(tilt), 3));
  values.emplace_back("roll", rounded_text(degrees(roll), 3));
  return values;
}

std::string digits_text(const PlacedTag& tag) { return '"' + to_string(tag.digits) + '"'; }

std::string placed_entry(const Survey& survey, const AsBuiltPlace& place) {
  const PlacedTag& tag = *find_tag(survey, place.tag);
  PlacedKeys values{{"tag", tag.name}, {"side", to_string(tag.side)}};
  std::ranges::move(measured_keys(place), std::back_inserter(values));
  values.emplace_back("digits", digits_text(tag));
  std::vector<std::string> words;
  for (const auto& [key, value] : values) words.push_back(fmt::format("{}: {}", key, value));
  return fmt::format("{{ {} }}", fmt::join(words, ", "));
}

}  // namespace tagsmith::detail
