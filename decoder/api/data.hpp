// SPDX-License-Identifier: Apache-2.0
// The content of public values, and their conversion to the modules' own. Internal to decoder/api.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <tagsmith/error.hpp>
#include <tagsmith/geometry.hpp>
#include <tagsmith/image.hpp>
#include <tagsmith/localize.hpp>
#include <tagsmith/rig.hpp>
#include <tagsmith/survey.hpp>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith {

// Each of the two libraries has its own copy of the code that makes these; none of it is exported.
#define TAGSMITH_HIDDEN __attribute__((visibility("hidden")))

// The survey as the modules have it, and the part of it that callers see.
struct TAGSMITH_HIDDEN Survey::Data {
  explicit Data(detail::Survey survey);

  detail::Survey survey;
  PlateTemplate plate;
  std::vector<SurveyTag> tags;
};

struct TAGSMITH_HIDDEN Rig::Data {
  explicit Data(detail::Rig rig);

  detail::Rig rig;
  RigDescription description;
};

}  // namespace tagsmith

namespace tagsmith::detail {

[[noreturn]] void throw_invalid(const std::string& message);

// The view with its stride filled in. Throws on views of nothing, or of more than 200 million
// pixels.
GrayView checked(const ImageView& image);

// Throws on text other than twelve digits; `what` begins the message.
Digits checked_digits(std::string_view digits, const std::string& what);

// Throws when a number is not finite or not within the limits.
void check_number(const std::string& name, double value, double least, double greatest);

TagTemplate template_from(const PlateTemplate& plate);
Camera camera_from(const CameraModel& model);

// Throws where they cannot be combined: one name or one code twice, plates of two colours.
std::vector<Survey> surveys_from(const std::vector<tagsmith::Survey>& surveys);

Corners corners_from(const FrameCorners& corners);
FrameCorners frame_corners_from(const Corners& corners);

Vector3 vector_from(const Eigen::Vector3d& vector);
Eigen::Vector3d eigen_from(const Vector3& vector);

template <std::size_t N, Eigen::StorageOptions Order = Eigen::ColMajor>
using SquareMatrix = Eigen::Matrix<double, static_cast<int>(N), static_cast<int>(N), Order>;

template <std::size_t N>
tagsmith::Matrix<N> matrix_from(const SquareMatrix<N>& matrix) {
  tagsmith::Matrix<N> rows{};
  Eigen::Map<SquareMatrix<N, Eigen::RowMajor>>(rows.front().data()) = matrix;
  return rows;
}

template <std::size_t N>
SquareMatrix<N> eigen_from(const tagsmith::Matrix<N>& rows) {
  return Eigen::Map<const SquareMatrix<N, Eigen::RowMajor>>(rows.front().data());
}

}  // namespace tagsmith::detail
