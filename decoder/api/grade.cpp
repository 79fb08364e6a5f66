// SPDX-License-Identifier: Apache-2.0
#include <tagsmith/grade.hpp>

#include "decoder/api/data.hpp"
#include "decoder/grade/symbol_grade.hpp"

namespace tagsmith {
namespace {

std::optional<detail::ReflectanceReferences> references_from(
    const std::optional<ReflectanceReferences>& references) {
  if (!references) return std::nullopt;
  return detail::ReflectanceReferences{references->white_light, references->white_reflectance,
                                       references->black_light, references->black_reflectance};
}

void check_corners(const Corners& corners) {
  constexpr double kFarthest = 1e9;
  for (const Point& corner : corners) {
    detail::check_number("a corner's x", corner.x, -kFarthest, kFarthest);
    detail::check_number("a corner's y", corner.y, -kFarthest, kFarthest);
  }
}

}  // namespace

Grade grade(const ImageView& image, const Corners& corners, const PlateTemplate& plate,
            const std::optional<ReflectanceReferences>& references) {
  check_corners(corners);
  const auto graded = detail::grade_symbol(
      detail::checked(image), detail::frame_corners_from(corners),
      detail::layout_of(detail::template_from(plate)), references_from(references));
  if (!graded) throw Error(ErrorCode::failed, graded.error().message);
  Grade result;
  result.grade = graded->grade;
  result.worst = to_string(graded->worst);
  result.absolute = graded->absolute;
  for (std::size_t i = 0; i < detail::kGradeParameters; ++i) {
    const auto& mean = graded->means[i];
    if (!mean) continue;
    result.parameters.push_back(
        {to_string(static_cast<detail::GradeParameter>(i)), mean->grade, mean->value});
  }
  return result;
}

}  // namespace tagsmith
