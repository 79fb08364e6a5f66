// SPDX-License-Identifier: Apache-2.0
// What files of templates and of boards say alike of a tag: feature frame and symbol. Internal to
// tagsmith/survey.
#pragma once

#include <optional>
#include <string>

#include "tagsmith/survey/yaml_reader.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

inline constexpr double kLargestPlate = 10.0;  // metres

struct Size {
  double width = 0;
  double height = 0;
};

// A list of two lengths of at most kLargestPlate.
std::optional<Size> read_size(const YamlNode* node, const std::string& name, FindingLog& log);

// The keys inner, stroke and offset.
void read_feature_frame(const MapReader& frame, TagTemplate& tag);

// The keys quiet_zone, margin and dots_per_inch.
void read_symbol(const MapReader& symbol, TagTemplate& tag);

// Logs, at the file's key `symbol`, bars of no height and modules of less than one dot.
void check_symbol(const TagTemplate& tag, const MapReader& file);

}  // namespace tagsmith::detail
