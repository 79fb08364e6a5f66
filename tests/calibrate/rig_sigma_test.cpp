// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/calibrate/distortion_curve.hpp"
#include "decoder/calibrate/ray_sigma.hpp"
#include "tests/support/board_photos.hpp"

using namespace tagsmith::detail;
using Eigen::Vector2d;

namespace {

// A camera of one form whose covariance is known.
CameraCalibration known(const Camera& camera, std::size_t form, const CameraVector& sigmas) {
  CameraCalibration calibration;
  calibration.camera = camera;
  calibration.form = {lens_forms(camera.lens)[form], true};
  calibration.covariance = sigmas.cwiseAbs2().asDiagonal();
  calibration.tried = {{calibration.form, camera, calibration.covariance, 10, 20, 1}};
  return calibration;
}

CameraVector sigmas_of(double focal, double centre, double k1) {
  CameraVector sigmas = CameraVector::Zero();
  sigmas.head<5>() << focal, focal, centre, centre, k1;
  return sigmas;
}

const Camera kPlain{1280, 960, 1000, 1000, 640, 480};

}  // namespace

TEST_CASE("a rig states focal length and centre as they are where nothing else is uncertain") {
  CameraCalibration calibration = known(kPlain, 0, CameraVector::Zero());
  // One focal length: fx and fy move together.
  calibration.covariance.topLeftCorner<2, 2>().setConstant(0.25);
  calibration.covariance(2, 2) = calibration.covariance(3, 3) = 0.09;
  calibration.tried[0].covariance = calibration.covariance;
  const IntrinsicsSigma sigma = rig_sigma(calibration);
  CHECK(sigma.focal == doctest::Approx(0.0005));
  CHECK(sigma.center == doctest::Approx(0.3));
}

TEST_CASE("a distortion that is not known widens the focal length that a rig states") {
  const CameraCalibration calibration = known(kPlain, 1, sigmas_of(0, 0.1, 0.01));
  const IntrinsicsSigma sigma = rig_sigma(calibration);
  CHECK(sigma.center == doctest::Approx(0.1));
  // By both, the mean square over the picture is that of the rays.
  double stated = 0, rays = 0;
  for (int x = 0; x < 12; ++x) {
    for (int y = 0; y < 12; ++y) {
      const Vector2d pixel(x * 1279.0 / 11, y * 959.0 / 11);
      const double ray = ray_sigma_px(calibration, pixel).value();
      rays += ray * ray;
      stated += 0.01 + sigma.focal * sigma.focal * (pixel - Vector2d(640, 480)).squaredNorm();
    }
  }
  CHECK(stated == doctest::Approx(rays));
  CHECK(sigma.focal > 1e-3);
}

TEST_CASE("the curve of a lens is its distortion, with its band and the runner-up") {
  Camera camera = kPlain;
  camera.distortion[0] = -0.1;
  CameraCalibration calibration = known(camera, 1, sigmas_of(0, 5, 0.01));
  Camera other = camera;
  other.distortion[1] = 0.02;
  calibration.tried.push_back(
      {{lens_forms(camera.lens)[2], true}, other, CameraCovariance::Zero(), 9, 25, 0});
  calibration.tried.push_back(
      {{lens_forms(camera.lens)[3], true}, camera, CameraCovariance::Zero(), 9, 30, 0});
  TagResidual tag;
  tag.seen << 640, 480, 740, 480, 940, 880, 640, 880;
  tag.used = true;
  calibration.residuals = {tag};

  const DistortionCurve curve = distortion_curve(calibration);
  CHECK(curve.seen_radius == doctest::Approx(500));
  REQUIRE(curve.other.has_value());
  CHECK(*curve.other == 1);
  REQUIRE(curve.points.size() > 50);
  CHECK(curve.points.front().radius == doctest::Approx(0).epsilon(1e-9));
  CHECK(curve.points.back().radius == doctest::Approx(800));
  for (const DistortionPoint& point : curve.points) {
    const double ideal = (point.radius - point.displacement) / 1000;
    CHECK(point.displacement == doctest::Approx(1000 * -0.1 * std::pow(ideal, 3)));
    // A shift of the centre moves no mean radius.
    CHECK(point.sigma == doctest::Approx(1000 * 0.01 * std::pow(ideal, 3)));
    CHECK(point.other.value() == doctest::Approx(1000 * 0.02 * std::pow(ideal, 5)));
  }
}

TEST_CASE("a fisheye's curve is told from the equidistant one") {
  const Camera camera{1280, 960, 400, 400, 640, 480, {-0.02}, LensModel::fisheye};
  const DistortionCurve curve = distortion_curve(known(camera, 0, CameraVector::Zero()));
  CHECK_FALSE(curve.other.has_value());
  for (const DistortionPoint& point : curve.points) {
    const double angle = (point.radius - point.displacement) / 400;
    CHECK(point.displacement == doctest::Approx(400 * -0.02 * std::pow(angle, 3)));
  }
}
