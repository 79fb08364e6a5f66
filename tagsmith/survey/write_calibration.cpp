// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/write_calibration.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kPlumbBob = 5;
constexpr std::size_t kFisheye = 4;

bool any_beyond(const Camera& camera, std::size_t first) {
  return std::ranges::any_of(camera.distortion.begin() + static_cast<std::ptrdiff_t>(first),
                             camera.distortion.end(), [](double k) { return k != 0; });
}

// The coefficients that the camera's model takes.
std::span<const double> coefficients(const Camera& camera) {
  const std::span<const double> all(camera.distortion);
  if (camera.lens == LensModel::fisheye) return all.first(kFisheye);
  return any_beyond(camera, kPlumbBob) ? all : all.first(kPlumbBob);
}

// The shortest text for this number. OpenCV recognises numbers with fractions by their point.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string numbers(std::span<const double> values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number(value));
  return fmt::format("[ {} ]", fmt::join(texts, ", "));
}

std::string comments(const CalibrationNotes& notes) {
  std::string text;
  for (const std::string& line : notes.comments) text += "# " + printable_text(line) + "\n";
  return text;
}

std::string matrix(std::string_view head, int rows, std::span<const double> values) {
  return fmt::format("{}\n   rows: {}\n   cols: {}\n{}   data: {}\n", head, rows,
                     values.size() / static_cast<std::size_t>(rows),
                     head.ends_with("matrix") ? "   dt: d\n" : "", numbers(values));
}

std::array<double, 9> camera_matrix(const Camera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

std::string opencv_text(const Camera& camera, const CalibrationNotes& notes) {
  const std::span<const double> k = coefficients(camera);
  std::string text = "%YAML:1.0\n---\n" + comments(notes);
  text += fmt::format("image_width: {}\nimage_height: {}\n", camera.width, camera.height);
  text += matrix("camera_matrix: !!opencv-matrix", 3, camera_matrix(camera));
  text += matrix("distortion_coefficients: !!opencv-matrix", static_cast<int>(k.size()), k);
  text += fmt::format("fisheye_model: {}\n", camera.lens == LensModel::fisheye ? 1 : 0);
  if (notes.rms_px > 0) text += "avg_reprojection_error: " + number(notes.rms_px) + "\n";
  return text;
}

// The names of sensor_msgs/distortion_models.hpp.
const char* ros_model(const Camera& camera) {
  if (camera.lens == LensModel::fisheye) return "equidistant";
  return coefficients(camera).size() > kPlumbBob ? "rational_polynomial" : "plumb_bob";
}

std::string ros_text(const Camera& camera, const CalibrationNotes& notes) {
  const std::array<double, 9> unit{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<double, 12> projection{camera.fx, 0, camera.cx, 0, 0, camera.fy,
                                          camera.cy, 0, 0,         0, 1, 0};
  std::string text = comments(notes);
  text += fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", camera.width,
                      camera.height, notes.camera_name);
  text += matrix("camera_matrix:", 3, camera_matrix(camera));
  text += fmt::format("distortion_model: {}\n", ros_model(camera));
  text += matrix("distortion_coefficients:", 1, coefficients(camera));
  text += matrix("rectification_matrix:", 3, unit);
  return text + matrix("projection_matrix:", 3, projection);
}

Result<std::string> kalibr_text(const Camera& camera, const CalibrationNotes& notes) {
  const bool is_fisheye = camera.lens == LensModel::fisheye;
  if (!is_fisheye && any_beyond(camera, kFisheye)) {
    return fail(
        "kalibr's radtan lens has k1, k2, p1 and p2 alone, and this camera needs more: expected "
        "the format opencv or ros");
  }
  const std::array<double, 4> intrinsics{camera.fx, camera.fy, camera.cx, camera.cy};
  return comments(notes) +
         fmt::format(
             "cam0:\n  camera_model: pinhole\n  intrinsics: {}\n  distortion_model: {}\n"
             "  distortion_coeffs: {}\n  resolution: [{}, {}]\n  rostopic: /{}/image_raw\n"
             "  cam_overlaps: []\n",
             numbers(intrinsics), is_fisheye ? "equidistant" : "radtan",
             numbers(coefficients(camera).first(kFisheye)), camera.width, camera.height,
             notes.camera_name);
}

}  // namespace

// Why: docs/decisions/0015-files-and-ledger.md.
Result<std::string> calibration_text(CalibrationFormat format, const Camera& camera,
                                     const CalibrationNotes& notes) {
  switch (format) {
    case CalibrationFormat::opencv:
      return opencv_text(camera, notes);
    case CalibrationFormat::ros:
      return ros_text(camera, notes);
    case CalibrationFormat::kalibr:
      break;
  }
  return kalibr_text(camera, notes);
}

}  // namespace tagsmith::detail
