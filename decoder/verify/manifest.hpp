// SPDX-License-Identifier: Apache-2.0
// The manifest.json that `print` writes beside its files: which tag each file must hold.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "decoder/verify/finding.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

struct ManifestTag {
  std::string name;
  Digits digits{};
  std::vector<std::string> files;  // names in the manifest's folder
};

struct PrintManifest {
  std::filesystem::path file;
  std::string survey;
  std::vector<ManifestTag> tags;
};

// The manifest beside a print file; nothing when there is none, or when the manifest.json there is
// something else (it has no "survey" or no "tags"). Fails when it is ours and broken.
Result<std::optional<PrintManifest>> find_manifest(const std::filesystem::path& print_file);

// Compares what was read in a print file with what the manifest says it holds: tags that stand in
// the wrong file become `misprinted`; tags that should be there and are not, and tags whose digits
// are no longer the survey's, are added to the findings. A file that the manifest does not name
// comes back as it was.
FileReport check_against_manifest(const PrintManifest& manifest, const Survey& survey,
                                  FileReport report);

}  // namespace tagsmith
