// SPDX-License-Identifier: Apache-2.0
// The manifest.json that `print` writes beside its files: which tag each file must hold.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/verify/verified_file.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/tiled_pages.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

struct ManifestTag {
  std::string name;
  Digits digits{};
  std::vector<std::string> files;              // names in the manifest's folder
  std::optional<Eigen::Vector3d> p_in_grid{};  // these two as printed on the label, metres
  std::optional<double> chainage{};
  bool is_kept = false;  // of an earlier print than the manifest's documents
};

struct PrintManifest {
  std::filesystem::path file;
  std::string sha256_of_file;
  std::string survey;
  std::vector<ManifestTag> tags;
  std::string revision{};                       // of the survey; empty = not stated
  std::vector<std::string> documents{};         // files without a tag for hanging
  std::map<std::string, std::string> sha256{};  // by file
  std::map<std::string, double> lengths{};      // of plates, named as by printed_lengths, mm
  std::optional<bool> white_on_black{};
  std::string template_revision{};  // empty = not stated
  bool tiled = false;               // the files hold pieces of tags
  std::optional<TilePlan> tiles{};  // how these are assembled, when it is stated
  PrinterScale scale{};             // of the printer that PDFs are for
  int dots_per_inch = 0;            // of PNG files; 0 = not stated
  int printer_dots_per_inch = 0;    // that modules were fitted to; 0 = none
};

// The tags that a file holds according to the manifest, in its order.
std::vector<ManifestTag> tags_of_file(const PrintManifest& manifest, const std::string& file);

// What a file of the manifest is, for a check of it.
enum class ManifestEntry { tags, tiles, document, unlisted };
ManifestEntry entry_of(const PrintManifest& manifest, const std::string& file);

// The manifest beside a print file; nothing when there is none, or when the manifest.json there is
// something else (it has no "survey" or no "tags"). Fails when it is a broken manifest.
Result<std::optional<PrintManifest>> find_manifest(const std::filesystem::path& print_file);

// The manifests of the folders searched last, each parsed once. Threads may share one.
class ManifestCache {
 public:
  // As find_manifest; null when there is none.
  Result<std::shared_ptr<const PrintManifest>> find(const std::filesystem::path& print_file);

 private:
  struct Entry {
    std::filesystem::path folder;
    Result<std::shared_ptr<const PrintManifest>> manifest;
  };

  std::mutex mutex_;
  std::deque<Entry> entries_;  // the oldest first
};

// For a print file that the manifest beside it does not list: it cannot be determined from which
// state of the survey it was printed.
void find_unlisted(const PrintManifest& manifest, VerifiedFile& file);

// As find_stale from what a print file states about itself, where no manifest lists it.
void find_stale(const ManifestTag& stated, const Survey& survey, VerifiedFile& file);

// The lengths in which the template now differs from the printed plates, as a reason for their
// being stale; empty when there are none.
std::string printed_otherwise(const PrintManifest& manifest, const TagTemplate& tag);

// Adds a finding for each of these tags of the manifest that was not read in its file.
void find_missing(std::span<const ManifestTag> expected, VerifiedFile& file);

// Whether the file is still what was printed and what the survey says: adds a finding when its
// SHA-256 is not the manifest's, and makes it stale, with the reason among the findings, when the
// survey now has other digits, another place or another plate for one of its tags, or no such tag.
// A document is stale when one of the manifest's tags is, or the survey has another revision; it is
// reported, too, when a table of the manifest beside it is not the one that was printed.
void find_stale(const PrintManifest& manifest, const Survey& survey, VerifiedFile& file);

}  // namespace tagsmith::detail
