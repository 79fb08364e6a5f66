// SPDX-License-Identifier: Apache-2.0
// Lines of `verify --json`: what is read is written again, and means the same.
#include <cstdlib>

#include "decoder/verify/verify_json.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::FileInMemory file(fuzz::as_text(data, size));
  (void)read_verify_lines(file.path(), [](const VerifiedFile& verified) {
    const std::string line = to_json_line(verified);
    const auto again = verified_file_from(line);
    if (!again || to_json_line(*again) != line) std::abort();
  });
  return 0;
}
