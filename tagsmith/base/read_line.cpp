// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/read_line.hpp"

#include <istream>

namespace tagsmith::detail {

std::optional<std::string> read_line(std::istream& stream, std::size_t most) {
  constexpr int kEnd = std::istream::traits_type::eof();
  int next = stream.get();
  if (next == kEnd) return std::nullopt;
  std::string line;
  for (; next != kEnd && next != '\n'; next = stream.get()) {
    line += static_cast<char>(next);
    if (line.size() > most) break;
  }
  return line;
}

}  // namespace tagsmith::detail
