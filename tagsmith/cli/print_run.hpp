// SPDX-License-Identifier: Apache-2.0
// A whole print: files, installer's documents, proof, manifest.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/print_job.hpp"
#include "tagsmith/cli/print_proof.hpp"

namespace tagsmith::detail {

struct PrintedTag {
  const PlacedTag* tag = nullptr;
  std::vector<std::string> files;  // names in the output folder
};

// What a print made.
struct PrintRecord {
  std::vector<PrintedTag> tags;
  std::vector<std::string> documents;           // files without a tag for hanging
  std::map<std::string, std::string> sha256{};  // by file
  std::optional<std::vector<TagProof>> proofs{};
  std::vector<std::string> warnings{};  // of files of earlier prints in the folder
};

// One JSON object of a printed tag, on one line. `folder` is put before the files' names.
std::string printed_tag_json(const PrintedTag& printed, const std::string& folder);

// Makes everything in the folder, or nothing when something fails. A proof that finds a fault
// leaves the folder unchanged; the record then holds the problems. A progress bar is shown.
// `files`: the input files, which no file of the print replaces.
Result<PrintRecord> run_print(const PrintJob& job, const std::filesystem::path& folder,
                              CommandFiles files);

// True when the proof found a fault.
bool has_problems(const PrintRecord& record);

}  // namespace tagsmith::detail
