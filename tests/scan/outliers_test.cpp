// SPDX-License-Identifier: Apache-2.0
// What of a profile no symbol explains.
#include <algorithm>

#include <doctest/doctest.h>

#include "decoder/scan/explanation.hpp"
#include "tests/scan/made_profile.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

const Digits kDirtyDigits = *parse_digits("019000700401");
const ImagingModel kDirtyImage{.blur = 0.4};

// Dirt over two modules: their darkness is the other one, in this share of the bars' height.
ScanProfile with_dirt(double agreement) {
  ScanProfile profile = profile_of(kDirtyDigits, kDirtyImage, 1e-4);
  for (ScanBin& bin : profile) {
    if (bin.at < 20 || bin.at > 22) continue;
    bin.darkness = 1 - bin.darkness;
    bin.agreement = agreement;
  }
  return profile;
}

std::optional<Explained> explained(const ScanProfile& profile) {
  return explain(profile, DecodingStart(profile, kDirtyImage), {CheckDigit::sum10, {}});
}

}  // namespace

TEST_CASE("dirt that covers a part of the bars' height is set aside, what all of it shows is not") {
  const ScanProfile outlined = with_dirt(0.5);
  const auto cleaned = explained(outlined);
  REQUIRE(cleaned);
  CHECK(cleaned->settled.decoding.digits == kDirtyDigits);
  const auto is_dirt = [](const ScanBin& bin) { return bin.at > 20 && bin.at < 22; };
  const auto hidden = std::ranges::count_if(cleaned->cleaned.profile, is_hidden);
  CHECK(hidden > 0.7 * static_cast<double>(std::ranges::count_if(outlined, is_dirt)));
  for (const ScanBin& bin : cleaned->cleaned.profile) CHECK((!is_hidden(bin) || is_dirt(bin)));
  CHECK(cleaned->settled.decoding.fit.kept ==
        doctest::Approx(1 - static_cast<double>(hidden) / static_cast<double>(outlined.size())));
  const auto whole = explained(with_dirt(0.95));
  REQUIRE(whole);
  CHECK(whole->settled.decoding.fit.kept == 1);
  CHECK(std::ranges::none_of(whole->cleaned.profile, is_hidden));
}
