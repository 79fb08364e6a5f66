// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/exif.hpp"

#include <random>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/exif_jpeg.hpp"

namespace tagsmith::detail {
namespace {

// A JPEG as far as its header goes.
const std::string kJpeg("\xFF\xD8\xFF\xDB", 4);

}  // namespace

TEST_CASE("a photo names its camera and lens") {
  const auto lens = photo_lens(test::with_lens(kJpeg, "Phone 7", 26));
  REQUIRE(lens);
  CHECK(lens->camera == "Maker Phone 7");
  CHECK(lens->focal_35_mm == 26);
  CHECK(lens->focal_mm == doctest::Approx(5.43));
  CHECK(photo_lens(test::with_lens(kJpeg, "Maker X", 26))->camera == "Maker X");
}

TEST_CASE("a photo that does not say its lens names none") {
  CHECK_FALSE(photo_lens(""));
  CHECK_FALSE(photo_lens(kJpeg));
  CHECK_FALSE(photo_lens(test::with_orientation(kJpeg, 6)));
  CHECK_FALSE(photo_lens(test::with_lens(kJpeg, "     ", 26)));
  CHECK_FALSE(photo_lens(test::with_lens(kJpeg, "Phone", 0)));
}

TEST_CASE("what a camera calls itself is printable, whatever its bytes are") {
  CHECK(photo_lens(test::with_lens(kJpeg, "\x1b[31m\xC3\xA9", 26))->camera == "Maker ?[31m??");
}

TEST_CASE("a damaged EXIF is read as far as it goes") {
  const std::string whole = test::with_lens(kJpeg, "Phone 7", 26);
  for (std::size_t size = 0; size < whole.size(); ++size) photo_lens(whole.substr(0, size));
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 20'000; ++i) {
    std::string changed = whole;
    for (int k = 0; k < 3; ++k) changed[random() % changed.size()] = static_cast<char>(random());
    const auto lens = photo_lens(changed);
    CHECK((!lens || lens->focal_35_mm > 0));
    exif_orientation(changed);
  }
}

}  // namespace tagsmith::detail
