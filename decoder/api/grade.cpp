// SPDX-License-Identifier: Apache-2.0
#include "decoder/grade/grade.hpp"

#include <tagsmith/grade.hpp>

#include "decoder/api/data.hpp"
#include "decoder/image/transform.hpp"

namespace tagsmith {
namespace {

// In a negative, white is black, and light and reflectance are what is missing of them.
std::optional<detail::ReflectanceReferences> references_from(
    const std::optional<ReflectanceReferences>& references, bool of_negative) {
  if (!references) return std::nullopt;
  if (of_negative) {
    return detail::ReflectanceReferences{
        1 - references->black_light, 1 - references->black_reflectance, 1 - references->white_light,
        1 - references->white_reflectance};
  }
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
  const detail::GrayView view = detail::checked(image);
  std::optional<detail::GrayImage> negative;
  if (plate.white_on_black) negative = detail::exchange_black_and_white(view);
  const auto graded =
      detail::grade_symbol(negative ? negative->view() : view, detail::frame_corners_from(corners),
                           detail::layout_of(detail::template_from(plate)),
                           references_from(references, plate.white_on_black));
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
