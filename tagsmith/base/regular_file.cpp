// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/regular_file.hpp"

#include <system_error>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/stream.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;

Result<std::string> read_regular_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (is_special(status)) {
    return fail(path.string() + ": is a " + file_type(status) + ", expected a regular file");
  }
  return read_file(path, max_bytes);
}

}  // namespace tagsmith::detail
