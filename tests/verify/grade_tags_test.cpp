// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/image/tone_curve.hpp"
#include "decoder/verify/verify_file.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/verify/survey_of_four.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kPixelsPerMetre = 2000;
constexpr double kWhite = 0.6;  // light of white and black in the picture
constexpr double kBlack = 0.05;
const Digits kDigits = *parse_digits("019000000404");

TagTemplate with_patches() {
  TagTemplate tag;
  tag.plate_length = 0.4;
  tag.plate_height = 0.3;
  tag.frame_inner_length = 0.339;
  tag.frame_inner_height = 0.168;
  tag.frame_stroke = 0.01;
  tag.frame_offset_up = 0.03;
  tag.patch_size = 0.02;
  return tag;
}

struct PlatePicture {
  GrayImage image;
  FrameCorners corners{};
};

void fill(GrayImage& image, const Rectangle& area, double light) {
  const auto pixel = [](double metres) {
    return static_cast<int>(std::lround((metres + 0.1) * kPixelsPerMetre));
  };
  const auto sample = static_cast<std::uint8_t>(std::lround(ToneCurve::srgb().sample_of(light)));
  for (int y = pixel(area.y); y < pixel(area.y + area.height); ++y) {
    for (int x = pixel(area.x); x < pixel(area.x + area.width); ++x) {
      image.samples[static_cast<std::size_t>(y * image.width + x)] = sample;
    }
  }
}

// The tag upright, P at 0.1 m from both edges of a dark picture.
PlatePicture draw(const TagTemplate& tag, double white) {
  constexpr int kWidth = 1200;
  constexpr int kHeight = 800;
  PlatePicture picture{
      {kWidth, kHeight, std::vector<std::uint8_t>(std::size_t{kWidth} * kHeight, 20)}};
  const TagDrawing drawing = draw_tag(tag, kDigits);
  fill(picture.image, drawing.plate, white);
  fill(picture.image, drawing.frame_outer, kBlack);
  fill(picture.image, drawing.frame_inner, white);
  for (const Rectangle& bar : drawing.bars) fill(picture.image, bar, kBlack);
  if (drawing.patches) fill(picture.image, drawing.patches->black, kBlack);
  const double left = 0.1 * kPixelsPerMetre - 0.5;
  const double right = left + tag.frame_inner_length * kPixelsPerMetre;
  const double bottom = left + tag.frame_inner_height * kPixelsPerMetre;
  picture.corners = {{{left, left}, {right, left}, {right, bottom}, {left, bottom}}};
  return picture;
}

VerifiedTag graded(const TagTemplate& tag, const PlatePicture& picture) {
  VerifiedTag verified;
  verified.corners = picture.corners;
  grade_tag(picture.image.view(), tag, verified);
  return verified;
}

}  // namespace

TEST_CASE("reference patches make a grade absolute") {
  const TagTemplate tag = with_patches();
  const PlatePicture picture = draw(tag, kWhite);
  const auto references = find_references(picture.image.view(), tag, picture.corners);
  REQUIRE(references.has_value());
  CHECK(references->white_light == doctest::Approx(kWhite).epsilon(0.01));
  CHECK(references->black_light == doctest::Approx(kBlack).epsilon(0.05));
  const VerifiedTag finding = graded(tag, picture);
  REQUIRE(finding.grade.has_value());
  CHECK(finding.grade->absolute);
  const double contrast = *finding.grade->means[1]->value;
  CHECK(contrast == doctest::Approx(kWhitePatchReflectance - kBlackPatchReflectance).epsilon(0.02));
}

TEST_CASE("what lies along the edges of reference patches, as dirt does, leaves a grade as it is") {
  const TagTemplate tag = with_patches();
  PlatePicture picture = draw(tag, kWhite);
  const auto clean = find_references(picture.image.view(), tag, picture.corners);
  const ReferencePatches patches = *draw_tag(tag, kDigits).patches;
  for (const auto& [patch, light] : {std::pair(patches.white, kWhite), {patches.black, kBlack}}) {
    constexpr double kEdge = 0.2;  // of the patch
    fill(picture.image, patch, 0.3);
    fill(picture.image,
         {patch.x + kEdge * patch.width, patch.y + kEdge * patch.height,
          (1 - 2 * kEdge) * patch.width, (1 - 2 * kEdge) * patch.height},
         light);
  }
  const auto dirty = find_references(picture.image.view(), tag, picture.corners);
  REQUIRE(clean);
  REQUIRE(dirty);
  CHECK(dirty->white_light == doctest::Approx(clean->white_light));
  CHECK(dirty->black_light == doctest::Approx(clean->black_light));
}

TEST_CASE("without patches, or with overexposed ones, a grade is relative") {
  TagTemplate plain = with_patches();
  plain.patch_size = 0;
  const VerifiedTag finding = graded(plain, draw(plain, kWhite));
  REQUIRE(finding.grade.has_value());
  CHECK(!finding.grade->absolute);
  const PlatePicture glare = draw(with_patches(), 1.0);
  CHECK(!find_references(glare.image.view(), with_patches(), glare.corners));
}

TEST_CASE("a far tag has a reason instead of a grade") {
  const TagTemplate tag = with_patches();
  PlatePicture picture = draw(tag, kWhite);
  for (PixelPoint& corner : picture.corners) corner = 0.5 * corner;
  const VerifiedTag finding = graded(tag, picture);
  CHECK(!finding.grade);
  CHECK(finding.grade_reason.find("pixels a module") != std::string::npos);
}

}  // namespace tagsmith::detail
