// SPDX-License-Identifier: Apache-2.0
// How to read against a code book.
#pragma once

#include <string>
#include <vector>

#include "decoder/reader/read_options.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail::test {

inline ReadOptions with_book(const std::vector<std::string>& codes) {
  ReadOptions options;
  for (const std::string& code : codes) options.code_book.push_back(*parse_digits(code));
  return options;
}

}  // namespace tagsmith::detail::test
