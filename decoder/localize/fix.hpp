// SPDX-License-Identifier: Apache-2.0
// What localization returns, and how it compares with the truth where that is known.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/survey/run.hpp"

namespace tagsmith {

// The vehicle's centre O at one measurement.
struct Fix {
  std::string id;
  std::string method;             // "paper"
  std::string survey;             // name of the survey whose tags were used
  std::vector<std::string> tags;  // names of the tags used; without a position, of those seen
  // In the survey's grid, metres; there exactly when the measurement was located.
  std::optional<Eigen::Vector3d> position_in_grid;
  // Radians from +y towards +x of the grid; not every method determines one.
  std::optional<double> heading;
  std::optional<Eigen::Matrix3d> covariance_in_grid;  // of x, y, z, metres^2
  std::string reason;                                 // why there is no position; empty with one
  std::vector<std::string> notes;                     // what a user of the position should know
};

// "ok" or "no_position".
std::string status_of(const Fix& fix);

// Xu et al. (2017), (26) and (24).
struct FixError {
  double plane = 0;   // horizontal distance from the truth, metres
  double height = 0;  // difference of z without its sign, metres
};

// Nothing without a position or without a truth.
std::optional<FixError> error_of(const Fix& fix, const Measurement& measurement);

struct FixSummary {
  int count = 0;
  int located = 0;
  std::optional<FixError> mean_error;  // (27) and (25), over the measurements that have an error
  std::optional<FixError> max_error;   // of each by itself
};

// `fixes[i]` belongs to `measurements[i]`.
FixSummary summarize(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements);

}  // namespace tagsmith
