// SPDX-License-Identifier: Apache-2.0
// What surveys and rigs leave unsaid of their uncertainty, and what is taken instead. Where the
// numbers come from: docs/decisions/0020-unstated-is-not-exact.md.
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
// Of a plate's attitude about each axis: hung by eye and spirit level.
inline constexpr double kUsualAngleSigma = radians(0.3);

// Where a rig has a camera's focal length and principal point from.
enum class IntrinsicsSource { data_sheet, numbers, calibration_file };

// Of a camera that is mounted by hand and measured with a tape.
CalibrationSigma usual_calibration(IntrinsicsSource source, int image_width);

// Whether the survey's file says how well the tag is surveyed, and whether it does of every tag.
bool states_sigma_of(const Survey& survey, const PlacedTag& tag);
bool states_every_sigma(const Survey& survey);

// What was assumed, in words ("survey corridor states no sigma: 3 mm assumed"); nothing where the
// file states it.
std::optional<std::string> assumed_sigma(const Survey& survey);
std::vector<std::string> assumed_calibration(const Rig& rig);

// All of it, plates' attitudes included.
std::vector<std::string> assumptions(std::span<const Survey> surveys, const Rig& rig);

}  // namespace tagsmith::detail
