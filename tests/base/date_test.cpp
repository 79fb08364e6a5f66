// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/date.hpp"

#include <limits>

#include <doctest/doctest.h>

namespace tagsmith::detail {

TEST_CASE("a day is written and read back") {
  for (const char* text : {"1970-01-01", "2024-02-29", "2026-12-31", "0001-01-01"}) {
    const auto day = parse_day(text);
    REQUIRE(day);
    CHECK(to_text(*day) == text);
  }
  CHECK(parse_day("1970-01-11")->time_since_epoch().count() == 10);
  for (const char* text : {"", "2026-02-29", "2026-00-01", "2026-1-01", "2026-01-011", "x026-01-01",
                           "2026/01/01", "-026-01-01"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_day(text));
  }
}

TEST_CASE("seconds since 1970 are a moment where they can be such") {
  // By `date -u -d @1774965909 +%FT%TZ`.
  CHECK(unix_moment(1774965909.75) == "2026-03-31T14:05:09Z");
  CHECK(unix_moment(946684800) == "2000-01-01T00:00:00Z");
  CHECK(unix_moment(4102444799) == "2099-12-31T23:59:59Z");
  for (const double seconds : {0.0, -1.0, 12.5, 946684799.0, 4102444800.0, 1e300,
                               std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_FALSE(unix_moment(seconds));
  }
  CHECK(is_moment(*unix_moment(1774965909)));
}

TEST_CASE("a moment is a day with a time, and may say how far it is from universal time") {
  for (const char* text :
       {"2026-03-31T14:05:09", "2026-03-31T14:05:09Z", "2026-03-31T00:00:00+02:00",
        "2026-12-31T23:59:60Z", "2026-03-31T23:59:59-09:30", "2026-03-31T14:05:09+14:00"}) {
    CAPTURE(text);
    CHECK(is_moment(text));
  }
  for (const char* text :
       {"", "2026-03-31", "2026-03-31T14:05", "2026-02-30T14:05:09", "2026-03-31 14:05:09",
        "2026-03-31T24:00:00", "2026-03-31T14:60:00", "2026-03-31T14:05:61", "2026-03-31T14:05:09z",
        "2026-03-31T14:05:09+2", "2026-03-31T14:05:09+15:00", "2026-03-31T14:05:09+02:60",
        "2026-03-31T14:05:09*02:00"}) {
    CAPTURE(text);
    CHECK_FALSE(is_moment(text));
  }
}

}  // namespace tagsmith::detail
