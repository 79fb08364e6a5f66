// SPDX-License-Identifier: Apache-2.0
// A whole print: files, installer's documents, proof, manifest.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/print_job.hpp"
#include "tagsmith/cli/print_proof.hpp"

namespace tagsmith::detail {

// ---- The list of printed tags, which is sent to the sign maker and the installer with the files.

struct PrintedTag {
  const PlacedTag* tag = nullptr;
  std::vector<std::string> files;  // names in the output folder
};

// Values that become known while the files are made.
struct PrintRecord {
  std::vector<PrintedTag> tags;
  std::vector<std::string> documents;           // files without a tag for hanging
  std::map<std::string, std::string> sha256{};  // by file
  std::optional<std::vector<TagProof>> proofs{};
  // JSON list of the tags of earlier prints whose files are still in the folder, and these files.
  std::string kept_tags = "[]";
  std::map<std::string, std::string> kept_sha256{};
  std::set<std::string> kept_names{};   // of those whose plates are the same in the survey now
  std::vector<std::string> warnings{};  // of files of earlier prints
  // JSON object of the values that the kept tags share, where nothing else is printed; empty = the
  // present ones.
  std::string common{};
};

// Keeps the entries of the folder's manifest for files that this print does not change, so that
// `verify` still knows whether they are stale. Nothing of a manifest of another survey, template,
// printer or kind of print. Warns of plates that the folder no longer holds, holds in a state
// before the survey was changed, or holds twice.
void keep_earlier_tags(const PrintJob& job, const std::filesystem::path& folder,
                       PrintRecord& record);

// The job's tags and the files that show them.
std::vector<PrintedTag> printed_tags(const PrintJob& job);

// One JSON object of a printed tag, on one line. `folder` is put before the files' names.
std::string printed_tag_json(const PrintedTag& printed, const std::string& folder = {});

// manifest.json: the survey and its revision, how it was printed, the sizes common to all tags,
// each tag, each file's SHA-256, and the proof.
std::string print_manifest_json(const PrintJob& job, const PrintRecord& record);

// manifest.csv: the tags, one a row (RFC 4180).
std::string print_manifest_csv(const PrintJob& job, const PrintRecord& record);

// ---- The run.

// Makes everything in the folder, or nothing when something fails. A proof that finds a fault
// leaves the folder unchanged; the record then holds the problems. A progress bar is shown.
// `files`: the input files, which no file of the print replaces.
Result<PrintRecord> run_print(const PrintJob& job, const std::filesystem::path& folder,
                              CommandFiles files);

// True when the proof found a fault.
bool has_problems(const PrintRecord& record);

}  // namespace tagsmith::detail
