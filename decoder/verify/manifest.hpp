// SPDX-License-Identifier: Apache-2.0
// The manifest.json that `print` writes beside its files: which tag each file must hold.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/verify/finding.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

struct ManifestTag {
  std::string name;
  Digits digits{};
  std::vector<std::string> files;              // names in the manifest's folder
  std::optional<Eigen::Vector3d> p_in_grid{};  // as printed on the label
};

struct PrintManifest {
  std::filesystem::path file;
  std::string survey;
  std::vector<ManifestTag> tags;
  std::vector<std::string> documents{};                // files that hold no tag to hang
  std::map<std::string, std::string> sha256{};         // by file
  std::map<std::string, std::vector<double>> sizes{};  // plate_mm and others, millimetres
  bool tiled = false;                                  // the files hold pieces of tags
  int dots_per_inch = 0;                               // of PNG files; 0 = not said
};

// What a file of the manifest is, for who checks it.
enum class ManifestEntry { tags, tiles, document, stranger };
ManifestEntry entry_of(const PrintManifest& manifest, const std::string& file);

// The manifest beside a print file; nothing when there is none, or when the manifest.json there is
// something else (it has no "survey" or no "tags"). Fails when it is ours and broken.
Result<std::optional<PrintManifest>> find_manifest(const std::filesystem::path& print_file);

// Compares what was read in a print file with what the manifest says it holds: tags that stand in
// the wrong file become `misprinted`; tags that should be there and are not are added to the
// findings. A file that the manifest does not name comes back as it was.
FileReport check_against_manifest(const PrintManifest& manifest, FileReport report);

// Whether the file is still what was printed and what the survey says: adds a finding when its
// SHA-256 is not the manifest's, and makes it stale, with the reason among the findings, when the
// survey now has other digits, another place or another plate for one of its tags, or no such tag.
FileReport check_freshness(const PrintManifest& manifest, const Survey& survey, FileReport report);

}  // namespace tagsmith
