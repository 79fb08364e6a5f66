// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/yaml_file.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace tagsmith::detail {
namespace {

struct FileKind {
  std::string_view key;
  std::string_view name;
  std::string_view where;  // it belongs
};

constexpr std::array kFileKinds{
    FileKind{"board", "a calibration board", "boards belong to photos that calibrate a camera"},
    FileKind{"survey", "a survey", "pass surveys as the argument SURVEY"},
    FileKind{"printer", "a printer's profile", "pass profiles to print with --profile"},
    FileKind{"rig", "a rig", "pass rigs with --rig"},
    FileKind{"tag", "a template",
             "templates are named in surveys, at tags.template; `validate --template` checks them"},
};

}  // namespace

bool is_other_kind(const YamlNode& root, std::string_view key, FindingLog& log) {
  if (root.kind != YamlNode::Kind::map || index_of_key(root, key)) return false;
  const auto other = std::ranges::find_if(
      kFileKinds, [&](const FileKind& kind) { return index_of_key(root, kind.key).has_value(); });
  if (other == kFileKinds.end()) return false;
  const auto wanted = std::ranges::find(kFileKinds, key, &FileKind::key);
  log.error(root.place, "wrong-kind",
            "the file is " + std::string(other->name) + ", expected " + std::string(wanted->name),
            std::string(other->where));
  return true;
}

}  // namespace tagsmith::detail
