// SPDX-License-Identifier: Apache-2.0
// The thresholds of the search for feature frames, one struct for each stage. Where no command is
// named, `./dev bench photos` and `./dev bench ladder` show what a change does.
#pragma once

#include <cstddef>

namespace tagsmith::detail {

// Pairs of regions that something in front may have cut apart.
struct CandidateTuning {
  std::size_t most_pieces = 32;  // of a level
  double most_empty = 1.3;       // area around a pair of pieces, by that of both
};
inline constexpr CandidateTuning kCandidate;

// The fall from white inside a frame to its dark stroke, and the coarse fit of a side to it.
struct SideTuning {
  double least_fall = 6;     // grey levels from white to dark, over one pixel or two
  double scanned = 0.92;     // of a side's length: leaves the corners out
  double least_shown = 0.5;  // of the profiles across a side that must agree on one edge
  double tolerance = 0.6;    // pixels off a line of what agrees with it
  double agreed = 0.85;      // of the profiles: as good as all of them
  // Of the logarithm of the frame's proportions: how clearly a side must show which of the two it
  // is.
  double clear_elongation = 0.42;
  double least_reach = 1.5;  // pixels to either side of the edge that are looked at
  double most_reach = 8;
};
inline constexpr SideTuning kSide;

// The sub-pixel fit of a side.
struct EdgeFitTuning {
  float fine = 1.6F;          // pixels to either side of the edge where samples are close together
  float per_pixel = 4;        // samples there
  int zones = 4;              // along a side in which samples are averaged
  double thin_stroke = 4;     // pixels: fitted by both of its edges; lines that are nearer are one
  double most_pixels = 1000;  // of a side; more add nothing that the model could use
  // Of logarithms: the stroke's thickness by the guess, a side's blur by that of the others.
  double log_sigma = 0.4;
  double least_residual = 3;  // grey levels: of a pixel's noise, of the scale of Cauchy weights
  double start_blur = 0.6;    // pixels
  int rounds = 4;             // of fits through a lens and bows that these change
  // Where some of a side's samples are of something else, its edge is searched slice by slice.
  double least_fitting = 0.8;   // mean weight of the samples; with less, the edge may be covered
  double most_residual = 0.1;   // of the contrast, the scale of the Cauchy weights; or with more
  double slice_contrast = 0.5;  // of the side's, in a slice that shows the edge
  double slice_off = 0.35;      // pixels off the line of the others
};
inline constexpr EdgeFitTuning kEdgeFit;

// How sharpening is determined from the sides. Set by `./dev bench chain` with seed 1, tried with
// seed 2.
struct SharpeningTuning {
  double beyond_px = 5;     // pixels of white to either side of the stroke, undone around it
  double model = 1;         // grey levels that a profile may be off its model
  double dirt = 8;          // grey levels of the scale of the Cauchy weights
  double usual_px = 1.6;    // standard deviation of the mask's Gaussian
  double worth = 2.5;       // of the square of standard deviations, for a closer look
  double clear = 12;        // of twice the logarithm of the likelihood ratio
  double doubt = 0.35;      // of what undoing or growth moves; of what stroke and bars differ by
  double thin_stroke = 10;  // pixels, of a stroke that shows by how much edges are moved
};
inline constexpr SharpeningTuning kSharpening;

// The error of the corners beyond what noise explains, as seen on the ray-traced photos of
// docs/accuracy.md. Why: docs/decisions/0007-corner-covariance.md.
struct CornerTuning {
  double alike = 1.8;   // factor of variances: compression makes neighbouring pixels' noise alike
  double side = 0.006;  // pixels, a side as a whole, and either of its ends by itself
  // A pixel's response is no Gaussian, so an edge is found a little off, depending on where in the
  // pixel it lies. That is so much greater than noise of the same residuals, because it is alike
  // all along a side: seen on ladder and phone photos, on sides that cross 0.15 to 1.6 pixels.
  double pixel_locking = 4;
  // Where the blur reaches from one edge of the stroke to the other, the model's errors do too.
  double blurred = 0.5;  // pixels, times (blur / stroke)^2
  // Pixels that edges of shadows beside the sides of a plate and across them may move these by
  // (`./dev bench photos -s 0.1`).
  double in_shadow = 0.12;
  // Chi-square by a place, above which bars or frame are wrong, or of another layout.
  double most_contradiction = 10;
};
inline constexpr CornerTuning kCorner;

// How an unknown lens is estimated from the sides; chosen by `./dev bench lens`.
// Why: docs/decisions/0006-lens-tone-and-shadows.md.
struct LensTuning {
  double most = 0.8;    // of 1, at the farthest corner; in the image's where none is seen
  double shape = 0.04;  // of a bow, at either end: lenses are not quite of the model
};
inline constexpr LensTuning kLens;

// Which tiles and regions of them count as bars. Chosen by `./dev bench frameless` and `bench
// photos` on the dark and dirty photos. With strengths of 50 to 90, shares of 0.2 to 0.3 and
// cosines of 0.7 to 0.9 the numbers read differ by a photo or two.
struct BarRegionTuning {
  int least_tile = 200;        // strength of one tile: 6 grey levels from pixel to pixel
  float least_strength = 70;   // of a tile among its neighbours: 2 grey levels
  float least_share = 0.2F;    // of the gradients' strength that is of one direction
  unsigned least_row = 4;      // tiles of seven in the gradients' direction that share it
  std::size_t around = 5;      // tiles: quiet zone and stroke, 14 modules of 2.8 pixels
  float least_cosine = 0.82F;  // of twice the angle between neighbours: 17 degrees
  double least_length = 40;    // pixels: 95 modules of half a pixel, less what is left out
};
inline constexpr BarRegionTuning kBarRegion;

// A frame whose sides are not wholly visible, found around bars by scan lines outwards from them.
struct FrameAroundTuning {
  int scan_lines = 28;         // for each side; slopes to both sides
  double of_best = 0.75;       // of those that fall on the most visible line
  std::size_t most_lines = 4;  // above and below the bars, tried in pairs
  double most_slope = 0.8;     // of a plate seen and turned obliquely
  // From the bars' middle: of their height beyond their ends, of their length beside them.
  double beyond = 2;
};
inline constexpr FrameAroundTuning kFrameAround;

}  // namespace tagsmith::detail
