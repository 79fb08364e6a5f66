// SPDX-License-Identifier: Apache-2.0
// The keys of a template for what stands beside feature frame and symbol. Internal to
// tagsmith/survey.
#pragma once

#include <filesystem>

#include "tagsmith/survey/yaml_reader.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// Label, holes, patches, logo, QR symbol and cut; the logo's file is sought in the folder.
void read_plate_parts(const MapReader& file, const std::filesystem::path& template_folder,
                      TagTemplate& tag);

// All of it has its place on the plate.
void check_plate_parts(const TagTemplate& tag, const MapReader& file);

}  // namespace tagsmith::detail
