// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_yaml.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "tagsmith/survey/yaml_document.hpp"

namespace tagsmith::detail {
namespace {

// Bytes [begin, begin + length) become `text`.
struct Replacement {
  std::size_t begin = 0;
  std::size_t length = 0;
  std::string text;
};

// The later places first, so that the earlier ones stay valid.
std::string replaced(std::string_view text, std::vector<Replacement> all) {
  std::ranges::stable_sort(all, std::greater<>{}, &Replacement::begin);
  std::string edited(text);
  for (const Replacement& one : all) edited.replace(one.begin, one.length, one.text);
  return edited;
}

// The offset in the text of the word that a node or key at this place was read from; columns may
// count characters instead of bytes, so the search begins at that column of its line.
std::optional<std::size_t> offset_of(std::string_view text, const Place& place,
                                     std::string_view word) {
  const std::size_t line_start = start_of_line(text, place.line);
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

// The map that the path leads to; null when it is missing.
const YamlNode* map_at(const YamlNode& root, const std::vector<std::string>& path) {
  const YamlNode* map = &root;
  for (const std::string& step : path) {
    if (map != nullptr) map = value_at(*map, step);
  }
  return map != nullptr && map->kind == YamlNode::Kind::map ? map : nullptr;
}

Result<std::vector<Replacement>> replacements(std::string_view text, const YamlNode& root,
                                              const YamlEdit& edit) {
  const YamlNode* map = map_at(root, edit.path);
  if (map == nullptr || map->keys.empty()) return fail("no map to put `" + edit.key + "` in");
  for (const std::string& key : {edit.key, edit.instead_of}) {
    const auto index = key.empty() ? std::nullopt : index_of_key(*map, key);
    if (!index) continue;
    const auto replaced = scalar_replaced(text, map->items[*index], edit);
    if (!replaced) return fail(replaced);
    std::vector<Replacement> all{*replaced};
    if (key == edit.key) return all;
    const auto key_offset = offset_of(text, map->keys[*index].place, key);
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

// --- removal ---

bool are_equal(const YamlNode& a, const YamlNode& b) {
  return a.kind == b.kind && a.text == b.text && a.quoted == b.quoted &&
         std::ranges::equal(a.keys, b.keys, {}, &YamlKey::text, &YamlKey::text) &&
         std::ranges::equal(a.items, b.items, are_equal);
}

// The tree without the key of the map that the path leads to, from its step `depth` on.
void remove_from_tree(YamlNode& map, const std::vector<std::string>& path, std::size_t depth,
                      const std::string& key) {
  const auto index = *index_of_key(map, depth < path.size() ? path[depth] : key);
  if (depth < path.size()) {
    remove_from_tree(map.items[index], path, depth + 1, key);
    return;
  }
  const auto place = static_cast<std::ptrdiff_t>(index);
  map.keys.erase(map.keys.begin() + place);
  map.items.erase(map.items.begin() + place);
}

int last_line(const YamlNode& node) {
  int line = node.place.line;
  for (const YamlNode& item : node.items) line = std::max(line, last_line(item));
  return line;
}

// Where the lines of a block map's entry end: those of its value, and all that are indented more.
std::size_t end_of_block_entry(std::string_view text, std::size_t key, const YamlNode& value,
                               const Place& place) {
  const std::size_t indent = key - (text.rfind('\n', key) + 1);
  std::size_t end = next_line(text, key);
  for (int line = place.line; line < last_line(value); ++line) end = next_line(text, end);
  for (std::size_t at = end; at < text.size(); at = next_line(text, at)) {
    const std::size_t word = text.find_first_not_of(' ', at);
    if (word == std::string_view::npos) break;
    if (text[word] == '\n' || text[word] == '\r' || text[word] == '#') continue;
    if (word - at <= indent) break;
    end = next_line(text, at);
  }
  return end;
}

// The bracket that closes the flow map in which this place is.
std::size_t closing_bracket(std::string_view text, std::size_t at) {
  int depth = 0;
  while (at < text.size()) {
    const char c = text[at];
    // Elsewhere an apostrophe is one.
    const bool begins = std::string_view(" \t\n,:{[").find(text[at - 1]) != std::string_view::npos;
    if (begins && (c == '"' || c == '\'')) {
      at = end_of_quotes(text, at);
      continue;
    }
    if (begins && c == '#') {
      at = next_line(text, at);
      continue;
    }
    if (c == '{' || c == '[') ++depth;
    if ((c == '}' || c == ']') && depth-- == 0) break;
    ++at;
  }
  return at;
}

// The last entry of a flow map, with the comma before it.
Replacement last_flow_entry(std::string_view text, std::size_t key) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t closing = closing_bracket(text, key);
  const std::size_t end = text.find_last_not_of(kBlank, closing - 1) + 1;
  const std::size_t before = text.find_last_not_of(kBlank, key - 1);
  const bool has_comma = before != std::string_view::npos && text[before] == ',';
  const std::size_t begin = has_comma ? before : key;
  return {begin, end - begin, ""};
}

// The entry of the map's key at `place` among its keys.
std::optional<Replacement> entry_at(std::string_view text, const YamlNode& map, std::size_t place) {
  const auto offset = offset_of(text, map.keys[place].place, map.keys[place].text);
  if (!offset) return std::nullopt;
  if (map.flow) {
    if (place + 1 == map.keys.size()) return last_flow_entry(text, *offset);
    const YamlKey& next = map.keys[place + 1];
    const auto end = offset_of(text, next.place, next.text);
    return end ? std::optional(Replacement{*offset, *end - *offset, ""}) : std::nullopt;
  }
  const std::size_t line = text.rfind('\n', *offset) + 1;  // npos + 1 = 0
  const std::size_t end =
      end_of_block_entry(text, *offset, map.items[place], map.keys[place].place);
  return Replacement{line, end - line, ""};
}

Result<std::string> key_removed(std::string_view text, const std::vector<std::string>& path,
                                const std::string& key) {
  Result<YamlNode> root = parse_yaml_to_edit(text, "edited");
  if (!root) return fail(root);
  const YamlNode* map = map_at(*root, path);
  if (map == nullptr) return fail("no map to remove `" + key + "` from");
  const std::optional<std::size_t> index = index_of_key(*map, key);
  if (!index) return std::string(text);
  const std::optional<Replacement> cut = entry_at(text, *map, *index);
  std::string edited(text);
  if (cut) edited.erase(cut->begin, cut->length);
  // The result must be the former content without the key: the cut uses the text, not the tree.
  remove_from_tree(*root, path, 0, key);
  const Result<YamlNode> after = parse_yaml_to_edit(edited, "edited");
  if (cut && after && are_equal(*after, *root)) return edited;
  return fail("the key `" + key + "` cannot be removed from the file as it is laid out");
}

// --- lists ---

// Where in the text a value begins and ends: a scalar, quoted or not, or a list in brackets.
std::optional<Replacement> value_place(std::string_view text, const YamlNode& value) {
  if (value.kind == YamlNode::Kind::scalar && !value.quoted) {
    const auto at = offset_of(text, value.place, value.text);
    return at ? std::optional(Replacement{*at, value.text.size(), ""}) : std::nullopt;
  }
  const bool is_list = value.kind == YamlNode::Kind::sequence && value.flow;
  if (!is_list && !value.quoted) return std::nullopt;
  for (const char* opening : {"[", "\"", "'"}) {
    const auto at = offset_of(text, value.place, opening);
    if (!at || is_list != (*opening == '[')) continue;
    const std::size_t end = is_list ? closing_bracket(text, *at + 1) + 1 : end_of_quotes(text, *at);
    return Replacement{*at, end - *at, ""};
  }
  return std::nullopt;
}

// Where a map's last entry ends: in brackets with its value, else with its lines.
std::optional<std::size_t> end_of_map(std::string_view text, const YamlNode& map) {
  if (map.kind != YamlNode::Kind::map || map.keys.empty()) return std::nullopt;
  const auto key = offset_of(text, map.keys.back().place, map.keys.back().text);
  if (!key) return std::nullopt;
  if (!map.flow) {
    return end_of_block_entry(text, *key, map.items.back(), map.keys.back().place);
  }
  const auto value = value_place(text, map.items.back());
  return value ? std::optional(value->begin + value->length) : std::nullopt;
}

Result<void> add_item_edit(std::string_view text, const YamlNode& map, const YamlItemEdit& edit,
                           std::vector<Replacement>& all) {
  const std::string failure = fmt::format(
      "the entry on line {} cannot be changed as it is laid out: write it on one line, as {{ tag: "
      "000L, side: left, p: [0, 0, 0] }}",
      map.place.line);
  const auto end = end_of_map(text, map);
  if (!end) return fail(failure);
  const std::string indent(static_cast<std::size_t>(map.keys.front().place.column - 1), ' ');
  std::string added;
  for (const auto& [key, value] : edit.values) {
    const YamlNode* old = value_at(map, key);
    if (old == nullptr) {
      added += map.flow ? fmt::format(", {}: {}", key, value)
                        : fmt::format("{}{}: {}\n", indent, key, value);
      continue;
    }
    auto place = value_place(text, *old);
    if (!place) return fail(failure);
    place->text = value;
    all.push_back(std::move(*place));
  }
  const bool lacks_line_end = !map.flow && !added.empty() && text[*end - 1] != '\n';
  all.push_back({*end, 0, (lacks_line_end ? "\n" : "") + added});
  return {};
}

// Where the line `...` begins that ends the document (YAML 1.2.2, 9.1.2), else the text's end.
std::size_t end_of_document(std::string_view text) {
  constexpr std::string_view kMark = "\n...";
  for (std::size_t at = text.find(kMark); at != std::string_view::npos;
       at = text.find(kMark, at + 1)) {
    const std::size_t behind = at + kMark.size();
    if (behind == text.size() || std::isspace(static_cast<unsigned char>(text[behind])) != 0) {
      return at + 1;
    }
  }
  return text.size();
}

// Behind the last item of a list, in the same style; at the end of the text where there is no list.
Result<Replacement> items_appended(std::string_view text, const YamlNode* list,
                                   const std::string& name,
                                   const std::vector<std::string>& appended) {
  std::string lines;
  if (list == nullptr) {
    for (const std::string& item : appended) lines += "  - " + item + "\n";
    const std::size_t end = end_of_document(text);
    const bool ends_line = end == 0 || text[end - 1] == '\n';
    return Replacement{end, 0, (ends_line ? "" : "\n") + name + ":\n" + lines};
  }
  auto end = list->items.empty() ? std::nullopt : end_of_map(text, list->items.back());
  if (!end || list->flow) {
    return fail("the list `" + name +
                "` cannot be added to: write its items on lines of their own, after dashes, or "
                "remove it where it is empty");
  }
  if (list->items.back().flow) end = next_line(text, closing_bracket(text, *end));
  const auto first = offset_of(text, list->items.back().place, "");
  // The item's dash may stand on a line above its first key.
  std::size_t line = text.rfind('\n', *first) + 1;  // npos + 1 = 0
  std::size_t dash = text.find_first_not_of(' ', line);
  while (text[dash] != '-' && line > 0) {
    line = line < 2 ? 0 : text.rfind('\n', line - 2) + 1;
    dash = text.find_first_not_of(' ', line);
  }
  const std::string indent(dash - line, ' ');
  for (const std::string& item : appended) lines += fmt::format("{}- {}\n", indent, item);
  return Replacement{*end, 0, (text[*end - 1] == '\n' ? "" : "\n") + lines};
}

}  // namespace

Result<std::string> remove_yaml_keys(std::string_view text, const std::vector<std::string>& path,
                                     const std::vector<std::string>& keys) {
  Result<std::string> edited = std::string(text);
  for (const std::string& key : keys) {
    if (edited) edited = key_removed(*edited, path, key);
  }
  return edited;
}

Result<std::string> edit_yaml(std::string_view text, const std::vector<YamlEdit>& edits) {
  const Result<YamlNode> root = parse_yaml_to_edit(text, "edited");
  if (!root) return fail(root);
  std::vector<Replacement> all;
  for (const YamlEdit& edit : edits) {
    const auto some = replacements(text, *root, edit);
    if (!some) return fail(some);
    all.insert(all.end(), some->begin(), some->end());
  }
  return replaced(text, std::move(all));
}

Result<std::string> edit_yaml_list(std::string_view text, const std::string& list,
                                   const std::vector<YamlItemEdit>& edits,
                                   const std::vector<std::string>& appended) {
  const Result<YamlNode> root = parse_yaml_to_edit(text, "edited");
  if (!root) return fail(root);
  const YamlNode* items = value_at(*root, list);
  std::vector<Replacement> all;
  // First: where it coincides with an entry's end, that entry's new keys come before it.
  if (!appended.empty()) {
    auto added = items_appended(text, items, list, appended);
    if (!added) return fail(added);
    all.push_back(std::move(*added));
  }
  for (const YamlItemEdit& edit : edits) {
    const auto changed = add_item_edit(text, items->items[edit.item], edit, all);
    if (!changed) return fail(changed);
  }
  return replaced(text, std::move(all));
}

}  // namespace tagsmith::detail
