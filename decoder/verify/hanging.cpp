// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hanging.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {
namespace {

struct Strip {
  double white = 0;  // brightest tenth, samples
  double ink = 0;    // share of samples darker than half of it
};

// The strip in the plate's frame; nothing when a part of it is outside the picture.
std::optional<Strip> look_at(const GrayView& image, const TagTemplate& tag,
                             const FrameCorners& corners, const Rectangle& area) {
  constexpr int kAlong = 160;
  constexpr int kAcross = 12;
  const Homography image_from_unit = homography_to(corners);
  std::vector<double> samples;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const PixelPoint at =
          image_from_unit((area.x + area.width * (i + 0.5) / kAlong) / tag.frame_inner_length,
                          (area.y + area.height * (j + 0.5) / kAcross) / tag.frame_inner_height);
      const bool inside =
          at.x >= 0 && at.y >= 0 && at.x <= image.width - 1 && at.y <= image.height - 1;
      if (!inside) return std::nullopt;
      samples.push_back(
          image.at(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y))));
    }
  }
  std::ranges::sort(samples);
  const double white = samples[samples.size() * 9 / 10];
  const auto dark = std::ranges::lower_bound(samples, white / 2);
  return Strip{white,
               static_cast<double>(dark - samples.begin()) / static_cast<double>(samples.size())};
}

// Where the label's text stands; nothing when none is below the frame.
std::optional<Rectangle> label_below(const TagTemplate& tag) {
  if (!tag.label.shown) return std::nullopt;
  const Rectangle strip = strip_below_frame(tag);
  if (strip.height < kLeastLabelHeight) return std::nullopt;
  // The patches at its right end would be ink as well.
  const double width = strip.width - (tag.patch_size > 0 ? 2.5 * tag.patch_size : 0);
  return Rectangle{strip.x, strip.y, width, strip.height};
}

bool is_mirrored(const GrayView& image, const TagTemplate& tag, const FrameCorners& corners,
                 const Rectangle& below) {
  Rectangle above = below;
  above.y = tag.frame_inner_height - below.y - below.height;
  const std::optional<Strip> right = look_at(image, tag, corners, below);
  const std::optional<Strip> wrong = look_at(image, tag, corners, above);
  constexpr double kBlank = 0.003;
  constexpr double kLeastInk = 0.02;
  constexpr double kMostInk = 0.4;  // rock and other plates are darker on the whole
  constexpr double kSameWhite = 0.7;
  return right && wrong && right->ink < kBlank && wrong->ink > kLeastInk && wrong->ink < kMostInk &&
         right->white > kSameWhite * wrong->white && wrong->white > kSameWhite * right->white;
}

// The place of `corner` of the other plate in this plate's plane, metres right and down of P.
PixelPoint in_plane(const Homography& unit_from_image, const TagTemplate& tag, PixelPoint at) {
  const PixelPoint unit = unit_from_image(at.x, at.y);
  return {unit.x * tag.frame_inner_length, unit.y * tag.frame_inner_height};
}

// P of b in the plane of a, if b hangs there as a does: upright, and of the same size to 15 %.
std::optional<PixelPoint> beside(const TagTemplate& tag, const FrameCorners& a,
                                 const FrameCorners& b) {
  const Homography unit_from_image = inverse(homography_to(a));
  FrameCorners seen;
  for (std::size_t i = 0; i < 4; ++i) seen[i] = in_plane(unit_from_image, tag, b[i]);
  const double length = tag.frame_inner_length;
  const double height = tag.frame_inner_height;
  const auto near_to = [&](PixelPoint side, double x, double y) {
    return distance(side, PixelPoint{x, y}) < 0.15 * length;
  };
  const bool fits = near_to(seen[1] - seen[0], length, 0) &&
                    near_to(seen[2] - seen[3], length, 0) &&
                    near_to(seen[3] - seen[0], 0, height) && near_to(seen[2] - seen[1], 0, height);
  if (!fits) return std::nullopt;
  return seen[0];
}

void compare(const Survey& survey, TagFinding& a, TagFinding& b) {
  const PlacedTag* first = find_tag(survey, *a.digits);
  const PlacedTag* second = find_tag(survey, *b.digits);
  if (first == nullptr || second == nullptr) return;
  const TagTemplate& tag = survey.tag_template;
  constexpr double kFarthest = 4;  // metres
  const std::optional<PixelPoint> there = beside(tag, a.corners, b.corners);
  const std::optional<PixelPoint> back = beside(tag, b.corners, a.corners);
  if (!there || !back || std::abs(there->x) > kFarthest) return;
  std::string rule;
  std::string words;
  if (first->side != second->side) {
    rule = "wrong-wall";
    words = "hang side by side on one wall, expected on opposite ones";
  } else {
    const Eigen::Vector3d way =
        second->world_from_plate.translation - first->world_from_plate.translation;
    const double expected = first->world_from_plate.rotation.col(0).dot(way);
    if (std::abs(expected) > kFarthest || expected * there->x > 0) return;
    rule = "swapped";
    words = fmt::format("hang the wrong way round: {} is to the {} of {}, expected to the {}",
                        second->name, there->x > 0 ? "right" : "left", first->name,
                        expected > 0 ? "right" : "left");
  }
  for (TagFinding* finding : {&a, &b}) {
    finding->status = TagStatus::misplaced;
    finding->rule = rule;
    finding->message = fmt::format("{} and {} {}", first->name, second->name, words);
  }
}

}  // namespace

void find_mirrored(const GrayView& image, const TagTemplate& tag,
                   std::vector<TagFinding>& findings) {
  constexpr double kLeastModule = 4;  // pixels; letters are four modules high and more
  const std::optional<Rectangle> below = label_below(tag);
  if (!below) return;
  for (TagFinding& finding : findings) {
    if (finding.status != TagStatus::ok || finding.module_px < kLeastModule) continue;
    if (!is_mirrored(image, tag, finding.corners, *below)) continue;
    finding.status = TagStatus::misprinted;
    finding.rule = "mirrored";
    finding.message = finding.tag + " is mirrored: its label stands above the bars, expected below";
  }
}

void find_upside_down(std::vector<TagFinding>& findings) {
  for (TagFinding& finding : findings) {
    if (finding.status != TagStatus::ok) continue;
    const PixelPoint along = finding.corners[1] - finding.corners[0];
    if (along.x > -std::abs(along.y)) continue;
    finding.status = TagStatus::misprinted;
    finding.rule = "upside-down";
    finding.message = finding.tag + " stands on its head on the page";
  }
}

void find_misplaced(const Survey& survey, std::vector<TagFinding>& findings) {
  constexpr double kLeastModule = 2;  // pixels
  std::vector<TagFinding*> tags;
  for (TagFinding& finding : findings) {
    if (finding.status == TagStatus::ok && finding.module_px >= kLeastModule) {
      tags.push_back(&finding);
    }
  }
  for (std::size_t i = 0; i < tags.size(); ++i) {
    for (std::size_t j = i + 1; j < tags.size(); ++j) compare(survey, *tags[i], *tags[j]);
  }
}

}  // namespace tagsmith
