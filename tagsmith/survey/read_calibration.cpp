// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/limits.hpp"
#include "tagsmith/survey/xml_document.hpp"
#include "tagsmith/survey/yaml_document.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::uintmax_t kLargestFile = 8U << 20U;  // a calibration with all its image points
constexpr const char* kFormats =
    "OpenCV (camera_matrix, distortion_coefficients, image_width, image_height), ROS camera_info "
    "or "
    "a kalibr camchain";

// A key of the file and its value; the formats spell one key in several ways.
struct Entry {
  std::string key;
  const YamlNode* value = nullptr;

  explicit operator bool() const { return value != nullptr; }
};

Entry find(const YamlNode& map, std::initializer_list<std::string_view> spellings,
           FindingLog& log) {
  Entry found;
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    const YamlKey& key = map.keys[i];
    if (std::ranges::count(spellings, key.text) == 0) continue;
    if (found) {
      log.error(key.place, "duplicate-key", "`" + key.text + "` after `" + found.key + "`",
                "keep one of the two");
      continue;
    }
    found = {key.text, &map.items[i]};
  }
  return found;
}

const YamlNode* value_at(const YamlNode& map, std::string_view key, FindingLog& log) {
  return find(map, {key}, log).value;
}

Entry need(const YamlNode& map, std::initializer_list<std::string_view> spellings,
           FindingLog& log) {
  Entry entry = find(map, spellings, log);
  if (!entry) {
    log.error(map.place, "missing-key",
              "the key `" + std::string(*spellings.begin()) + "` is missing",
              "expected " + std::string(kFormats));
  }
  return entry;
}

// --- matrices ---

void flatten(const YamlNode& node, std::vector<const YamlNode*>& numbers) {
  if (node.kind != YamlNode::Kind::sequence) {
    numbers.push_back(&node);
    return;
  }
  for (const YamlNode& item : node.items) flatten(item, numbers);
}

// The numbers of a matrix, row by row: a map with `data` (OpenCV's and ROS's, with `rows` and
// `cols`) or a list, plain or of rows.
std::optional<std::vector<double>> read_matrix(const Entry& entry, FindingLog& log) {
  if (!entry) return std::nullopt;
  const YamlNode* data = entry.value;
  if (data->kind == YamlNode::Kind::map) data = need(*data, {"data"}, log).value;
  if (data == nullptr || data->kind == YamlNode::Kind::broken) return std::nullopt;
  std::vector<const YamlNode*> nodes;
  if (data->kind != YamlNode::Kind::empty) flatten(*data, nodes);
  if (entry.value->kind == YamlNode::Kind::map) {
    constexpr int kMost = 100;
    const auto rows =
        read_integer(value_at(*entry.value, "rows", log), entry.key + ".rows", 0, kMost, log);
    const auto columns =
        read_integer(value_at(*entry.value, "cols", log), entry.key + ".cols", 0, kMost, log);
    if (rows && columns &&
        static_cast<std::size_t>(*rows) * static_cast<std::size_t>(*columns) != nodes.size()) {
      log.error(data->place, "wrong-length",
                entry.key + ".data has " + std::to_string(nodes.size()) + " numbers, expected " +
                    std::to_string(*rows) + " x " + std::to_string(*columns));
      return std::nullopt;
    }
  }
  constexpr double kLargest = 1e9;
  std::vector<double> values;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto value = read_number(nodes[i], entry.key + "[" + std::to_string(i) + "]",
                                   between(-kLargest, kLargest, ""), log);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

// --- intrinsics ---

bool set_intrinsics(Camera& camera, const std::vector<double>& fx_fy_cx_cy, const Entry& entry,
                    FindingLog& log) {
  camera.fx = fx_fy_cx_cy[0];
  camera.fy = fx_fy_cx_cy[1];
  camera.cx = fx_fy_cx_cy[2];
  camera.cy = fx_fy_cx_cy[3];
  const bool focal = camera.fx > 0 && camera.fy > 0 && camera.fx <= kLongestFocalPx &&
                     camera.fy <= kLongestFocalPx;
  const bool centre = std::abs(camera.cx) <= kMostPixels && std::abs(camera.cy) <= kMostPixels;
  if (focal && centre) return true;
  log.error(entry.value->place, "out-of-range",
            entry.key + " says focal lengths of " + format_number(camera.fx) + " and " +
                format_number(camera.fy) + " pixels and a principal point at (" +
                format_number(camera.cx) + ", " + format_number(camera.cy) +
                "), expected those of a camera",
            focal ? "" : "all zero is what a camera without calibration publishes");
  return false;
}

bool read_camera_matrix(Camera& camera, const Entry& entry, FindingLog& log) {
  const auto k = read_matrix(entry, log);
  if (!k) return false;
  if (k->size() != 9) {
    log.error(entry.value->place, "wrong-length",
              entry.key + " has " + std::to_string(k->size()) + " numbers, expected 3 x 3");
    return false;
  }
  constexpr double kNothing = 1e-6;
  const bool is_pinhole = std::abs((*k)[1]) <= kNothing * std::abs((*k)[0]) && (*k)[3] == 0 &&
                          (*k)[6] == 0 && (*k)[7] == 0 &&
                          (std::abs((*k)[8] - 1) < kNothing || (*k)[0] == 0);
  if (!is_pinhole) {
    log.error(entry.value->place, "camera-matrix",
              entry.key + " is not [fx, 0, cx; 0, fy, cy; 0, 0, 1]",
              "skewed pixels are not supported; a transposed matrix must be turned");
    return false;
  }
  return set_intrinsics(camera, {(*k)[0], (*k)[4], (*k)[2], (*k)[5]}, entry, log);
}

bool read_size(Camera& camera, const Entry& width, const Entry& height, FindingLog& log) {
  if (!width && !height) return true;
  if (!width || !height) {
    log.error((width ? width : height).value->place, "missing-key",
              "the image's width or height is missing, expected both");
    return false;
  }
  const int most = static_cast<int>(kMostPixels);
  camera.width = read_integer(width.value, width.key, 1, most, log).value_or(0);
  camera.height = read_integer(height.value, height.key, 1, most, log).value_or(0);
  return camera.width > 0 && camera.height > 0;
}

// --- distortion ---

std::string name_of(LensModel model) {
  return model == LensModel::fisheye ? "fisheye" : "perspective";
}

// What the file says of its lens model; `place` is where.
struct StatedModel {
  std::optional<LensModel> model;
  Place place;
};

// The model of `count` coefficients; nothing, with an error, when file and rig contradict each
// other or neither says what four coefficients are.
std::optional<LensModel> agreed_model(const StatedModel& stated, std::optional<LensModel> requested,
                                      std::size_t count, FindingLog& log) {
  if (stated.model && requested && *stated.model != *requested) {
    log.error(stated.place, "lens-model",
              "the calibration is of a " + name_of(*stated.model) +
                  " lens, the rig says model: " + name_of(*requested),
              "remove `model` from the rig's camera");
    return std::nullopt;
  }
  if (stated.model) return stated.model;
  if (requested) return requested;
  if (count != 4) return LensModel::perspective;
  log.error(stated.place, "lens-model",
            "four distortion coefficients, which may be those of a perspective lens (k1, k2, p1, "
            "p2) or of a fisheye (k1 to k4)",
            "add `model: perspective` or `model: fisheye` to the rig's camera");
  return std::nullopt;
}

bool fail_on_count(const Entry& entry, std::size_t count, LensModel model, FindingLog& log) {
  log.error(entry.value->place, "wrong-length",
            entry.key + " has " + std::to_string(count) + " coefficients, expected " +
                (model == LensModel::fisheye ? "4 of a fisheye" : "4, 5 or 8"));
  return false;
}

bool set_distortion(Camera& camera, LensModel model, std::vector<double> k, const Entry& entry,
                    FindingLog& log) {
  camera.lens = model;
  if (k.empty()) return true;
  const std::size_t count = k.size();
  if (model == LensModel::fisheye) {
    if (count != 4) return fail_on_count(entry, count, model, log);
  } else if (count == 12 || count == 14) {
    if (std::ranges::any_of(k.begin() + 8, k.end(), [](double value) { return value != 0; })) {
      log.error(entry.value->place, "lens-model",
                entry.key + " has thin-prism or tilt terms, which are not supported",
                "calibrate without CALIB_THIN_PRISM_MODEL and CALIB_TILTED_MODEL");
      return false;
    }
    k.resize(8);
  } else if (count != 4 && count != 5 && count != 8) {
    return fail_on_count(entry, count, model, log);
  }
  std::ranges::copy(k, camera.distortion.begin());
  return true;
}

bool read_distortion(Camera& camera, const Entry& entry, const StatedModel& stated,
                     const CalibrationRequest& request, FindingLog& log) {
  const auto k = read_matrix(entry, log);
  if (!k) return false;
  const auto model = agreed_model(stated, request.model, k->size(), log);
  return model && set_distortion(camera, *model, *k, entry, log);
}

// --- OpenCV and ROS ---

// ROS names its models (sensor_msgs/distortion_models.hpp), OpenCV's sample program says whether it
// used the fisheye's. Nothing, with an error, for a model that is not supported.
std::optional<StatedModel> stated_model(const YamlNode& root, const Entry& distortion,
                                        FindingLog& log) {
  if (const YamlNode* xi = value_at(root, "xi", log)) {  // OpenCV's omnidir module
    log.error(xi->place, "lens-model",
              "xi: the calibration is of an omnidirectional lens (Mei), which is not supported",
              "calibrate with cv::fisheye, or with tagsmith calibrate");
    return std::nullopt;
  }
  StatedModel stated{std::nullopt, distortion.value->place};
  if (const YamlNode* name = value_at(root, "distortion_model", log)) {
    stated.place = name->place;
    if (name->kind == YamlNode::Kind::empty || name->text.empty()) return stated;
    const auto word =
        read_choice(name, "distortion_model",
                    {"plumb_bob", "rational_polynomial", "equidistant", "fisheye"}, log);
    if (!word) return std::nullopt;
    const bool is_fisheye = *word == "equidistant" || *word == "fisheye";
    stated.model = is_fisheye ? LensModel::fisheye : LensModel::perspective;
  } else if (const YamlNode* flag = value_at(root, "fisheye_model", log)) {
    stated.place = flag->place;
    const auto value = read_integer(flag, "fisheye_model", 0, 1, log);
    if (!value) return std::nullopt;
    stated.model = *value == 1 ? LensModel::fisheye : LensModel::perspective;
  }
  return stated;
}

// A ROS message may say that its images are a part of the sensor or binned.
bool shows_whole_image(const YamlNode& root, FindingLog& log) {
  const auto check = [&](const YamlNode& map, const char* key, double most) {
    const YamlNode* node = value_at(map, key, log);
    const auto value = node != nullptr ? parse_number(node->text) : std::nullopt;
    if (!value || *value <= most) return true;
    log.error(node->place, "part-of-image",
              std::string(key) + " is " + node->text + ": the camera gives a part of its image",
              "calibrate with the images that the vehicle takes");
    return false;
  };
  bool whole = check(root, "binning_x", 1) && check(root, "binning_y", 1);
  if (const YamlNode* roi = value_at(root, "roi", log)) {
    whole = check(*roi, "x_offset", 0) && check(*roi, "y_offset", 0) && whole;
    const auto pixels = [&](const YamlNode& map, const char* key) {
      const YamlNode* node = value_at(map, key, log);
      return node != nullptr ? parse_number(node->text).value_or(0) : 0;
    };
    // 0, and the full size, mean the whole image.
    const auto is_part = [&](const char* key) {
      const double part = pixels(*roi, key);
      const double all = pixels(root, key);
      if (!(part > 0 && all > 0 && part < all)) return false;
      log.error(
          value_at(*roi, key, log)->place, "part-of-image",
          fmt::format("roi.{} is {} of {}: the camera gives a part of its image", key, part, all),
          "calibrate with the images that the vehicle takes");
      return true;
    };
    if (is_part("width") || is_part("height")) whole = false;
  }
  return whole;
}

std::optional<Camera> read_matrices(const YamlNode& root, const CalibrationRequest& request,
                                    FindingLog& log) {
  if (!request.camera.empty()) {
    log.error(root.place, "one-camera",
              "the file holds one camera, not one called `" + request.camera + "`",
              "remove `camera` from the rig's `calibration`");
    return std::nullopt;
  }
  const Entry matrix = need(root, {"camera_matrix", "Camera_Matrix", "K", "k"}, log);
  const Entry distortion =
      need(root, {"distortion_coefficients", "Distortion_Coefficients", "D", "d"}, log);
  const Entry width = find(root, {"image_width", "image_Width", "width"}, log);
  const Entry height = find(root, {"image_height", "image_Height", "height"}, log);
  if (!matrix || !distortion || !shows_whole_image(root, log)) return std::nullopt;
  const auto stated = stated_model(root, distortion, log);
  Camera camera;
  const bool is_read = stated && read_camera_matrix(camera, matrix, log) &&
                       read_distortion(camera, distortion, *stated, request, log) &&
                       read_size(camera, width, height, log);
  return is_read ? std::optional(camera) : std::nullopt;
}

// --- kalibr ---

bool is_kalibr_camera(const YamlNode& node) {
  return node.kind == YamlNode::Kind::map &&
         std::ranges::count(node.keys, "intrinsics", &YamlKey::text) > 0;
}

std::vector<std::string> kalibr_cameras(const YamlNode& root) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < root.keys.size(); ++i) {
    if (is_kalibr_camera(root.items[i])) names.push_back(root.keys[i].text);
  }
  return names;
}

const YamlNode* choose_camera(const YamlNode& root, const std::vector<std::string>& names,
                              const CalibrationRequest& request, FindingLog& log) {
  if (request.camera.empty() && names.size() == 1) return value_at(root, names.front(), log);
  if (request.camera.empty()) {
    log.error(root.place, "several-cameras",
              "the file holds the cameras " + either_of(names) + ", expected to be told which",
              "write calibration: { file: " + request.file.filename().string() +
                  ", camera: " + names.front() + " } in the rig");
    return nullptr;
  }
  if (std::ranges::count(names, request.camera) > 0) return value_at(root, request.camera, log);
  log.error(root.place, "unknown-camera",
            "no camera `" + request.camera + "`, expected " + either_of(names));
  return nullptr;
}

std::optional<Camera> read_kalibr_camera(const YamlNode& node, const CalibrationRequest& request,
                                         FindingLog& log) {
  Camera camera;
  const auto projection =
      read_choice(need(node, {"camera_model"}, log).value, "camera_model", {"pinhole"}, log);
  const Entry intrinsics = need(node, {"intrinsics"}, log);
  const auto model = read_choice(need(node, {"distortion_model"}, log).value, "distortion_model",
                                 {"radtan", "equidistant", "none"}, log);
  const auto size = read_numbers(need(node, {"resolution"}, log).value, "resolution", 2,
                                 between(1, kMostPixels, "pixels"), log);
  if (!projection || !model || !size) return std::nullopt;
  camera.width = static_cast<int>((*size)[0]);
  camera.height = static_cast<int>((*size)[1]);
  const auto numbers = read_numbers(intrinsics.value, intrinsics.key, 4,
                                    between(-kLongestFocalPx, kLongestFocalPx, "pixels"), log);
  if (!numbers || !set_intrinsics(camera, *numbers, intrinsics, log)) return std::nullopt;
  const StatedModel stated{*model == "equidistant" ? LensModel::fisheye : LensModel::perspective,
                           node.place};
  if (*model == "none")
    return agreed_model(stated, request.model, 0, log) ? std::optional(camera) : std::nullopt;
  const Entry coefficients = need(node, {"distortion_coeffs"}, log);
  if (!coefficients || !read_distortion(camera, coefficients, stated, request, log)) {
    return std::nullopt;
  }
  return camera;
}

std::optional<Camera> read_calibration_tree(const YamlNode& root, const CalibrationRequest& request,
                                            FindingLog& log) {
  if (root.kind != YamlNode::Kind::map) {
    log.error(root.place, "unknown-format", "no map of keys, expected " + std::string(kFormats));
    return std::nullopt;
  }
  const std::vector<std::string> cameras = kalibr_cameras(root);
  if (cameras.empty()) return read_matrices(root, request, log);
  const YamlNode* node = choose_camera(root, cameras, request, log);
  return node != nullptr ? read_kalibr_camera(*node, request, log) : std::nullopt;
}

// OpenCV begins with `%YAML:1.0`, which is no YAML directive, and a printed ROS message ends with
// the mark of a next document.
std::string plain_yaml(std::string text) {
  if (text.starts_with("%YAML")) text.front() = '#';
  const std::size_t end = text.find_last_not_of(" \t\r\n");
  if (end != std::string::npos && text.substr(0, end + 1).ends_with("\n---")) {
    text.resize(end + 1 - 3);
  }
  return text;
}

}  // namespace

// Why: docs/decisions/0015-files-and-ledger.md.
Result<Diagnosed<Camera>> read_calibration(const CalibrationRequest& request) {
  Result<std::string> text = read_file(request.file, kLargestFile);
  if (!text) return fail(text);
  FindingLog log(request.file.string());
  const std::size_t start = std::min(text->find_first_not_of(" \t\r\n\xEF\xBB\xBF"), text->size());
  const bool is_xml = std::string_view(*text).substr(start).starts_with('<');
  const std::optional<YamlNode> root =
      is_xml ? parse_xml(*text, log)
             : parse_yaml(plain_yaml(std::move(*text)), log, "tag:yaml.org,2002:opencv-matrix");
  Diagnosed<Camera> reading;
  if (root) reading.value = read_calibration_tree(*root, request, log);
  if (log.has_errors()) reading.value.reset();
  reading.diagnostics = log.sorted();
  return reading;
}

}  // namespace tagsmith::detail
