// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/read_intrinsics.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/yaml_file.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

constexpr double kLargestVehicle = 100.0;     // metres
constexpr double kDefaultHeightSigma = 0.05;  // metres: likewise, and how far wheels sink in
constexpr double kDefaultAttitude = 2.0;      // degrees: of a crawler on an undulating floor

// With a hint the key is required.
std::optional<Side> read_side(const MapReader& map, std::string_view key,
                              const std::string& hint = {}) {
  const auto side = map.choice(key, {"left", "right"}, hint);
  if (!side) return std::nullopt;
  return *side == "left" ? Side::left : Side::right;
}

// Mounting by alpha and side (Xu et al. 2017, Fig 11), or by yaw, pitch and roll.
Pose read_mounting(const MapReader& map, std::optional<Side> side) {
  const Eigen::Vector3d position =
      read_point(map.at("position"), kLargestVehicle).value_or(Eigen::Vector3d(0, 0, 0));
  for (const char* key : {"yaw", "pitch", "roll"}) map.exclude_each_other({"alpha", key});
  if (map.has("alpha")) {
    const double alpha = map.number_or("alpha", 0, between(-90, 90, "degrees"));
    map.need("side", "side: left or side: right, the wall that the camera looks at");
    Pose pose = vehicle_from_side_camera(side.value_or(Side::left), radians(alpha));
    pose.translation = position;
    return pose;
  }
  const NumberRange turn = between(-360, 360, "degrees");
  const double yaw = map.number("yaw", turn, "alpha and side, or yaw, pitch, roll").value_or(0);
  return vehicle_from_camera(radians(yaw), radians(map.number_or("pitch", 0, turn)),
                             radians(map.number_or("roll", 0, turn)), position);
}

const char* source_text(IntrinsicsSource source) {
  switch (source) {
    case IntrinsicsSource::data_sheet:
      return " (by data sheet)";
    case IntrinsicsSource::numbers:
      return " (by fx, fy, cx, cy)";
    default:
      return " (by calibration file)";
  }
}

// `sigma: 0` of a camera makes all its parts exact; no other number may replace all of them.
void check_exact(const YamlValue& value) {
  if (!value.node->quoted && parse_number(value.node->text) == 0) return;
  value.error(
      "wrong-type",
      value.name + " is `" + value.node->text.substr(0, 60) +
          "`, expected 0 (all exact), or a map with position, angle, focal, center, distortion, "
          "edge");
}

// The camera's `sigma`; for parts that are left out the usual values are assumed.
void read_calibration_sigma(const MapReader& keys, RigCamera& camera) {
  const YamlValue sigma = keys.at("sigma");
  if (sigma.is(YamlNode::Kind::scalar)) return check_exact(sigma);
  const IntrinsicsSource source = intrinsics_source(keys);
  const CalibrationSigma usual = usual_calibration(source, camera.camera);
  const MapReader map(sigma, {"position", "angle", "focal", "center", "distortion", "edge"});
  std::vector<std::string> unsaid;
  const auto part = [&](const char* key, double value, double most, const char* unit,
                        const std::string& words) {
    if (!map.has(key)) unsaid.push_back(std::string(key) + " " + words);
    return map.number_or(key, value, between(0, most, unit));
  };
  const double angle = degrees(usual.angle);
  const double edge = part("edge", usual.edge, 10, "pixels", format_number(usual.edge) + " pixels");
  camera.calibration_sigma = {
      .position =
          part("position", usual.position, 1, "m", format_number(1000 * usual.position) + " mm"),
      .angle = radians(part("angle", angle, 10, "degrees", format_number(angle) + " degrees")),
      .focal = part("focal", usual.focal, 0.1, "", format_number(100 * usual.focal) + " %"),
      .center =
          part("center", usual.center, 100, "pixels", format_number(usual.center) + " pixels"),
      .edge = edge};
  // Who states how well the focal length is known has more than a data sheet.
  const bool by_sheet = source == IntrinsicsSource::data_sheet && !map.has("focal");
  const double distortion =
      by_sheet || map.has("distortion")
          ? part("distortion", kUsualDistortion, 0.5, "",
                 format_number(100 * kUsualDistortion) + " % at the image's corners")
          : 0;
  camera.calibration_sigma.radial = radial_by_corners(distortion, camera.camera);
  camera.assumed_sigma = fmt::format("{}", fmt::join(unsaid, ", "));
  if (!map.has("focal") || !map.has("center")) camera.assumed_sigma += source_text(source);
}

// The sizes of a data sheet that are not stated as exact give one focal length, the mean of those
// across and down: between the two a position would be centimetres off.
void take_square_pixels(const MapReader& keys, RigCamera& camera) {
  Camera& lens = camera.camera;
  if (intrinsics_source(keys) != IntrinsicsSource::data_sheet) return;
  if (camera.calibration_sigma.focal == 0 || lens.fy == 0) return;
  if (std::abs(lens.fx / lens.fy - 1) > kSquarePixels) return;
  lens.fx = lens.fy = std::sqrt(lens.fx * lens.fy);
}

// Depth of field: a focus has no meaning without the lens opening, nor the reverse.
void read_focus(const MapReader& map, RigCamera& camera) {
  camera.focus = map.number_if_there("focus", above_zero(10'000, "m"));
  const auto aperture = map.number_if_there("aperture_mm", above_zero(1000, "mm"));
  if (aperture) camera.aperture = *aperture / 1000;
  if (map.has("focus") == map.has("aperture_mm")) return;
  map.need(map.has("focus") ? "aperture_mm" : "focus",
           "focus (m) and aperture_mm (focal length / f-number) belong together");
}

// Warns of a side that contradicts the camera's name or where it looks.
void lint_side(const MapReader& map, const RigCamera& camera) {
  if (!camera.side) return;
  const Side other = *camera.side == Side::left ? Side::right : Side::left;
  const double leftwards = camera.vehicle_from_camera.rotation(1, 2);  // of its axis
  const auto warn = [&](const std::string& what, const char* hint) {
    map.at("side").warning(
        "camera-side",
        fmt::format("camera {} {}, its side is {}", camera.name, what, to_string(*camera.side)),
        hint);
  };
  if (camera.name == to_string(other)) {
    warn("is named after the other wall", "exchange the sides or the names");
  } else if (leftwards * (*camera.side == Side::left ? 1 : -1) < -0.01) {
    warn(fmt::format("looks to the {}", to_string(other)), "yaw is positive to the left");
  }
}

// Warns of a camera beside the vehicle's middle (metres aside) that looks over the middle before or
// behind itself within a vehicle's length: through the vehicle.
void lint_position(const MapReader& map, const RigCamera& camera) {
  constexpr double kAside = 0.2, kAlong = 2;
  const double aside = camera.vehicle_from_camera.translation.y();
  const Eigen::Vector3d look = camera.vehicle_from_camera.rotation.col(2);
  if (std::abs(aside) <= kAside || aside * look.y() >= 0 ||
      std::abs(look.x() * aside) >= kAlong * std::abs(look.y())) {
    return;
  }
  map.at("position")
      .warning("looks-across",
               fmt::format("camera {} is {} m {} of the vehicle's middle and looks across it",
                           camera.name, format_number(std::abs(aside), 3),
                           to_string(aside > 0 ? Side::left : Side::right)),
               "position is [forward, left, up], yaw is positive to the left");
}

void lint_units(const MapReader& map, const RigCamera& camera) {
  // The widest modules of the shipped templates (11 mm) pass by three at a third of a metre a
  // second, slower than a walk.
  constexpr double kLongExposure = 0.1;  // seconds
  if (camera.exposure && *camera.exposure > kLongExposure) {
    map.at("exposure")
        .warning("long-exposure",
                 fmt::format("camera {} exposes for {} s, expected at most {}", camera.name,
                             format_number(*camera.exposure), kLongExposure),
                 "exposure is in seconds: 2 ms are 0.002");
  }
  // A camera that looks straight sideways has 0, one that looks ahead tens of degrees.
  const YamlValue alpha = map.at("alpha");
  const double angle = alpha ? parse_number(alpha.node->text).value_or(0) : 0;
  if (angle != 0 && std::abs(angle) < std::numbers::pi / 2) {
    alpha.warning("angle-unit",
                  fmt::format("alpha of camera {} is {} degrees; as radians it would be {}",
                              camera.name, format_number(angle), format_number(degrees(angle), 1)),
                  "alpha is in degrees");
  }
}

RigCamera read_camera(const YamlValue& value, const std::string& name, const fs::path& folder) {
  std::vector<std::string> keys = intrinsics_keys();
  keys.insert(keys.end(), {"alpha", "side", "yaw", "pitch", "roll", "position", "exposure",
                           "blur_px", "readout", "delay", "focus", "aperture_mm", "sigma"});
  const MapReader map(value, keys);
  RigCamera camera;
  camera.name = name;
  const Intrinsics intrinsics = read_intrinsics(map, folder).value_or(Intrinsics{});
  camera.camera = intrinsics.camera;
  camera.calibration = intrinsics.calibration;
  camera.side = read_side(map, "side");
  camera.vehicle_from_camera = read_mounting(map, camera.side);
  camera.exposure = map.number_if_there("exposure", above_zero(10, "s"));
  camera.blur_px = map.number_if_there("blur_px", between(0, 100, "pixels"));
  camera.readout = map.number_if_there("readout", between(0, 10, "s"));
  camera.delay = map.number_if_there("delay", between(0, 10, "s"));
  read_calibration_sigma(map, camera);
  take_square_pixels(map, camera);
  read_focus(map, camera);
  lint_side(map, camera);
  lint_position(map, camera);
  lint_units(map, camera);
  return camera;
}

std::optional<RigRange> read_range(const YamlValue& value, const std::string& name) {
  const MapReader map(value, {"wall", "min", "max", "sigma"});
  const auto wall = read_side(map, "wall", "wall: left or wall: right");
  const auto min = map.number("min", between(0, 1000, "m"));
  const auto max = map.number("max", above_zero(1000, "m"));
  const auto sigma = map.number("sigma", above_zero(1, "m"));
  if (!wall || !min || !max || !sigma) return std::nullopt;
  if (*min >= *max) {
    map.at("max").error("out-of-range", map.at("max").name + " is " + format_number(*max) +
                                            ", expected more than min, " + format_number(*min) +
                                            " m");
  }
  constexpr double kFine = 0.002;  // metres: finer than laser distance meters in the field
  if (*sigma < kFine) {
    map.at("sigma").warning("fine-range",
                            fmt::format("sigma of range {} is {} mm, expected {} mm and more", name,
                                        format_number(1000 * *sigma), 1000 * kFine),
                            "the resolution of a sensor is no standard deviation: an ultrasonic "
                            "distance is off by about 1 %, a laser's by 2 mm");
  }
  return RigRange{name, *wall, *min, *max, *sigma};
}

// Cameras and ranges name columns of run files.
bool is_column_name(const YamlKey& key, const std::string& kind, FindingLog& log) {
  static const std::set<std::string> kTaken = {"id",      "time",    "truth_x",
                                               "truth_y", "truth_z", "truth_heading"};
  const std::string& name = key.text;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const bool well_formed = !name.empty() && name.size() <= 60 && is_letter(name.front()) &&
                           std::ranges::all_of(name, [&](char c) {
                             return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
                           });
  if (well_formed && !kTaken.contains(name)) return true;
  log.error(
      key.place, "bad-name",
      "a " + kind + " named `" + name.substr(0, 60) +
          "`, expected a letter and then letters, digits, - or _, and no column of a run file");
  return false;
}

// Calls `read(value, name)` for each well-named entry of a map whose keys are names.
template <class Read>
void read_named(const YamlValue& map, const std::string& kind, const Read& read) {
  if (!map || map.is(YamlNode::Kind::broken)) return;
  if (!map.is(YamlNode::Kind::map)) {
    map.error("wrong-type", kind + "s is no map, expected a map from names to " + kind + "s");
    return;
  }
  std::set<std::string> seen;
  for (std::size_t i = 0; i < map.node->keys.size(); ++i) {
    const YamlKey& key = map.node->keys[i];
    if (!is_column_name(key, kind, *map.log)) continue;
    if (seen.insert(key.text).second) {
      read(YamlValue{&map.node->items[i], map.name + "." + key.text, map.log}, key.text);
    } else {
      map.log->error(key.place, "duplicate-key",
                     "the " + kind + " `" + key.text + "` a second time", "remove one of the two");
    }
  }
}

// Run-file columns that two parts of the rig would share.
void check_columns(const Rig& rig, const MapReader& file) {
  std::set<std::string> columns;
  for (const RigCamera& camera : rig.cameras) {
    for (const char* suffix : {"", "_tag", "_distance"}) columns.insert(camera.name + suffix);
  }
  for (const RigRange& range : rig.ranges) {
    if (columns.insert(range.name).second) continue;
    file.at("ranges").error("duplicate-key",
                            "the range `" + range.name + "` has the name of a camera's column",
                            "rename the range");
  }
  if (columns.size() != 3 * rig.cameras.size() + rig.ranges.size()) {
    file.at("cameras").error(
        "duplicate-key", "two cameras share a column of the run file, as NAME_tag does with NAME",
        "rename one of them");
  }
}

VehicleEnvelope read_envelope(const YamlValue& value) {
  const MapReader map(value, {"lateral", "yaw", "speed", "roll", "pitch"});
  VehicleEnvelope envelope;
  envelope.lateral = map.number("lateral", between(0, kLargestVehicle, "m")).value_or(0);
  envelope.yaw = radians(map.number("yaw", between(0, 90, "degrees")).value_or(0));
  envelope.speed = map.number("speed", between(0, 100, "m/s")).value_or(0);
  envelope.roll = radians(map.number_or("roll", 0, between(0, 45, "degrees")));
  envelope.pitch = radians(map.number_or("pitch", 0, between(0, 45, "degrees")));
  return envelope;
}

void read_vehicle(const YamlValue& value, Rig& rig) {
  const MapReader map(value, {"height", "roll_sigma", "pitch_sigma", "height_sigma", "envelope"});
  const NumberRange sigma = above_zero(45, "degrees");
  rig.vehicle_height = map.number("height", between(-kLargestVehicle, kLargestVehicle, "m"),
                                  "height: of the vehicle's centre O above the floor")
                           .value_or(0);
  rig.roll_sigma = radians(map.number_or("roll_sigma", kDefaultAttitude, sigma));
  rig.pitch_sigma = radians(map.number_or("pitch_sigma", kDefaultAttitude, sigma));
  rig.height_sigma = map.number_or("height_sigma", kDefaultHeightSigma, above_zero(10, "m"));
  if (map.has("envelope")) rig.envelope = read_envelope(map.at("envelope"));
}

Rig read_rig_tree(const YamlValue& root, const fs::path& path) {
  const MapReader file(root, {"rig", "cameras", "ranges", "vehicle"});
  Rig rig;
  rig.file = path;
  rig.name = read_name(file.need("rig", "rig: NAME")).value_or("");
  const YamlValue cameras = file.need("cameras", "cameras: { left: ..., right: ... }");
  read_named(cameras, "camera", [&](const YamlValue& value, const std::string& name) {
    rig.cameras.push_back(read_camera(value, name, path.parent_path()));
  });
  if (cameras.is(YamlNode::Kind::map) && cameras.node->keys.empty()) {
    cameras.error("wrong-length", "cameras is empty, expected at least one camera");
  }
  read_named(file.at("ranges"), "range", [&](const YamlValue& value, const std::string& name) {
    if (auto range = read_range(value, name)) rig.ranges.push_back(*range);
  });
  read_vehicle(file.need("vehicle", "vehicle: { height: 0.24 }"), rig);
  set_motion_sigmas(rig);
  if (!root.log->has_errors()) check_columns(rig, file);
  return rig;
}

}  // namespace

Diagnosed<Rig> read_rig_text(const fs::path& path, std::string_view text) {
  return read_yaml_text<Rig>(path, text, "rig",
                             [&](const YamlValue& root) { return read_rig_tree(root, path); });
}

Result<Diagnosed<Rig>> read_rig(const fs::path& path) {
  return read_file(path).map([&](const std::string& text) { return read_rig_text(path, text); });
}

Result<Rig> load_rig(const fs::path& path) { return value_without_errors(read_rig(path)); }

}  // namespace tagsmith::detail
