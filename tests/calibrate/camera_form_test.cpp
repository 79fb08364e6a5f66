// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/camera_form.hpp"

#include <cmath>
#include <vector>

#include <doctest/doctest.h>

using namespace tagsmith::detail;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

std::vector<Camera> lenses() {
  return {{1280, 960, 900, 905, 641, 470},
          {1280, 960, 900, 905, 641, 470, {-0.35, 0.12, 0.001, -0.002, -0.01}},
          {1280, 960, 900, 905, 641, 470, {0.3, -0.1, 0.001, -0.002, 0.02, 0.5, -0.05, 0.01}},
          {1280, 960, 400, 401, 641, 470, {-0.03, 0.01, -0.004, 0.0007}, LensModel::fisheye}};
}

}  // namespace

TEST_CASE("derivatives by a camera's parameters are those of its projection") {
  for (const Camera& camera : lenses()) {
    for (const Vector3d& point : {Vector3d(0.02, -0.01, 0.5), Vector3d(0.3, 0.2, 0.7),
                                  Vector3d(-0.4, 0.1, 1.1), Vector3d(0, 0, 1)}) {
      const auto by = by_parameters(camera, point);
      const CameraVector parameters = parameters_of(camera);
      for (Eigen::Index i = 0; i < kCameraParameters; ++i) {
        if (camera.lens == LensModel::fisheye && i >= 8) continue;
        CAPTURE(i);
        CameraVector more = parameters, less = parameters;
        const double step = i < 4 ? 1e-3 : 1e-6;
        more[i] += step;
        less[i] -= step;
        const Vector2d numeric = (*project(with_parameters(camera, more), point) -
                                  *project(with_parameters(camera, less), point)) /
                                 (2 * step);
        CHECK((by.col(i) - numeric).norm() < 1e-5 * (1 + numeric.norm()));
      }
    }
  }
}

TEST_CASE("the coefficients that a form frees are those that it names") {
  for (const LensModel lens : {LensModel::perspective, LensModel::fisheye}) {
    unsigned before = 0;
    for (const LensForm& form : lens_forms(lens)) {
      CAPTURE(form.name);
      CHECK(form.lens == lens);
      CHECK((form.free & before) == before);  // the one before is a special case
      before = form.free;
      for (const bool square : {true, false}) {
        const CameraForm camera{form, square};
        const auto columns = free_parameters(camera);
        CHECK(columns.cols() == camera.parameters());
        for (Eigen::Index i = 0; i < 8; ++i) {
          CHECK(columns.row(4 + i).sum() == ((form.free >> i & 1U) != 0 ? 1 : 0));
        }
        CHECK((columns.col(0).head<2>().sum() == 2) == square);
      }
    }
  }
}
