// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/observation.hpp"

#include <utility>
#include <vector>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

TEST_CASE("what a lens is warped by falls with the third power of the distance from the centre") {
  Rig rig;
  rig.cameras.resize(1);
  rig.cameras[0].camera = {1280, 960, 1000, 1000, 640, 480};
  rig.cameras[0].calibration_sigma.warp = 0.4;
  SeenCorners seen;
  seen.covariance.setZero();
  // A corner of the image, half way there, the centre, and the corner across.
  seen.corners = {{{0, 0}, {320, 240}, {640, 480}, {1280, 960}}};
  const CornerCovariance covariance = sighting_of(seen, rig, 0, 0).covariance;
  for (const int axis : {0, 1}) {
    CHECK(covariance(axis, axis) == doctest::Approx(0.4 * 0.4));
    CHECK(covariance(2 + axis, 2 + axis) == doctest::Approx(0.05 * 0.05));
    CHECK(covariance(4 + axis, 4 + axis) == 0);
    CHECK(covariance(6 + axis, 6 + axis) == doctest::Approx(0.4 * 0.4));
  }
  CHECK(covariance(0, 1) == 0);
  // Points are moved alike as far as they are near each other.
  CHECK(covariance(0, 2) > 0);
  CHECK(covariance(0, 2) < 0.4 * 0.05);
  CHECK(covariance(0, 6) < 1e-6);
}

TEST_CASE("measurements are of one place where their tags lie as they lay") {
  const auto seen_at = [](const char* camera, const char* name, double x) {
    SeenTag seen;
    seen.camera = camera;
    seen.tag.name = name;
    seen.seen_corners = SeenCorners{{{{x, 100}, {x + 120, 100}, {x + 120, 160}, {x, 160}}}, 0.1};
    return seen;
  };
  Observation first;
  first.tags = {seen_at("left", "000L", 100), seen_at("left", "001L", 300)};
  const auto is_same = [&](std::vector<SeenTag> tags) {
    Observation second;
    second.tags = std::move(tags);
    return are_of_one_place(first, second);
  };
  CHECK(is_same(first.tags));
  CHECK(is_same({seen_at("left", "000L", 120)}));
  CHECK_FALSE(is_same({seen_at("left", "000L", 135)}));
  CHECK_FALSE(is_same({seen_at("left", "000L", 100), seen_at("left", "001L", 340)}));
  CHECK_FALSE(is_same({seen_at("right", "000L", 100)}));
  CHECK_FALSE(is_same({seen_at("left", "002L", 100)}));
  CHECK_FALSE(is_same({}));
}
