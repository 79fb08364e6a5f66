// SPDX-License-Identifier: Apache-2.0
// The only way to standard output and standard error: shown text cannot move the cursor, change
// colours or imitate another line. tests/house prevents every other way.
#pragma once

#include <cstdio>
#include <iostream>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {

// Text with intended line feeds: tables, several findings. Everything in it that comes from outside
// must already be on one line.
struct Lines {
  std::string text;
};

// A value in the form in which it may be shown: numbers unchanged, all else by terminal_text.
template <class Value>
auto shown(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>) {
    return value;
  } else if constexpr (std::is_same_v<Value, Lines>) {
    return terminal_lines(value.text);
  } else if constexpr (std::is_convertible_v<const Value&, std::string>) {
    return terminal_text(static_cast<std::string>(value));
  } else {
    return terminal_text(fmt::format("{}", Value(value)));  // a view of fmt::join is no lvalue
  }
}

template <class... Values>
using ShownFormat = fmt::format_string<decltype(shown(std::declval<const Values&>()))...>;

template <class... Values>
void print_shown(std::FILE* stream, ShownFormat<Values...> format, const Values&... values) {
  const std::string text = fmt::format(format, shown(values)...);
  std::fwrite(text.data(), 1, text.size(), stream);
}

// `format` is the program's own; the values may hold anything.
template <class... Values>
void to_stdout(ShownFormat<Values...> format, const Values&... values) {
  print_shown<Values...>(stdout, format, values...);
}

template <class... Values>
void to_stderr(ShownFormat<Values...> format, const Values&... values) {
  print_shown<Values...>(stderr, format, values...);
}

// A file's content to standard output, byte by byte.
inline void bytes_to_stdout(const std::string& bytes) {
  std::fwrite(bytes.data(), 1, bytes.size(), stdout);
}

// Hides from the user what libraries write to std::cerr, as OpenCV does for files it cannot decode:
// the program itself reports their errors.
inline void mute_libraries() { std::cerr.setstate(std::ios_base::badbit); }

}  // namespace tagsmith::detail
