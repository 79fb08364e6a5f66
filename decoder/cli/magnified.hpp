// SPDX-License-Identifier: Apache-2.0
// Millimetres in plans of metres: offsets and 95 % ellipses drawn magnified by one round factor.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tagsmith/render/sketch.hpp"
#include "tagsmith/survey/tunnel.hpp"

namespace tagsmith::detail {

// 95 % of a normal distribution in the plane lie within this many standard deviations: the square
// root of -2 ln 0.05.
extern const double kEllipse95;

// The factor by which objects of these sizes (metres) are magnified, so that nine of ten stay
// within a fifth of the tunnel: 1, 2 or 5 times a power of ten, 1 to 1000.
double magnification_for(const Tunnel& tunnel, std::vector<double> sizes);

// The ellipse about a point of the sketch in which 95 % lie, magnified.
Ellipse ellipse95(const Eigen::Vector2d& centre, const Eigen::Matrix2d& covariance, double factor);

}  // namespace tagsmith::detail
