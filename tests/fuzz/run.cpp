// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/run.hpp"

#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  const fuzz::FileInMemory file(fuzz::as_text(data, size));
  (void)load_run(file.path(), rig);
  return 0;
}
