// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_rig.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/edit_yaml.hpp"
#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/read_intrinsics.hpp"
#include "tagsmith/survey/yaml_document.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {
namespace {

const YamlNode* value_at(const YamlNode& map, std::string_view key) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (map.keys[i].text == key) return &map.items[i];
  }
  return nullptr;
}

// The camera's map in the tree.
Result<const YamlNode*> camera_map(const YamlNode& root, const std::string& camera) {
  const YamlNode* cameras = value_at(root, "cameras");
  if (cameras == nullptr || cameras->kind != YamlNode::Kind::map) {
    return fail("the rig has no cameras");
  }
  const YamlNode* map = value_at(*cameras, camera);
  if (map != nullptr && map->kind == YamlNode::Kind::map) return map;
  std::vector<std::string> names;
  for (const YamlKey& key : cameras->keys) names.push_back(key.text);
  return fail("the rig has no camera `" + camera + "`, expected " + either_of(names));
}

// The keys that the calibration replaces. The image's size may stay: it must agree.
std::vector<std::string> replaced_keys() {
  std::vector<std::string> keys = intrinsics_keys();
  std::erase(keys, "image_size");
  return keys;
}

// The camera's `sigma` with the two values in it.
Result<std::string> with_sigma(const std::string& text, const std::vector<std::string>& path,
                               const YamlNode* sigma, const CalibratedIntrinsics& intrinsics) {
  if (sigma != nullptr && sigma->kind == YamlNode::Kind::map && !sigma->keys.empty()) {
    std::vector<std::string> inside = path;
    inside.emplace_back("sigma");
    return edit_yaml(text, {{inside, "focal", focal_value(intrinsics), ""},
                            {inside, "center", center_value(intrinsics), ""}});
  }
  const bool was_exact = sigma != nullptr && parse_number(sigma->text) == 0;
  const Result<std::string> without = remove_yaml_keys(text, path, {"sigma"});
  if (!without) return without;
  return edit_yaml(*without, {{path, "sigma",
                               fmt::format("{{ {}focal: {}, center: {} }}",
                                           was_exact ? "position: 0, angle: 0, edge: 0, " : "",
                                           focal_value(intrinsics), center_value(intrinsics)),
                               ""}});
}

}  // namespace

std::string calibration_value(const CalibratedIntrinsics& intrinsics) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._/";
  const bool is_plain = intrinsics.file.find_first_not_of(kPlain) == std::string::npos &&
                        !parse_number(intrinsics.file);
  if (is_plain) return intrinsics.file;
  std::string quoted = "\"";
  for (const char c : intrinsics.file) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

std::string focal_value(const CalibratedIntrinsics& intrinsics) {
  return fmt::format("{:.2g}", intrinsics.focal);
}

std::string center_value(const CalibratedIntrinsics& intrinsics) {
  return fmt::format("{:.2g}", intrinsics.center);
}

Result<std::string> rig_with_calibration(std::string_view rig_text, const std::string& camera,
                                         const CalibratedIntrinsics& intrinsics) {
  FindingLog log("the rig");
  const std::optional<YamlNode> root = parse_yaml(rig_text, log);
  if (!root) return fail(to_string(log.sorted(), true));
  const Result<const YamlNode*> map = camera_map(*root, camera);
  if (!map) return fail(map.error().message);
  const std::vector<std::string> path{"cameras", camera};
  const Result<std::string> without = remove_yaml_keys(rig_text, path, replaced_keys());
  if (!without) return without;
  const Result<std::string> with_file =
      edit_yaml(*without, {{path, "calibration", calibration_value(intrinsics), ""}});
  if (!with_file) return with_file;
  return with_sigma(*with_file, path, value_at(**map, "sigma"), intrinsics);
}

}  // namespace tagsmith::detail
