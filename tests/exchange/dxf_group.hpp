// SPDX-License-Identifier: Apache-2.0
// Drawings that tests write.
#pragma once

#include <string>

#include <fmt/format.h>

namespace tagsmith::detail::test {

// A group of an ASCII DXF: its code and its value, a line each.
inline std::string group(int code, const std::string& value) {
  return fmt::format("{:>3}\n{}\n", code, value);
}

inline std::string group(int code, double value) {
  return group(code, fmt::format("{:.6f}", value));
}

}  // namespace tagsmith::detail::test
