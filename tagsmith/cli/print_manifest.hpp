// SPDX-License-Identifier: Apache-2.0
// What was printed: the list that goes to the sign maker and the installer with the files.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/render/page.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

struct PrintedTag {
  const PlacedTag* tag = nullptr;
  std::vector<std::string> files;  // names in the output folder
};

// One JSON object of a printed tag, on one line. `folder` is put before the files' names.
std::string printed_tag_json(const PrintedTag& printed, const std::string& folder = {});

// manifest.json: the survey, the sizes common to all tags, and each tag.
std::string print_manifest_json(const Survey& survey, const Page& page,
                                const std::vector<PrintedTag>& printed);

// manifest.csv: the same, a tag a row (RFC 4180).
std::string print_manifest_csv(const Survey& survey, const Page& page,
                               const std::vector<PrintedTag>& printed);

}  // namespace tagsmith
