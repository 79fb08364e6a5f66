// SPDX-License-Identifier: Apache-2.0
#include "decoder/api/data.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/check_together.hpp"

namespace tagsmith::detail {

void throw_invalid(const std::string& message) {
  throw tagsmith::Error(ErrorCode::invalid_argument, message);
}

GrayView checked(const ImageView& image) {
  constexpr double kMostPixels = 200e6;
  if (image.data == nullptr || image.width <= 0 || image.height <= 0) {
    throw_invalid("the image is " + std::to_string(image.width) + " x " +
                  std::to_string(image.height) + " pixels" +
                  (image.data == nullptr ? " of nothing" : "") + ", expected one pixel at least");
  }
  if (static_cast<double>(image.width) * image.height > kMostPixels) {
    throw_invalid("the image has more than 200 million pixels");
  }
  const std::ptrdiff_t stride = image.stride == 0 ? image.width : image.stride;
  if (std::abs(stride) < image.width) {
    throw_invalid("the image's stride is " + std::to_string(stride) + " bytes, expected " +
                  std::to_string(image.width) + " at least");
  }
  return {image.data, image.width, image.height, stride};
}

Digits checked_digits(std::string_view digits, const std::string& what) {
  const std::optional<Digits> parsed = parse_digits(digits);
  if (!parsed) {
    throw_invalid(what + " are `" + std::string(digits.substr(0, 60)) +
                  "`, expected twelve digits");
  }
  return *parsed;
}

void check_number(const std::string& name, double value, double least, double greatest) {
  if (value >= least && value <= greatest) return;
  throw_invalid(name + " is " + (std::isfinite(value) ? format_number(value) : "no number") +
                ", expected " + format_number(least) + " to " + format_number(greatest));
}

TagTemplate template_from(const PlateTemplate& plate) {
  TagTemplate tag;
  tag.name = plate.name;
  tag.plate_length = plate.plate_length;
  tag.plate_height = plate.plate_height;
  tag.frame_inner_length = plate.frame_inner_length;
  tag.frame_inner_height = plate.frame_inner_height;
  tag.frame_stroke = plate.frame_stroke;
  tag.frame_offset_right = plate.frame_offset_right;
  tag.frame_offset_up = plate.frame_offset_up;
  tag.quiet_zone_modules = plate.quiet_zone_modules;
  tag.margin_modules = plate.margin_modules;
  tag.white_on_black = plate.white_on_black;
  constexpr double kLargest = 100;
  for (const auto& [name, length] : {std::pair{"the plate's length", tag.plate_length},
                                     {"the plate's height", tag.plate_height},
                                     {"the frame's inner length", tag.frame_inner_length},
                                     {"the frame's inner height", tag.frame_inner_height},
                                     {"the frame's stroke", tag.frame_stroke}}) {
    check_number(name, length, 1e-6, kLargest);
  }
  check_number("the frame's offset to the right", tag.frame_offset_right, -kLargest, kLargest);
  check_number("the frame's offset upwards", tag.frame_offset_up, -kLargest, kLargest);
  check_number("the quiet zone", tag.quiet_zone_modules, 0, 1000);
  check_number("the margin", tag.margin_modules, 0, 1000);
  if (bar_height(tag) <= 0) throw_invalid("the plate's margins leave no room for the bars");
  const double length =
      tag.frame_inner_length + 2 * tag.frame_stroke + 2 * std::abs(tag.frame_offset_right);
  const double height =
      tag.frame_inner_height + 2 * tag.frame_stroke + 2 * std::abs(tag.frame_offset_up);
  constexpr double kRounding = 1e-9;
  if (length > tag.plate_length + kRounding || height > tag.plate_height + kRounding) {
    throw_invalid("the feature frame needs a plate of " + format_number(length) + " x " +
                  format_number(height) + " m, the plate is " + format_number(tag.plate_length) +
                  " x " + format_number(tag.plate_height) + " m");
  }
  return tag;
}

Camera camera_from(const CameraModel& model) {
  constexpr int kMostPixels = 100'000;
  check_number("a camera's width", model.width, 1, kMostPixels);
  check_number("a camera's height", model.height, 1, kMostPixels);
  for (const double focal : {model.fx, model.fy}) {
    check_number("a camera's focal length", focal, 1e-3, 1e9);
  }
  for (const double center : {model.cx, model.cy}) {
    check_number("a camera's principal point", center, -1e9, 1e9);
  }
  for (const double term : model.distortion) {
    check_number("a camera's distortion", term, -1e9, 1e9);
  }
  return {model.width,
          model.height,
          model.fx,
          model.fy,
          model.cx,
          model.cy,
          model.distortion,
          model.lens == tagsmith::LensModel::fisheye ? LensModel::fisheye : LensModel::perspective};
}

std::vector<Survey> surveys_from(const std::vector<tagsmith::Survey>& surveys) {
  std::vector<Survey> all;
  all.reserve(surveys.size());
  for (const tagsmith::Survey& survey : surveys) all.push_back(survey.data().survey);
  const std::vector<Diagnostic> together = check_together(all);
  if (has_errors(together)) throw_invalid(to_string(together, true));
  return all;
}

Corners corners_from(const FrameCorners& corners) {
  Corners points;
  std::ranges::transform(corners, points.begin(), [](const PixelPoint& corner) {
    return Point{corner.x, corner.y};
  });
  return points;
}

FrameCorners frame_corners_from(const Corners& corners) {
  FrameCorners points;
  std::ranges::transform(corners, points.begin(), [](const Point& corner) {
    return PixelPoint{corner.x, corner.y};
  });
  return points;
}

Vector3 vector_from(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Eigen::Vector3d eigen_from(const Vector3& vector) { return {vector[0], vector[1], vector[2]}; }

}  // namespace tagsmith::detail
