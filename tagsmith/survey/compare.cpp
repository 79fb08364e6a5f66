// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

std::string place_text(const Eigen::Vector3d& p) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
}

// World positions are compared, so that a mirrored grid counts as a change.
double distance_between(const PlacedTag& before, const PlacedTag& after) {
  return (before.world_from_plate.translation - after.world_from_plate.translation).norm();
}

// The turn of the plate in its own frame (x to the right, y down, z into the wall): clockwise,
// right edge out, top out; radians.
Eigen::Vector3d turn_between(const PlacedTag& before, const PlacedTag& after) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(before.world_from_plate.rotation.transpose() *
                                               after.world_from_plate.rotation));
  const Eigen::Vector3d by_axis = turn.angle() * turn.axis();
  return {by_axis.z(), by_axis.y(), by_axis.x()};
}

// "turned by 20.0 degrees clockwise and 3.0 degrees top out"; empty when it is not turned.
std::string turn_text(const Eigen::Vector3d& turn) {
  constexpr std::array<std::array<const char*, 2>, 3> kWays{{{"clockwise", "counterclockwise"},
                                                             {"right edge out", "right edge in"},
                                                             {"top out", "top in"}}};
  if (turn.norm() < kSameDirection) return {};
  std::vector<std::string> parts;
  const double least = std::min(kSameDirection, turn.cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < kWays.size(); ++i) {
    const double angle = turn[static_cast<Eigen::Index>(i)];
    if (std::abs(angle) < least) continue;
    parts.push_back(
        fmt::format("{:.1f} degrees {}", degrees(std::abs(angle)), kWays[i][angle < 0 ? 1 : 0]));
  }
  return fmt::format("turned by {}", fmt::join(parts, " and "));
}

std::optional<TagDifference> compare(const PlacedTag& before, const PlacedTag& after,
                                     const std::string& template_change) {
  TagDifference difference{after.name, TagChange::reprint, distance_between(before, after), {}};
  difference.turn = turn_between(before, after);
  std::vector<std::string> hung;
  if (difference.distance > kSamePlace || before.side != after.side) {
    hung.push_back(fmt::format("by {} mm, from {} to {}",
                               format_number(difference.distance * 1000, 1),
                               place_text(before.p_in_grid), place_text(after.p_in_grid)));
  }
  if (std::string turned = turn_text(difference.turn); !turned.empty()) {
    hung.push_back(std::move(turned));
  }
  const std::string where = fmt::format("{}", fmt::join(hung, "; "));
  if (before.digits != after.digits) {
    difference.reason = "digits " + to_string(before.digits) + " become " + to_string(after.digits);
  } else if (!template_change.empty()) {
    difference.reason = template_change;
  } else {
    if (hung.empty()) return std::nullopt;
    difference.change = TagChange::move;
    difference.reason = where;
    return difference;
  }
  if (!hung.empty()) difference.reason += "; hangs elsewhere: " + where;
  return difference;
}

}  // namespace

std::string to_string(TagChange change) {
  constexpr std::array kNames{"print", "reprint", "move", "remove"};
  static_assert(kNames.size() == static_cast<std::size_t>(TagChange::remove) + 1);
  return kNames[static_cast<std::size_t>(change)];
}

std::span<const PrintedLength> printed_lengths() {
  using Tag = TagTemplate;
  static constexpr PrintedLength kLengths[] = {
      {"plate length", "plate_mm", 0, [](const Tag& tag) { return tag.plate_length; }},
      {"plate height", "plate_mm", 1, [](const Tag& tag) { return tag.plate_height; }},
      {"frame's inner length", "feature_frame_inner_mm", 0,
       [](const Tag& tag) { return tag.frame_inner_length; }},
      {"frame's inner height", "feature_frame_inner_mm", 1,
       [](const Tag& tag) { return tag.frame_inner_height; }},
      {"frame's stroke",
       "feature_frame_stroke_mm",
       {},
       [](const Tag& tag) { return tag.frame_stroke; }},
      {"frame's offset right", "frame_offset_mm", 0,
       [](const Tag& tag) { return tag.frame_offset_right; }},
      {"frame's offset up", "frame_offset_mm", 1,
       [](const Tag& tag) { return tag.frame_offset_up; }},
      {"module", "module_mm", {}, [](const Tag& tag) { return module_width(tag); }},
      {"bars' height", "bar_height_mm", {}, [](const Tag& tag) { return bar_height(tag); }},
  };
  return kLengths;
}

std::string describe_template_change(const TagTemplate& before, const TagTemplate& after) {
  if (before.white_on_black != after.white_on_black) {
    return after.white_on_black ? "it becomes white on black" : "it becomes black on white";
  }
  constexpr double kSameLength = 1e-6;
  for (const PrintedLength& length : printed_lengths()) {
    if (std::abs(length.of(before) - length.of(after)) < kSameLength) continue;
    return fmt::format("the {} becomes {} mm (was {})", length.name,
                       format_number(length.of(after) * 1000, 3),
                       format_number(length.of(before) * 1000, 3));
  }
  return {};
}

std::vector<TagDifference> compare_surveys(const Survey& before, const Survey& after) {
  const std::string template_change =
      describe_template_change(before.tag_template, after.tag_template);
  std::map<std::string, const PlacedTag*> old_tags;
  for (const PlacedTag& tag : before.tags) old_tags[tag.name] = &tag;
  std::vector<TagDifference> differences;
  for (const PlacedTag& tag : after.tags) {
    const auto old = old_tags.find(tag.name);
    if (old == old_tags.end()) {
      differences.push_back(
          {tag.name, TagChange::print, 0,
           "new, digits " + to_string(tag.digits) + ", P at " + place_text(tag.p_in_grid)});
      continue;
    }
    if (auto difference = compare(*old->second, tag, template_change)) {
      differences.push_back(*difference);
    }
    old_tags.erase(old);
  }
  for (const PlacedTag& tag : before.tags) {
    if (!old_tags.contains(tag.name)) continue;
    differences.push_back({tag.name, TagChange::remove, 0,
                           "no longer in the survey; it hangs at " + place_text(tag.p_in_grid)});
  }
  return differences;
}

std::vector<ReadElsewhere> read_elsewhere(const Survey& before, const Survey& after) {
  std::map<Digits, const PlacedTag*> by_digits;
  for (const PlacedTag& tag : after.tags) by_digits[tag.digits] = &tag;
  std::vector<ReadElsewhere> plates;
  for (const PlacedTag& tag : before.tags) {
    const auto read = by_digits.find(tag.digits);
    if (read == by_digits.end()) continue;
    const bool was_measured = read->second->name == tag.name && !read->second->date.empty();
    const double distance = distance_between(tag, *read->second);
    if (distance > kSamePlace && !was_measured)
      plates.push_back({tag.name, read->second->name, distance});
  }
  return plates;
}

}  // namespace tagsmith::detail
