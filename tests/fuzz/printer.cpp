// SPDX-License-Identifier: Apache-2.0
// Printer profiles: what is read is written again.
#include <cstdlib>

#include "tagsmith/survey/read_printer.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::FileInMemory file(fuzz::as_text(data, size));
  const auto profile = read_printer_profile(file.path());
  if (!profile) return 0;
  const fuzz::FileInMemory written(printer_profile_text(*profile));
  if (!read_printer_profile(written.path())) std::abort();
  return 0;
}
