// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/lens_distortion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "decoder/feature_frame/tuning.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {

LensDistortion::LensDistortion(const Camera& camera) {
  if (!is_rectilinear(camera)) lens_ = camera;
}

LensDistortion LensDistortion::radial(PixelPoint centre, double lambda) {
  LensDistortion bend;
  if (lambda != 0) bend.lens_ = Division{centre, lambda};
  return bend;
}

std::optional<PixelPoint> LensDistortion::straightened(PixelPoint pixel) const {
  if (const auto* camera = std::get_if<Camera>(&lens_)) {
    const auto ray = ray_through(*camera, {pixel.x, pixel.y});
    return ray ? std::optional(PixelPoint{ray->x(), ray->y()}) : std::nullopt;
  }
  if (const auto* division = std::get_if<Division>(&lens_)) {
    const PixelPoint off = pixel - division->centre;
    const double scale = 1 + division->lambda * dot(off, off);
    constexpr double kLeastScale = 0.05;
    if (scale < kLeastScale) return std::nullopt;
    return division->centre + 1 / scale * off;
  }
  return pixel;
}

std::optional<PixelPoint> LensDistortion::bent(PixelPoint point) const {
  if (const auto* camera = std::get_if<Camera>(&lens_)) {
    const auto pixel = project(*camera, {point.x, point.y, 1});
    return pixel ? std::optional(PixelPoint{pixel->x(), pixel->y()}) : std::nullopt;
  }
  if (const auto* division = std::get_if<Division>(&lens_)) {
    const PixelPoint off = point - division->centre;
    const double discriminant = 1 - 4 * division->lambda * dot(off, off);
    if (discriminant <= 0) return std::nullopt;
    return division->centre + 2 / (1 + std::sqrt(discriminant)) * off;
  }
  return point;
}

std::optional<Quad> straightened(const LensDistortion& lens, const Quad& corners) {
  Quad straight{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto point = lens.straightened(corners[i]);
    if (!point) return std::nullopt;
    straight[i] = *point;
  }
  return straight;
}

namespace {

// A place of a side: -1 at its begin, 1 at its end; and how far the side bows there, as a share of
// 1 - s^2.
struct BowedPlace {
  double s = 0;
  double bow = 0;
};

// The image, through a lens, of the straight line between two points of its plane, so far along it,
// measured outwards from the side between their pixels. Nothing where the lens shows none of it, or
// next to the ends.
std::optional<BowedPlace> bowed_place(const LensDistortion& lens, const SideLine& side,
                                      PixelPoint from, PixelPoint to, double share) {
  const auto pixel = lens.bent((1 - share) * from + share * to);
  if (!pixel) return std::nullopt;
  const PixelPoint off = *pixel - side.begin;
  const double s = 2 * dot(off, side.along) / distance(side.begin, side.end) - 1;
  if (!(std::abs(s) < 0.995)) return std::nullopt;
  return BowedPlace{s, dot(off, side.outward) / (1 - s * s)};
}

// The curve through a bent side's ends and its pixels at five places.
SideSagitta bow_between(const LensDistortion& lens, const SideLine& side, PixelPoint from,
                        PixelPoint to) {
  constexpr std::array<double, 5> kShares{0.04, 0.22, 0.5, 0.78, 0.96};
  constexpr auto kCount = static_cast<Eigen::Index>(kShares.size());
  Eigen::Matrix<double, kCount, kCount> powers;
  Eigen::Matrix<double, kCount, 1> series;
  for (Eigen::Index i = 0; i < kCount; ++i) {
    const auto place = bowed_place(lens, side, from, to, kShares[static_cast<std::size_t>(i)]);
    if (!place) return {};
    series[i] = place->bow;
    double power = 1;
    for (Eigen::Index k = 0; k < kCount; ++k, power *= place->s) powers(i, k) = power;
  }
  const Eigen::Matrix<double, kCount, 1> c = least_squares(powers, series);
  SideSagitta bow;
  std::ranges::copy(c, bow.c.begin());
  return bow;
}

// How far the sides bow at the middle of their length, or near it where they are seen obliquely: a
// small lambda bows a side alike everywhere, as a share of 1 - s^2.
std::array<double, 4> bows_amid(const LensDistortion& lens, const Quad& corners) {
  std::array<double, 4> bows{};
  const std::optional<Quad> straight = straightened(lens, corners);
  if (!straight) return bows;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto place =
        bowed_place(lens, side_of(corners, i), (*straight)[i], (*straight)[(i + 1) % 4], 0.5);
    if (place) bows[i] = place->bow;
  }
  return bows;
}

// The change of the sides' bows with lambda.
std::array<double, 4> bows_by_lambda(const Quad& corners, PixelPoint centre, double lambda) {
  double farthest = 1;
  for (const PixelPoint& corner : corners) farthest = std::max(farthest, distance(corner, centre));
  const double step = 1e-3 / (farthest * farthest);
  const auto more = bows_amid(LensDistortion::radial(centre, lambda + step), corners);
  const auto less = bows_amid(LensDistortion::radial(centre, lambda - step), corners);
  std::array<double, 4> by_lambda{};
  for (std::size_t i = 0; i < 4; ++i) by_lambda[i] = (more[i] - less[i]) / (2 * step);
  return by_lambda;
}

// The lens that explains the bows best; `by_lambda`: the change of each with lambda, at `lambda`.
std::optional<RadialLens> likeliest_lens(const std::array<double, 4>& by_lambda,
                                         const std::array<SeenSagitta, 4>& seen, double lambda) {
  double weight = 0, sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!(seen[i].variance > 0)) continue;
    weight += by_lambda[i] * by_lambda[i] / seen[i].variance;
    sum += by_lambda[i] * seen[i].beyond / seen[i].variance;
  }
  if (!(weight > 0)) return std::nullopt;
  return RadialLens{lambda + sum / weight, 1 / std::sqrt(weight)};
}

}  // namespace

SideSagittas sagittas_of(const LensDistortion& lens, const Quad& corners) {
  SideSagittas bows{};
  if (!lens.bends()) return bows;
  const std::optional<Quad> straight = straightened(lens, corners);
  if (!straight) return bows;
  for (std::size_t i = 0; i < 4; ++i) {
    bows[i] = bow_between(lens, side_of(corners, i), (*straight)[i], (*straight)[(i + 1) % 4]);
  }
  return bows;
}

namespace {

// The thickness of the stroke as a share of the frame's extent across its side, by the rectangle
// that the plane of a camera's lens shows: columns of its homography are as long as its sides.
double share_of_stroke(const Homography& plane, const FrameShape& shape) {
  const double along = std::hypot(plane.h[0], plane.h[3], plane.h[6]);
  const double across = std::hypot(plane.h[1], plane.h[4], plane.h[7]);
  const bool is_longer = (along > across) == (shape.length > shape.height);
  return shape.stroke / (is_longer ? shape.height : shape.length);
}

}  // namespace

void set_stroke_through(const LensDistortion& lens, const Quad& corners, std::size_t i,
                        const FrameShape& shape, SideLine& side) {
  const auto corner = [&](const Quad& of, std::size_t k) { return of[(i + k) % 4]; };
  const std::optional<Quad> straight = straightened(lens, corners);
  if (!straight) return;
  const Homography plane = homography_to(
      {corner(*straight, 0), corner(*straight, 1), corner(*straight, 2), corner(*straight, 3)});
  const PixelPoint middle = 0.5 * (side.begin + side.end);
  const PixelPoint opposite = 0.5 * (corner(corners, 2) + corner(corners, 3));
  const double share = lens.is_calibrated()
                           ? share_of_stroke(plane, shape)
                           : side.stroke / std::abs(dot(middle - opposite, side.outward));
  std::array<double, 2> places{}, thickness{};
  for (const std::size_t k : {0U, 1U}) {
    const auto pixel = lens.bent(plane(k == 0 ? 0.2 : 0.8, -share));
    if (!pixel) return;
    const PixelPoint off = *pixel - side.begin;
    places[k] = 2 * dot(off, side.along) / distance(side.begin, side.end) - 1;
    thickness[k] = dot(off, side.outward) - side.bow.at(places[k]);
  }
  const double slope = (thickness[1] - thickness[0]) / (places[1] - places[0]);
  const double amid = thickness[0] - slope * places[0];
  if (!(amid > 0)) return;
  side.stroke = std::max(1.0, amid);
  side.taper = std::clamp(slope / amid, -0.5, 0.5);
}

// Why: docs/decisions/0006-lens-tone-and-shadows.md.
std::optional<RadialLens> lens_of_sides(const Quad& corners, const std::array<SeenSagitta, 4>& seen,
                                        PixelPoint centre, double lambda) {
  const std::array<double, 4> by_lambda = bows_by_lambda(corners, centre, lambda);
  const std::optional<RadialLens> likeliest = likeliest_lens(by_lambda, seen, lambda);
  if (!likeliest) return std::nullopt;
  const RadialLens lens = *likeliest;
  const double change = lens.lambda - lambda;
  double unexplained = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!(seen[i].variance > 0)) continue;
    unexplained += std::pow(seen[i].beyond - change * by_lambda[i], 2) / seen[i].variance;
  }
  const double explained = std::pow(lens.lambda / lens.sigma, 2);
  if (!(explained > std::max(kBeyondNoise * kBeyondNoise, unexplained))) return std::nullopt;
  for (const PixelPoint& corner : corners) {
    const PixelPoint off = corner - centre;
    const double there = lens.lambda * dot(off, off);
    if (std::abs(there) > kLens.most) return std::nullopt;
  }
  return lens;
}

UnseenLens unseen_lens(const Quad& corners, const std::array<SeenSagitta, 4>& seen,
                       PixelPoint centre) {
  UnseenLens unseen{0, bows_by_lambda(corners, centre, 0)};
  const std::optional<RadialLens> lens = likeliest_lens(unseen.bows, seen, 0);
  if (!lens) return {};
  unseen.lambda = std::min(std::hypot(lens->lambda, lens->sigma), kLens.most / dot(centre, centre));
  for (double& bow : unseen.bows) bow *= unseen.lambda;
  return unseen;
}

double lambda_of_coarse(const Quad& corners, const SideSagittas& bows, double sigma,
                        PixelPoint centre) {
  std::array<SeenSagitta, 4> seen{};
  for (std::size_t i = 0; i < 4; ++i) {
    // A side that was not bowed was fitted well enough by a straight line: that is weak evidence.
    if (bows[i].middle() != 0) seen[i] = {bows[i].middle(), sigma * sigma};
  }
  const auto lens = lens_of_sides(corners, seen, centre, 0);
  return lens ? lens->lambda : 0;
}

FrameHomography::FrameHomography(const Quad& corners, const LensDistortion& lens)
    : flat_(homography_to(corners)) {
  if (!lens.bends()) return;
  const std::optional<Quad> straight = straightened(lens, corners);
  if (!straight) return;
  lens_ = lens;
  straight_ = homography_to(*straight);
  fit_correction();
}

PixelPoint FrameHomography::through_lens(double u, double v) const {
  return lens_.bent(straight_(u, v)).value_or(flat_(u, v));
}

PixelPoint FrameHomography::unit_of(PixelPoint pixel) const {
  if (lens_.bends()) {
    const auto straight = lens_.straightened(pixel);
    if (straight) return inverse(straight_)(straight->x, straight->y);
  }
  return inverse(flat_)(pixel.x, pixel.y);
}

void FrameHomography::correct(float& u, float& v) const {
  float change_u = 0, change_v = 0;
  for (std::size_t j = kAcross; j-- > 0;) {
    float along_u = 0, along_v = 0;
    for (std::size_t i = kAlong; i-- > 0;) {
      along_u = along_u * u + by_u_[j][i];
      along_v = along_v * u + by_v_[j][i];
    }
    change_u = change_u * v + along_u;
    change_v = change_v * v + along_v;
  }
  u += change_u;
  v += change_v;
}

// Least squares over a grid of places.
void FrameHomography::fit_correction() {
  constexpr int kPlacesAlong = 11, kPlacesUp = 7;
  constexpr int kTerms = kAlong * kAcross;
  const Homography flat_from_image = inverse(flat_);
  Eigen::Matrix<double, kPlacesAlong * kPlacesUp, kTerms> terms;
  Eigen::Matrix<double, kPlacesAlong * kPlacesUp, 2> changes;
  for (int row = 0; row < kPlacesUp; ++row) {
    for (int column = 0; column < kPlacesAlong; ++column) {
      const double u = static_cast<double>(column) / (kPlacesAlong - 1);
      const double v = static_cast<double>(row) / (kPlacesUp - 1);
      const PixelPoint pixel = (*this)(u, v);
      const PixelPoint flat = flat_from_image(pixel.x, pixel.y);
      const Eigen::Index k = row * kPlacesAlong + column;
      changes.row(k) << u - flat.x, v - flat.y;
      double across = 1;
      for (int j = 0; j < kAcross; ++j, across *= flat.y) {
        double power = across;
        for (int i = 0; i < kAlong; ++i, power *= flat.x) terms(k, j * kAlong + i) = power;
      }
    }
  }
  const Eigen::Matrix<double, kTerms, 2> fit = least_squares(terms, changes);
  for (std::size_t j = 0; j < kAcross; ++j) {
    for (std::size_t i = 0; i < kAlong; ++i) {
      const auto term = static_cast<Eigen::Index>(j * kAlong + i);
      by_u_[j][i] = static_cast<float>(fit(term, 0));
      by_v_[j][i] = static_cast<float>(fit(term, 1));
    }
  }
}

}  // namespace tagsmith::detail
