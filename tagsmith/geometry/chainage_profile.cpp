// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/chainage_profile.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

namespace tagsmith::detail {
namespace {

using Stations = std::vector<ProfileStation>;

double between(const ProfileStation& a, const ProfileStation& b, double chainage) {
  const double share = (chainage - a.chainage) / (b.chainage - a.chainage);
  return a.value + share * (b.value - a.value);
}

// The first station beyond `chainage`, or with `at_too` at it.
Stations::const_iterator next_station(const Stations& stations, double chainage, bool at_too) {
  return at_too ? std::ranges::lower_bound(stations, chainage, {}, &ProfileStation::chainage)
                : std::ranges::upper_bound(stations, chainage, {}, &ProfileStation::chainage);
}

double value_at(const Stations& stations, double chainage, bool before_step) {
  const auto next = next_station(stations, chainage, before_step);
  if (next == stations.begin()) return stations.front().value;
  if (next == stations.end()) return stations.back().value;
  return between(*std::prev(next), *next, chainage);
}

// The stations in (from, to), or with `ends_too` in [from, to].
std::span<const ProfileStation> within(const Stations& stations, double from, double to,
                                       bool ends_too) {
  const auto first = next_station(stations, from, ends_too);
  return {first, std::max(first, next_station(stations, to, !ends_too))};
}

// How much the value rises at each step among these stations.
std::vector<double> steps_of(std::span<const ProfileStation> stations) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stations.size(); ++i) {
    const bool is_step = stations[i].chainage == stations[i - 1].chainage;
    if (is_step) steps.push_back(stations[i].value - stations[i - 1].value);
  }
  return steps;
}

}  // namespace

ChainageProfile::ChainageProfile(double value) : stations_{{0, value}} {}

ChainageProfile::ChainageProfile(std::vector<ProfileStation> stations)
    : stations_(std::move(stations)) {
  assert(!stations_.empty());
  assert(std::ranges::is_sorted(stations_, {}, &ProfileStation::chainage));
}

double ChainageProfile::at(double chainage) const { return value_at(stations_, chainage, false); }

double ChainageProfile::before(double chainage) const {
  return value_at(stations_, chainage, true);
}

double ChainageProfile::slope(double from, double to) const {
  if (is_constant()) return 0;
  double change = before(to) - at(from);
  for (const double step : steps_of(within(stations_, from, to, false))) change -= step;
  return change / (to - from);
}

double ChainageProfile::steps(double from, double to) const {
  double sum = 0;
  for (const double step : steps_of(within(stations_, from, to, true))) sum += std::abs(step);
  return sum;
}

double ChainageProfile::least(double from, double to) const {
  double least = std::min(at(from), before(to));
  for (const ProfileStation& station : within(stations_, from, to, true)) {
    least = std::min(least, station.value);
  }
  return least;
}

double ChainageProfile::greatest(double from, double to) const {
  return -scaled(-1).least(from, to);
}

double ChainageProfile::least() const {
  return std::ranges::min(stations_, {}, &ProfileStation::value).value;
}

double ChainageProfile::greatest() const {
  return std::ranges::max(stations_, {}, &ProfileStation::value).value;
}

std::vector<double> ChainageProfile::breaks(double from, double to) const {
  std::vector<double> chainages;
  if (is_constant()) return chainages;
  for (const ProfileStation& station : within(stations_, from, to, false)) {
    if (chainages.empty() || chainages.back() != station.chainage) {
      chainages.push_back(station.chainage);
    }
  }
  return chainages;
}

ChainageProfile ChainageProfile::scaled(double factor, double shift) const {
  ChainageProfile result = *this;
  for (ProfileStation& station : result.stations_) station.value = factor * station.value + shift;
  return result;
}

ChainageProfile sum(const ChainageProfile& a, const ChainageProfile& b) {
  if (a.is_constant()) return b.scaled(1, a.at(0));
  if (b.is_constant()) return a.scaled(1, b.at(0));
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  std::vector<double> chainages;
  std::ranges::set_union(a.breaks(-kEnd, kEnd), b.breaks(-kEnd, kEnd),
                         std::back_inserter(chainages));
  Stations stations;
  for (const double chainage : chainages) {
    const double before = a.before(chainage) + b.before(chainage);
    const double beyond = a.at(chainage) + b.at(chainage);
    stations.push_back({chainage, before});
    if (beyond != before) stations.push_back({chainage, beyond});
  }
  return ChainageProfile(std::move(stations));
}

}  // namespace tagsmith::detail
