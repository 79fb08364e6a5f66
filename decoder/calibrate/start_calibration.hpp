// SPDX-License-Identifier: Apache-2.0
// A first camera and first poses, without any initial guess.
#pragma once

#include "decoder/calibrate/board_adjustment.hpp"

namespace tagsmith::detail {

// A camera of this lens model with square pixels whose focal length and bend, of a grid of both,
// explain the sightings best, each sighting's pose fitted separately. All sightings of the problem
// get a pose; one that the camera cannot have made is put at the camera's centre, where nothing of
// it is visible.
//
// Trying focal lengths needs no photo to be free of distortion, as the closed form of Zhang (2000,
// "A flexible new technique for camera calibration") does, and holds for fisheyes alike.
CalibrationState start_calibration(const CalibrationProblem& problem, LensModel lens);

}  // namespace tagsmith::detail
