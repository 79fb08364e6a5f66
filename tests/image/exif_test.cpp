// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/exif.hpp"

#include <array>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/date.hpp"
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

TEST_CASE("what stands behind a directory's entries is none of them") {
  std::string photo = test::with_orientation(kJpeg, 6);
  CHECK(exif_orientation(photo) == 6);
  const std::size_t count = photo.find("\x01\x12") - 1;
  photo[count] = 0;
  CHECK_FALSE(exif_orientation(photo));
}

TEST_CASE("what a camera calls itself is printable, whatever its bytes are") {
  CHECK(photo_lens(test::with_lens(kJpeg, "\x1b[31m\xC3\xA9", 26))->camera == "Maker ?[31m??");
}

TEST_CASE("a photo says when it was taken") {
  const auto moment = [](const std::string& text, const std::string& offset = "") {
    return photo_moment(test::with_moment(kJpeg, text, offset)).value_or("none");
  };
  CHECK(moment("2026:03:31 14:05:09") == "2026-03-31T14:05:09");
  CHECK(moment("2026:03:31 14:05:09", "+02:00") == "2026-03-31T14:05:09+02:00");
  CHECK(moment("2024:02:29 00:00:00") == "2024-02-29T00:00:00");
  // What is no offset is left out, and what is no time is none.
  CHECK(moment("2026:03:31 14:05:09", "+2 h") == "2026-03-31T14:05:09");
  CHECK(moment("2026:03:31 14:05:09", "+99:00") == "2026-03-31T14:05:09");
  for (const char* text :
       {"", "    :  :     :  :  ", "0000:00:00 00:00:00", "0000:01:01 00:00:00",
        "2026:02:30 14:05:09", "2026:13:01 14:05:09", "2026:03:31 24:05:09", "2026:03:31 14:61:09",
        "2026-03-31 14:05:09", "2026:03:31T14:05:09", "2026:03:31 14:05", "2026:03:31",
        "2026:03:31 14:05:0x", "2026:03:31 14:05:099", "\xFF\xFF\xFF\xFF:03:31 14:05:09"}) {
    CAPTURE(text);
    CHECK(moment(text) == "none");
  }
  CHECK_FALSE(photo_moment(kJpeg));
  CHECK_FALSE(photo_moment(test::with_lens(kJpeg, "Phone 7", 26)));
}

TEST_CASE("a damaged EXIF is read as far as it goes") {
  const std::array wholes{test::with_lens(kJpeg, "Phone 7", 26),
                          test::with_moment(kJpeg, "2026:03:31 14:05:09", "+02:00")};
  for (const std::string& whole : wholes) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      photo_lens(whole.substr(0, size));
      photo_moment(whole.substr(0, size));
    }
  }
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 20'000; ++i) {
    std::string changed = wholes[static_cast<std::size_t>(i % 2)];
    for (int k = 0; k < 3; ++k) changed[random() % changed.size()] = static_cast<char>(random());
    const auto lens = photo_lens(changed);
    CHECK((!lens || lens->focal_35_mm > 0));
    exif_orientation(changed);
    const auto moment = photo_moment(changed);
    CHECK((!moment || is_moment(*moment)));
  }
}

}  // namespace tagsmith::detail
