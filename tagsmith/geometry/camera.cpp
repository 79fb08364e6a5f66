// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Coefficients of 1, s, s^2, ...
using Polynomial = std::array<double, 7>;

template <std::size_t Size>
double value_at(const std::array<double, Size>& p, double s) {
  double value = 0;
  for (std::size_t i = Size; i-- > 0;) value = value * s + p[i];
  return value;
}

// Both lens models take a point's distance from the axis to its distance in the image by one curve,
// q N(q^2)/D(q^2): q is the tangent of the angle to the axis in the perspective model, that angle
// itself in the fisheye's. It is made anew for every point, hence no more than its coefficients.
struct RadialCurve {
  std::array<double, 5> numerator{};
  std::array<double, 4> denominator{1};
  bool is_ratio = false;  // else the denominator is 1

  // The curve's value divided by q.
  double ratio(double q) const {
    const double value = value_at(numerator, q * q);
    return is_ratio ? value / value_at(denominator, q * q) : value;
  }
  double value(double q) const { return q * ratio(q); }
  double slope(double q) const;
};

// The curve's derivative times the denominator's square: (N + 2 s N') D - 2 s N D'.
Polynomial rise_of(const RadialCurve& curve) {
  Polynomial rise{};
  for (std::size_t i = 0; i < curve.numerator.size(); ++i) {
    if (!curve.is_ratio) {
      rise[i] = static_cast<double>(2 * i + 1) * curve.numerator[i];
      continue;
    }
    for (std::size_t j = 0; j < curve.denominator.size() && i + j < rise.size(); ++j) {
      const double factor = 1 + 2 * (static_cast<double>(i) - static_cast<double>(j));
      rise[i + j] += factor * curve.numerator[i] * curve.denominator[j];
    }
  }
  return rise;
}

double RadialCurve::slope(double q) const {
  const double rise = value_at(rise_of(*this), q * q);
  if (!is_ratio) return rise;
  const double d = value_at(denominator, q * q);
  return rise / (d * d);
}

RadialCurve radial_curve(const Camera& camera) {
  const std::array<double, 8>& k = camera.distortion;
  if (camera.lens == LensModel::fisheye) return {{1, k[0], k[1], k[2], k[3]}};
  const bool is_ratio = k[5] != 0 || k[6] != 0 || k[7] != 0;
  return {{1, k[0], k[1], k[4]}, {1, k[5], k[6], k[7]}, is_ratio};
}

// True when the polynomial with these Bernstein coefficients is positive on all of [0, 1]. It lies
// in their convex hull; where that does not decide, each half is tested (Farouki and Rajan 1988,
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

// A polynomial's Bernstein coefficients over [0, 1], by its coefficients.
constexpr std::array<Polynomial, 7> kBernstein = [] {
  constexpr std::size_t kDegree = 6;
  std::array<Polynomial, 7> choose{};
  for (std::size_t j = 0; j <= kDegree; ++j) {
    choose[j][0] = 1;
    for (std::size_t i = 1; i <= j; ++i) choose[j][i] = choose[j - 1][i - 1] + choose[j - 1][i];
  }
  std::array<Polynomial, 7> weights = choose;
  for (Polynomial& row : weights) {
    for (std::size_t i = 0; i <= kDegree; ++i) row[i] /= choose[kDegree][i];
  }
  return weights;
}();

// True when p > 0 on [0, end].
bool is_positive_up_to(const Polynomial& p, double end) {
  constexpr int kHalvings = 24;
  Polynomial scaled{};
  double power = 1;
  for (std::size_t i = 0; i < p.size(); ++i, power *= end) {
    scaled[i] = p[i] * power;
  }
  Polynomial bernstein{};
  for (std::size_t j = 0; j < p.size(); ++j) {
    for (std::size_t i = 0; i <= j; ++i) bernstein[j] += kBernstein[j][i] * scaled[i];
  }
  return is_positive(bernstein, kHalvings);
}

// True when the curve rises all the way from 0 to q.
bool rises_up_to(const RadialCurve& curve, double q) {
  if (!curve.is_ratio) {
    // Its falling terms alone bound the rise from below; this is sufficient at most places of most
    // lenses.
    double falling = 0;
    for (std::size_t i = curve.numerator.size(); i-- > 1;) {
      falling =
          q * q * (falling + static_cast<double>(2 * i + 1) * std::min(curve.numerator[i], 0.0));
    }
    if (1 + falling > 0) return true;
  }
  if (!is_positive_up_to(rise_of(curve), q * q)) return false;
  if (!curve.is_ratio) return true;
  const auto& d = curve.denominator;
  return is_positive_up_to({d[0], d[1], d[2], d[3]}, q * q);
}

// The largest q up to which distortion is evaluated. Beyond, x/z and y/z lose their meaning.
double widest(LensModel lens) {
  constexpr double kWidest = radians(89.9);
  return lens == LensModel::fisheye ? kWidest : std::tan(kWidest);
}

// How far the curve moves a point of the plane z = 1 out from the axis, as a factor.
double radial_scale(const Camera& camera, const RadialCurve& curve, double r) {
  if (camera.lens == LensModel::perspective) return curve.ratio(r);
  const double q = std::atan(r);
  return curve.ratio(q) * (r > 0 ? q / r : 1);
}

// A point of the plane z = 1 moved by the distortion.
Vector2d distorted_point(const Camera& camera, const RadialCurve& curve, const Vector2d& ideal) {
  const double r2 = ideal.squaredNorm();
  Vector2d point = radial_scale(camera, curve, std::sqrt(r2)) * ideal;
  if (camera.lens == LensModel::fisheye) return point;
  const double p1 = camera.distortion[2];
  const double p2 = camera.distortion[3];
  const double x = ideal.x();
  const double y = ideal.y();
  return point +
         Vector2d(2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y);
}

// The derivative of that.
Matrix2d distortion_derivative(const Camera& camera, const RadialCurve& curve,
                               const Vector2d& ideal) {
  const bool is_fisheye = camera.lens == LensModel::fisheye;
  const std::array<double, 8>& k = camera.distortion;
  const double r2 = ideal.squaredNorm();
  const double r = std::sqrt(r2);
  const double scale = radial_scale(camera, curve, r);
  // Near the axis the quotient below loses its digits; the next terms are of order r^2 smaller.
  constexpr double kNearAxis = 1e-6;
  double bend = is_fisheye ? 2 * (k[0] - 1.0 / 3) : 2 * (k[0] - k[5]);
  if (r2 >= kNearAxis) {
    const double slope = is_fisheye ? curve.slope(std::atan(r)) / (1 + r2) : curve.slope(r);
    bend = (slope - scale) / r2;
  }
  Matrix2d by_ideal = scale * Matrix2d::Identity() + bend * ideal * ideal.transpose();
  if (is_fisheye) return by_ideal;
  const double p1 = k[2];
  const double p2 = k[3];
  const double mixed = 2 * (p1 * ideal.x() + p2 * ideal.y());
  by_ideal(0, 0) += 2 * p1 * ideal.y() + 6 * p2 * ideal.x();
  by_ideal(0, 1) += mixed;
  by_ideal(1, 0) += mixed;
  by_ideal(1, 1) += 6 * p1 * ideal.y() + 2 * p2 * ideal.x();
  return by_ideal;
}

// How far the distortion moves the point a unit of its first coefficient.
Vector2d by_first_coefficient(const Camera& camera, const RadialCurve& curve,
                              const Vector2d& ideal) {
  const double r2 = ideal.squaredNorm();
  if (camera.lens == LensModel::perspective) {
    return (curve.is_ratio ? r2 / value_at(curve.denominator, r2) : r2) * ideal;
  }
  const double r = std::sqrt(r2);
  return r > 0 ? Vector2d(std::pow(std::atan(r), 3) / r * ideal) : Vector2d(0, 0);
}

bool in_reach(const Camera& camera, const RadialCurve& curve, const Vector2d& ideal) {
  const double r = ideal.norm();
  const double q = camera.lens == LensModel::fisheye ? std::atan(r) : r;
  return q <= widest(camera.lens) && rises_up_to(curve, q);
}

constexpr double kConverged = 1e-14;

// The q at which the curve has the value `radius`, by Newton's method where it converges at once.
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
// ones, are corrected by Newton's method from the solution without them.
std::optional<Vector2d> undistort(const Camera& camera, const Vector2d& distorted) {
  const RadialCurve curve = radial_curve(camera);
  const double radius = distorted.norm();
  const std::optional<double> q = invert(curve, radius, widest(camera.lens));
  if (!q) return std::nullopt;
  const double r = camera.lens == LensModel::fisheye ? std::tan(*q) : *q;
  Vector2d point = radius > 0 ? Vector2d(r / radius * distorted) : Vector2d(0, 0);
  if (camera.lens == LensModel::fisheye) return point;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Matrix2d by_point = distortion_derivative(camera, curve, point);
    const Vector2d step = by_point.inverse() * (distorted - distorted_point(camera, curve, point));
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
  const std::optional<Vector2d> pixel = project(camera, point_in_camera);
  if (!pixel) return std::nullopt;
  const double z = point_in_camera.z();
  const Vector2d ideal = point_in_camera.head<2>() / z;
  Matrix2d by_ideal = Vector2d(camera.fx, camera.fy).asDiagonal();
  Projection projection;
  projection.pixel = *pixel;
  projection.by_k1 = ideal.squaredNorm() * (by_ideal * ideal);
  if (!is_rectilinear(camera)) {
    const RadialCurve curve = radial_curve(camera);
    projection.by_k1 = by_ideal * by_first_coefficient(camera, curve, ideal);
    by_ideal = by_ideal * distortion_derivative(camera, curve, ideal);
  }
  projection.by_point.leftCols<2>() = by_ideal / z;
  projection.by_point.col(2) = -(by_ideal * ideal) / z;
  return projection;
}

std::optional<Vector2d> project(const Camera& camera, const Vector3d& point_in_camera) {
  constexpr double kNearest = 1e-3;
  const double z = point_in_camera.z();
  if (!(z >= kNearest)) return std::nullopt;
  Vector2d point = point_in_camera.head<2>() / z;
  if (!is_rectilinear(camera)) {
    const RadialCurve curve = radial_curve(camera);
    if (!in_reach(camera, curve, point)) return std::nullopt;
    point = distorted_point(camera, curve, point);
  }
  return Vector2d(camera.fx * point.x() + camera.cx, camera.fy * point.y() + camera.cy);
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

}  // namespace tagsmith::detail
