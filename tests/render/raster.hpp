// SPDX-License-Identifier: Apache-2.0
// Rendered pages as rasters, and measuring in them by grey coverage.
#pragma once

#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/render/page.hpp"

namespace tagsmith::detail::test {

struct Raster {
  GrayImage image;
  double pixels_per_mm = 0;
};

// Rasterises by pdftoppm or rsvg-convert. Throws when the program is missing or fails.
Raster rasterize_pdf(const std::string& bytes, double dpi);
Raster rasterize_svg(const std::string& bytes, double dpi);

// The darkness (0 = white, 1 = black) along a line, averaged across it. The rectangle is in metres
// on the page; `vertical` averages over x and runs along y.
struct Profile {
  std::vector<double> darkness;
  double first_mm = 0;  // where the first sample begins
  double step_mm = 0;   // length of a sample
};
Profile profile_of(const Raster& raster, const Rectangle& strip, bool vertical);

// Positions in mm of all changes between white and black, each from the darkness between the
// middles of the two runs it parts.
std::vector<double> edges_mm(const Profile& profile);

// Middles in mm of the dark lines across the profile.
std::vector<double> lines_mm(const Profile& profile);

// The most darkness of any pixel inside the rectangle (metres on the page).
double darkest(const Raster& raster, const Rectangle& rectangle);

// The rectangle with all its sides moved outward.
Rectangle grown(const Rectangle& rectangle, double by);

// The most darkness in the ring between two rectangles, the inner one inside the outer one.
double darkest_between(const Raster& raster, const Rectangle& inner, const Rectangle& outer);

}  // namespace tagsmith::detail::test
