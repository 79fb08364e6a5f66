// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/date.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace tagsmith::detail {
namespace {

// `d` in the shape means any digit.
bool has_shape(std::string_view text, std::string_view shape) {
  return std::ranges::equal(text, shape, [](char c, char like) {
    return like == 'd' ? c >= '0' && c <= '9' : c == like;
  });
}

// Of digits.
unsigned number(std::string_view digits) {
  unsigned value = 0;
  for (const char digit : digits) value = 10 * value + static_cast<unsigned>(digit - '0');
  return value;
}

}  // namespace

std::optional<std::chrono::sys_days> parse_day(std::string_view text) {
  if (!has_shape(text, "dddd-dd-dd")) return std::nullopt;
  const std::chrono::year_month_day day(
      std::chrono::year(static_cast<int>(number(text.substr(0, 4)))),
      std::chrono::month(number(text.substr(5, 2))), std::chrono::day(number(text.substr(8, 2))));
  return day.ok() ? std::optional(std::chrono::sys_days(day)) : std::nullopt;
}

std::string to_text(std::chrono::sys_days day) {
  const std::chrono::year_month_day date(day);
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

bool is_moment(std::string_view text) {
  constexpr std::size_t kDay = 10;
  constexpr std::size_t kTime = 9;  // with its T
  if (text.size() < kDay + kTime || !parse_day(text.substr(0, kDay))) return false;
  const std::string_view time = text.substr(kDay, kTime);
  const std::string_view offset = text.substr(kDay + kTime);
  // A leap second is accepted.
  if (!has_shape(time, "Tdd:dd:dd") || number(time.substr(1, 2)) > 23 ||
      number(time.substr(4, 2)) > 59 || number(time.substr(7, 2)) > 60) {
    return false;
  }
  if (offset.empty() || offset == "Z") return true;
  return (has_shape(offset, "+dd:dd") || has_shape(offset, "-dd:dd")) &&
         number(offset.substr(1, 2)) <= 14 && number(offset.substr(4, 2)) <= 59;
}

std::optional<std::string> unix_moment(double seconds) {
  using namespace std::chrono;
  constexpr double kFirst = sys_seconds(sys_days(January / 1 / 2000)).time_since_epoch().count();
  constexpr double kEnd = sys_seconds(sys_days(January / 1 / 2100)).time_since_epoch().count();
  if (!(seconds >= kFirst && seconds < kEnd)) return std::nullopt;
  const sys_seconds moment{std::chrono::seconds(static_cast<long long>(seconds))};
  const sys_days day = floor<days>(moment);
  const hh_mm_ss time(moment - day);
  return fmt::format("{}T{:02}:{:02}:{:02}Z", to_text(day), time.hours().count(),
                     time.minutes().count(), time.seconds().count());
}

}  // namespace tagsmith::detail
