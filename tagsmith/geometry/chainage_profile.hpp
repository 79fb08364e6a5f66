// SPDX-License-Identifier: Apache-2.0
// A length that changes along the drive: half widths, heights, as surveyed at some chainages.
#pragma once

#include <vector>

namespace tagsmith::detail {

// A value at a chainage, both in metres.
struct ProfileStation {
  double chainage = 0;
  double value = 0;

  bool operator==(const ProfileStation&) const = default;
};

// Linear between its stations, constant before the first and after the last one. Two stations at
// one chainage are a step.
class ChainageProfile {
 public:
  // One value everywhere.
  ChainageProfile(
      double value = 0);  // NOLINT(google-explicit-constructor): most tunnels have one width

  // `stations`: at least one; chainages do not fall, and no three are equal.
  explicit ChainageProfile(std::vector<ProfileStation> stations);

  bool is_constant() const { return stations_.size() == 1; }
  const std::vector<ProfileStation>& stations() const { return stations_; }

  // At a step, the value beyond it.
  double at(double chainage) const;
  // At a step, the value before it.
  double before(double chainage) const;

  // Change per metre over [from, to], from < to, on average; steps do not count.
  double slope(double from, double to) const;
  // The steps within [from, to] added up without their signs.
  double steps(double from, double to) const;

  double least(double from, double to) const;
  double greatest(double from, double to) const;
  double least() const;
  double greatest() const;

  // The stations that lie strictly within (from, to), each chainage once.
  std::vector<double> breaks(double from, double to) const;

  // factor * value + shift.
  ChainageProfile scaled(double factor, double shift = 0) const;

  bool operator==(const ChainageProfile&) const = default;

 private:
  std::vector<ProfileStation> stations_;
};

// a + b.
ChainageProfile sum(const ChainageProfile& a, const ChainageProfile& b);

}  // namespace tagsmith::detail
