// SPDX-License-Identifier: Apache-2.0
// How well a tag's corners were read.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/feature_frame/frame.hpp"

namespace tagsmith::detail::bench {

// The corners of a reading, or of a part of a tag, against the true ones.
struct CornerFit {
  Eigen::Matrix<double, 8, 1> error;  // u, v of each corner, pixels
  double sigma = 0;                   // stated, root mean square of a coordinate
  double chi_square = 0;              // of the error by its covariance, over 8
};

inline CornerFit corner_fit(const auto& reading, const FrameCorners& truth) {
  CornerFit fit;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const PixelPoint off = reading.corners[i] - truth[i];
    fit.error.template segment<2>(static_cast<Eigen::Index>(2 * i)) << off.x, off.y;
  }
  fit.sigma = std::sqrt(reading.corner_covariance.trace() / 8);
  fit.chi_square = fit.error.dot(reading.corner_covariance.ldlt().solve(fit.error)) / 8;
  return fit;
}

}  // namespace tagsmith::detail::bench
