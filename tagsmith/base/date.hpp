// SPDX-License-Identifier: Apache-2.0
// Calendar days and moments as text (ISO 8601).
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace tagsmith::detail {

// The day that the text states in full, as 2026-03-31; nothing for any other text, days that no
// calendar has included.
std::optional<std::chrono::sys_days> parse_day(std::string_view text);

// "2026-03-31"; of the years 0 to 9999.
std::string to_text(std::chrono::sys_days day);

// True for a day with a time of day, as 2026-03-31T14:05:09, which an offset from universal time
// may follow: Z, +02:00.
bool is_moment(std::string_view text);

// The moment this many seconds after the beginning of 1970, as 2026-03-31T14:05:09Z. Nothing
// outside of the years 2000 to 2099: seconds that are counted from something else.
std::optional<std::string> unix_moment(double seconds);

}  // namespace tagsmith::detail
