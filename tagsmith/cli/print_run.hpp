// SPDX-License-Identifier: Apache-2.0
// A whole print: files, installer's documents, proof, manifest.
#pragma once

#include <filesystem>

#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/print_manifest.hpp"
#include "tagsmith/cli/print_proof.hpp"

namespace tagsmith {

struct PrintExtras {
  bool setting_out = true;      // the installer's list, table and drawing
  double tolerance = 0;         // of a plate's place, metres; 0 = usual_tolerance
  bool northing_first = false;  // y before x in the list (PNEZD instead of PENZD)
  ProvePages prove{};           // none = no proof
  CommandFiles files{};         // what was read for it, which no file of the print replaces
};

// Makes everything in the folder, or nothing when something fails. A proof that finds a fault
// leaves the folder as it was; the record then holds the problems. A progress bar is shown.
Result<PrintRecord> run_print(const PrintJob& job, const std::filesystem::path& folder,
                              const PrintExtras& extras = {});

// True when the proof found a fault.
bool has_problems(const PrintRecord& record);

}  // namespace tagsmith
