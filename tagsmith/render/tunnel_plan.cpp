// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/tunnel_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/side_line.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

// On paper, metres.
constexpr double kTagNameHeight = 0.0018;
constexpr double kLeastDrive = 0.0060;  // between the walls
constexpr double kPlateThickness = 0.0007;
constexpr double kNameClear = 0.0022;       // between wall and name
constexpr double kStripOverhead = 0.032;    // names on both sides of the walls, title
constexpr double kAxesOverhead = 0.030;     // axes beside the strip, names that stand over its ends
constexpr double kMostTurn = radians(150);  // of one strip: a tighter one would overlap itself

// A line beside the center line all along the strip.
std::vector<SketchPoint> beside(const Centerline& line, const ChainageProfile& offset,
                                const PlanStrip& strip) {
  constexpr double kSagitta = 0.0005;
  return line_in_view(strip, line, offset, strip.from, strip.to, kSagitta);
}

PlanStrip make_strip(const Centerline& line, double from, double to) {
  PlanStrip strip{from, to};
  const CenterlinePoint start = line.at(from);
  Vector2d along = (line.at(to).position - start.position).head<2>();
  if (along.norm() < 1e-6 * (to - from)) along = direction_of(start.heading).head<2>();
  const double turn = -std::atan2(along.y(), along.x());
  strip.view_from_world =
      Eigen::Rotation2Dd(turn) * Eigen::Translation2d(Vector2d(-start.position.head<2>()));
  return strip;
}

// Width and height of the walls in the strip's view, metres on the ground.
Vector2d extent_of(const Survey& survey, const PlanStrip& strip) {
  Eigen::AlignedBox2d box;
  for (const Side side : {Side::left, Side::right}) {
    for (const SketchPoint& point :
         beside(survey.tunnel.centerline, rock_of(survey.tunnel, side), strip)) {
      box.extend(point.model);
    }
  }
  return box.sizes();
}

double turn_of(const Centerline& line, const PlanStrip& strip) {
  double turn = 0;
  double start = 0;
  for (const CenterlineElement& element : line.elements()) {
    const double length = std::min(strip.to, start + element.length) - std::max(strip.from, start);
    if (length > 0) turn += std::abs(element.curvature) * length;
    start += element.length;
  }
  return turn;
}

// Where the tunnel is drawn: all of it, and where tags hang before its start or beyond its end.
std::pair<double, double> drawn_chainages(const Survey& survey) {
  double from = 0;
  double to = survey.tunnel.centerline.length();
  for (const PlacedTag& tag : survey.tags) {
    from = std::min(from, tag.chainage - survey.tag_template.plate_length);
    to = std::max(to, tag.chainage + survey.tag_template.plate_length);
  }
  return {from, to};
}

Vector2d room_for_strips(Paper paper) {
  return drawing_area(paper) - Vector2d(kAxesOverhead, kStripOverhead);
}

// The longest strip from here on that fits the room, ending at a multiple of the step.
PlanStrip longest_strip(const Survey& survey, double from, double to, const Vector2d& room,
                        double step) {
  const Centerline& line = survey.tunnel.centerline;
  const auto fits = [&](const PlanStrip& strip) {
    return (extent_of(survey, strip).array() <= room.array()).all() &&
           turn_of(line, strip) <= kMostTurn;
  };
  double count = std::floor(room.x() / step);
  const double first = std::floor(from / step + 1e-9) * step;
  while (true) {
    PlanStrip strip = make_strip(line, from, std::min(to, first + count * step));
    if (count <= 1 || fits(strip)) return strip;
    --count;
  }
}

std::vector<PlanStrip> cut_into_strips(const Survey& survey, double from, double to,
                                       const Vector2d& room) {
  const double step = round_step(room.x() / 20);
  std::vector<PlanStrip> strips;
  while (from < to - 1e-9) {
    strips.push_back(longest_strip(survey, from, to, room, step));
    from = strips.back().to;
  }
  return strips;
}

void draw_tunnel(Sketch& sketch, const Survey& survey, const PlanStrip& strip) {
  const Centerline& line = survey.tunnel.centerline;
  const auto left = beside(line, rock_of(survey.tunnel, Side::left), strip);
  const auto right = beside(line, rock_of(survey.tunnel, Side::right), strip);
  std::vector<SketchPoint> floor = left;
  floor.insert(floor.end(), right.rbegin(), right.rend());
  sketch.layer("floor").add(Area{floor, {0.95, 0.95, 0.93}});
  for (const auto& wall : {left, right}) {
    sketch.layer("walls").add(Polyline{wall, {.width = kWide}});
  }
  sketch.layer("centerline")
      .add(Polyline{beside(line, 0, strip), {colours::kGrey, kNarrow, long_dashed_dotted()}});
}

void draw_chainages(SketchLayer& layer, const Survey& survey, const PlanStrip& strip) {
  for (const double chainage : plan_ticks(strip)) {
    const CenterlinePoint point = survey.tunnel.centerline.at(chainage);
    const Vector2d at = strip.in_view(point.position);
    const Vector2d across = strip.turned(right_of(point.heading));
    const Vector2d along = strip.turned(direction_of(point.heading));
    layer.add(
        Polyline{{{at, across * 0.001}, {at, across * -0.001}}, {colours::kBlue, kNarrow, {}}});
    layer.add(Words{.text = format_number(chainage, 3),
                    .at = {at, along * 0.0006 - across * 0.0007},
                    .height = 0.0014,
                    .angle = std::atan2(along.y(), along.x()),
                    .colour = colours::kBlue});
  }
}

void draw_plate(SketchLayer& layer, const Survey& survey, const PlanStrip& strip,
                const PlacedTag& tag) {
  const Pose& pose = tag.world_from_plate;
  const double left = plate_outline(survey.tag_template).x;
  const double right = left + survey.tag_template.plate_length;
  const Vector2d from = strip.in_view(pose * Eigen::Vector3d(left, 0, 0));
  const Vector2d to = strip.in_view(pose * Eigen::Vector3d(right, 0, 0));
  const Vector2d middle = (from + to) / 2;
  const Vector2d along = strip.turned(pose.rotation.col(0));
  const Vector2d into_rock = strip.turned(pose.rotation.col(2));
  const Vector2d back = into_rock * kPlateThickness;
  layer.add(Area{{from, to, {to, back}, {from, back}}, colours::kBlack});
  // Points the way the plate faces.
  layer.add(
      Area{{{middle, along * 0.0007}, {middle, along * -0.0007}, {middle, into_rock * -0.0016}},
           colours::kOrange});
  layer.add(Dot{strip.in_view(pose.translation), 0.0004, colours::kRed});
}

// Text beside the tag's wall, `clear` metres on paper away from it.
Words words_beside(const Survey& survey, const PlanStrip& strip, const PlacedTag& tag,
                   std::string text, double clear) {
  const Pose& pose = tag.world_from_plate;
  const Vector2d middle =
      strip.in_view(pose * Eigen::Vector3d(plate_middle(survey.tag_template), 0, 0));
  const Vector2d outward = strip.turned(pose.rotation.col(2)).normalized();
  const double angle = std::atan2(outward.y(), outward.x());
  // Readable from the right rather than turned upside down by a bend of the wall.
  const bool upside_down = angle > radians(105) || angle <= radians(-75);
  return {.text = std::move(text),
          .at = {middle, outward * clear},
          .height = kTagNameHeight,
          .angle = upside_down ? angle + std::numbers::pi : angle,
          .align = upside_down ? TextAlign::right : TextAlign::left,
          .level = TextLevel::middle};
}

Words name_of(const Survey& survey, const PlanStrip& strip, const PlacedTag& tag) {
  return words_beside(survey, strip, tag, tag.name, kNameClear);
}

// The gap that a tenth of the gaps between neighbours on one wall are shorter than; infinity
// without neighbours.
double tight_gap(const Survey& survey) {
  std::vector<double> gaps;
  for (const Side side : {Side::left, Side::right}) {
    std::vector<double> chainages;
    for (const PlacedTag& tag : survey.tags) {
      if (tag.side == side) chainages.push_back(tag.chainage);
    }
    std::ranges::sort(chainages);
    for (std::size_t i = 1; i < chainages.size(); ++i) {
      gaps.push_back(chainages[i] - chainages[i - 1]);
    }
  }
  if (gaps.empty()) return 1e9;
  const auto tenth = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 10);
  std::ranges::nth_element(gaps, tenth);
  return std::max(*tenth, 0.1 * survey.tag_template.plate_length);
}

}  // namespace

Vector2d PlanStrip::in_view(const Eigen::Vector3d& point) const {
  return view_from_world * Vector2d(point.head<2>());
}

Vector2d PlanStrip::turned(const Eigen::Vector3d& direction) const {
  return view_from_world.linear() * Vector2d(direction.head<2>());
}

std::vector<SketchPoint> line_in_view(const PlanStrip& strip, const Centerline& line,
                                      const ChainageProfile& offset, double from, double to,
                                      double sag) {
  std::vector<SketchPoint> points;
  for (const SidePoint& point : side_points(line, offset, from, to, sag)) {
    points.emplace_back(strip.in_view(point.position));
  }
  return points;
}

double coarsest_plan_scale(const Survey& survey, const PlanLegibility& least) {
  const double by_names = tight_gap(survey) / least.name_pitch;
  const double by_plates =
      least.plate > 0 ? survey.tag_template.plate_length / least.plate : by_names;
  const double by_walls = least_width(survey.tunnel) / kLeastDrive;
  // round_scale goes to the next coarser one; the one before it is needed.
  const double most = std::min({by_names, by_plates, by_walls});
  double scale = round_scale(most / 2.6);
  while (round_scale(scale * 1.01) <= most) scale = round_scale(scale * 1.01);
  return scale;
}

Rectangle plate_outline(const TagTemplate& tag) { return draw_tag(tag, Digits{}).plate; }

double plate_middle(const TagTemplate& tag) {
  return tag.frame_inner_length / 2 - tag.frame_offset_right;
}

std::vector<double> plan_ticks(const PlanStrip& strip) {
  const double step = round_step((strip.to - strip.from) / 20);
  const double first = std::ceil(strip.from / step - 1e-9);
  std::vector<double> chainages;
  for (int i = 0; (first + i) * step <= strip.to + step * 1e-9; ++i) {
    chainages.push_back((first + i) * step);
  }
  return chainages;
}

PlanStrip plan_strip(const Survey& survey, double from, double to) {
  return make_strip(survey.tunnel.centerline, from, to);
}

std::vector<PlanStrip> plan_strips(const Survey& survey, Paper paper, const PlanLegibility& least) {
  const auto [from, to] = drawn_chainages(survey);
  const Vector2d room = room_for_strips(paper);
  const PlanStrip whole = make_strip(survey.tunnel.centerline, from, to);
  const double needed = (extent_of(survey, whole).array() / room.array()).maxCoeff();
  double scale = coarsest_plan_scale(survey, least);
  if (needed <= scale) return {whole};
  const double by_count = (to - from) / (kMostStrips / 2.0 * room.x());
  scale = round_scale(std::max(scale, by_count));
  return cut_into_strips(survey, from, to, room * scale);
}

Words words_beyond_name(const Survey& survey, const PlanStrip& strip, const PlacedTag& tag,
                        std::string text) {
  const double clear = kNameClear + text_width(tag.name + " ", kTagNameHeight);
  return words_beside(survey, strip, tag, std::move(text), clear);
}

Sketch tunnel_plan(const Survey& survey, const PlanStrip& strip) {
  Sketch sketch;
  draw_tunnel(sketch, survey, strip);
  draw_chainages(sketch.layer("centerline"), survey, strip);
  for (const PlacedTag& tag : survey.tags) {
    if (!strip.has(tag)) continue;
    draw_plate(sketch.layer("tags"), survey, strip, tag);
    sketch.layer("names").add(name_of(survey, strip, tag));
  }
  return sketch;
}

ViewAxes plan_axes(const Survey& survey, const PlanStrip& strip) {
  ViewAxes axes;
  axes.x = strip.turned(world_from_grid(survey.grid, {1, 0, 0}));
  axes.y = strip.turned(world_from_grid(survey.grid, {0, 1, 0}));
  return axes;
}

DrawingView plan_view(const Survey& survey, const PlanStrip& strip) {
  DrawingView view;
  view.title =
      "Plan, chainage " + format_number(strip.from, 1) + " to " + format_number(strip.to, 1) + " m";
  view.sketch = tunnel_plan(survey, strip);
  view.axes = plan_axes(survey, strip);
  view.new_row = true;
  return view;
}

}  // namespace tagsmith::detail
