// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/manifest.hpp"

#include <filesystem>
#include <fstream>

#include "tests/fuzz/fuzz_input.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "manifest.json", std::ios::binary) << fuzz::as_text(data, size);
  const auto manifest = find_manifest(folder.path() / "tags.pdf");
  if (!manifest || !*manifest) return 0;
  tags_of_file(**manifest, "tags.pdf");
  entry_of(**manifest, "tags.pdf");
  return 0;
}
