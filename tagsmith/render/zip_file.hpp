// SPDX-License-Identifier: Apache-2.0
// Files in one ZIP.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

struct ZipEntry {
  std::string name;  // in the ZIP, UTF-8, without folders
  std::filesystem::path file;
};

// Writes the ZIP (PKWARE APPNOTE 6.3.3, deflated, without ZIP64): equal entries give equal bytes,
// because no time and no owner is stored. One entry is in memory at any time. Fails when an entry
// cannot be read, and on more than a ZIP without ZIP64 holds: 65,534 files, 4 GB.
Result<void> write_zip(const std::filesystem::path& path, std::span<const ZipEntry> entries);

}  // namespace tagsmith::detail
