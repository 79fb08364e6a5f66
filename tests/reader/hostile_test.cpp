// SPDX-License-Identifier: Apache-2.0
// Frames with anything inside, degraded in every way at once (docs/accuracy.md, "Reliability").
#include <cstdint>

#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "tests/bench/mass_picture.hpp"

using namespace tagsmith::detail;

namespace {

ReadResult read_telling_all(const mass::Picture& picture) {
  ReadOptions options;
  options.tell_passed_over = true;
  return read_tags(picture.image.view(), options);
}

}  // namespace

TEST_CASE("of hostile frames none is read as what it is not, and tags are") {
  constexpr std::uint64_t kFirst = 90'000'000;
  constexpr int kFrames = 150;
  int right = 0;
  for (std::uint64_t number = kFirst; number < kFirst + kFrames; ++number) {
    const mass::Picture picture = mass::draw(number);
    CAPTURE(number);
    for (const Reading& tag : read_tags(picture.image.view()).tags) {
      CHECK(mass::may_be_read(picture.kind));
      CHECK(to_string(tag.digits) == to_string(picture.code));
      ++right;
    }
  }
  CHECK(right >= 10);
}

TEST_CASE("a frame whose plane's horizon runs through its pixels is passed over") {
  // Places near the horizon are too far away for any integer.
  constexpr std::uint64_t kHorizon = 40'490'213;
  const mass::Picture picture = mass::draw(kHorizon);
  const ReadResult result = read_telling_all(picture);
  CHECK(result.tags.empty());
  CHECK(result.rejected.size() + result.passed_over.size() > 0);
}

TEST_CASE(
    "a misprinted digit behind a cable that hides the misprint in part of the height is not read") {
  constexpr std::uint64_t kMisprint = 40'334'602;
  const mass::Picture picture = mass::draw(kMisprint);
  CHECK(picture.kind == mass::Kind::foreign);
  ReadOptions options;
  options.code_book.push_back(picture.code);
  CHECK(read_tags(picture.image.view(), options).tags.empty());
  options.min_confidence = 0;
  CHECK(read_tags(picture.image.view(), options).tags.empty());
}

TEST_CASE("beside covered bars a character of no digit is not read as the one that fits the rest") {
  constexpr std::uint64_t kNoDigit = 27'000'279'066;
  const mass::Picture picture = mass::draw(kNoDigit);
  ReadOptions options;
  options.check = CheckDigit::gs1;
  CHECK(read_tags(picture.image.view(), options).tags.empty());
  options.min_confidence = kSureInFrame;
  const ReadResult result = read_tags(picture.image.view(), options);
  REQUIRE(result.tags.size() == 1);
  CHECK(result.tags[0].method == ReadingMethod::partly_covered);
  CHECK(result.tags[0].confidence < kSureIfCovered);
}
