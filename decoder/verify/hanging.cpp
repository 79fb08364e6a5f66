// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/hanging.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/image/transform.hpp"

namespace tagsmith::detail {
namespace {

// The place of `corner` of the other plate in this plate's plane, metres right and down of P.
PixelPoint in_plane(const Homography& frame_from_image, const TagTemplate& tag, PixelPoint at) {
  const PixelPoint unit = frame_from_image(at.x, at.y);
  return {unit.x * tag.frame_inner_length, unit.y * tag.frame_inner_height};
}

// P of b in the plane of a, if b hangs there as a does: upright, and of the same size to 15 %.
std::optional<PixelPoint> beside(const TagTemplate& tag, const FrameCorners& a,
                                 const FrameCorners& b) {
  const Homography frame_from_image = inverse(homography_to(a));
  FrameCorners seen;
  for (std::size_t i = 0; i < 4; ++i) seen[i] = in_plane(frame_from_image, tag, b[i]);
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

// How b hangs beside a in contradiction to the survey, seen in the plane of either plate.
std::optional<Finding> compare(const Survey& survey, const VerifiedTag& a, const VerifiedTag& b) {
  const PlacedTag* first = find_tag(survey, *a.digits);
  const PlacedTag* second = find_tag(survey, *b.digits);
  const TagTemplate& tag = survey.tag_template;
  constexpr double kFarthest = 4;  // metres
  const std::optional<PixelPoint> there = beside(tag, a.corners, b.corners);
  const std::optional<PixelPoint> back = beside(tag, b.corners, a.corners);
  if (!there || !back || std::abs(there->x) > kFarthest) return std::nullopt;
  if (first->side != second->side) {
    return Finding{TagStatus::misplaced, "wrong-wall",
                   fmt::format("{} and {} hang side by side on one wall, expected on opposite ones",
                               first->name, second->name)};
  }
  const Eigen::Vector3d way =
      second->world_from_plate.translation - first->world_from_plate.translation;
  const double expected = first->world_from_plate.rotation.col(0).dot(way);
  if (std::abs(expected) > kFarthest || expected * there->x > 0) return std::nullopt;
  return Finding{TagStatus::misplaced, "swapped",
                 fmt::format("{0} and {1} hang the wrong way round: {1} is to the {2} of {0}, "
                             "expected to the {3}",
                             first->name, second->name, there->x > 0 ? "right" : "left",
                             expected > 0 ? "right" : "left")};
}

// The direction from the upper edge to the lower one as the tag itself stands, in the picture
// turned as the camera noted.
PixelPoint down_of(const PictureEvidence& evidence, const TagEvidence& seen) {
  FrameCorners corners = seen.tag.corners;
  if (evidence.orientation) {
    const Upright upright{*evidence.orientation, evidence.image.width, evidence.image.height};
    for (PixelPoint& corner : corners) corner = upright.turn(corner);
  }
  return corners[3] - corners[0] + (corners[2] - corners[1]);
}

// Opposite, and alike, to 45 degrees.
bool opposes(const PixelPoint& a, const PixelPoint& b) {
  return a.x * b.x + a.y * b.y < -std::abs(cross(a, b));
}
bool agrees(const PixelPoint& a, const PixelPoint& b) { return opposes(a, -1.0 * b); }

// The directions of tags that read as they should and that the survey has upright.
std::vector<PixelPoint> standing_tags(const PictureEvidence& evidence) {
  std::vector<PixelPoint> downs;
  for (const TagEvidence& seen : evidence.tags) {
    if (reads_well(evidence, seen) && hangs_upright(evidence.survey, seen.tag)) {
      downs.push_back(down_of(evidence, seen));
    }
  }
  return downs;
}

Finding upside_down(const TagEvidence& seen, const std::string& how,
                    TagStatus status = TagStatus::misprinted) {
  return {status, "upside-down", seen.tag.tag + " is upside down" + how};
}

}  // namespace

bool hangs_upright(const Survey& survey, const VerifiedTag& tag) {
  const PlacedTag* placed = find_tag(survey, tag.tag);
  return placed != nullptr && placed->world_from_plate.rotation(2, 1) < -std::numbers::sqrt2 / 2;
}

bool reads_well(const PictureEvidence& evidence, const TagEvidence& seen) {
  if (seen.sight != Sight::read || !seen.mirrored.empty()) return false;
  const auto same = [&](const TagEvidence& other) { return other.tag.digits == seen.tag.digits; };
  return find_tag(evidence.survey, *seen.tag.digits) != nullptr &&
         &*std::ranges::find_if(evidence.tags, same) == &seen;
}

UpSource up_of_photo(const PictureEvidence& evidence) {
  // In a mirrored picture plates read as if they were upside down.
  const bool noted = evidence.orientation && !Upright{*evidence.orientation}.mirrors();
  if (!noted) return UpSource::unknown;
  const std::vector<PixelPoint> downs = standing_tags(evidence);
  const auto on_head = [](const PixelPoint& down) { return opposes(down, {0, 1}); };
  return !downs.empty() && std::ranges::all_of(downs, on_head) ? UpSource::doubted
                                                               : UpSource::camera;
}

std::optional<Finding> find_upside_down(const PictureEvidence& evidence, const TagEvidence& seen) {
  if (evidence.up == UpSource::page) {
    const PixelPoint along = seen.tag.corners[1] - seen.tag.corners[0];
    if (along.x > -std::abs(along.y)) return std::nullopt;
    return upside_down(seen, " on the page: it is turned, or a mirrored print");
  }
  const bool is_asked = evidence.is_photo && evidence.up != UpSource::rig;
  if (!is_asked || !hangs_upright(evidence.survey, seen.tag)) return std::nullopt;
  const std::vector<PixelPoint> downs = standing_tags(evidence);
  const PixelPoint down = down_of(evidence, seen);
  if (evidence.up == UpSource::doubted && downs.size() == 1) {
    return upside_down(
        seen,
        " by the photo's EXIF orientation, and no other tag in the photo shows whether that is "
        "right. Look where its arrow points: if down, the plate hangs upside down; if up, the "
        "camera was upside down and noted otherwise, or the print is mirrored",
        TagStatus::doubtful);
  }
  if (evidence.up == UpSource::camera && opposes(down, {0, 1})) {
    return upside_down(
        seen, " by the photo's EXIF orientation: it hangs upside down, or is a mirrored print");
  }
  const auto against =
      std::ranges::count_if(downs, [&](const PixelPoint& other) { return opposes(down, other); });
  const auto with =
      std::ranges::count_if(downs, [&](const PixelPoint& other) { return agrees(down, other); });
  if (against < 2 || with > 1) return std::nullopt;  // it agrees with itself: `with` counts it
  return upside_down(
      seen, fmt::format(" against the {} other tags in the photo: it hangs upside down, or is a "
                        "mirrored print (which way is up in the photo is not known: the others may "
                        "be the ones that hang wrong)",
                        against));
}

namespace {

// A tag of the photo that does not hang beside another as the survey has it.
struct Contradiction {
  const TagEvidence* other = nullptr;
  Finding finding;
};

std::vector<Contradiction> contradictions_of(const PictureEvidence& evidence,
                                             const TagEvidence& seen) {
  constexpr double kLeastModule = 2;  // pixels
  const auto is_clear = [](const TagEvidence& tag) {
    return tag.tag.finding.status == TagStatus::ok && tag.tag.module_px >= kLeastModule;
  };
  std::vector<Contradiction> all;
  if (!is_clear(seen)) return all;
  bool before = true;
  for (const TagEvidence& other : evidence.tags) {
    if (&other == &seen) before = false;
    if (&other == &seen || !is_clear(other)) continue;
    auto wrong = before ? compare(evidence.survey, other.tag, seen.tag)
                        : compare(evidence.survey, seen.tag, other.tag);
    if (wrong) all.push_back({&other, std::move(*wrong)});
  }
  return all;
}

}  // namespace

// Of two tags that contradict each other the one hangs wrong that contradicts more others. Where
// both contradict as many, it cannot be determined which of them does.
std::optional<Finding> find_misplaced(const PictureEvidence& evidence, const TagEvidence& seen) {
  if (!evidence.is_photo) return std::nullopt;
  const std::vector<Contradiction> own = contradictions_of(evidence, seen);
  std::optional<Finding> found;
  bool is_decided = true;
  for (const Contradiction& one : own) {
    const std::size_t others = contradictions_of(evidence, *one.other).size();
    if (others > own.size()) continue;
    is_decided = is_decided && others < own.size();
    found = one.finding;
  }
  if (!found || is_decided) return found;
  found->status = TagStatus::doubtful;
  found->message += "; one of the two hangs wrong, or both";
  return found;
}

}  // namespace tagsmith::detail
