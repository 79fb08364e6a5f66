// SPDX-License-Identifier: Apache-2.0
// Changes of single keys in a YAML file that leave its layout and comments unchanged.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// `key: value` in the map that the path leads to. Where the map has no such key, it is put in the
// place of the key `instead_of`, or else becomes the map's first.
struct YamlEdit {
  std::vector<std::string> path;
  std::string key;
  std::string value;       // as YAML text
  std::string instead_of;  // may be empty
};

// The text with these changes. Fails when it is no YAML, a map is missing, or the value to be
// changed is no plain scalar.
Result<std::string> edit_yaml(std::string_view text, const std::vector<YamlEdit>& edits);

// The text without these keys of the map that the path leads to, whatever their values; keys that
// the map does not have are ignored. Comments on lines of their own stay. Fails when the text is no
// YAML, the map is missing, or a key cannot be cut out without changing anything else.
Result<std::string> remove_yaml_keys(std::string_view text, const std::vector<std::string>& path,
                                     const std::vector<std::string>& keys);

// Keys of one item, a map, of a list.
struct YamlItemEdit {
  std::size_t item = 0;
  std::vector<std::pair<std::string, std::string>> values;  // key and value, as YAML text
};

// The text with these values in the items of the list at its top (keys that an item does not have
// are put behind its last), and these maps, as YAML text, behind the last item; a list that is
// missing is put at the end. Comments stay where they are. Fails when the layout does not allow a
// list or value to be changed.
Result<std::string> edit_yaml_list(std::string_view text, const std::string& list,
                                   const std::vector<YamlItemEdit>& edits,
                                   const std::vector<std::string>& appended);

}  // namespace tagsmith::detail
