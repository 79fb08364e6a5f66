// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/rig.hpp"

#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_rig_text("surveys/corridor/fuzz.yaml", fuzz::as_text(data, size));
  return 0;
}
