// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <doctest/doctest.h>

#include "decoder/scan/explanation.hpp"
#include "tests/scan/made_profile.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

TEST_CASE("a profile that is as expected is explained wholly, one of mid grey not at all") {
  const Digits digits = *parse_digits("019012340400");
  const ImagingModel image{.blur = 0.4, .white = 0.1, .black = 0.9};
  ScanProfile profile = profile_of(digits, image, 1, 0.5);
  const std::vector<double> expected = expected_darkness(image, digits, profile);
  for (std::size_t i = 0; i < profile.size(); ++i) profile[i].darkness = expected[i];
  CHECK(explained_by_guards(profile, image, expected) == doctest::Approx(1).epsilon(1e-9));
  for (const double share : explained_by_digits(profile, image, expected)) CHECK(share == 1);
  for (ScanBin& bin : profile) bin.darkness = 0.5;
  CHECK(explained_by_guards(profile, image, expected) == 0);
}

TEST_CASE("what is off leaves so much of the variation unexplained as its square has of it") {
  const Digits digits = *parse_digits("019012340400");
  const ImagingModel image{.blur = 0.4};
  ScanProfile profile = profile_of(digits, image, 1, 0.5);
  std::vector<double> expected(profile.size(), 0.2);
  for (ScanBin& bin : profile) bin.darkness = 0.1;
  CHECK(explained_by_guards(profile, image, expected) ==
        doctest::Approx(1 - 0.1 * 0.1 / (0.4 * 0.4)));
}

TEST_CASE("guard patterns show where bars are blurred more than the frame, and in no even light") {
  const Digits digits = *parse_digits("019012340400");
  for (const double blur : {0.3, 0.6, 0.9}) {
    CAPTURE(blur);
    CHECK(shows_guards(profile_of(digits, {.blur = blur}), {.blur = 0.3}));
  }
  for (const double even : {0.0, 1.0}) {
    CAPTURE(even);
    ScanProfile plain = profile_of(digits, {.blur = 0.3});
    for (ScanBin& bin : plain) {
      if (bin.at > 0 && bin.at < kModuleCount) bin.darkness = even;
    }
    CHECK_FALSE(shows_guards(plain, {.blur = 0.3}));
  }
}

TEST_CASE("a digit of which a profile shows nothing leaves nothing unexplained") {
  const Digits digits = *parse_digits("019012340400");
  const ImagingModel image{.blur = 0.4};
  ScanProfile profile = profile_of(digits, image);
  std::erase_if(profile, [](const ScanBin& bin) { return digit_at(bin.at) == std::size_t{3}; });
  for (ScanBin& bin : profile) bin.darkness = 0.3;
  const auto shares = explained_by_digits(profile, image, std::vector<double>(profile.size(), 0.0));
  for (std::size_t i = 0; i < shares.size(); ++i) {
    CAPTURE(i);
    if (i == 3) CHECK(shares[i] == 1);
    if (i != 3) CHECK(shares[i] < 0.5);
  }
}
