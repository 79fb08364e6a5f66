// SPDX-License-Identifier: Apache-2.0
// One side of a feature frame, fitted to the pixels that show it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "decoder/feature_frame/edge_samples.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// ---- Which part of a side of a feature frame shows its edge, where something covers the rest.

// The edge on which most slices agree.
struct ShownPart {
  double place = 0;                 // pixels outwards from the side that was sampled, in its middle
  double turn = 0;                  // what is added to that at its end and subtracted at its begin
  std::vector<EdgeSample> samples;  // of the slices in which the edge lies there
};

// The straight line on which the edge lies in most slices of a side, by samples in kSlices zones
// along it; nothing where all or all but one agree, as they also do on a bow, or where fewer than
// half agree on a line. `noise`: of a sample, grey levels.
std::optional<ShownPart> shown_part(std::vector<EdgeSample> samples, double noise);

// ---- The fit.

// One fitted side of the frame, from corner i to corner i+1.
struct FrameSide {
  double blur_px = 0;      // standard deviation of the point spread across the side
  double white_begin = 0;  // light (0-1) inside the frame at the side's begin and end
  double white_end = 0;
  double black_begin = 0;  // light of the stroke
  double black_end = 0;
  double stroke_px = 0;  // thickness of the stroke
  // Of the inner edge's place across the side at its begin and its end, from the fit, pixels^2.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  // By how much the fit misses an edge because of where in a pixel that lies, root mean square,
  // pixels: as the residuals beside the edge exceed those of the noise. None of this is in the
  // covariance.
  double pixel_locking_px = 0;
};

// Least squares by Gauss-Newton steps with Cauchy weights: the light across the side is white, then
// the stroke's black, and white again where the stroke is thinner than `thin` pixels, all blurred.
// Where the fit to all of a side rejects many samples, the visible part of it is fitted. An edge
// that is found away from the line where it was searched, where samples are means over pixels, is
// fitted again there.
class FittedSide {
 public:
  // Nothing where too few pixels show the side.
  static std::optional<FittedSide> fit(const GrayView& image, const SideLine& near, double thin);

  FittedSide(FittedSide&&) noexcept;
  FittedSide& operator=(FittedSide&&) noexcept;
  ~FittedSide();

  // Whether the edge was found no farther from `near` than samples were taken.
  bool stays_near() const;
  double blur_px() const;
  SideLine line() const;
  FrameSide side() const;

  // By how much the samples put the side's middle off the bow that it was fitted with.
  SeenSagitta bow() const;
  // By how much noise that is correlated between neighbouring pixels raises the fit's variance; at
  // least 1.
  double noise_correlation() const;

  // Fits once more from another blur, and keeps the better fit. A side along the pixel grid shows
  // every pixel at the same fraction, and its blur may be mistaken for its place.
  void try_blur(double blur_px);

  struct Solved;

 private:
  explicit FittedSide(Solved solved);

  std::unique_ptr<Solved> solved_;
};

}  // namespace tagsmith::detail
