// SPDX-License-Identifier: Apache-2.0
// Files that claim to be ledgers.
#include "decoder/ledger/ledger.hpp"

#include <fstream>

#include "tests/fuzz/fuzz_input.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TemporaryFolder folder;
  const auto path = folder.path() / "ledger.db";
  std::ofstream(path, std::ios::binary | std::ios::trunc) << fuzz::as_text(data, size);
  if (const auto ledger = Ledger::open_to_read(path)) {
    (void)ledger->count_photos("corridor", "2026-03-31", "abc");
    (void)ledger->for_each_sighting("corridor", [](const PlateSighting&) {});
  }
  (void)Ledger::open_to_write(path);
  return 0;
}
