// SPDX-License-Identifier: Apache-2.0
// The details of a survey's drawing: cross section, pair, plate, rig.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/survey_views.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

constexpr const char* kDegree = "\u00b0";

std::vector<SketchPoint> box(const Vector2d& corner, const Vector2d& opposite) {
  return {corner, Vector2d(opposite.x(), corner.y()), opposite, Vector2d(corner.x(), opposite.y())};
}

// A plate in the cross section: a thick line on its wall, from its upper to its lower edge.
void draw_plate_edge(Sketch& sketch, const Survey& survey, const PlacedTag& tag) {
  const TagTemplate& plate = survey.tag_template;
  const double out = tag.side == Side::left ? -1 : 1;
  const double top = plate_outline(plate).y;
  const double floor = survey.tunnel.centerline.at(tag.chainage).position.z();
  const auto in_section = [&](double down) {
    const Eigen::Vector3d point =
        tag.world_from_plate * Eigen::Vector3d(plate.frame_inner_length / 2, down, 0);
    return Vector2d(survey.tunnel.centerline.locate(point.head<2>()).offset, point.z() - floor);
  };
  const double x = in_section(0).x();
  const double p = height_of_p(survey, tag);
  const Vector2d back(out * 0.001, 0);
  const Vector2d upper = in_section(top);
  const Vector2d lower = in_section(top + plate.plate_height);
  sketch.layer("tags").add(Area{{upper, lower, {lower, back}, {upper, back}}, colours::kBlack});
  sketch.layer("tags").add(Dot{Vector2d(x, p), 0.0006, colours::kRed});
  sketch.layer("names").add(Words{.text = tag.name,
                                  .at = {Vector2d(x, p), Vector2d(-out * 0.002, 0)},
                                  .align = out < 0 ? TextAlign::left : TextAlign::right});
  add_dimension(sketch.layer("dimensions"), {x, 0}, {x, p}, -out * 0.008, "H_P " + metres(p),
                colours::kRed);
}

void draw_vehicle_section(Sketch& sketch, const Rig& rig) {
  SketchLayer& layer = sketch.layer("rig");
  const Vector2d o(0, rig.vehicle_height);
  layer.add(Dot{o, 0.0008, colours::kBlue});
  layer.add(Words{.text = "O", .at = {o, Vector2d(0.0012, 0.0008)}, .colour = colours::kBlue});
  add_dimension(layer, {0, 0}, o, 0.006, metres(rig.vehicle_height), colours::kBlue);
  for (const RigCamera& camera : rig.cameras) {
    const Eigen::Vector3d& at = camera.vehicle_from_camera.translation;
    if (at.norm() < 1e-3) continue;
    const Vector2d place(-at.y(), rig.vehicle_height + at.z());
    layer.add(Dot{place, 0.0005, colours::kBlue});
    layer.add(Words{.text = camera.name,
                    .at = {place, Vector2d(0.001, 0.0008)},
                    .height = 0.0014,
                    .colour = colours::kBlue});
  }
}

// Of a corner of the feature frame.
Words point_name(const std::string& name, const Vector2d& at, const Vector2d& offset,
                 TextAlign align) {
  return {.text = name,
          .at = {at, offset},
          .height = 0.0025,
          .align = align,
          .level = TextLevel::middle,
          .colour = colours::kRed};
}

void draw_angle(SketchLayer& layer, const Vector2d& apex, double from, double to, double radius,
                const std::string& text) {
  constexpr int kSteps = 24;
  Polyline arc{{}, {colours::kRed, kNarrow, {}}};
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = from + (to - from) * i / kSteps;
    arc.points.emplace_back(apex + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  layer.add(arc);
  const Vector2d end(std::cos(to), std::sin(to));
  const Vector2d beyond = Vector2d(-end.y(), end.x()) * (to > from ? 1 : -1);
  layer.add(Words{.text = text,
                  .at = {apex + radius * end, beyond * 0.0015},
                  .align = beyond.x() < 0 ? TextAlign::right : TextAlign::left,
                  .level = TextLevel::middle,
                  .colour = colours::kRed});
}

// P1, P2, the perpendicular at P1, theta between them and the way from its foot to P2.
void draw_pair_angle(SketchLayer& layer, const Vector2d& p1, const Vector2d& p2,
                     const Vector2d& into_tunnel) {
  const double across = (p2 - p1).dot(into_tunnel);
  const Vector2d foot = p1 + across * into_tunnel;
  const LineStyle line{colours::kRed, kNarrow, dashed()};
  layer.add(Polyline{{p1, p2}, line});
  layer.add(Polyline{{p1, foot}, line});
  const double from = std::atan2(into_tunnel.y(), into_tunnel.x());
  const double turn = wrapped_angle(std::atan2((p2 - p1).y(), (p2 - p1).x()) - from);
  draw_angle(layer, p1, from, from + turn, 0.6 * across,
             "\u03b8 " + format_number(degrees(std::abs(turn)), 2) + kDegree);
  layer.add(point_name("P1", p1, -into_tunnel * 0.0045, TextAlign::right));
  layer.add(point_name("P2", p2, into_tunnel * 0.0045, TextAlign::left));
  const bool ahead = (p2 - foot).x() >= 0;
  add_dimension(layer, ahead ? foot : p2, ahead ? p2 : foot, -0.010,
                "stagger " + metres((p2 - foot).norm()), colours::kRed);
}

void draw_camera_rays(SketchLayer& layer, const RigCamera& camera, double reach) {
  const Pose& pose = camera.vehicle_from_camera;
  const Vector2d at = pose.translation.head<2>();
  const auto ray = [&](double pixel, double length) {
    const Eigen::Vector3d direction =
        pose.rotation *
        Eigen::Vector3d((pixel - camera.camera.cx) / camera.camera.fx, 0, 1).normalized();
    return Vector2d(at + length * Vector2d(direction.head<2>()));
  };
  const LineStyle edge{colours::kBlue, kExtraNarrow, {}};
  layer.add(Polyline{{at, ray(0, reach)}, edge});
  layer.add(Polyline{{at, ray(camera.camera.width - 1.0, reach)}, edge});
  const Vector2d axis_end = ray(camera.camera.cx, 0.7 * reach);
  layer.add(Arrow{at, axis_end, {colours::kBlue, kNarrow, long_dashed_dotted()}});
  const Vector2d axis = axis_end - at;
  const double yaw = std::atan2(axis.y(), axis.x());
  const double alpha = std::numbers::pi / 2 - std::abs(yaw);
  layer.add(Words{.text = camera.name + ": alpha " + format_number(degrees(alpha), 2) + kDegree +
                          ", yaw " + format_number(degrees(yaw), 2) + kDegree,
                  .at = {axis_end, axis.normalized() * 0.002},
                  .align = axis.x() < 0 ? TextAlign::right : TextAlign::left,
                  .level = TextLevel::middle,
                  .colour = colours::kBlue});
}

// `chainage`: where the vehicle stands.
void draw_ranges(SketchLayer& layer, const Rig& rig, const Tunnel& tunnel, double chainage) {
  const double half_width = width_at(tunnel, chainage) / 2;
  double along = 0;
  for (const RigRange& range : rig.ranges) {
    const double wall = -wall_of(tunnel, range.wall).at(chainage);
    add_dimension(layer, {along, 0}, {along, wall}, 0.003, range.name, colours::kOrange);
    along -= 0.15 * half_width;
  }
}

}  // namespace

std::string metres(double length) { return format_number(length, 3); }

std::string point_text(const Survey& survey, const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector3d p = grid_from_world(survey.grid, point_in_world);
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
}

void add_dimension(SketchLayer& layer, const Vector2d& from, const Vector2d& to, double offset,
                   const std::string& text, const Colour& colour) {
  layer.add(Dimension{from, to, offset, text, colour});
}

std::optional<TagPair> first_pair(const Survey& survey) {
  for (std::size_t i = 1; i < survey.tags.size(); ++i) {
    const PlacedTag& left = survey.tags[i - 1];
    const PlacedTag& right = survey.tags[i];
    if (left.pair == right.pair && left.side != right.side) return TagPair{left, right};
  }
  return std::nullopt;
}

DrawingView cross_section(const Survey& survey, const PlacedTag& tag,
                          const std::optional<Rig>& rig) {
  const Tunnel& tunnel = survey.tunnel;
  const double left = tunnel.left.at(tag.chainage);
  const double right = tunnel.right.at(tag.chainage);
  const double height = tunnel.height.at(tag.chainage);
  const std::vector<SketchPoint> room =
      box({left - tunnel.stand_off, 0}, {right + tunnel.stand_off, height});
  DrawingView view;
  view.title = "Section at chainage " + metres(tag.chainage) + " m, seen along the drive";
  view.axes = ViewAxes{{1, 0}, {0, 1}, "right", "z"};
  view.sketch.layer("floor").add(Area{room, {0.95, 0.95, 0.93}});
  view.sketch.layer("walls").add(Polyline{room, {.width = kWide}, true});
  view.sketch.layer("centerline")
      .add(Polyline{{Vector2d(0, 0), Vector2d(0, height)},
                    {colours::kGrey, kNarrow, long_dashed_dotted()}});
  for (const PlacedTag& other : survey.tags) {
    if (other.pair == tag.pair) draw_plate_edge(view.sketch, survey, other);
  }
  SketchLayer& dimensions = view.sketch.layer("dimensions");
  add_dimension(dimensions, {left, 0}, {right, 0}, -0.008,
                "W_T " + metres(width_at(tunnel, tag.chainage)));
  add_dimension(dimensions, {left, 0}, {left, height}, 0.016, metres(height));
  if (rig) draw_vehicle_section(view.sketch, *rig);
  return view;
}

DrawingView pair_plan(const Survey& survey, const TagPair& pair) {
  const double margin =
      survey.tag_template.plate_length + 0.3 * width_at(survey.tunnel, pair.left.chainage);
  const auto [from, to] = std::minmax(pair.left.chainage, pair.right.chainage);
  const PlanStrip strip = plan_strip(survey, from - margin, to + margin);
  DrawingView view;
  view.title = "Pair " + pair.left.name + ", " + pair.right.name + " from above";
  view.sketch = tunnel_plan(survey, strip);
  view.axes = plan_axes(survey, strip);
  const auto place = [&](const PlacedTag& tag) {
    return strip.in_view(tag.world_from_plate.translation);
  };
  // Across the drive, whichever way the two walls lean.
  const Eigen::Vector3d facing =
      pair.right.world_from_plate.rotation.col(2) - pair.left.world_from_plate.rotation.col(2);
  const Vector2d into_tunnel = strip.turned(facing).normalized();
  draw_pair_angle(view.sketch.layer("theta"), place(pair.left), place(pair.right), into_tunnel);
  // The width at the left plate, drawn beside the view.
  const double chainage = pair.left.chainage;
  const CenterlinePoint here = survey.tunnel.centerline.at(chainage);
  const Eigen::Vector3d beside = survey.tunnel.centerline.at(strip.from).position;
  const auto wall = [&](Side side) {
    return strip.in_view(beside +
                         wall_of(survey.tunnel, side).at(chainage) * right_of(here.heading));
  };
  add_dimension(view.sketch.layer("dimensions"), wall(Side::right), wall(Side::left), 0.008,
                "W_T " + metres(width_at(survey.tunnel, chainage)));
  return view;
}

DrawingView plate_view(const Survey& survey, const PlacedTag& tag) {
  const TagTemplate& plate = survey.tag_template;
  const TagDrawing drawing = draw_tag(plate, tag.digits);
  const auto corners = [](const Rectangle& r) {
    return box({r.x, -r.y}, {r.x + r.width, -(r.y + r.height)});
  };
  DrawingView view;
  view.title = "Plate of " + tag.name + ", seen facing it";
  if (tag.attitude) view.title += ", which " + attitude_text(*tag.attitude);
  const double scale = round_scale(drawing.plate.width / 0.075);
  view.title += ", " + scale_text(scale);
  view.scale = scale;
  SketchLayer& layer = view.sketch.layer("tags");
  layer.add(Polyline{corners(drawing.plate), {.width = kNarrow}, true});
  Colour ink = colours::kBlack, ground = colours::kWhite;
  if (drawing.white_on_black) {
    std::swap(ink, ground);
    layer.add(Area{corners(drawing.plate), ground});
  }
  layer.add(Area{corners(drawing.frame_outer), ink});
  layer.add(Area{corners(drawing.frame_inner), ground});
  for (const Rectangle& bar : drawing.bars) layer.add(Area{corners(bar), ink});
  const Rectangle& inner = drawing.frame_inner;
  SketchLayer& points = view.sketch.layer("theta");
  const auto mark = [&](const char* name, double x, double y, const Vector2d& offset) {
    points.add(Dot{Vector2d(x, -y), 0.0008, colours::kRed});
    points.add(point_name(name, Vector2d(x, -y), offset, TextAlign::centre));
  };
  mark("P", 0, 0, {0.0025, -0.0025});
  mark("F", inner.width, 0, {-0.0025, -0.0025});
  mark("Q", 0, inner.height, {0.0025, 0.0025});
  SketchLayer& dimensions = view.sketch.layer("dimensions");
  const Rectangle& p = drawing.plate;
  add_dimension(dimensions, {0, -p.y}, {inner.width, -p.y}, 0.005, "L_CI " + metres(inner.width));
  add_dimension(dimensions, {p.x, -p.y}, {p.x + p.width, -p.y}, 0.011, metres(p.width));
  add_dimension(dimensions, {p.x, -inner.height}, {p.x, 0}, 0.005, "H_CI " + metres(inner.height));
  add_dimension(dimensions, {p.x, -(p.y + p.height)}, {p.x, -p.y}, 0.011, metres(p.height));
  return view;
}

DrawingView rig_view(const Survey& survey, const Rig& rig) {
  const double chainage = survey.tags.empty() ? 0 : survey.tags.front().chainage;
  const double half = width_at(survey.tunnel, chainage) / 2;
  DrawingView view;
  view.title = "Rig " + rig.name + " from above, on the center line";
  view.axes = ViewAxes{{1, 0}, {0, 1}, "x fwd", "y left"};
  const double reach = 1.1 * half;
  for (const Side side : {Side::left, Side::right}) {
    const double y = -wall_of(survey.tunnel, side).at(chainage);
    view.sketch.layer("walls").add(
        Polyline{{Vector2d(-1.2 * half, y), Vector2d(1.6 * half, y)}, {.width = kWide}});
  }
  view.sketch.layer("centerline")
      .add(Polyline{{Vector2d(-1.2 * half, 0), Vector2d(1.6 * half, 0)},
                    {colours::kGrey, kNarrow, long_dashed_dotted()}});
  SketchLayer& layer = view.sketch.layer("rig");
  for (const RigCamera& camera : rig.cameras) draw_camera_rays(layer, camera, reach);
  draw_ranges(layer, rig, survey.tunnel, chainage);
  const Vector2d o(0, 0);
  layer.add(Dot{o, 0.0009, colours::kBlue});
  layer.add(Words{.text = "O", .at = {o, Vector2d(0.0012, -0.0035)}, .colour = colours::kBlue});
  return view;
}

}  // namespace tagsmith::detail
