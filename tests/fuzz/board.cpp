// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/board_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::FileInMemory file(fuzz::as_text(data, size));
  (void)read_board(file.path());
  return 0;
}
