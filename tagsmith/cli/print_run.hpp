// SPDX-License-Identifier: Apache-2.0
// A whole print: files, installer's documents, proof, manifest.
#pragma once

#include <filesystem>

#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/print_manifest.hpp"

namespace tagsmith::detail {

// Makes everything in the folder, or nothing when something fails. A proof that finds a fault
// leaves the folder as it was; the record then holds the problems. A progress bar is shown.
// `files`: what was read for it, which no file of the print replaces.
Result<PrintRecord> run_print(const PrintJob& job, const std::filesystem::path& folder,
                              CommandFiles files);

// True when the proof found a fault.
bool has_problems(const PrintRecord& record);

}  // namespace tagsmith::detail
