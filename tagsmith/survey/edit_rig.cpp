// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_rig.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/as_built_place.hpp"
#include "tagsmith/survey/edit_yaml.hpp"
#include "tagsmith/survey/read_intrinsics.hpp"
#include "tagsmith/survey/yaml_document.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {
namespace {

// The camera's map in the rig file's text.
Result<YamlNode> camera_map(std::string_view rig_text, const std::string& camera) {
  const Result<YamlNode> root = parse_yaml_to_edit(rig_text, "the rig");
  if (!root) return fail(root);
  const YamlNode* cameras = value_at(*root, "cameras");
  if (cameras == nullptr || cameras->kind != YamlNode::Kind::map) {
    return fail("the rig has no cameras");
  }
  const YamlNode* map = value_at(*cameras, camera);
  if (map != nullptr && map->kind == YamlNode::Kind::map) return *map;
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

// A part of a camera's `sigma`.
struct SigmaPart {
  std::string key;
  std::string value;
};

// The camera's `sigma` with these parts in it. Where everything was exact, parts that are not among
// them stay exact.
Result<std::string> with_sigma(const std::string& text, const std::vector<std::string>& path,
                               const YamlNode* sigma, const std::vector<SigmaPart>& parts) {
  if (sigma != nullptr && sigma->kind == YamlNode::Kind::map && !sigma->keys.empty()) {
    std::vector<std::string> inside = path;
    inside.emplace_back("sigma");
    std::vector<YamlEdit> edits;
    for (const SigmaPart& part : parts) edits.push_back({inside, part.key, part.value, ""});
    return edit_yaml(text, edits);
  }
  std::string value;
  if (sigma != nullptr && parse_number(sigma->text) == 0) {
    for (const char* key : {"position", "angle", "focal", "center", "edge"}) {
      if (std::ranges::find(parts, key, &SigmaPart::key) == parts.end()) {
        value += fmt::format("{}: 0, ", key);
      }
    }
  }
  for (const SigmaPart& part : parts) value += fmt::format("{}: {}, ", part.key, part.value);
  value.resize(value.size() - 2);
  Result<std::string> without = remove_yaml_keys(text, path, {"sigma"});
  if (!without) return without;
  return edit_yaml(*without, {{path, "sigma", "{ " + value + " }", ""}});
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
  const Result<YamlNode> map = camera_map(rig_text, camera);
  if (!map) return fail(map);
  const std::vector<std::string> path{"cameras", camera};
  Result<std::string> without = remove_yaml_keys(rig_text, path, replaced_keys());
  if (!without) return without;
  Result<std::string> with_file =
      edit_yaml(*without, {{path, "calibration", calibration_value(intrinsics), ""}});
  if (!with_file) return with_file;
  return with_sigma(*with_file, path, value_at(*map, "sigma"),
                    {{"focal", focal_value(intrinsics)}, {"center", center_value(intrinsics)}});
}

Result<std::string> rig_with_mounting(std::string_view rig_text, const std::string& camera,
                                      const CalibratedMounting& mounting) {
  const Result<YamlNode> map = camera_map(rig_text, camera);
  if (!map) return fail(map);
  const std::vector<std::string> path{"cameras", camera};
  Result<std::string> without =
      remove_yaml_keys(rig_text, path, {"alpha", "yaw", "pitch", "roll", "position"});
  if (!without) return without;
  // The last becomes the first.
  std::vector<YamlEdit> edits;
  const Eigen::Vector3d& at = mounting.position;
  constexpr double kRounding = 5e-5;  // metres
  if (at.cwiseAbs().maxCoeff() >= kRounding) {
    edits.push_back({path, "position", point_text(at), ""});
  }
  const auto& [yaw, pitch, roll] = mounting.angles;
  edits.push_back({path, "roll", rounded_text(degrees(roll), 3), ""});
  edits.push_back({path, "pitch", rounded_text(degrees(pitch), 3), ""});
  edits.push_back({path, "yaw", rounded_text(degrees(yaw), 3), ""});
  Result<std::string> with_angles = edit_yaml(*without, edits);
  if (!with_angles) return with_angles;
  std::vector<SigmaPart> sigmas;
  if (mounting.position_sigma > 0) {
    sigmas.push_back({"position", fmt::format("{:.2g}", mounting.position_sigma)});
  }
  sigmas.push_back({"angle", fmt::format("{:.2g}", degrees(mounting.angle_sigma))});
  return with_sigma(*with_angles, path, value_at(*map, "sigma"), sigmas);
}

}  // namespace tagsmith::detail
