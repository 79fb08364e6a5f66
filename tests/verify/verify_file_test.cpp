// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_file.hpp"

#include <doctest/doctest.h>

#include "tests/verify/survey_of_four.hpp"

namespace tagsmith {

using test::reading_of;

TEST_CASE("of two passes over one picture the first is believed, the second fills in") {
  ReadResult first;
  first.tags = {reading_of("019000000404", 100)};
  first.rejected = {{"too small", reading_of("019000800402", 600).corners},
                    {"guard pattern", reading_of("019000800402", 2000).corners}};
  ReadResult second;
  second.tags = {reading_of("000000340401", 110),   // lies on the first pass's tag
                 reading_of("019000800402", 600)};  // read at last
  second.rejected = {{"not in survey", reading_of("019000000404", 100).corners}};

  const ReadResult merged = merge_readings(first, second);
  REQUIRE(merged.tags.size() == 2);
  CHECK(to_string(merged.tags[0].digits) == "019000000404");
  CHECK(to_string(merged.tags[1].digits) == "019000800402");
  REQUIRE(merged.rejected.size() == 1);
  CHECK(merged.rejected[0].reason == "guard pattern");
}

TEST_CASE("tags side by side do not hide each other") {
  ReadResult first;
  first.tags = {reading_of("019000000404", 100)};
  ReadResult second;
  second.tags = {reading_of("000000340401", 450)};
  CHECK(merge_readings(first, second).tags.size() == 2);
}

}  // namespace tagsmith
