// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/read_options.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

ReadOptions read_options_of(std::span<const Survey* const> surveys) {
  ReadOptions options;
  if (surveys.empty()) return options;
  options.layouts.clear();
  for (const Survey* survey : surveys) {
    for (const PlacedTag& tag : survey->tags) options.code_book.push_back(tag.digits);
    const SymbolLayout layout = layout_of(survey->tag_template);
    if (std::ranges::find(options.layouts, layout) == options.layouts.end()) {
      options.layouts.push_back(layout);
    }
  }
  options.white_on_black = surveys.front()->tag_template.white_on_black;
  const CheckDigit check = surveys.front()->code.check;
  const auto agrees = [&](const Survey* survey) { return survey->code.check == check; };
  if (std::ranges::all_of(surveys, agrees)) options.check = check;
  return options;
}

ReadOptions read_options_for(std::span<const Survey> surveys) {
  std::vector<const Survey*> each;
  each.reserve(surveys.size());
  for (const Survey& survey : surveys) each.push_back(&survey);
  return read_options_of(each);
}

// ---- Tags that should be in a picture.

namespace {

// The frame's inner corners in the image; nothing when one is out of it.
std::optional<FrameCorners> corners_in_image(const Camera& camera, const Pose& camera_from_plate,
                                             const TagTemplate& tag) {
  const double right = tag.frame_inner_length;
  const double down = tag.frame_inner_height;
  const std::array<Eigen::Vector3d, 4> corners_in_plate{
      {{0, 0, 0}, {right, 0, 0}, {right, down, 0}, {0, down, 0}}};
  FrameCorners corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = project(camera, camera_from_plate * corners_in_plate[i]);
    if (!pixel || !in_image(camera, *pixel)) return std::nullopt;
    corners[i] = {pixel->x(), pixel->y()};
  }
  return corners;
}

}  // namespace

std::vector<ExpectedTag> expected_tags(const Survey& survey, const Camera& camera,
                                       const Pose& camera_from_world, double uncertainty_px) {
  constexpr double kLeastModule = 0.25;  // pixels
  std::vector<ExpectedTag> expected;
  for (const PlacedTag& tag : survey.tags) {
    const Pose camera_from_plate = camera_from_world * tag.world_from_plate;
    // The plate's z axis points into the wall: its printed side is seen from where z is negative.
    if (inverse(camera_from_plate).translation.z() >= 0) continue;
    const auto corners = corners_in_image(camera, camera_from_plate, survey.tag_template);
    if (!corners) continue;
    const double modules = kModuleCount + 2 * survey.tag_template.quiet_zone_modules;
    if (distance((*corners)[0], (*corners)[1]) < kLeastModule * modules) continue;
    expected.push_back({*corners, uncertainty_px});
  }
  std::ranges::sort(expected, [](const ExpectedTag& a, const ExpectedTag& b) {
    return distance(a.corners[0], a.corners[3]) > distance(b.corners[0], b.corners[3]);
  });
  return expected;
}

}  // namespace tagsmith::detail
