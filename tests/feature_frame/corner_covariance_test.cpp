// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/corner_covariance.hpp"

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/side_line.hpp"

using namespace tagsmith::detail;

namespace {

RefinedFrame skew_frame() {
  RefinedFrame frame;
  frame.corners = {{{40, 50}, {300, 20}, {330, 190}, {30, 160}}};
  for (FrameSide& side : frame.sides) {
    side.blur_px = 0.5;
    side.stroke_px = 9;
  }
  return frame;
}

// Where the lines through two pairs of points meet.
PixelPoint crossing(PixelPoint a, PixelPoint b, PixelPoint c, PixelPoint d) {
  const double t = cross(c - a, d - c) / cross(b - a, d - c);
  return a + t * (b - a);
}

// The corners when side `moved` has its begin and its end this far outwards.
Quad corners_when_moved(const Quad& quad, std::size_t moved, double begin, double end) {
  std::array<std::array<PixelPoint, 2>, 4> lines{};
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint along = quad[(i + 1) % 4] - quad[i];
    const PixelPoint outward = 1 / length(along) * PixelPoint{along.y, -along.x};
    lines[i] = {quad[i], quad[(i + 1) % 4]};
    if (i != moved) continue;
    lines[i] = {quad[i] + begin * outward, quad[(i + 1) % 4] + end * outward};
  }
  Quad corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& before = lines[(i + 3) % 4];
    corners[i] = crossing(before[0], before[1], lines[i][0], lines[i][1]);
  }
  return corners;
}

// How the corners move with the begins and ends of the sides, from small moves.
CornerCovariance corners_by_places(const Quad& quad) {
  constexpr double kStep = 1e-5;
  CornerCovariance by_places;
  for (std::size_t place = 0; place < 8; ++place) {
    const double begin = place % 2 == 0 ? kStep : 0, end = kStep - begin;
    const Quad moved = corners_when_moved(quad, place / 2, begin, end);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      const auto column = static_cast<Eigen::Index>(place);
      by_places(row, column) = (moved[i].x - quad[i].x) / kStep;
      by_places(row + 1, column) = (moved[i].y - quad[i].y) / kStep;
    }
  }
  return by_places;
}

}  // namespace

TEST_CASE("corners vary as the crossings of their sides do") {
  const RefinedFrame exact = skew_frame();
  RefinedFrame frame = exact;
  CornerCovariance of_places = CornerCovariance::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const double size = 0.01 * static_cast<double>(i + 1);
    frame.sides[i].covariance << size, 0.3 * size, 0.3 * size, 2 * size;
    const auto at = static_cast<Eigen::Index>(2 * i);
    of_places.block<2, 2>(at, at) = frame.sides[i].covariance;
  }
  const CornerCovariance by_places = corners_by_places(frame.corners);
  const CornerCovariance expected = by_places * of_places * by_places.transpose();
  const CornerCovariance fitted = corner_covariance(frame) - corner_covariance(exact);
  // Compression makes more of the fit's own variance, of all alike.
  const double more = fitted.trace() / expected.trace();
  CHECK(more >= 1);
  CHECK(more < 3);
  CHECK((fitted - more * expected).norm() < 1e-5 * fitted.norm());
}

TEST_CASE("pixel locking moves a side along the pixel grid and turns one that crosses a pixel") {
  // The upper side from (40, 30) to (300, 30 + crossed); of its two ends' places, the variances of
  // their mean and of half their difference that locking adds.
  const auto added = [](double crossed) {
    RefinedFrame frame = skew_frame();
    frame.corners = {{{40, 30}, {300, 30 + crossed}, {330, 190}, {30, 160}}};
    const CornerCovariance without = corner_covariance(frame);
    for (FrameSide& side : frame.sides) side.pixel_locking_px = 0.05;
    const CornerCovariance more = corner_covariance(frame) - without;
    return std::pair((more(1, 1) + more(3, 3) + 2 * more(1, 3)) / 4,
                     (more(1, 1) + more(3, 3) - 2 * more(1, 3)) / 4);
  };
  CHECK(added(0).first > 0.9 * 0.05 * 0.05);
  CHECK(added(0.66).second > 1.6 * 0.05 * 0.05);
  CHECK(added(0.66).second > 3 * added(0).second);
  CHECK(added(20).first < 0.1 * added(0).first);
  CHECK(added(20).second < 0.1 * added(0.66).second);
}

TEST_CASE("corners whose sides were fitted without an error are not exact") {
  const auto least_variance = [](const RefinedFrame& frame) {
    const Eigen::SelfAdjointEigenSolver<CornerCovariance> solver(corner_covariance(frame));
    return solver.eigenvalues().minCoeff();
  };
  CHECK(least_variance(skew_frame()) > 1e-6);
  CHECK(corner_covariance(skew_frame()).trace() < 8 * 0.02 * 0.02);
  // A side whose stroke is as thin as the blur tells less.
  const CornerCovariance skew = corner_covariance(skew_frame());
  RefinedFrame thin = skew_frame();
  thin.sides[2].stroke_px = 1;
  const CornerCovariance doubtful = corner_covariance(thin);
  CHECK(doubtful(5, 5) > 20 * skew(5, 5));
  CHECK(doubtful(7, 7) > 20 * skew(7, 7));
  CHECK(doubtful(1, 1) == doctest::Approx(skew(1, 1)));
}

TEST_CASE("a frame that is turned begins with another corner, and so does its covariance") {
  RefinedFrame frame = skew_frame();
  for (std::size_t i = 0; i < 4; ++i) {
    frame.sides[i].covariance = Eigen::Matrix2d::Identity() * 0.01 * static_cast<double>(i + 1);
  }
  const CornerCovariance covariance = corner_covariance(frame);
  CHECK(corner_covariance(turned_to(frame, 0)) == covariance);
  for (std::size_t first = 1; first < 4; ++first) {
    CAPTURE(first);
    const CornerCovariance turned = corner_covariance(turned_to(frame, first));
    CHECK((covariance - turned).norm() > 1e-3);
    for (Eigen::Index row = 0; row < 8; ++row) {
      for (Eigen::Index column = 0; column < 8; ++column) {
        const auto shift = static_cast<Eigen::Index>(2 * first);
        CHECK(turned(row, column) ==
              doctest::Approx(covariance((row + shift) % 8, (column + shift) % 8)));
      }
    }
  }
}

TEST_CASE("Edges that growth displaces otherwise move a frame's corners together") {
  constexpr double kDisplaced = 0.1;
  const RefinedFrame frame = skew_frame();
  const CornerCovariance added = corner_covariance(frame, kDisplaced) - corner_covariance(frame);
  const Eigen::SelfAdjointEigenSolver<CornerCovariance> solver(added);
  // Outwards, and by more or less along and across the frame.
  for (Eigen::Index i = 0; i < 8; ++i) {
    CAPTURE(i);
    if (i < 5) CHECK(solver.eigenvalues()[i] == doctest::Approx(0).epsilon(1e-9));
    if (i >= 5) CHECK(solver.eigenvalues()[i] > kDisplaced * kDisplaced);
  }
}

TEST_CASE(
    "Edges that all lie outwards alike move a frame's corners in one way, and no hidden side") {
  constexpr double kAlike = 0.1;
  RefinedFrame frame = skew_frame();
  for (const bool is_hidden : {false, true}) {
    CAPTURE(is_hidden);
    frame.shown[1] = !is_hidden;
    const CornerCovariance added = corner_covariance(frame, 0, kAlike) - corner_covariance(frame);
    const Eigen::SelfAdjointEigenSolver<CornerCovariance> solver(added);
    for (Eigen::Index i = 0; i < 7; ++i) {
      CHECK(solver.eigenvalues()[i] == doctest::Approx(0).epsilon(1e-9));
    }
    CHECK(solver.eigenvalues()[7] > kAlike * kAlike);
    const PixelPoint outward = side_of(frame.corners, 1).outward;
    const double across = Eigen::Vector2d(outward.x, outward.y).transpose() *
                          added.block<2, 2>(2, 2) * Eigen::Vector2d(outward.x, outward.y);
    CHECK(across == doctest::Approx(is_hidden ? 0 : kAlike * kAlike).epsilon(1e-9));
  }
}
