// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/draft_survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <string_view>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/draft/fit_plan.hpp"
#include "tagsmith/draft/move_to_p.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {
namespace {

template <class Values>
std::string joined(const Values& values) {
  std::string text;
  for (const auto& value : values) {
    text += (text.empty() ? "" : ", ") + format_number(static_cast<double>(value));
  }
  return "[" + text + "]";
}

std::string grade_key(const CenterlineElement& element) {
  return element.grade == 0 ? "" : ", grade: " + format_number(100 * element.grade, 8);
}

std::string element_text(const CenterlineElement& element) {
  constexpr double kFlat = 1e-4;  // 1/m: more digits are written of small angles
  const std::string grade = grade_key(element);
  if (element.curvature == 0) return "{ line: " + format_number(element.length) + grade + " }";
  const double angle = element.length * std::abs(element.curvature);
  const int decimals = std::abs(element.curvature) < kFlat ? 12 : 8;
  return "{ arc: " + format_number(1 / std::abs(element.curvature)) +
         ", turn: " + (element.curvature > 0 ? "right" : "left") +
         ", angle: " + format_number(degrees(angle), decimals) + grade + " }";
}

// Nothing for elements that no key of a survey describes: other ones, and clothoids that bend to
// both sides.
std::optional<std::string> clothoid_text(std::span<const CenterlineElement> arcs) {
  const std::optional<Clothoid> clothoid = clothoid_of(arcs);
  if (!clothoid || clothoid->from * clothoid->to < 0) return std::nullopt;
  const auto& [length, from, to] = *clothoid;
  std::string text =
      "{ clothoid: " + format_number(length) + ", turn: " + (from + to > 0 ? "right" : "left");
  if (from != 0) text += ", from_radius: " + format_number(1 / std::abs(from));
  if (to != 0) text += ", to_radius: " + format_number(1 / std::abs(to));
  return text + grade_key(arcs.front()) + " }";
}

std::vector<std::string> element_texts(std::span<const CenterlineElement> elements) {
  std::vector<std::string> texts;
  while (!elements.empty()) {
    const std::span<const CenterlineElement> part = leading_part(elements);
    if (const auto clothoid = clothoid_text(part)) {
      texts.push_back(*clothoid);
    } else {
      std::ranges::transform(part, std::back_inserter(texts), element_text);
    }
    elements = elements.subspan(part.size());
  }
  return texts;
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
      room_text(draft.fit.tunnel), joined(grid_from_world(draft.grid, start.position)),
      format_number(degrees(grid_heading_from_world(draft.grid, start.heading)), 8));
  for (const std::string& element : element_texts(line.elements())) {
    text += "      - " + element + "\n";
  }
  return text;
}

// Plates that are to hang.
std::string series_text(const TagSeries& series) {
  return fmt::format(
      "  height: {}   # of P above the floor\n"
      "  spacing: {}\n"
      "  first: {}   # chainage of the first left P\n"
      "  pairs: {}\n",
      format_number(series.mount_height), format_number(series.spacing),
      format_number(series.first), series.pairs);
}

// How many of the points across a drive its shape does not need: three numbers are fitted for a
// straight line with its width, two for each further element.
double freedom_of(const Centerline& line, double points) {
  return points - 1 - 2 * static_cast<double>(line.elements().size());
}

// How far points lie from the fitted walls, one standard deviation, metres.
struct AcrossScatter {
  std::string_view of;  // points of walls and tags, or tags alone
  double sigma = 0;
};

// The scatter of all points, or that of the tags where it is greater: walls may be measured better,
// or by another instrument. Nothing where it does not show how well they were measured: in walls
// that run through their points or are rougher than any survey, for few points, for computed ones,
// and for plates to come.
std::optional<AcrossScatter> scatter_across(const SurveyDraft& draft) {
  constexpr double kRoughest = 0.03;
  constexpr double kLeastFreedom = 5;
  const Tunnel& tunnel = draft.fit.tunnel;
  if (draft.series || draft.of_export) return std::nullopt;
  if (!tunnel.left.is_constant() || !tunnel.right.is_constant()) return std::nullopt;
  double points = 0;
  double tags = 0;
  double squares_of_tags = 0;
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    const std::optional<double>& across = draft.fit.residuals[i].across;
    if (!across) continue;
    ++points;
    if (!is_tag(draft.points[i])) continue;
    ++tags;
    squares_of_tags += *across * *across;
  }
  const double freedom = freedom_of(tunnel.centerline, points);
  if (freedom < kLeastFreedom || tags == 0) return std::nullopt;
  const double fitted = std::sqrt(points / freedom);  // the fit took a part of all scatter
  const double by_tags = std::sqrt(squares_of_tags / tags);
  const AcrossScatter scatter = by_tags > draft.fit.rms_across
                                    ? AcrossScatter{"tags", by_tags * fitted}
                                    : AcrossScatter{"points", draft.fit.rms_across * fitted};
  const bool tells = scatter.sigma >= kFinest && scatter.sigma <= kRoughest;
  return tells ? std::optional(scatter) : std::nullopt;
}

// How well the directions of plates are known that follow the drafted walls, and why not better
// than usual: the walls may be rough, and the points may determine them badly. Nothing where it is
// as usual, or the list states all directions.
struct DraftedAngle {
  double sigma = 0;  // degrees
  std::string why;
};

std::optional<DraftedAngle> angle_sigma_of(const SurveyDraft& draft) {
  const bool all_stated = std::ranges::all_of(draft.points, [](const SurveyedPoint& point) {
    return !is_tag(point) || (point.attitude && point.attitude->facing);
  });
  if (all_stated && !draft.series) return std::nullopt;
  const double on_walls = usual_angle_sigma(draft.fit.tunnel, draft.tag);
  constexpr double kMostStated = radians(45);  // that a survey may state
  const double by_fit = std::min(draft.fit.heading_sigma, kMostStated);
  const double whole = std::min(std::hypot(on_walls, by_fit), kMostStated);
  const double sigma = std::round(10 * degrees(whole)) / 10;
  if (radians(sigma) <= kUsualAngleSigma) return std::nullopt;
  if (on_walls > by_fit && on_walls > kUsualAngleSigma) {
    return DraftedAngle{sigma,
                        "the rock's direction under the plates scatters so;\n"
                        "                 # say facing of plates that hang parallel to the drive"};
  }
  return DraftedAngle{sigma,
                      fmt::format("the points determine the walls' to {:.1f}", degrees(by_fit))};
}

// The plate, and how well the points fit a tunnel of one width.
std::string tags_text(const SurveyDraft& draft) {
  std::string text = "tags:\n  template: " + draft.template_name + "\n";
  if (draft.series) text += series_text(*draft.series);
  if (const auto scatter = scatter_across(draft)) {
    const double mm = std::max(1.0, std::ceil(1000 * scatter->sigma));
    text += fmt::format(
        "  sigma: {}   # of a coordinate: the {} scatter by {:.1f} mm across from the fitted "
        "walls;\n"
        "                 # rounded up to a millimetre. Your instrument may tell better.\n",
        format_number(mm / 1000), scatter->of, 1000 * scatter->sigma);
  }
  if (draft.angle_sigma) {
    text += "  angle_sigma: " + format_number(degrees(*draft.angle_sigma)) + "\n";
  } else if (const auto angle = angle_sigma_of(draft)) {
    text += fmt::format("  angle_sigma: {}   # of the plates' direction, degrees: {}\n",
                        format_number(angle->sigma), angle->why);
  }
  return text;
}

// The keys of an attitude that does not follow from the drafted wall; of a rough one nothing
// follows.
std::string attitude_keys(const SurveyDraft& draft, const SurveyedPoint& point) {
  if (!point.attitude) return {};
  const bool rough = usual_angle_sigma(draft.fit.tunnel, draft.tag) > kUsualAngleSigma;
  const PlateAttitude& attitude = *point.attitude;
  const auto key = [](const char* name, double angle) {
    return std::string(", ") + name + ": " + format_number(degrees(angle));
  };
  std::string text;
  if (attitude.facing &&
      (rough || !faces_as_wall(point, draft.grid, draft.fit.tunnel, draft.tag))) {
    text += key("facing", *attitude.facing);
  }
  if (attitude.tilt != 0) text += key("tilt", attitude.tilt);
  if (attitude.roll != 0) text += key("roll", attitude.roll);
  return text;
}

std::string placed_text(const SurveyDraft& draft, const SurveyedPoint& point) {
  std::string text = "  - { tag: " + tag_name(point.tag->pair, point.tag->side) +
                     ", side: " + to_string(point.tag->side) + ", p: " + joined(point.in_grid);
  if (!point.digits.empty()) text += ", digits: \"" + point.digits + "\"";
  if (point.sigma) text += ", sigma: " + format_number(*point.sigma);
  if (!point.date.empty()) text += ", date: " + point.date;
  if (point.control) text += ", control: true";
  if (point.design_in_grid) text += ", design: " + joined(*point.design_in_grid);
  return text + attitude_keys(draft, point) + " }\n";
}

// Digits that `extent` metres take.
int digits_for(double extent, double resolution) {
  return std::max(1, static_cast<int>(std::ceil(std::log10(extent / resolution + 2))));
}

// The tags of one pair that a draft has, one or two.
struct PairOfTags {
  int pair = 0;
  double first = 0;  // chainages of its tags
  double last = 0;
  std::vector<Eigen::Vector3d> positions;
};

struct WallPoint {
  double chainage = 0;
  int line = 0;  // of the list
};

struct WallGap {
  int line = 0;       // of the list's point beside it
  std::string where;  // chainages, in words
};

// The plates of the draft's series.
std::vector<PlacedTag> proposed_tags(const SurveyDraft& draft) {
  std::vector<PlacedTag> tags;
  if (!draft.series) return tags;
  Survey survey;
  survey.grid = draft.grid;
  survey.tunnel = draft.fit.tunnel;
  survey.tag_template = draft.tag;
  survey.series = draft.series;
  for (int pair = 0; pair < draft.series->pairs; ++pair) {
    for (const Side side : {Side::left, Side::right}) {
      tags.push_back(place_in_series(survey, pair, side));
    }
  }
  return tags;
}

std::vector<PairOfTags> pairs_of(const SurveyDraft& draft) {
  std::map<int, PairOfTags> pairs;
  const auto add = [&](int pair, double chainage, const Eigen::Vector3d& p_in_grid) {
    PairOfTags& tags = pairs.emplace(pair, PairOfTags{pair, chainage, chainage, {}}).first->second;
    tags.first = std::min(tags.first, chainage);
    tags.last = std::max(tags.last, chainage);
    tags.positions.push_back(p_in_grid);
  };
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    const SurveyedPoint& point = draft.points[i];
    if (is_tag(point)) add(point.tag->pair, draft.fit.residuals[i].chainage, point.in_grid);
  }
  for (const PlacedTag& tag : proposed_tags(draft)) add(tag.pair, tag.chainage, tag.p_in_grid);
  std::vector<PairOfTags> result;
  for (auto& [number, pair] : pairs) result.push_back(std::move(pair));
  return result;
}

// ---- Stretches of a wall without points.

// In the order of the drive.
std::vector<WallPoint> points_of_wall(const SurveyDraft& draft, Side side) {
  const PointKind wanted = side == Side::left ? PointKind::left_wall : PointKind::right_wall;
  std::vector<WallPoint> wall;
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    if (draft.points[i].kind != wanted) continue;
    wall.push_back({draft.fit.residuals[i].chainage, draft.points[i].line});
  }
  std::ranges::sort(wall, {}, &WallPoint::chainage);
  return wall;
}

// The gap between points in which half of the wall lies, or smaller ones: bends are often measured
// more densely than the rest.
double usual_gap(const std::vector<WallPoint>& wall) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < wall.size(); ++i) {
    gaps.push_back(wall[i].chainage - wall[i - 1].chainage);
  }
  std::ranges::sort(gaps);
  double left = wall.empty() ? 0 : (wall.back().chainage - wall.front().chainage) / 2;
  for (const double gap : gaps) {
    left -= gap;
    if (left <= 0) return gap;
  }
  return 0;
}

// Where no point shows the wall beside a chainage, between which points; nothing where one does.
std::optional<WallGap> gap_at(const std::vector<WallPoint>& wall, double chainage, double usual,
                              double plate_length) {
  constexpr double kTimes = 3;  // the usual gap
  const auto next = std::ranges::upper_bound(wall, chainage, {}, &WallPoint::chainage);
  const double beyond = std::max(usual, plate_length);
  if (next == wall.begin()) {
    if (next->chainage - chainage <= beyond) return std::nullopt;
    return WallGap{next->line, fmt::format("before {:.1f} m", next->chainage)};
  }
  const WallPoint& before = *std::prev(next);
  if (next == wall.end()) {
    if (chainage - before.chainage <= beyond) return std::nullopt;
    return WallGap{before.line, fmt::format("beyond {:.1f} m", before.chainage)};
  }
  if (next->chainage - before.chainage <= std::max(kTimes * usual, plate_length)) {
    return std::nullopt;
  }
  return WallGap{before.line,
                 fmt::format("between {:.1f} and {:.1f} m", before.chainage, next->chainage)};
}

// ---- Parts of a draft.

constexpr double kFinestResolution = 0.01;  // metres

std::vector<Eigen::Vector3d> positions_of(std::span<const PairOfTags> pairs) {
  std::vector<Eigen::Vector3d> positions;
  for (const PairOfTags& pair : pairs) {
    positions.insert(positions.end(), pair.positions.begin(), pair.positions.end());
  }
  return positions;
}

Eigen::AlignedBox3d box_around(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : positions) box.extend(p);
  return box;
}

// One beyond the last pair that a code of the finest resolution reaches from `begin` on.
std::size_t end_of_part(const std::vector<PairOfTags>& pairs, std::size_t begin, CheckDigit check) {
  std::vector<Eigen::Vector3d> corners;  // of the box around the pairs so far
  std::size_t end = begin;
  for (; end < pairs.size(); ++end) {
    std::vector<Eigen::Vector3d> tried = corners;
    tried.insert(tried.end(), pairs[end].positions.begin(), pairs[end].positions.end());
    const Result<PositionCode> code = code_for(tried, check);
    if (!code || code->resolution[0] > kFinestResolution) break;
    const Eigen::AlignedBox3d box = box_around(tried);
    corners = {box.min(), box.max()};
  }
  return end;
}

// By how much the origin of a code may be lowered so that its tags get other digits: whole metres,
// and uneven lengths for plates at whole metres from each other. Such shifts stay within the digits
// that reach below a range.
std::vector<Eigen::Vector3d> shifts_of_origin() {
  constexpr int kMost = 9;
  std::vector<Eigen::Vector3d> shifts{Eigen::Vector3d::Zero()};
  for (const double step : {1.0, 0.37}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 1; i <= kMost; ++i) shifts.emplace_back(i * step * Eigen::Vector3d::Unit(axis));
    }
  }
  return shifts;
}

// The digits of the positions; nothing where one has none, or one that is already used.
std::optional<std::set<Digits>> free_digits(const PositionCode& code,
                                            const std::vector<Eigen::Vector3d>& positions,
                                            const std::set<Digits>& taken) {
  std::set<Digits> digits;
  for (const Eigen::Vector3d& p : positions) {
    const auto encoded = encode_position(code, {p.x(), p.y(), p.z()});
    if (!encoded || taken.contains(encoded->digits)) return std::nullopt;
    digits.insert(encoded->digits);
  }
  return digits;
}

// A code for the pairs with which none of them has digits that are used; then theirs are used.
Result<PositionCode> untaken_code(std::span<const PairOfTags> pairs, CheckDigit check,
                                  std::set<Digits>& taken) {
  const std::vector<Eigen::Vector3d> positions = positions_of(pairs);
  Result<PositionCode> usual = code_for(positions, check);
  if (!usual) return usual;
  for (const Eigen::Vector3d& shift : shifts_of_origin()) {
    PositionCode code = *usual;
    for (std::size_t i = 0; i < 3; ++i) code.origin[i] -= shift[static_cast<Eigen::Index>(i)];
    auto digits = free_digits(code, positions, taken);
    if (!digits) continue;
    taken.merge(*digits);
    return code;
  }
  return fail("no code was found for the part from " + tag_name(pairs.front().pair, Side::left) +
              " on with which its tags differ from those of the parts before it: draft the parts "
              "from lists of their own, and give each another code.origin");
}

ChainageProfile profile_between(const ChainageProfile& profile, double from, double to) {
  if (profile.is_constant()) return profile;
  std::vector<ProfileStation> stations{{0, profile.at(from)}};
  for (const ProfileStation& station : profile.stations()) {
    if (station.chainage <= from || station.chainage >= to) continue;
    stations.push_back({station.chainage - from, station.value});
  }
  stations.push_back({to - from, profile.before(to)});
  return ChainageProfile(std::move(stations));
}

Tunnel tunnel_between(const Tunnel& tunnel, double from, double to) {
  const CenterlinePoint start = tunnel.centerline.at(from);
  Tunnel part = tunnel;
  part.centerline = Centerline(start.position, start.heading,
                               elements_between(tunnel.centerline.elements(), from, to));
  part.left = profile_between(tunnel.left, from, to);
  part.right = profile_between(tunnel.right, from, to);
  part.height = profile_between(tunnel.height, from, to);
  return part;
}

// The draft between two chainages, with these pairs alone.
SurveyDraft part_between(const SurveyDraft& draft, std::span<const PairOfTags> pairs, double from,
                         double to) {
  SurveyDraft part = draft;
  part.points.clear();
  part.fit.residuals.clear();
  part.fit.tunnel = tunnel_between(draft.fit.tunnel, from, to);
  std::set<int> numbers;
  for (const PairOfTags& pair : pairs) numbers.insert(pair.pair);
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    const SurveyedPoint& point = draft.points[i];
    PointResidual residual = draft.fit.residuals[i];
    const bool inside = is_tag(point) ? numbers.contains(point.tag->pair)
                                      : residual.chainage >= from && residual.chainage < to;
    if (!inside) continue;
    residual.chainage -= from;
    part.points.push_back(point);
    part.fit.residuals.push_back(residual);
  }
  if (part.series) {
    const double pitch = draft.tag.plate_length + draft.series->spacing;
    part.series->first = draft.series->first + *numbers.begin() * pitch - from;
    part.series->pairs = static_cast<int>(pairs.size());
  }
  return part;
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
  # tilt: 4               # of plates on leaning walls: degrees, upper edge forward
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
      readout: 0, delay: 0, sigma: { position: 0.005, angle: 0.5, focal: 0.02, center: 12.8, edge: 0.1 } }
  right:
    { image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, side: right,
      readout: 0, delay: 0, sigma: { position: 0.005, angle: 0.5, focal: 0.02, center: 12.8, edge: 0.1 } }
  # sigma, one standard deviation each: position (m) and angle (degrees) of the
  # mounting, focal length (0.02 = 2 %: a lens by its data sheet), center of the image
  # (pixels). sigma: 0 calls all of them exact.
  # readout: 0 is a global shutter; of a rolling one, the seconds from the first row of an
  # image to the last (0.01 to 0.033, by the data sheet).
  # delay: 0 = triggered together; else how much earlier or later than the others it takes
  # its photo, seconds (0.01 to 0.03 of cameras that run freely).
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
      if (!is_tag(points[i]) || wall_of(points[i]) != side) continue;
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

Result<TagSeries> propose_series(const Tunnel& tunnel, const TagTemplate& tag,
                                 const LayoutWish& wish) {
  constexpr double kStep = 0.1;  // metres: chainages that are easily set out
  constexpr double kNudge = 1e-9;
  const double end = tunnel.centerline.length() - tag.plate_length;  // of what is surveyed
  TagSeries series;
  series.mount_height = wish.height;
  series.spacing = wish.spacing;
  series.first = wish.first.value_or(std::ceil(tag.plate_length / kStep - kNudge) * kStep);
  const double last = wish.to.value_or(end - tag.plate_length);
  const double count =
      std::floor((last - series.first) / (tag.plate_length + wish.spacing) + kNudge);
  if (count < 0) {
    return fail(
        fmt::format("no pair of plates fits between chainage {} and {} m of a tunnel {} m "
                    "long: other values of --first and --to",
                    format_number(series.first, 3), format_number(last, 3),
                    format_number(tunnel.centerline.length(), 3)));
  }
  if (count >= kMostTags / 2.0) return fail("more than a million plates: a wider --spacing");
  series.pairs = 1 + static_cast<int>(count);
  return series;
}

void check_proposed(const SurveyDraft& draft, FindingLog& log) {
  const std::vector<PlacedTag> tags = proposed_tags(draft);
  for (const Side side : {Side::left, Side::right}) {
    const std::vector<WallPoint> wall = points_of_wall(draft, side);
    if (wall.empty()) continue;
    const double usual = usual_gap(wall);
    struct Run {
      WallGap gap;
      std::string first;
      std::string last;
    };
    std::vector<Run> runs;
    for (const PlacedTag& tag : tags) {
      if (tag.side != side) continue;
      const Eigen::Vector3d middle =
          tag.world_from_plate * Eigen::Vector3d(draft.tag.frame_inner_length / 2, 0, 0);
      const double chainage = draft.fit.tunnel.centerline.locate(middle.head<2>()).chainage;
      const auto gap = gap_at(wall, chainage, usual, draft.tag.plate_length);
      if (!gap) continue;
      if (runs.empty() || runs.back().gap.where != gap->where) {
        runs.push_back({*gap, tag.name, tag.name});
      }
      runs.back().last = tag.name;
    }
    for (const Run& run : runs) {
      const bool one = run.first == run.last;
      log.warning(
          {run.gap.line, 0}, "no-wall",
          fmt::format("{}{}: no point of the {} wall {}, others are {:.1f} m apart",
                      one ? "tag " : "tags ", one ? run.first : run.first + " to " + run.last,
                      to_string(side), run.gap.where, usual),
          "is there a wall? list points of it there, or hang no plates in the opening");
    }
  }
}

void check_shape(const SurveyDraft& draft, FindingLog& log) {
  constexpr int kLeastFreedom = 2;
  const std::vector<CenterlineElement>& elements = draft.fit.tunnel.centerline.elements();
  const bool is_straight = elements.size() == 1 && elements.front().curvature == 0;
  int points = 0, first_line = 0;
  for (std::size_t i = 0; i < draft.points.size(); ++i) {
    const SurveyedPoint& point = draft.points[i];
    if (point.of_alignment || point.offset) return;  // the list states the shape itself
    if (!draft.fit.residuals[i].across) continue;
    if (points++ == 0) first_line = point.line;
  }
  const double freedom = freedom_of(draft.fit.tunnel.centerline, points);
  if (!is_straight && points > 0 && freedom < kLeastFreedom) {
    log.warning({first_line, 0}, "unchecked-shape",
                fmt::format("{} points determine a drive of {} {}, and none is left to check it",
                            points, elements.size(), elements.size() == 1 ? "arc" : "elements"),
                "is the drive bent so? list more points of the walls, or remove the wrong one");
    return;
  }
  for (const std::size_t i : draft.fit.unchecked) {
    const SurveyedPoint& point = draft.points[i];
    log.warning({point.line, 0}, "unchecked-shape",
                fmt::format("the tunnel follows point {} ({}) alone: no other point would show "
                            "that it is wrong",
                            point.name.substr(0, 60), to_string(point.kind)),
                "is the drive so there? measure more points beside it, or remove it");
  }
}

std::vector<Eigen::Vector3d> tag_positions(const SurveyDraft& draft) {
  return positions_of(pairs_of(draft));
}

Result<PositionCode> code_for(const std::vector<Eigen::Vector3d>& positions, CheckDigit check) {
  const Eigen::AlignedBox3d box = box_around(positions);
  PositionCode code;
  code.check = check;
  Eigen::Vector3d origin = (box.min().array() - 1).floor();
  for (const double resolution : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0}) {
    std::array<int, 3> counts{};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<std::size_t>(axis);
      counts[index] = digits_for(box.max()[axis] - origin[axis], resolution);
    }
    const int spare =
        static_cast<int>(kPayloadDigits) - std::accumulate(counts.begin(), counts.end(), 0);
    if (spare < 0) continue;
    for (int i = 0; i < spare; ++i) ++counts[static_cast<std::size_t>(i % 2)];
    code.digit_counts = counts;
    code.resolution = {resolution, resolution, resolution};
    code.origin = {origin.x(), origin.y(), origin.z()};
    return code;
  }
  const Eigen::Vector3d span = box.sizes();
  return fail(
      fmt::format("the tags lie {:.0f} m, {:.0f} m and {:.0f} m apart along x, y and z, too "
                  "far for eleven digits: check the farthest, or --split",
                  span.x(), span.y(), span.z()));
}

Result<std::vector<DraftPart>> split_draft(const SurveyDraft& draft) {
  std::vector<PairOfTags> pairs = pairs_of(draft);
  std::ranges::stable_sort(pairs, {}, &PairOfTags::first);
  const double length = draft.fit.tunnel.centerline.length();
  const double plate = draft.tag.plate_length;
  const bool has_digits = std::ranges::any_of(
      draft.points, [](const SurveyedPoint& point) { return !point.digits.empty(); });
  if (has_digits) {
    return fail("the list says the digits that are printed on its plates: leave --split out");
  }
  std::vector<DraftPart> parts;
  std::set<Digits> taken;
  double from = 0;
  for (std::size_t begin = 0; begin < pairs.size();) {
    const std::size_t end = end_of_part(pairs, begin, draft.code.check);
    if (end == begin)
      return fail("a pair's tags lie too far apart for one code: check " +
                  tag_name(pairs[begin].pair, Side::left));
    const std::span<const PairOfTags> run = std::span(pairs).subspan(begin, end - begin);
    const double last = std::ranges::max(run, {}, &PairOfTags::last).last;
    const bool is_last = end == pairs.size();
    // Halfway to the next tag, or further, so that each plate hangs wholly in its part.
    const double border = is_last ? length : (last + pairs[end].first) / 2;
    const double to = is_last ? length : std::min(length, std::max(border, last + plate));
    DraftPart part{part_between(draft, run, from, to), from, to};
    part.draft.name += "-" + std::to_string(parts.size() + 1);
    const Result<PositionCode> code = untaken_code(run, draft.code.check, taken);
    if (!code) return fail(code);
    part.draft.code = *code;
    parts.push_back(std::move(part));
    if (!is_last) from = std::clamp(pairs[end].first - plate, 0.0, border);
    begin = end;
  }
  return parts;
}

std::string draft_survey(const SurveyDraft& draft) {
  const PositionCode& code = draft.code;
  std::string text = fmt::format(
      "# Drafted from {}: {} points, {:.1f} mm rms across the tunnel, {:.1f} mm up and down.\n"
      "# Check it with `tagsmith validate`, look at it with `tagsmith draw`.\n"
      "survey: {}\n"
      "grid: {{ x_axis: {}{} }}\n",
      terminal_text(draft.source), draft.points.size(), draft.fit.rms_across * 1000,
      draft.fit.rms_up * 1000, draft.name, draft.grid.x_axis_left ? "left" : "right",
      draft.grid.epsg == 0 ? "" : fmt::format(", crs: EPSG:{}", draft.grid.epsg));
  text += tunnel_text(draft);
  text += tags_text(draft);
  text += fmt::format("code: {{ check_digit: {}, resolution: {}, digits: {}, origin: {} }}\n",
                      to_string(code.check), joined(code.resolution), joined(code.digit_counts),
                      joined(code.origin));
  std::vector<const SurveyedPoint*> tags;
  for (const SurveyedPoint& point : draft.points) {
    if (is_tag(point)) tags.push_back(&point);
  }
  std::ranges::sort(tags, {}, [](const SurveyedPoint* point) {
    return std::pair(point->tag->pair, point->tag->side);
  });
  if (!tags.empty()) text += "placed:   # P as surveyed\n";
  for (const SurveyedPoint* tag : tags) text += placed_text(draft, *tag);
  return text;
}

}  // namespace tagsmith::detail
