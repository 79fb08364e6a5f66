// SPDX-License-Identifier: Apache-2.0
// How a lens bends straight lines.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {

// A map between the image and a plane in which straight lines are straight.
class LensDistortion {
 public:
  // Bends nothing.
  LensDistortion() = default;

  // A camera's lens. The plane is z = 1 of the camera frame.
  explicit LensDistortion(const Camera& camera);

  // The division model (Fitzgibbon 2001, "Simultaneous linear estimation of multiple view geometry
  // and lens distortion", (5)): a pixel at the distance r from `centre` belongs to the point of the
  // plane, in pixels, at r / (1 + lambda r^2) in the same direction. A barrel has lambda < 0.
  static LensDistortion radial(PixelPoint centre, double lambda);

  bool bends() const { return !std::holds_alternative<std::monostate>(lens_); }

  // True of a camera's lens: its plane shows angles as they are.
  bool is_calibrated() const { return std::holds_alternative<Camera>(lens_); }

  // The pixel's point of the plane; nothing where the lens has none.
  std::optional<PixelPoint> straightened(PixelPoint pixel) const;

  // The point's pixel; nothing where the lens has none.
  std::optional<PixelPoint> bent(PixelPoint point) const;

 private:
  struct Division {
    PixelPoint centre;
    double lambda = 0;
  };

  std::variant<std::monostate, Division, Camera> lens_;
};

// The corners' points of the lens's plane; nothing where it has none for one of them.
std::optional<Quad> straightened(const LensDistortion& lens, const Quad& corners);

// How the lens bends the sides of a quadrilateral (clockwise in the image) whose corners have these
// pixels, to a thousandth of their bow; zero where it has no ray for one.
SideSagittas sagittas_of(const LensDistortion& lens, const Quad& corners);

// Sets the thickness of a bowed side's stroke and its taper as lens and perspective show them. A
// camera's lens says which sides are the frame's longer ones; otherwise the stroke is as thick a
// share of the frame's depth as the side says. Leaves both as they are where the lens has no ray.
void set_stroke_through(const LensDistortion& lens, const Quad& corners, std::size_t i,
                        const FrameShape& shape, SideLine& side);

// What is known of the lens before a frame is fitted.
struct LensGuess {
  std::optional<LensDistortion> known;  // otherwise it is estimated from the frame's own sides
  double lambda = 0;                    // about the image's centre, to start from
};

// A side's bow as seen: its middle's distance outwards from the chord beyond what the lens that it
// was fitted with gives.
struct SeenSagitta {
  double beyond = 0;    // pixels
  double variance = 0;  // pixels^2
};

struct RadialLens {   // of the division model, as radial() takes it
  double lambda = 0;  // 1 / pixels^2
  double sigma = 0;   // of lambda
};

// The lens of the division model that follows from the sides of a frame that were fitted with that
// of `lambda`; nothing when they are straight as far as can be seen, or bow in ways that no such
// lens mostly explains.
std::optional<RadialLens> lens_of_sides(const Quad& corners, const std::array<SeenSagitta, 4>& seen,
                                        PixelPoint centre, double lambda);

// The distortion that may remain unseen in sides that were fitted straight: the likeliest lens
// about `centre`, the image's, and its uncertainty.
struct UnseenLens {
  double lambda = 0;             // standard deviation about 0, 1 / pixels^2
  std::array<double, 4> bows{};  // how far it moves the sides' middles, pixels
};
UnseenLens unseen_lens(const Quad& corners, const std::array<SeenSagitta, 4>& seen,
                       PixelPoint centre);

// The lambda that follows from the bows of a settled frame, zero when they give none; `sigma` of a
// bow's middle, pixels.
double lambda_of_coarse(const Quad& corners, const SideSagittas& bows, double sigma,
                        PixelPoint centre);

// The map from the unit square, (0,0) (1,0) (1,1) (0,1) -> a frame's corners in order, to the image
// through a lens.
class FrameHomography {
 public:
  FrameHomography(const Quad& corners, const LensDistortion& lens);

  PixelPoint operator()(double u, double v) const {
    return lens_.bends() ? through_lens(u, v) : flat_(u, v);
  }

  // The place in the unit square of a pixel, exactly; without the lens where that has no ray.
  PixelPoint unit_of(PixelPoint pixel) const;

  // The map without the lens.
  const Homography& flat() const { return flat_; }

  bool bends() const { return lens_.bends(); }

  // The place in the unit square of a pixel that the map without the lens puts at (u, v). For
  // places in the square or near it, to about a fiftieth of what the lens changes.
  void correct(float& u, float& v) const;

 private:
  static constexpr int kAlong = 5;  // coefficients, by powers of u
  static constexpr int kAcross = 4;

  PixelPoint through_lens(double u, double v) const;
  void fit_correction();

  LensDistortion lens_;
  Homography flat_;
  Homography straight_;
  std::array<std::array<float, kAlong>, kAcross> by_u_{};
  std::array<std::array<float, kAlong>, kAcross> by_v_{};
};

}  // namespace tagsmith::detail
