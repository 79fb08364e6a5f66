// SPDX-License-Identifier: Apache-2.0
// XML as OpenCV's FileStorage writes it, as the tree that YAML gives, and places in XML of any
// kind. Internal to tagsmith/survey: pugixml appears in no header.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/yaml_document.hpp"

namespace tagsmith::detail {

// Lines and columns of a text's bytes.
class TextPlaces {
 public:
  explicit TextPlaces(std::string_view text);

  // The text's beginning or end for offsets outside of it.
  Place at(std::ptrdiff_t offset) const;

 private:
  std::size_t size_;
  std::vector<std::size_t> line_starts_{0};
};

// The children of the root element as a map from their names; attributes are left out. An element
// with children is a map, or a list when all of them are called `_`; text of several words is a
// list of words, other text a scalar, in quotes as written. Nothing when there is no usable tree;
// why is in the log: syntax, not UTF-8, nested deeper than 32.
std::optional<YamlNode> parse_xml(std::string_view text, FindingLog& log);

}  // namespace tagsmith::detail
