// SPDX-License-Identifier: Apache-2.0
// Lists of tags for `print --only`.
#include <sstream>

#include "tagsmith/cli/print_only.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream input(std::string(fuzz::as_text(data, size)));
  (void)read_tags_to_print("-", input);
  return 0;
}
