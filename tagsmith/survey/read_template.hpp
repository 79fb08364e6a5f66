// SPDX-License-Identifier: Apache-2.0
// Template files (templates/*.yaml).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/yaml_reader.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// ---- The keys of a tag that files of templates and of boards share: feature frame and symbol.
// Internal to tagsmith/survey.

// The keys inner, stroke and offset.
void read_feature_frame(const MapReader& frame, TagTemplate& tag);

// The keys quiet_zone, margin and dots_per_inch.
void read_symbol(const MapReader& symbol, TagTemplate& tag);

// Logs, at the file's key `symbol`, bars of no height and modules of less than one dot.
void check_symbol(const TagTemplate& tag, const MapReader& file);

// ---- The file.

// Fails only when the file cannot be read at all.
Result<Diagnosed<TagTemplate>> read_template(const std::filesystem::path& path);

// The template of a file without errors; fails with all of its findings.
Result<TagTemplate> load_template(const std::filesystem::path& path);

// The file that a survey means by `name`: a path (absolute, or relative to the survey's folder), or
// NAME.yaml beside the survey, or NAME.yaml among the tool's own templates. Nothing when none
// exists.
std::optional<std::filesystem::path> find_template(const std::string& name,
                                                   const std::filesystem::path& survey_folder);

// The names of the tool's own templates, in alphabetical order, separated by commas, for a message.
std::string own_templates();

// The folder that holds the tool's own `templates` and `surveys`: the environment variable
// TAGSMITH_DATA, else the nearest folder above the executable, or above the shared library that
// this is part of (or its share/tagsmith), that has them, else the source tree it was built from.
std::filesystem::path data_directory();

}  // namespace tagsmith::detail
