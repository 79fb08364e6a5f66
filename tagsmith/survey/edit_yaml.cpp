// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_yaml.hpp"

#include <algorithm>
#include <functional>
#include <optional>

#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/yaml_document.hpp"

namespace tagsmith::detail {
namespace {

// Bytes [begin, begin + length) become `text`.
struct Replacement {
  std::size_t begin = 0;
  std::size_t length = 0;
  std::string text;
};

const YamlNode* value_at(const YamlNode& map, std::string_view key) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (map.keys[i].text == key) return &map.items[i];
  }
  return nullptr;
}

const YamlKey* key_at(const YamlNode& map, std::string_view key) {
  const auto found = std::ranges::find(map.keys, key, &YamlKey::text);
  return found == map.keys.end() ? nullptr : &*found;
}

// Where in the text the word stands that a node or key at this place was read from; columns may
// count characters instead of bytes, so that it is looked for from there on in its line.
std::optional<std::size_t> offset_of(std::string_view text, const Place& place,
                                     std::string_view word) {
  std::size_t line_start = 0;
  for (int line = 1; line < place.line; ++line) {
    line_start = text.find('\n', line_start);
    if (line_start == std::string_view::npos) return std::nullopt;
    ++line_start;
  }
  const std::size_t line_end = std::min(text.find('\n', line_start), text.size());
  const std::size_t from = line_start + static_cast<std::size_t>(std::max(0, place.column - 1));
  const std::size_t found = text.find(word, from);
  if (found == std::string_view::npos || found + word.size() > line_end) return std::nullopt;
  return found;
}

Result<Replacement> scalar_replaced(std::string_view text, const YamlNode& node,
                                    const YamlEdit& edit) {
  const auto offset = offset_of(text, node.place, node.text);
  if (node.kind != YamlNode::Kind::scalar || node.quoted || !offset) {
    return fail("the value of `" + edit.key + "` is no plain one and cannot be changed");
  }
  return Replacement{*offset, node.text.size(), edit.value};
}

Result<std::vector<Replacement>> replacements(std::string_view text, const YamlNode& root,
                                              const YamlEdit& edit) {
  const YamlNode* map = &root;
  for (const std::string& step : edit.path) {
    map = value_at(*map, step);
    if (map == nullptr) return fail("the map `" + step + "` is missing");
  }
  if (map->kind != YamlNode::Kind::map || map->keys.empty()) {
    return fail("no map to put `" + edit.key + "` in");
  }
  for (const std::string& key : {edit.key, edit.instead_of}) {
    const YamlNode* value = key.empty() ? nullptr : value_at(*map, key);
    if (value == nullptr) continue;
    const auto replaced = scalar_replaced(text, *value, edit);
    if (!replaced) return fail(replaced.error().message);
    std::vector<Replacement> all{*replaced};
    if (key == edit.key) return all;
    const auto key_offset = offset_of(text, key_at(*map, key)->place, key);
    if (!key_offset) return fail("the key `" + key + "` cannot be changed");
    all.push_back({*key_offset, key.size(), edit.key});
    return all;
  }
  const YamlKey& first = map->keys.front();
  const auto offset = offset_of(text, first.place, first.text);
  if (!offset) return fail("the map of `" + edit.key + "` cannot be changed");
  const std::size_t line_start = text.rfind('\n', *offset) + 1;  // npos + 1 = 0
  const std::string_view before = text.substr(line_start, *offset - line_start);
  const bool is_block = before.find_first_not_of(' ') == std::string_view::npos;
  const std::string gap = is_block ? "\n" + std::string(before) : ", ";
  return std::vector<Replacement>{{*offset, 0, edit.key + ": " + edit.value + gap}};
}

}  // namespace

Result<std::string> edit_yaml(std::string_view text, const std::vector<YamlEdit>& edits) {
  FindingLog log("edited");
  const std::optional<YamlNode> root = parse_yaml(text, log);
  if (!root) return fail(to_string(log.sorted(), true));
  std::vector<Replacement> all;
  for (const YamlEdit& edit : edits) {
    const auto some = replacements(text, *root, edit);
    if (!some) return fail(some.error().message);
    all.insert(all.end(), some->begin(), some->end());
  }
  std::ranges::stable_sort(all, std::greater<>{}, &Replacement::begin);
  std::string edited(text);
  for (const Replacement& one : all) edited.replace(one.begin, one.length, one.text);
  return edited;
}

}  // namespace tagsmith::detail
