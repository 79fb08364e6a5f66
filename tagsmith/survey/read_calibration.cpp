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
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::uintmax_t kLargestFile = 8U << 20U;  // a calibration with all its image points
constexpr const char* kFormats =
    "OpenCV (camera_matrix, distortion_coefficients, image_width, image_height), ROS camera_info "
    "or "
    "a kalibr camchain";

// The value of a key, which the formats spell in several ways; its name is the key alone.
YamlValue find(const YamlValue& map, std::initializer_list<std::string_view> spellings) {
  YamlValue found{nullptr, "", map.log};
  for (std::size_t i = 0; i < map.node->keys.size(); ++i) {
    const YamlKey& key = map.node->keys[i];
    if (std::ranges::count(spellings, key.text) == 0) continue;
    if (found) {
      map.log->error(key.place, "duplicate-key", "`" + key.text + "` after `" + found.name + "`",
                     "keep one of the two");
      continue;
    }
    found.node = &map.node->items[i];
    found.name = key.text;
  }
  return found;
}

YamlValue need(const YamlValue& map, std::initializer_list<std::string_view> spellings) {
  YamlValue value = find(map, spellings);
  if (!value) {
    map.error("missing-key", "the key `" + std::string(*spellings.begin()) + "` is missing",
              "expected " + std::string(kFormats));
  }
  return value;
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
std::optional<std::vector<double>> read_matrix(const YamlValue& matrix) {
  if (!matrix) return std::nullopt;
  const bool is_map = matrix.is(YamlNode::Kind::map);
  const YamlValue data = is_map ? need(matrix, {"data"}) : matrix;
  if (!data || data.is(YamlNode::Kind::broken)) return std::nullopt;
  std::vector<const YamlNode*> nodes;
  if (!data.is(YamlNode::Kind::empty)) flatten(*data.node, nodes);
  if (is_map) {
    const auto size = [&](const char* key) {
      constexpr int kMost = 100;
      return read_integer({find(matrix, {key}).node, matrix.name + "." + key, matrix.log}, 0,
                          kMost);
    };
    const auto rows = size("rows");
    const auto columns = size("cols");
    if (rows && columns &&
        static_cast<std::size_t>(*rows) * static_cast<std::size_t>(*columns) != nodes.size()) {
      return data.error("wrong-length", fmt::format("{}.data has {} numbers, expected {} x {}",
                                                    matrix.name, nodes.size(), *rows, *columns));
    }
  }
  constexpr double kLargest = 1e9;
  std::vector<double> values;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto value = read_number({nodes[i], fmt::format("{}[{}]", matrix.name, i), matrix.log},
                                   between(-kLargest, kLargest, ""));
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

// --- intrinsics ---

bool set_intrinsics(Camera& camera, const std::vector<double>& fx_fy_cx_cy,
                    const YamlValue& stated) {
  camera.fx = fx_fy_cx_cy[0];
  camera.fy = fx_fy_cx_cy[1];
  camera.cx = fx_fy_cx_cy[2];
  camera.cy = fx_fy_cx_cy[3];
  const bool focal = camera.fx > 0 && camera.fy > 0 && camera.fx <= kLongestFocalPx &&
                     camera.fy <= kLongestFocalPx;
  const bool centre = std::abs(camera.cx) <= kMostPixels && std::abs(camera.cy) <= kMostPixels;
  if (focal && centre) return true;
  stated.error("out-of-range",
               stated.name + " says focal lengths of " + format_number(camera.fx) + " and " +
                   format_number(camera.fy) + " pixels and a principal point at (" +
                   format_number(camera.cx) + ", " + format_number(camera.cy) +
                   "), expected those of a camera",
               focal ? "" : "all zero is what a camera without calibration publishes");
  return false;
}

bool read_camera_matrix(Camera& camera, const YamlValue& matrix) {
  const auto k = read_matrix(matrix);
  if (!k) return false;
  if (k->size() != 9) {
    matrix.error("wrong-length",
                 fmt::format("{} has {} numbers, expected 3 x 3", matrix.name, k->size()));
    return false;
  }
  constexpr double kNothing = 1e-6;
  const bool is_pinhole = std::abs((*k)[1]) <= kNothing * std::abs((*k)[0]) && (*k)[3] == 0 &&
                          (*k)[6] == 0 && (*k)[7] == 0 &&
                          (std::abs((*k)[8] - 1) < kNothing || (*k)[0] == 0);
  if (!is_pinhole) {
    matrix.error("camera-matrix", matrix.name + " is not [fx, 0, cx; 0, fy, cy; 0, 0, 1]",
                 "skewed pixels are not supported; a transposed matrix must be turned");
    return false;
  }
  return set_intrinsics(camera, {(*k)[0], (*k)[4], (*k)[2], (*k)[5]}, matrix);
}

bool read_size(Camera& camera, const YamlValue& width, const YamlValue& height) {
  if (!width && !height) return true;
  if (!width || !height) {
    (width ? width : height)
        .error("missing-key", "the image's width or height is missing, expected both");
    return false;
  }
  const int most = static_cast<int>(kMostPixels);
  camera.width = read_integer(width, 1, most).value_or(0);
  camera.height = read_integer(height, 1, most).value_or(0);
  return camera.width > 0 && camera.height > 0;
}

// --- distortion ---

std::string name_of(LensModel model) {
  return model == LensModel::fisheye ? "fisheye" : "perspective";
}

// What the file says of its lens model; `by` is where.
struct StatedModel {
  std::optional<LensModel> model;
  YamlValue by;
};

// The model of `count` coefficients; nothing, with an error, when file and rig contradict each
// other or neither says what four coefficients are.
std::optional<LensModel> agreed_model(const StatedModel& stated, std::optional<LensModel> requested,
                                      std::size_t count) {
  if (stated.model && requested && *stated.model != *requested) {
    return stated.by.error("lens-model",
                           "the calibration is of a " + name_of(*stated.model) +
                               " lens, the rig says model: " + name_of(*requested),
                           "remove `model` from the rig's camera");
  }
  if (stated.model) return stated.model;
  if (requested) return requested;
  if (count != 4) return LensModel::perspective;
  return stated.by.error(
      "lens-model",
      "four distortion coefficients, which may be those of a perspective lens (k1, k2, p1, p2) or "
      "of a fisheye (k1 to k4)",
      "add `model: perspective` or `model: fisheye` to the rig's camera");
}

bool set_distortion(Camera& camera, LensModel model, std::vector<double> k,
                    const YamlValue& stated) {
  camera.lens = model;
  const bool is_fisheye = model == LensModel::fisheye;
  if (!is_fisheye && (k.size() == 12 || k.size() == 14)) {
    if (std::ranges::any_of(k.begin() + 8, k.end(), [](double value) { return value != 0; })) {
      stated.error("lens-model",
                   stated.name + " has thin-prism or tilt terms, which are not supported",
                   "calibrate without CALIB_THIN_PRISM_MODEL and CALIB_TILTED_MODEL");
      return false;
    }
    k.resize(8);
  }
  const bool of_model = k.size() == 4 || (!is_fisheye && (k.size() == 5 || k.size() == 8));
  if (!k.empty() && !of_model) {
    stated.error("wrong-length",
                 fmt::format("{} has {} coefficients, expected {}", stated.name, k.size(),
                             is_fisheye ? "4 of a fisheye" : "4, 5 or 8"));
    return false;
  }
  std::ranges::copy(k, camera.distortion.begin());
  return true;
}

bool read_distortion(Camera& camera, const YamlValue& coefficients, const StatedModel& stated,
                     const CalibrationRequest& request) {
  const auto k = read_matrix(coefficients);
  if (!k) return false;
  const auto model = agreed_model(stated, request.model, k->size());
  return model && set_distortion(camera, *model, *k, coefficients);
}

// --- OpenCV and ROS ---

// ROS names its models (sensor_msgs/distortion_models.hpp), OpenCV's sample program says whether it
// used the fisheye's. Nothing, with an error, for a model that is not supported.
std::optional<StatedModel> stated_model(const YamlValue& root, const YamlValue& distortion) {
  if (const YamlValue xi = find(root, {"xi"})) {  // OpenCV's omnidir module
    return xi.error(
        "lens-model",
        "xi: the calibration is of an omnidirectional lens (Mei), which is not supported",
        "calibrate with cv::fisheye, or with tagsmith calibrate");
  }
  if (const YamlValue name = find(root, {"distortion_model"})) {
    if (name.is(YamlNode::Kind::empty) || name.node->text.empty()) return StatedModel{{}, name};
    const auto word =
        read_choice(name, {"plumb_bob", "rational_polynomial", "equidistant", "fisheye"});
    if (!word) return std::nullopt;
    const bool is_fisheye = *word == "equidistant" || *word == "fisheye";
    return StatedModel{is_fisheye ? LensModel::fisheye : LensModel::perspective, name};
  }
  if (const YamlValue flag = find(root, {"fisheye_model"})) {
    const auto value = read_integer(flag, 0, 1);
    if (!value) return std::nullopt;
    return StatedModel{*value == 1 ? LensModel::fisheye : LensModel::perspective, flag};
  }
  return StatedModel{std::nullopt, distortion};
}

// A ROS message may say that its images are a part of the sensor or binned.
bool shows_whole_image(const YamlValue& root) {
  const auto number_of = [](const YamlValue& value) {
    return value ? parse_number(value.node->text).value_or(0) : 0;
  };
  const auto is_whole = [](bool whole, const YamlValue& value, const std::string& stated) {
    if (whole) return true;
    value.error("part-of-image", stated + ": the camera gives a part of its image",
                "calibrate with the images that the vehicle takes");
    return false;
  };
  const auto is_at_most = [&](const YamlValue& map, const char* key, double most) {
    const YamlValue value = find(map, {key});
    return is_whole(number_of(value) <= most, value,
                    value ? std::string(key) + " is " + value.node->text : "");
  };
  bool whole = is_at_most(root, "binning_x", 1) && is_at_most(root, "binning_y", 1);
  const YamlValue roi = find(root, {"roi"});
  if (!roi) return whole;
  whole = is_at_most(roi, "x_offset", 0) && is_at_most(roi, "y_offset", 0) && whole;
  // 0, and the full size, mean the whole image.
  const auto is_full = [&](const char* key) {
    const YamlValue value = find(roi, {key});
    const double part = number_of(value);
    const double all = number_of(find(root, {key}));
    return is_whole(!(part > 0 && all > 0 && part < all), value,
                    fmt::format("roi.{} is {} of {}", key, part, all));
  };
  return is_full("width") && is_full("height") && whole;
}

std::optional<Camera> read_matrices(const YamlValue& root, const CalibrationRequest& request) {
  if (!request.camera.empty()) {
    return root.error("one-camera",
                      "the file holds one camera, not one called `" + request.camera + "`",
                      "remove `camera` from the rig's `calibration`");
  }
  const YamlValue matrix = need(root, {"camera_matrix", "Camera_Matrix", "K", "k"});
  const YamlValue distortion =
      need(root, {"distortion_coefficients", "Distortion_Coefficients", "D", "d"});
  const YamlValue width = find(root, {"image_width", "image_Width", "width"});
  const YamlValue height = find(root, {"image_height", "image_Height", "height"});
  if (!matrix || !distortion || !shows_whole_image(root)) return std::nullopt;
  const auto stated = stated_model(root, distortion);
  Camera camera;
  const bool is_read = stated && read_camera_matrix(camera, matrix) &&
                       read_distortion(camera, distortion, *stated, request) &&
                       read_size(camera, width, height);
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

// Without a value where the file has no such camera, or several.
YamlValue choose_camera(const YamlValue& root, const std::vector<std::string>& names,
                        const CalibrationRequest& request) {
  if (request.camera.empty() && names.size() == 1) return find(root, {names.front()});
  if (std::ranges::count(names, request.camera) > 0) return find(root, {request.camera});
  if (request.camera.empty()) {
    root.error("several-cameras",
               "the file holds the cameras " + either_of(names) + ", expected to be told which",
               "write calibration: { file: " + request.file.filename().string() +
                   ", camera: " + names.front() + " } in the rig");
  } else {
    root.error("unknown-camera",
               "no camera `" + request.camera + "`, expected " + either_of(names));
  }
  return {};
}

std::optional<Camera> read_kalibr_camera(const YamlValue& entry,
                                         const CalibrationRequest& request) {
  Camera camera;
  const auto projection = read_choice(need(entry, {"camera_model"}), {"pinhole"});
  const YamlValue intrinsics = need(entry, {"intrinsics"});
  const auto model =
      read_choice(need(entry, {"distortion_model"}), {"radtan", "equidistant", "none"});
  const auto size = read_numbers(need(entry, {"resolution"}), 2, between(1, kMostPixels, "pixels"));
  if (!projection || !model || !size) return std::nullopt;
  camera.width = static_cast<int>((*size)[0]);
  camera.height = static_cast<int>((*size)[1]);
  const auto numbers =
      read_numbers(intrinsics, 4, between(-kLongestFocalPx, kLongestFocalPx, "pixels"));
  if (!numbers || !set_intrinsics(camera, *numbers, intrinsics)) return std::nullopt;
  const StatedModel stated{*model == "equidistant" ? LensModel::fisheye : LensModel::perspective,
                           entry};
  const bool is_read =
      *model == "none"
          ? agreed_model(stated, request.model, 0).has_value()
          : read_distortion(camera, need(entry, {"distortion_coeffs"}), stated, request);
  return is_read ? std::optional(camera) : std::nullopt;
}

std::optional<Camera> read_calibration_tree(const YamlValue& root,
                                            const CalibrationRequest& request) {
  if (!root.is(YamlNode::Kind::map)) {
    return root.error("unknown-format", "no map of keys, expected " + std::string(kFormats));
  }
  const std::vector<std::string> cameras = kalibr_cameras(*root.node);
  if (cameras.empty()) return read_matrices(root, request);
  const YamlValue camera = choose_camera(root, cameras, request);
  return camera ? read_kalibr_camera(camera, request) : std::nullopt;
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
  if (root) reading.value = read_calibration_tree({&*root, "", &log}, request);
  if (log.has_errors()) reading.value.reset();
  reading.diagnostics = log.sorted();
  return reading;
}

}  // namespace tagsmith::detail
