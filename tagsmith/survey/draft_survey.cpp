// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/draft_survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "tagsmith/base/printable.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kPayloadDigits = kDigitCount - 1;

bool is_tag(const SurveyedPoint& point) {
  return point.kind == PointKind::left_tag || point.kind == PointKind::right_tag;
}

Side side_of(const SurveyedPoint& point) {
  return point.kind == PointKind::left_tag ? Side::left : Side::right;
}

std::string list_of(const Eigen::Vector3d& p) {
  return "[" + format_number(p.x()) + ", " + format_number(p.y()) + ", " + format_number(p.z()) +
         "]";
}

template <class Values>
std::string joined(const Values& values) {
  std::string text;
  for (const auto& value : values) {
    text += (text.empty() ? "" : ", ") + format_number(static_cast<double>(value));
  }
  return "[" + text + "]";
}

std::string element_text(const CenterlineElement& element) {
  const std::string grade =
      element.grade == 0 ? "" : ", grade: " + format_number(100 * element.grade, 8);
  if (element.curvature == 0) return "{ line: " + format_number(element.length) + grade + " }";
  const double angle = element.length * std::abs(element.curvature);
  return "{ arc: " + format_number(1 / std::abs(element.curvature)) +
         ", turn: " + (element.curvature > 0 ? "right" : "left") +
         ", angle: " + format_number(degrees(angle), 8) + grade + " }";
}

std::string stations_text(const ChainageProfile& profile) {
  std::string text;
  for (const ProfileStation& station : profile.stations()) {
    text += "      - " + joined(std::array{station.chainage, std::abs(station.value)}) + "\n";
  }
  return text;
}

// Walls, roof and stand-off: the keys beside `centerline`.
std::string room_text(const Tunnel& tunnel) {
  std::string text;
  if (tunnel.height.is_constant()) {
    text = "  height: " + format_number(tunnel.height.at(0)) + "\n";
  } else {
    text = "  sections:\n";
    for (const ProfileStation& station : tunnel.height.stations()) {
      text += "    - { at: " + format_number(station.chainage) +
              ", height: " + format_number(station.value) + " }\n";
    }
  }
  if (tunnel.left.is_constant() && tunnel.right.is_constant()) {
    return "  width: " + format_number(width_at(tunnel, 0)) +
           "   # between the planes of the left and the right plates\n" + text;
  }
  return text + "  walls:   # [chainage, distance from the center line], through the points\n" +
         "    left:\n" + stations_text(tunnel.left) + "    right:\n" + stations_text(tunnel.right);
}

std::string tunnel_text(const SurveyDraft& draft) {
  const Centerline& line = draft.fit.tunnel.centerline;
  const CenterlinePoint start = line.at(0);
  std::string text = fmt::format(
      "tunnel:\n"
      "{}"
      "  centerline:\n"
      "    start: {}   # on the floor\n"
      "    heading: {}   # degrees from +y towards +x\n"
      "    elements:\n",
      room_text(draft.fit.tunnel), list_of(grid_from_world(draft.grid, start.position)),
      format_number(degrees(grid_heading_from_world(draft.grid, start.heading)), 8));
  for (const CenterlineElement& element : line.elements()) {
    text += "      - " + element_text(element) + "\n";
  }
  return text;
}

// The plate, and how well the points fit a tunnel of one width; walls that run through their points
// do not tell.
std::string tags_text(const SurveyDraft& draft) {
  const Tunnel& tunnel = draft.fit.tunnel;
  if (!tunnel.left.is_constant() || !tunnel.right.is_constant()) {
    return "tags: { template: " + draft.template_name + " }\n";
  }
  const auto points = std::ranges::count_if(draft.fit.residuals, [](const PointResidual& residual) {
    return residual.across.has_value();
  });
  const double mm = std::max(1.0, std::ceil(1000 * draft.fit.rms_across));
  return fmt::format(
      "tags:\n"
      "  template: {}\n"
      "  sigma: {}   # of a coordinate: {} points lie {:.1f} mm rms across from the fitted walls;\n"
      "                 # rounded up to a millimetre. Your instrument may tell better.\n",
      draft.template_name, format_number(mm / 1000), points, 1000 * draft.fit.rms_across);
}

// The keys of an attitude that the drafted wall does not say already.
std::string attitude_keys(const SurveyDraft& draft, const SurveyedPoint& point) {
  constexpr double kSame = radians(0.02);
  if (!point.attitude) return {};
  const PlateAttitude& attitude = *point.attitude;
  const Pose on_wall = plate_on_wall(draft.fit.tunnel, draft.tag, point.tag->side,
                                     world_from_grid(draft.grid, point.in_grid));
  const double by_wall = grid_heading_from_world(draft.grid, facing_of(on_wall));
  const double turned =
      std::remainder(attitude.facing.value_or(by_wall) - by_wall, 2 * std::numbers::pi);
  const auto key = [](const char* name, double angle) {
    return std::string(", ") + name + ": " + format_number(degrees(angle));
  };
  std::string text;
  if (std::abs(turned) > kSame) text += key("facing", *attitude.facing);
  if (attitude.tilt != 0) text += key("tilt", attitude.tilt);
  if (attitude.roll != 0) text += key("roll", attitude.roll);
  return text;
}

std::string placed_text(const SurveyDraft& draft, const SurveyedPoint& point) {
  std::string text = "  - { tag: " + tag_name(point.tag->pair, point.tag->side) +
                     ", side: " + to_string(point.tag->side) + ", p: " + list_of(point.in_grid);
  if (!point.digits.empty()) text += ", digits: \"" + point.digits + "\"";
  if (point.sigma) text += ", sigma: " + format_number(*point.sigma);
  if (!point.date.empty()) text += ", date: " + point.date;
  if (point.design_in_grid) text += ", design: " + list_of(*point.design_in_grid);
  return text + attitude_keys(draft, point) + " }\n";
}

// Digits that `extent` metres take.
int digits_for(double extent, double resolution) {
  return std::max(1, static_cast<int>(std::ceil(std::log10(extent / resolution + 2))));
}

}  // namespace

std::string survey_to_edit(const std::string& name) {
  return R"yaml(# A survey to edit. Check it with `tagsmith validate`, look at it with `tagsmith draw`.
# Lengths are metres, angles degrees.
survey: )yaml" +
         name + R"yaml(
grid: { x_axis: right }   # of +y, seen from above; left where your x grows to the left
tunnel:
  width: 3.0              # between the planes of the left and the right plates
  height: 2.8             # of the roof above the floor
  centerline:
    start: [0.0, 0.0, 0.0]   # on the floor, in the mine's grid
    heading: 0               # of the drive, degrees from +y towards +x
    elements:                # from the start on, joined without bends
      - { line: 20.0 }
      # - { arc: 15.0, turn: left, angle: 40, grade: 1.5 }   # radius, side, degrees, rise in %
tags:
  template: tag-400x300   # the plate: own ones are tag-400x300 and tag-800x430
  height: 1.2             # of P, the upper left inner corner of the frame, above the floor
  spacing: 1.0            # clear gap between neighbouring plates of one wall
  first: 1.0              # chainage of the first left P
  pairs: 10               # or to: CHAINAGE
  # theta: 6.5            # leave out: plates then face each other exactly
  sigma: 0.003            # how well a coordinate is surveyed, one standard deviation;
                          # 0 = exact
  angle_sigma: 0.3        # how far plates lean or turn, degrees; 0.3: hung by eye
code:
  check_digit: gs1        # gs1: any bar code scanner; sum10: that of Xu et al. 2017
  resolution: 0.01        # metres of the last digit
  digits: [4, 4, 3]       # for x, y and z, eleven in all
  origin: [-10, -10, -1]  # subtracted first: nothing negative can be coded
# Plates as they hang, measured; `digits` as printed on them.
# placed:
#   - { tag: 003R, side: right, p: [1.498, 5.551, 1.203], digits: "114915552208", sigma: 0.002, date: 2026-03-31 }
)yaml";
}

std::string rig_to_edit(const std::string& name) {
  return R"yaml(# A vehicle's cameras and range sensors, to edit. x forward, y left, z up from its centre O.
rig: )yaml" +
         name + R"yaml(
cameras:   # by name; alpha = degrees between the optical axis and the cross section, forward
  left:
    { image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, side: left,
      sigma: { position: 0.005, angle: 0.5, focal: 0.02, center: 12.8, edge: 0.1 } }
  right:
    { image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, side: right,
      sigma: { position: 0.005, angle: 0.5, focal: 0.02, center: 12.8, edge: 0.1 } }
  # sigma, one standard deviation each: position (m) and angle (degrees) of the
  # mounting, focal length (0.02 = 2 %: a lens by its data sheet), center of the image
  # (pixels). sigma: 0 calls all of them exact.
  # a calibrated camera, mounted anywhere:
  # front: { image_size: [1280, 960], fx: 1600, fy: 1600, cx: 639.5, cy: 479.5,
  #          distortion: [0, 0, 0, 0, 0], yaw: 0, pitch: 0, roll: 0, position: [0.5, 0, 0.2],
  #          sigma: { position: 0.002, angle: 0.1, focal: 0.001, center: 1 } }
ranges:    # least horizontal distance from O to a wall
  d: { wall: left, min: 0.25, max: 5.0, sigma: 0.01 }
vehicle:
  height: 0.6       # of O above the floor
  roll_sigma: 2     # how far it leans, one standard deviation, degrees
  pitch_sigma: 2
)yaml";
}

void number_tags(std::vector<SurveyedPoint>& points, const TunnelFit& fit) {
  for (const Side side : {Side::left, Side::right}) {
    std::set<int> taken;
    std::vector<std::size_t> unnamed;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!is_tag(points[i]) || side_of(points[i]) != side) continue;
      if (points[i].tag) {
        taken.insert(points[i].tag->pair);
      } else {
        unnamed.push_back(i);
      }
    }
    std::ranges::stable_sort(unnamed, {}, [&](std::size_t i) { return fit.residuals[i].chainage; });
    int pair = 0;
    for (const std::size_t i : unnamed) {
      while (taken.contains(pair)) ++pair;
      points[i].tag = TagName{pair++, side};
    }
  }
}

Result<PositionCode> code_for(const std::vector<SurveyedPoint>& points, CheckDigit check) {
  Eigen::Vector3d low = points.front().in_grid;
  Eigen::Vector3d high = low;
  for (const SurveyedPoint& point : points) {
    low = low.cwiseMin(point.in_grid);
    high = high.cwiseMax(point.in_grid);
  }
  PositionCode code;
  code.check = check;
  Eigen::Vector3d origin = (low.array() - 1).floor();
  for (const double resolution : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0}) {
    std::array<int, 3> counts{};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<std::size_t>(axis);
      counts[index] = digits_for(high[axis] - origin[axis], resolution);
    }
    const int spare = kPayloadDigits - std::accumulate(counts.begin(), counts.end(), 0);
    if (spare < 0) continue;
    for (int i = 0; i < spare; ++i) ++counts[static_cast<std::size_t>(i % 2)];
    code.digit_counts = counts;
    code.resolution = {resolution, resolution, resolution};
    code.origin = {origin.x(), origin.y(), origin.z()};
    return code;
  }
  return fail("the points lie too far apart for eleven digits: make several surveys of them");
}

std::string draft_survey(const SurveyDraft& draft) {
  const PositionCode& code = draft.code;
  std::string text = fmt::format(
      "# Drafted from {}: {} points, {:.1f} mm rms across the tunnel, {:.1f} mm up and down.\n"
      "# Check it with `tagsmith validate`, look at it with `tagsmith draw`.\n"
      "survey: {}\n"
      "grid: {{ x_axis: {} }}\n",
      terminal_text(draft.source), draft.points.size(), draft.fit.rms_across * 1000,
      draft.fit.rms_up * 1000, draft.name, draft.grid.x_axis_left ? "left" : "right");
  text += tunnel_text(draft);
  text += tags_text(draft);
  text += fmt::format("code: {{ check_digit: {}, resolution: {}, digits: {}, origin: {} }}\n",
                      to_string(code.check), joined(code.resolution), joined(code.digit_counts),
                      joined(code.origin));
  text += "placed:   # P as surveyed\n";
  std::vector<const SurveyedPoint*> tags;
  for (const SurveyedPoint& point : draft.points) {
    if (is_tag(point)) tags.push_back(&point);
  }
  std::ranges::sort(tags, {}, [](const SurveyedPoint* point) {
    return std::pair(point->tag->pair, point->tag->side);
  });
  for (const SurveyedPoint* tag : tags) text += placed_text(draft, *tag);
  return text;
}

}  // namespace tagsmith::detail
