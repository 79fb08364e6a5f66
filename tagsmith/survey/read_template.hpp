// SPDX-License-Identifier: Apache-2.0
// Template files (templates/*.yaml).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// Fails only when the file cannot be read at all.
Result<Diagnosed<TagTemplate>> read_template(const std::filesystem::path& path);

// The template of a file without errors; fails with all of its findings.
Result<TagTemplate> load_template(const std::filesystem::path& path);

// The file that a survey means by `name`: a path (absolute, or relative to the survey's folder), or
// NAME.yaml beside the survey, or NAME.yaml among the tool's own templates. Nothing when none
// exists.
std::optional<std::filesystem::path> find_template(const std::string& name,
                                                   const std::filesystem::path& survey_folder);

// The names of the tool's own templates, by the alphabet, separated by commas, for a message.
std::string own_templates();

// The folder that holds the tool's own `templates` and `surveys`: the environment variable
// TAGSMITH_DATA, else the nearest folder above the executable, or above the shared library that
// this is part of (or its share/tagsmith), that has them, else the source tree it was built from.
std::filesystem::path data_directory();

}  // namespace tagsmith::detail
