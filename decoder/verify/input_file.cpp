// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/input_file.hpp"

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/file.hpp"

namespace tagsmith::detail {

Result<InputFile> read_input_file(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMaxBytes = 512U << 20U;
  Result<std::string> bytes = read_regular_file(path, kMaxBytes);
  if (!bytes) return fail(bytes.error().message);
  std::string hash = sha256(*bytes);
  return InputFile{path, std::move(*bytes), std::move(hash)};
}

}  // namespace tagsmith::detail
