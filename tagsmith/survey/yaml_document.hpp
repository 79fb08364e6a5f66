// SPDX-License-Identifier: Apache-2.0
// YAML text as a tree with places. Internal to tagsmith/survey: yaml-cpp appears nowhere else.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/finding_log.hpp"

namespace tagsmith::detail {

// A key of a map, as written.
struct YamlKey {
  std::string text;
  Place place;
};

struct YamlNode {
  // `broken` = a finding was logged about it already; functions that read it add none.
  enum class Kind { empty, scalar, sequence, map, broken };

  Kind kind = Kind::empty;
  bool quoted = false;            // a scalar in quotes is text, whatever it looks like
  bool flow = false;              // a sequence or map in brackets
  Place place;                    // of a block map, sequence or nothing under a key: the key's
  std::string text{};             // of a scalar
  std::vector<YamlKey> keys{};    // of a map
  std::vector<YamlNode> items{};  // of a sequence; of a map, the values of `keys` one by one
};

// The text's one document. Nothing when it has no usable tree; why is in the log: syntax, not
// UTF-8, empty, several documents, nested deeper than 32, more than four million values. Aliases,
// merge keys and explicit tags other than `known_tag` are logged as errors and leave a broken node.
std::optional<YamlNode> parse_yaml(std::string_view text, FindingLog& log,
                                   std::string_view known_tag = {});

// The tree of text that this program is to change; fails with all that is wrong with it. `name`:
// what the text is, for the message.
Result<YamlNode> parse_yaml_to_edit(std::string_view text, const std::string& name);

// The place of a key among those of a map; nothing where it has no such key.
std::optional<std::size_t> index_of_key(const YamlNode& map, std::string_view key);

// The value of a map's key; null where it has no such key.
const YamlNode* value_at(const YamlNode& map, std::string_view key);

// Where the next line begins; the text's end behind the last one.
std::size_t next_line(std::string_view text, std::size_t at);

// Where the line of this number begins, counted from 1.
std::size_t start_of_line(std::string_view text, int line);

// One beyond the closing quote of the quoted text that begins here; without one the text's end.
std::size_t end_of_quotes(std::string_view text, std::size_t quote);

// Logs the first byte that is no UTF-8 text; true when there is none.
bool check_utf8(std::string_view text, FindingLog& log);

}  // namespace tagsmith::detail
