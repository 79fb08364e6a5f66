// SPDX-License-Identifier: Apache-2.0
// Whole symbols in pictures.
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/grade/grade.hpp"
#include "decoder/image/tone_curve.hpp"
#include "tests/grade/synthetic_symbol.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

struct Picture {
  GrayImage image;
  Quad corners;
};

std::uint8_t sample(double reflectance) {
  return static_cast<std::uint8_t>(std::lround(ToneCurve::srgb().sample_of(reflectance)));
}

// A frame of 113 x 60 modules whose symbol has this profile, upright, with `scale` pixels a module
// and 10 pixels around. Light is half of the reflectance.
Picture picture_of(const std::vector<double>& profile, int scale) {
  constexpr int kAround = 10;
  constexpr int kHigh = 60;
  const int width = 113 * scale + 2 * kAround;
  const int height = kHigh * scale + 2 * kAround;
  Picture picture{{width, height,
                   std::vector<std::uint8_t>(
                       static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 20)},
                  {}};
  for (int y = kAround; y < height - kAround; ++y) {
    const double v = (y + 0.5 - kAround) / (kHigh * scale);
    for (int x = kAround; x < width - kAround; ++x) {
      const double place = (x + 0.5 - kAround) / scale;
      const bool bars = v > 0.163 && v < 0.837;
      const double reflectance =
          bars ? profile[static_cast<std::size_t>(place * kPerModule)] : kWhite;
      picture.image.samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(x)] = sample(0.5 * reflectance);
    }
  }
  const double left = kAround - 0.5, top = kAround - 0.5;
  const double right = width - kAround - 0.5, bottom = height - kAround - 0.5;
  picture.corners = {{{left, top}, {right, top}, {right, bottom}, {left, bottom}}};
  return picture;
}

}  // namespace

TEST_CASE("a sharp print is graded 4 from ten scans that agree") {
  const Picture picture = picture_of(profile_of(edges_of(kDigits)), 10);
  const auto grade = grade_symbol(picture.image.view(), picture.corners, {});
  REQUIRE(grade);
  CHECK(grade->grade == Approx(4));
  CHECK(to_string(*grade) == "4.0");
  CHECK(grade->means[0]->grade == Approx(4));  // decode
}

TEST_CASE("references in the picture make reflectances true") {
  const Picture picture = picture_of(profile_of(edges_of(kDigits)), 10);
  const ReflectanceReferences references{0.45, 0.9, 0.05, 0.1};
  const auto grade = grade_symbol(picture.image.view(), picture.corners, {}, references);
  REQUIRE(grade);
  CHECK(grade->absolute);
  CHECK(*grade->means[1]->value == Approx(0.8).epsilon(0.02));
  CHECK(*grade->means[2]->value == Approx(0.1).epsilon(0.02));  // of the black
  CHECK(grade->grade == Approx(4));
}

TEST_CASE("the parameter to blame is named") {
  std::vector<double> profile = profile_of(edges_of(kDigits));
  paint(profile, -6, -4, 0.90 - 0.18);
  const Picture picture = picture_of(profile, 10);
  const auto grade = grade_symbol(picture.image.view(), picture.corners, {});
  REQUIRE(grade);
  CHECK(grade->grade < 3.2);
  CHECK(grade->worst == GradeParameter::defects);
}

TEST_CASE("a scan is as high as its aperture, not a line of pixels") {
  Picture picture = picture_of(profile_of(edges_of(kDigits)), 10);
  const auto width = static_cast<std::size_t>(picture.image.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(picture.image.height); ++y) {
    if (y % 5 > 0) continue;  // a row of five is dim in the quiet zone before the bars
    for (std::size_t x = 40; x < 70; ++x) picture.image.samples[y * width + x] = sample(0.3);
  }
  const auto grade = grade_symbol(picture.image.view(), picture.corners, {});
  REQUIRE(grade);
  CHECK(grade->grade == Approx(4));
}

TEST_CASE("scans that decode differently make grade 0") {
  Picture picture = picture_of(profile_of(edges_of(kDigits)), 10);
  const Picture other = picture_of(profile_of(edges_of(*parse_digits("012345678905"))), 10);
  const std::size_t half = picture.image.samples.size() / 2;
  std::copy(other.image.samples.begin() + static_cast<std::ptrdiff_t>(half),
            other.image.samples.end(),
            picture.image.samples.begin() + static_cast<std::ptrdiff_t>(half));
  const auto grade = grade_symbol(picture.image.view(), picture.corners, {});
  REQUIRE(grade);
  CHECK(grade->grade == 0);
  CHECK(grade->worst == GradeParameter::decode);
}

TEST_CASE("too few pixels or a tag that leaves the picture are no basis for a grade") {
  const Picture small = picture_of(profile_of(edges_of(kDigits)), 3);
  const auto coarse = grade_symbol(small.image.view(), small.corners, {});
  REQUIRE(!coarse);
  CHECK(coarse.error().message.find("3.0 pixels a module") != std::string::npos);
  Picture outside = picture_of(profile_of(edges_of(kDigits)), 10);
  outside.corners[0].x = -3;
  CHECK(!grade_symbol(outside.image.view(), outside.corners, {}));
}
