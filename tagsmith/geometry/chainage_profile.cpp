// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/chainage_profile.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
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

}  // namespace

ChainageProfile::ChainageProfile(double value) : stations_{{0, value}} {}

ChainageProfile::ChainageProfile(std::vector<ProfileStation> stations)
    : stations_(std::move(stations)) {
  assert(!stations_.empty());
  assert(std::ranges::is_sorted(stations_, {}, &ProfileStation::chainage));
}

double ChainageProfile::at(double chainage) const {
  if (is_constant()) return stations_.front().value;
  return value_at(stations_, chainage, false);
}

double ChainageProfile::before(double chainage) const {
  if (is_constant()) return stations_.front().value;
  return value_at(stations_, chainage, true);
}

double ChainageProfile::slope(double from, double to) const {
  if (is_constant()) return 0;
  double change = before(to) - at(from);
  auto next = next_station(stations_, from, false);
  for (; next != stations_.end() && next->chainage < to; ++next) {
    const bool is_step = next != stations_.begin() && std::prev(next)->chainage == next->chainage;
    if (is_step) change -= next->value - std::prev(next)->value;
  }
  return change / (to - from);
}

double ChainageProfile::steps(double from, double to) const {
  double sum = 0;
  auto next = next_station(stations_, from, true);
  for (; next != stations_.end() && next->chainage <= to; ++next) {
    const bool is_step = next != stations_.begin() && std::prev(next)->chainage == next->chainage;
    if (is_step) sum += std::abs(next->value - std::prev(next)->value);
  }
  return sum;
}

double ChainageProfile::least(double from, double to) const {
  double least = std::min(at(from), before(to));
  auto next = next_station(stations_, from, true);
  for (; next != stations_.end() && next->chainage <= to; ++next) {
    least = std::min(least, next->value);
  }
  return least;
}

double ChainageProfile::greatest(double from, double to) const {
  double greatest = std::max(at(from), before(to));
  auto next = next_station(stations_, from, true);
  for (; next != stations_.end() && next->chainage <= to; ++next) {
    greatest = std::max(greatest, next->value);
  }
  return greatest;
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
  auto next = next_station(stations_, from, false);
  for (; next != stations_.end() && next->chainage < to; ++next) {
    if (chainages.empty() || chainages.back() != next->chainage) {
      chainages.push_back(next->chainage);
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
  std::vector<double> chainages;
  for (const ChainageProfile* profile : {&a, &b}) {
    for (const ProfileStation& station : profile->stations()) {
      chainages.push_back(station.chainage);
    }
  }
  std::ranges::sort(chainages);
  chainages.erase(std::unique(chainages.begin(), chainages.end()), chainages.end());
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
