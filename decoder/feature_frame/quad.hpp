// SPDX-License-Identifier: Apache-2.0
// Quadrilaterals and the homography between a feature frame and its image.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// Four corners in order around the quadrilateral, clockwise in the image (y down).
using Quad = std::array<PixelPoint, 4>;

double area_of(const Quad& quad);

// Means of the two sides that run along from corner 0 to corner 1, and of the other two.
double length_of(const Quad& quad);
double height_of(const Quad& quad);

// True when the corners run clockwise in the image around a convex shape.
bool is_convex(const Quad& quad);

// Convex hull, clockwise in the image, of any points.
std::vector<PixelPoint> convex_hull(std::vector<PixelPoint> points);

double area_of(const std::vector<PixelPoint>& polygon);

// The quadrilateral around a convex polygon that is left when the sides that matter least (whose
// neighbours, prolonged to meet, add the least area) are dropped one by one. It begins at its upper
// left corner: there begins the symbol of a tag that is seen the right way up.
std::optional<Quad> enclosing_quad(const std::vector<PixelPoint>& hull);

// Every side moved outwards by this many pixels; the corners are where the moved sides meet.
Quad widened(const Quad& quad, double pixels);

// Whether a point is inside a convex quadrilateral or on its sides, whichever way it turns.
bool contains(const Quad& quad, PixelPoint point);

// Mean of the four corners.
PixelPoint centre_of(const Quad& quad);

// Whether the centre of one is inside the other: two outlines of one tag do, two plates do not.
bool overlap(const Quad& a, const Quad& b);

// Whether the corners of two quadrilaterals are all less than this many pixels apart, in some turn.
bool nearly_equal(const Quad& a, const Quad& b, double pixels);

// Plane projective map from the unit square, (0,0) (1,0) (1,1) (0,1) -> the quad's corners in
// order.
struct Homography {
  std::array<double, 9> h{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major

  PixelPoint operator()(double u, double v) const {
    const double w = h[6] * u + h[7] * v + h[8];
    return {(h[0] * u + h[1] * v + h[2]) / w, (h[3] * u + h[4] * v + h[5]) / w};
  }
};

Homography homography_to(const Quad& quad);

// The inverse map: image pixels to the unit square.
Homography inverse(const Homography& homography);

}  // namespace tagsmith::detail
