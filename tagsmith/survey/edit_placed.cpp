// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_placed.hpp"

#include <map>

#include "tagsmith/survey/edit_yaml.hpp"
#include "tagsmith/survey/yaml_document.hpp"

namespace tagsmith::detail {
namespace {

YamlItemEdit changed_entry(std::size_t item, const YamlNode& entry, const PlacedTag& tag,
                           const AsBuiltPlace& place) {
  YamlItemEdit edit{item, measured_keys(place)};
  if (value_at(entry, "digits") == nullptr) edit.values.emplace_back("digits", digits_text(tag));
  const bool was_measured = value_at(entry, "date") != nullptr;
  if (!tag.design_in_grid && !was_measured) {
    edit.values.emplace_back("design", point_text(tag.p_in_grid));
  }
  return edit;
}

// The entries of `placed` by the names of their tags.
std::map<std::string, std::size_t> entries_of(const YamlNode* placed) {
  std::map<std::string, std::size_t> entries;
  for (std::size_t i = 0; placed != nullptr && i < placed->items.size(); ++i) {
    const YamlNode* name = value_at(placed->items[i], "tag");
    if (name != nullptr) entries.emplace(name->text, i);
  }
  return entries;
}

}  // namespace

Result<std::string> survey_with_places(std::string_view text, const Survey& survey,
                                       const std::vector<AsBuiltPlace>& places) {
  const Result<YamlNode> root = parse_yaml_to_edit(text, "the survey");
  if (!root) return fail(root);
  const YamlNode* placed = value_at(*root, "placed");
  const std::map<std::string, std::size_t> entries = entries_of(placed);
  std::vector<YamlItemEdit> edits;
  std::vector<std::string> added;
  for (const AsBuiltPlace& place : places) {
    const PlacedTag& tag = *find_tag(survey, place.tag);
    const auto entry = entries.find(place.tag);
    if (entry == entries.end()) {
      added.push_back(placed_entry(survey, place));
    } else {
      edits.push_back(changed_entry(entry->second, placed->items[entry->second], tag, place));
    }
  }
  return edit_yaml_list(text, "placed", edits, added);
}

}  // namespace tagsmith::detail
