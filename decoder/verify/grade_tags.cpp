// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/grade_tags.hpp"

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {
namespace {

// Mean light of the rectangle's inner half; nothing when a part of it is outside the picture.
std::optional<double> mean_light(const GrayView& image, const Homography& image_from_frame,
                                 const TagTemplate& tag, const Rectangle& area) {
  constexpr int kSteps = 8;
  const ToneCurve& tone = ToneCurve::of(image);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double x = area.x + area.width * (0.25 + 0.5 * (i + 0.5) / kSteps);
      const double y = area.y + area.height * (0.25 + 0.5 * (j + 0.5) / kSteps);
      const auto level = sample_nearest(
          image, image_from_frame(x / tag.frame_inner_length, y / tag.frame_inner_height));
      if (!level) return std::nullopt;
      sum += tone.light_of(*level);
    }
  }
  return sum / (kSteps * kSteps);
}

}  // namespace

std::optional<ReflectanceReferences> find_references(const GrayView& image, const TagTemplate& tag,
                                                     const FrameCorners& corners) {
  if (tag.patch_size <= 0) return std::nullopt;
  const std::optional<ReferencePatches> patches = draw_tag(tag, Digits{}).patches;
  if (!patches) return std::nullopt;
  const Homography image_from_frame = homography_to(corners);
  const std::optional<double> white = mean_light(image, image_from_frame, tag, patches->white);
  const std::optional<double> black = mean_light(image, image_from_frame, tag, patches->black);
  constexpr double kOverexposed = 0.98;
  constexpr double kLeastDifference = 0.1;
  const double brightest = image.is_negative ? 1 - black.value_or(0) : white.value_or(1);
  if (!white || !black || brightest > kOverexposed || *white - *black < kLeastDifference) {
    return std::nullopt;
  }
  if (image.is_negative) {
    return ReflectanceReferences{*white, 1 - kBlackPatchReflectance, *black,
                                 1 - kWhitePatchReflectance};
  }
  return ReflectanceReferences{*white, kWhitePatchReflectance, *black, kBlackPatchReflectance};
}

void grade_tag(const GrayView& image, const TagTemplate& tag, VerifiedTag& verified) {
  Result<SymbolGrade> grade = grade_symbol(image, verified.corners, layout_of(tag),
                                           find_references(image, tag, verified.corners));
  if (grade) {
    verified.grade = *grade;
  } else {
    verified.grade_reason = grade.error().message;
  }
}

}  // namespace tagsmith::detail
