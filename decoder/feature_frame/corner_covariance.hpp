// SPDX-License-Identifier: Apache-2.0
// How well a refined frame's corners are known.
#pragma once

#include <Eigen/Core>

namespace tagsmith::detail {

struct RefinedFrame;

// Of u, v of the four corners in their order, pixels^2.
using CornerCovariance = Eigen::Matrix<double, 8, 8>;

// By how much edges are missed because of where in a pixel they lie, root mean square of the
// frame's sides, pixels: it is the optics' and the processing's, so it is one for the picture.
double pixel_locking(const RefinedFrame& frame);

// Each corner is where two fitted sides meet, so neighbouring corners share a side's errors.
// Positive definite: the errors of the lens, the print and the tone curve that no fit shows are
// added. `displaced`: by how many pixels, one standard deviation, edges may lie elsewhere than the
// growth of the bars says. A tone curve that is not sRGB, or that ends in the white, displaces a
// single edge differently from edges between bars. Half of this is common to all sides, and it is
// twice as much for a side that runs along the pixel grid. `alike`: how far all of them may lie
// outwards or inwards alike, pixels. Neither moves a side that was not fitted to its edge.
CornerCovariance corner_covariance(const RefinedFrame& frame, double displaced = 0,
                                   double alike = 0);

}  // namespace tagsmith::detail
