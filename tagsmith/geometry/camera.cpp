// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "tagsmith/geometry/angle.hpp"

namespace tagsmith {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Coefficients of 1, s, s^2, ...
using Polynomial = std::array<double, 7>;

double value_at(const Polynomial& p, double s) {
  double value = 0;
  for (std::size_t i = p.size(); i-- > 0;) value = value * s + p[i];
  return value;
}

Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  Polynomial product{};
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == 0) continue;
    for (std::size_t j = 0; i + j < product.size(); ++j) product[i + j] += a[i] * b[j];
  }
  return product;
}

// s p'(s).
Polynomial s_times_slope(Polynomial p) {
  for (std::size_t i = 0; i < p.size(); ++i) p[i] *= static_cast<double>(i);
  return p;
}

// Both lens models take a point's distance from the axis to its distance in the image by one curve,
// q N(q^2)/D(q^2): q is the tangent of the angle to the axis in the perspective model, that angle
// itself in the fisheye's.
struct RadialCurve {
  Polynomial numerator{};
  Polynomial denominator{};
  Polynomial rise{};  // the curve's derivative is rise / denominator^2

  double value(double q) const {
    return q * value_at(numerator, q * q) / value_at(denominator, q * q);
  }
  double slope(double q) const {
    const double d = value_at(denominator, q * q);
    return value_at(rise, q * q) / (d * d);
  }
};

RadialCurve radial_curve(const Camera& camera) {
  const std::array<double, 8>& k = camera.distortion;
  RadialCurve curve;
  curve.numerator = camera.lens == LensModel::fisheye ? Polynomial{1, k[0], k[1], k[2], k[3]}
                                                      : Polynomial{1, k[0], k[1], k[4]};
  curve.denominator = {1};
  if (camera.lens == LensModel::perspective) curve.denominator = {1, k[5], k[6], k[7]};
  const Polynomial up = s_times_slope(curve.numerator) * curve.denominator;
  const Polynomial down = curve.numerator * s_times_slope(curve.denominator);
  curve.rise = curve.numerator * curve.denominator;
  for (std::size_t i = 0; i < curve.rise.size(); ++i) curve.rise[i] += 2 * (up[i] - down[i]);
  return curve;
}

// True when the polynomial with these Bernstein coefficients is positive on all of [0, 1]. It lies
// in their convex hull; where that leaves it open, each half is looked at (Farouki and Rajan 1988,
// "Algorithms for polynomials in Bernstein form").
bool is_positive(const Polynomial& bernstein, int halvings) {
  if (!(bernstein.front() > 0 && bernstein.back() > 0)) return false;
  if (std::ranges::all_of(bernstein, [](double b) { return b > 0; })) return true;
  if (halvings == 0) return false;
  Polynomial left{};
  Polynomial right = bernstein;
  for (std::size_t i = 0; i < right.size(); ++i) {
    left[i] = right[0];
    for (std::size_t j = 0; j + 1 + i < right.size(); ++j) right[j] = (right[j] + right[j + 1]) / 2;
  }
  return is_positive(left, halvings - 1) && is_positive(right, halvings - 1);
}

// True when p > 0 on [0, end].
bool is_positive_up_to(const Polynomial& p, double end) {
  constexpr int kHalvings = 24;
  constexpr std::size_t kDegree = 6;
  constexpr std::array<std::array<double, 7>, 7> kChoose{{{1, 0, 0, 0, 0, 0, 0},
                                                          {1, 1, 0, 0, 0, 0, 0},
                                                          {1, 2, 1, 0, 0, 0, 0},
                                                          {1, 3, 3, 1, 0, 0, 0},
                                                          {1, 4, 6, 4, 1, 0, 0},
                                                          {1, 5, 10, 10, 5, 1, 0},
                                                          {1, 6, 15, 20, 15, 6, 1}}};
  Polynomial scaled = p;
  double power = 1;
  for (std::size_t i = 0; i <= kDegree; ++i, power *= end) scaled[i] *= power / kChoose[kDegree][i];
  Polynomial bernstein{};
  for (std::size_t j = 0; j <= kDegree; ++j) {
    for (std::size_t i = 0; i <= j; ++i) bernstein[j] += kChoose[j][i] * scaled[i];
  }
  return is_positive(bernstein, kHalvings);
}

// True when the curve rises all the way from 0 to q.
bool rises_up_to(const RadialCurve& curve, double q) {
  return is_positive_up_to(curve.rise, q * q) && is_positive_up_to(curve.denominator, q * q);
}

// The largest q that distortion is followed to. Beyond, x/z and y/z lose their meaning.
double widest(LensModel lens) {
  constexpr double kWidest = radians(89.9);
  return lens == LensModel::fisheye ? kWidest : std::tan(kWidest);
}

// A point of the plane z = 1 moved by the distortion, and the derivative of that.
struct Distorted {
  Vector2d point;
  Matrix2d by_ideal;
};

Distorted distort(const Camera& camera, const RadialCurve& curve, const Vector2d& ideal) {
  const bool is_fisheye = camera.lens == LensModel::fisheye;
  const std::array<double, 8>& k = camera.distortion;
  const double r2 = ideal.squaredNorm();
  const double r = std::sqrt(r2);
  const double q = is_fisheye ? std::atan(r) : r;
  // Near the axis the quotients below lose their digits; the next terms are of order r^2 smaller.
  constexpr double kNearAxis = 1e-6;
  double scale = 1;
  double bend = is_fisheye ? 2 * (k[0] - 1.0 / 3) : 2 * (k[0] - k[5]);
  if (r2 < kNearAxis) {
    scale += bend / 2 * r2;
  } else {
    scale = curve.value(q) / r;
    const double slope = curve.slope(q) * (is_fisheye ? 1 / (1 + r2) : 1.0);
    bend = (slope - scale) / r2;
  }
  Distorted result{scale * ideal, scale * Matrix2d::Identity() + bend * ideal * ideal.transpose()};
  if (is_fisheye) return result;
  const double p1 = k[2];
  const double p2 = k[3];
  const double x = ideal.x();
  const double y = ideal.y();
  result.point +=
      Vector2d(2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y);
  const double mixed = 2 * (p1 * x + p2 * y);
  result.by_ideal(0, 0) += 2 * p1 * y + 6 * p2 * x;
  result.by_ideal(0, 1) += mixed;
  result.by_ideal(1, 0) += mixed;
  result.by_ideal(1, 1) += 6 * p1 * y + 2 * p2 * x;
  return result;
}

bool in_reach(const Camera& camera, const RadialCurve& curve, const Vector2d& ideal) {
  const double r = ideal.norm();
  const double q = camera.lens == LensModel::fisheye ? std::atan(r) : r;
  return q <= widest(camera.lens) && rises_up_to(curve, q);
}

std::optional<Distorted> distorted_in_reach(const Camera& camera, const Vector2d& ideal) {
  if (is_rectilinear(camera)) return Distorted{ideal, Matrix2d::Identity()};
  const RadialCurve curve = radial_curve(camera);
  if (!in_reach(camera, curve, ideal)) return std::nullopt;
  return distort(camera, curve, ideal);
}

constexpr double kConverged = 1e-14;

// The q at which the curve has the value `radius`, by Newton's method where that leads there at
// once.
std::optional<double> invert_at_once(const RadialCurve& curve, double radius, double widest_q) {
  double q = std::min(radius, widest_q);
  for (int iteration = 0; iteration < 8; ++iteration) {
    const double step = (radius - curve.value(q)) / curve.slope(q);
    q += step;
    if (!(q >= 0 && q <= widest_q)) return std::nullopt;
    if (std::abs(step) > kConverged * (1 + q)) continue;
    return rises_up_to(curve, q) ? std::optional(q) : std::nullopt;
  }
  return std::nullopt;
}

// The same kept between a place known to be too near and one known to be too far (a place beyond a
// falling stretch is too far); nothing when the curve does not rise to `radius`.
std::optional<double> invert(const RadialCurve& curve, double radius, double widest_q) {
  if (const auto q = invert_at_once(curve, radius, widest_q)) return q;
  double near = 0;
  double far = widest_q;
  double q = std::min(radius, far);
  for (int iteration = 0; iteration < 100; ++iteration) {
    double step = 0;
    if (!rises_up_to(curve, q)) {
      far = q;
    } else {
      const double missing = radius - curve.value(q);
      (missing > 0 ? near : far) = q;
      step = missing / curve.slope(q);
      if (std::abs(step) < kConverged * (1 + q)) return q;
    }
    const double next = q + step;
    q = next > near && next < far ? next : (near + far) / 2;
    if (far - near < 1e-15 * (1 + near)) break;
  }
  return std::nullopt;
}

// The ideal point that is distorted to this one. The tangential terms, small against the radial
// ones, are mended by Newton's method from the solution without them.
std::optional<Vector2d> undistort(const Camera& camera, const Vector2d& distorted) {
  const RadialCurve curve = radial_curve(camera);
  const double radius = distorted.norm();
  const std::optional<double> q = invert(curve, radius, widest(camera.lens));
  if (!q) return std::nullopt;
  const double r = camera.lens == LensModel::fisheye ? std::tan(*q) : *q;
  Vector2d point = radius > 0 ? Vector2d(r / radius * distorted) : Vector2d(0, 0);
  if (camera.lens == LensModel::fisheye) return point;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Distorted there = distort(camera, curve, point);
    const Vector2d step = there.by_ideal.inverse() * (distorted - there.point);
    point += step;
    if (step.squaredNorm() < 1e-28 * (1 + point.squaredNorm())) {
      return in_reach(camera, curve, point) ? std::optional(point) : std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace

Camera camera_from_sensor(int width, int height, double focal_length, double sensor_width,
                          double sensor_height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focal_length * width / sensor_width;
  camera.fy = focal_length * height / sensor_height;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

bool is_rectilinear(const Camera& camera) {
  return camera.lens == LensModel::perspective &&
         std::ranges::all_of(camera.distortion, [](double k) { return k == 0; });
}

double reach(const Camera& camera) {
  if (is_rectilinear(camera)) return std::numeric_limits<double>::infinity();
  const RadialCurve curve = radial_curve(camera);
  double near = 0;
  double far = widest(camera.lens);
  if (rises_up_to(curve, far)) near = far;
  while (far - near > 1e-13 * far) {
    const double middle = (near + far) / 2;
    (rises_up_to(curve, middle) ? near : far) = middle;
  }
  return camera.lens == LensModel::fisheye ? std::tan(near) : near;
}

std::optional<Projection> project_with_derivative(const Camera& camera,
                                                  const Vector3d& point_in_camera) {
  constexpr double kNearest = 1e-3;
  const double z = point_in_camera.z();
  if (!(z >= kNearest)) return std::nullopt;
  const Vector2d ideal = point_in_camera.head<2>() / z;
  const std::optional<Distorted> distorted = distorted_in_reach(camera, ideal);
  if (!distorted) return std::nullopt;
  const Vector2d focal(camera.fx, camera.fy);
  Projection projection;
  projection.pixel = focal.cwiseProduct(distorted->point) + Vector2d(camera.cx, camera.cy);
  const Matrix2d by_ideal = focal.asDiagonal() * distorted->by_ideal;
  projection.by_point.leftCols<2>() = by_ideal / z;
  projection.by_point.col(2) = -(by_ideal * ideal) / z;
  return projection;
}

std::optional<Vector2d> project(const Camera& camera, const Vector3d& point_in_camera) {
  const std::optional<Projection> projection = project_with_derivative(camera, point_in_camera);
  if (!projection) return std::nullopt;
  return projection->pixel;
}

std::optional<Vector3d> ray_through(const Camera& camera, const Vector2d& pixel) {
  const Vector2d distorted((pixel.x() - camera.cx) / camera.fx,
                           (pixel.y() - camera.cy) / camera.fy);
  const std::optional<Vector2d> ideal =
      is_rectilinear(camera) ? distorted : undistort(camera, distorted);
  if (!ideal) return std::nullopt;
  return Vector3d(ideal->x(), ideal->y(), 1.0);
}

bool in_image(const Camera& camera, const Vector2d& pixel) {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= camera.width - 0.5 &&
         pixel.y() <= camera.height - 0.5;
}

}  // namespace tagsmith
