// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_intrinsics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/limits.hpp"
#include "tagsmith/survey/read_calibration.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

struct ImageSize {
  int width = 0;
  int height = 0;
};

std::string words_of(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

std::optional<ImageSize> read_image_size(const YamlValue& value) {
  const auto sides = read_numbers(value, 2, between(1, kMostPixels, "pixels"));
  if (!sides) return std::nullopt;
  const auto [width, height] = std::array{(*sides)[0], (*sides)[1]};
  if (width == std::floor(width) && height == std::floor(height)) {
    return ImageSize{static_cast<int>(width), static_cast<int>(height)};
  }
  return value.error("wrong-type", value.name + " has fractions, expected whole pixels");
}

void need_image_size(const MapReader& map) {
  map.need("image_size", "image_size: [width, height] in pixels");
}

std::optional<LensModel> read_model(const MapReader& map) {
  const auto model = map.choice("model", {"perspective", "fisheye"});
  if (!model) return std::nullopt;
  return *model == "fisheye" ? LensModel::fisheye : LensModel::perspective;
}

// The lens and sensor as their data sheets give them.
std::optional<Camera> read_lens(const MapReader& map, const ImageSize& size) {
  const auto focal =
      map.number("focal_length_mm", above_zero(10'000, "mm"),
                 "focal_length_mm and sensor_mm, or fx, fy, cx, cy, or calibration: FILE");
  const YamlValue sides = map.need("sensor_mm", "sensor_mm: [width, height]");
  const auto sensor = read_numbers(sides, 2, above_zero(1000, "mm"));
  if (!focal || !sensor) return std::nullopt;
  const Camera camera =
      camera_from_sensor(size.width, size.height, *focal, (*sensor)[0], (*sensor)[1]);
  if (std::abs(camera.fx / camera.fy - 1) > kSquarePixels) {
    sides.warning(
        "odd-pixels",
        sides.name + " and image_size give pixels of " +
            format_number(1000 * (*sensor)[0] / size.width, 3) + " x " +
            format_number(1000 * (*sensor)[1] / size.height, 3) +
            " micrometres, expected square ones",
        "check the order of width and height; of a picture cut from the sensor (16:9 from "
        "4:3), give the size of the part that is used");
  }
  return camera;
}

// Five coefficients of a perspective lens, or eight of the rational model; four of a fisheye.
std::optional<std::vector<double>> read_distortion(const YamlValue& value, LensModel model) {
  if (!value) return std::vector<double>{};
  constexpr std::size_t kRational = 8;
  const bool is_rational =
      value.is(YamlNode::Kind::sequence) && value.node->items.size() == kRational;
  const std::size_t count = model == LensModel::fisheye ? 4 : is_rational ? kRational : 5;
  return read_numbers(value, count, between(-100, 100, ""));
}

std::optional<Camera> read_numbers_of_lens(const MapReader& map, const ImageSize& size,
                                           LensModel model) {
  const NumberRange focal = above_zero(kLongestFocalPx, "pixels");
  const NumberRange centre = between(-kMostPixels, 2 * kMostPixels, "pixels");
  const auto fx = map.number("fx", focal);
  const auto fy = map.number("fy", focal);
  const auto cx = map.number("cx", centre);
  const auto cy = map.number("cy", centre);
  const auto distortion = read_distortion(map.at("distortion"), model);
  if (!fx || !fy || !cx || !cy || !distortion) return std::nullopt;
  Camera camera{size.width, size.height, *fx, *fy, *cx, *cy, {}};
  std::ranges::copy(*distortion, camera.distortion.begin());
  return camera;
}

// --- calibration file ---

// calibration: FILE, or calibration: { file: FILE, camera: KEY }.
std::optional<CalibrationRequest> read_request(const MapReader& map, const fs::path& folder) {
  const YamlValue value = map.at("calibration");
  CalibrationRequest request;
  std::optional<std::string> file;
  if (value.is(YamlNode::Kind::map)) {
    const MapReader choice(value, {"file", "camera"});
    file = read_text(choice.need("file", "file: FILE"));
    if (choice.has("camera")) {
      const auto camera = read_text(choice.at("camera"));
      if (!camera) return std::nullopt;
      request.camera = *camera;
    }
  } else {
    file = read_text(value);
  }
  if (!file) return std::nullopt;
  request.file = folder / *file;
  request.model = read_model(map);
  return request;
}

// The image size that both agree on.
bool settle_size(const MapReader& map, const std::optional<ImageSize>& size, const fs::path& file,
                 Camera& camera) {
  if (camera.width == 0) {
    if (!size) need_image_size(map);
    if (size) camera.width = size->width;
    if (size) camera.height = size->height;
    return size.has_value();
  }
  if (!size || (size->width == camera.width && size->height == camera.height)) return true;
  const YamlValue value = map.at("image_size");
  value.error("calibration-size",
              value.name + " is " + words_of(size->width, size->height) + ", but " + file.string() +
                  " was calibrated with images of " + words_of(camera.width, camera.height),
              "calibrate with images of the size that the vehicle takes");
  return false;
}

std::optional<Intrinsics> read_calibration_file(const MapReader& map,
                                                const std::optional<ImageSize>& size,
                                                const fs::path& folder) {
  const auto request = read_request(map, folder);
  if (!request) return std::nullopt;
  Result<Diagnosed<Camera>> reading = read_calibration(*request);
  if (!reading) {
    const YamlValue value = map.at("calibration");
    return value.error("calibration-file", value.name + ": " + reading.error().message,
                       "its path is relative to the rig's folder");
  }
  map.log().append(reading->diagnostics);
  if (!reading->value || (map.has("image_size") && !size)) return std::nullopt;
  if (!settle_size(map, size, request->file, *reading->value)) return std::nullopt;
  return Intrinsics{*reading->value, request->file};
}

// --- plausibility ---

// Numbers that are improbable for this camera and image size. `stated`: by what.
void warn_of_odd_lens(const MapReader& map, const YamlValue& stated, const Camera& camera) {
  const std::string& name = map.value().name;
  if (!in_image(camera, {camera.cx, camera.cy})) {
    stated.warning("odd-principal-point", name + ": cx, cy lie outside the image",
                   "was the camera calibrated at another image size?");
  }
  if (camera.lens == LensModel::fisheye) return;
  constexpr double kWidest = 0.2;  // 136 degrees across
  if (camera.fx < kWidest * camera.width) {
    stated.warning("odd-focal-length",
                   name + ": a focal length of " + format_number(camera.fx, 1) + " pixels for " +
                       std::to_string(camera.width) + " pixels of width",
                   map.has("focal_length_mm")
                       ? "focal_length_mm and sensor_mm are in millimetres: 6 for 0.006 m"
                       : "focal lengths are in pixels here; so wide a lens needs model: fisheye");
  }
  constexpr double kAlike = 0.01;  // those of a data sheet: see odd-pixels
  if (!map.has("sensor_mm") && std::abs(camera.fx / camera.fy - 1) > kAlike) {
    stated.warning("odd-focal-length",
                   name + ": focal lengths of " + format_number(camera.fx, 1) + " and " +
                       format_number(camera.fy, 1) + " pixels across and down",
                   "pixels are square, or nearly so: is a digit wrong or missing?");
  }
  const double right = camera.width - 1.0;
  const double bottom = camera.height - 1.0;
  const std::array<Eigen::Vector2d, 4> corners{{{0, 0}, {right, 0}, {0, bottom}, {right, bottom}}};
  const bool reaches = std::ranges::all_of(
      corners, [&](const auto& corner) { return ray_through(camera, corner).has_value(); });
  if (reaches) return;
  stated.warning("lens-reach",
                 name +
                     ": the distortion folds back before it reaches the image's corners; what is "
                     "seen there cannot be used",
                 "calibrate with the target in the corners of the image too");
}

}  // namespace

std::vector<std::string> intrinsics_keys() {
  return {"image_size", "focal_length_mm", "sensor_mm", "fx",         "fy", "cx",
          "cy",         "distortion",      "model",     "calibration"};
}

IntrinsicsSource intrinsics_source(const MapReader& map) {
  if (map.has("calibration")) return IntrinsicsSource::calibration_file;
  const bool by_numbers = map.has("fx") || map.has("fy") || map.has("cx") || map.has("cy");
  return by_numbers ? IntrinsicsSource::numbers : IntrinsicsSource::data_sheet;
}

std::optional<Intrinsics> read_intrinsics(const MapReader& map, const fs::path& folder) {
  if (!map.is_map()) return std::nullopt;
  const IntrinsicsSource source = intrinsics_source(map);
  const bool by_file = source == IntrinsicsSource::calibration_file;
  if (!by_file) need_image_size(map);
  const std::optional<ImageSize> size = read_image_size(map.at("image_size"));
  for (const char* key : {"fx", "distortion", "calibration"}) {
    map.exclude_each_other({"focal_length_mm", key});
  }
  for (const char* key : {"fx", "fy", "cx", "cy", "distortion", "sensor_mm"}) {
    map.exclude_each_other({"calibration", key});
  }
  map.exclude_each_other({"sensor_mm", "fx"});
  std::optional<Intrinsics> intrinsics;
  const char* told_by = "calibration";
  if (by_file) {
    intrinsics = read_calibration_file(map, size, folder);
  } else {
    const ImageSize used = size.value_or(ImageSize{1, 1});
    const LensModel model = read_model(map).value_or(LensModel::perspective);
    const bool by_numbers = source == IntrinsicsSource::numbers;
    told_by = by_numbers ? "fx" : "focal_length_mm";
    auto camera = by_numbers ? read_numbers_of_lens(map, used, model) : read_lens(map, used);
    if (camera) camera->lens = model;
    if (camera && size) intrinsics = Intrinsics{*camera, {}};
  }
  if (intrinsics) warn_of_odd_lens(map, map.at(told_by), intrinsics->camera);
  return intrinsics;
}

}  // namespace tagsmith::detail
