// SPDX-License-Identifier: Apache-2.0
// What truth.json says of a folder's photos.
#pragma once

#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <nlohmann/json.hpp>

#include "decoder/reader/reading.hpp"

namespace tagsmith::detail::bench {

// The frame's corners of a plate of truth.json, P, F, R, Q, pixels.
inline FrameCorners corners_of(const nlohmann::json& plate) {
  FrameCorners corners{};
  std::size_t next = 0;
  for (const char* name : {"P", "F", "R", "Q"}) {
    const nlohmann::json& at = plate.at("corners_px").at(name);
    corners[next++] = {at[0].get<double>(), at[1].get<double>()};
  }
  return corners;
}

// The codes of all its plates, in order.
inline std::vector<Digits> codes_of(const nlohmann::json& truth) {
  std::set<Digits> codes;
  for (const auto& item : truth.at("images")) {
    for (const auto& plate : item.at("plates")) {
      const auto code = parse_digits(plate.value("code", std::string()));
      if (code) codes.insert(*code);
    }
  }
  return {codes.begin(), codes.end()};
}

// A reading's corners against the true ones.
struct CornerFit {
  Eigen::Matrix<double, 8, 1> error;  // pixels
  double sigma = 0;                   // stated, root mean square of a coordinate
  double chi_square = 0;              // of the error against its covariance, over 8
};

inline CornerFit corner_fit(const Reading& reading, const nlohmann::json& plate) {
  CornerFit fit;
  const FrameCorners truth = corners_of(plate);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(2 * i);
    fit.error[at] = reading.corners[i].x - truth[i].x;
    fit.error[at + 1] = reading.corners[i].y - truth[i].y;
  }
  fit.sigma = std::sqrt(reading.corner_covariance.trace() / 8);
  fit.chi_square = fit.error.dot(reading.corner_covariance.ldlt().solve(fit.error)) / 8;
  return fit;
}

}  // namespace tagsmith::detail::bench
