// SPDX-License-Identifier: Apache-2.0
// What surveys and rigs do not state of their uncertainty, and what is assumed instead. The source
// of the numbers: docs/decisions/0013-unstated-is-not-exact.md.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

inline constexpr double kUsualSigma = 0.003;  // of a surveyed coordinate, metres
// A plate's attitude about each axis: hung by eye and spirit level.
inline constexpr double kUsualAngleSigma = radians(0.3);

// The same of plates on walls that are listed, where those are rough: a plate is placed along its
// wall over its own length, and hangs by what the rock is like there. In tenths of degrees.
double usual_angle_sigma(const Tunnel& tunnel, const TagTemplate& tag);

// Of the survey's plates: only those without `facing` follow their wall.
double usual_angle_sigma(const Survey& survey);

// The source of a camera's focal length and principal point in a rig.
enum class IntrinsicsSource { data_sheet, numbers, calibration_file };

// Pixels whose sides differ by at most this share are square: data sheets round the sensor's sizes,
// or state those of its type (6.17 x 4.55 mm for pictures of 4:3).
inline constexpr double kSquarePixels = 0.02;

// How far a lens of a data sheet, which states no distortion, moves the image's corners, relative
// to their distance from its centre: a standard deviation.
inline constexpr double kUsualDistortion = 0.02;

// CalibrationSigma::radial by how far the image's corners move, relative.
double radial_by_corners(double distortion, const Camera& camera);

// A camera that is mounted by hand and measured with a tape.
CalibrationSigma usual_calibration(IntrinsicsSource source, const Camera& camera);

// Whether the survey's file states how well the tag is surveyed, and whether it does for every tag.
bool states_sigma_of(const Survey& survey, const PlacedTag& tag);
bool states_every_sigma(const Survey& survey);

// What was assumed, in words ("survey corridor states no sigma: 3 mm assumed"); nothing where the
// file states it.
std::optional<std::string> assumed_sigma(const Survey& survey);
std::vector<std::string> assumed_calibration(const Rig& rig, std::optional<double> speed = {});

// All assumptions, those on plates' attitudes included. `speed` is the vehicle's where it is stated
// elsewhere than in the rig, metres a second.
std::vector<std::string> assumptions(std::span<const Survey> surveys, const Rig& rig,
                                     std::optional<double> speed = {});

}  // namespace tagsmith::detail
