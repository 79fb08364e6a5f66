// SPDX-License-Identifier: Apache-2.0
// A tag with a random code before a camera at a wanted resolution, and how well its corners are
// read.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "decoder/reader/reading.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/corner_fit.hpp"
#include "tests/support/turned_plate.hpp"

namespace tagsmith::detail::bench {

// Any code with the check digit of GS1.
inline Digits random_code(std::mt19937_64& random) {
  std::uniform_int_distribution<int> digit(0, 9);
  Digits digits{};
  for (auto& value : digits) value = static_cast<std::uint8_t>(digit(random));
  digits.back() = check_digit(CheckDigit::gs1, std::span(digits).first<11>());
  return digits;
}

// A code book of `size` codes, `code` among them.
inline std::vector<Digits> book_with(const Digits& code, std::size_t size,
                                     std::mt19937_64& random) {
  std::vector<Digits> book{code};
  while (book.size() < size) book.push_back(random_code(random));
  return book;
}

// How a plate stands before the camera: `pixel` shows its middle; turned by `tilt` about its
// vertical axis, by `lean` about its horizontal axis and by `roll` in its plane, radians;
// `module_px` pixels to a module.
struct Stance {
  Eigen::Vector2d pixel;
  double module_px = 2;
  double tilt = 0;
  double roll = 0;
  double lean = 0;
};

// The plate at the distance where its modules, foreshortened, are as wide as the stance says.
inline ScenePlate plate_at(const Camera& camera, TagDrawing drawing, const Stance& stance) {
  ScenePlate plate;
  plate.drawing = std::move(drawing);
  double distance = camera.fx * plate.drawing.module / stance.module_px * std::cos(stance.tilt);
  for (int i = 0; i < 6; ++i) {
    plate.camera_from_plate = camera_from_turned_plate(
        camera, plate.drawing, stance.pixel, distance, stance.tilt, stance.lean, stance.roll);
    const auto truth = plate_truths(camera, std::span(&plate, 1));
    if (truth.front().module_px <= 0) break;
    distance *= truth.front().module_px / stance.module_px;
  }
  return plate;
}

// Those of a plate that is before the camera.
inline FrameCorners corners_of(const PlateTruth& truth) {
  FrameCorners corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d corner = truth.corners[i].value_or(Eigen::Vector2d::Zero());
    corners[i] = {corner.x(), corner.y()};
  }
  return corners;
}

// Errors of the corners' coordinates without their sign, pixels.
inline std::array<double, 8> corner_errors(const Reading& reading, const PlateTruth& truth) {
  std::array<double, 8> errors{};
  Eigen::Matrix<double, 8, 1>::Map(errors.data()) =
      corner_fit(reading, corners_of(truth)).error.cwiseAbs();
  return errors;
}

// Chi-square of the corners' errors by their covariance, per degree of freedom.
inline double corner_chi_square(const Reading& reading, const PlateTruth& truth) {
  return corner_fit(reading, corners_of(truth)).chi_square;
}

}  // namespace tagsmith::detail::bench
