// SPDX-License-Identifier: Apache-2.0
// Printer profiles as files.
#pragma once

#include <filesystem>
#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// Fails on files that are no profile, with the place, what was found and what is expected.
Result<PrinterProfile> read_printer_profile(const std::filesystem::path& path);

// The file of a profile, with comments for people.
std::string printer_profile_text(const PrinterProfile& profile);

}  // namespace tagsmith::detail
