// SPDX-License-Identifier: Apache-2.0
// Random disturbances of rigs and plates, repeatable by their seed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

#include <Eigen/Geometry>

#include "tagsmith/survey/rig.hpp"

namespace tagsmith::detail::test {

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed) {}
  double normal(double sigma) { return sigma * normal_(random_); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  Eigen::Vector3d normals(double sigma) { return {normal(sigma), normal(sigma), normal(sigma)}; }
  std::size_t index(std::size_t size) {
    return std::uniform_int_distribution<std::size_t>(0, size - 1)(random_);
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

// A turn about each axis with this standard deviation.
inline Eigen::Matrix3d small_turn(Draws& draws, double sigma) {
  const Eigen::Vector3d turn = draws.normals(sigma);
  return Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()).toRotationMatrix();
}

// The rig as it may really be, by its cameras' calibration sigmas.
inline Rig disturbed(Rig rig, Draws& draws) {
  for (RigCamera& camera : rig.cameras) {
    const CalibrationSigma& sigma = camera.calibration_sigma;
    const double focal = 1 + draws.normal(sigma.focal);
    camera.camera.fx *= focal;
    camera.camera.fy *= focal;
    camera.camera.cx += draws.normal(sigma.center);
    camera.camera.cy += draws.normal(sigma.center);
    camera.vehicle_from_camera.translation += draws.normals(sigma.position);
    camera.vehicle_from_camera.rotation *= small_turn(draws, sigma.angle);
  }
  return rig;
}

}  // namespace tagsmith::detail::test
