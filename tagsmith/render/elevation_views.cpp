// SPDX-License-Identifier: Apache-2.0
// The views along the tunnel: annotated plan and wall elevations.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/render/survey_views.hpp"
#include "tagsmith/render/tag_text.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

// The start of the drive: a place, a direction and their text in the survey.
void draw_start(SketchLayer& layer, const Survey& survey, const PlanStrip& strip) {
  const CenterlinePoint start = survey.tunnel.centerline.at(0);
  const Vector2d at = strip.in_view(start.position);
  const Vector2d along = strip.turned(direction_of(start.heading));
  const Vector2d right = strip.turned(right_of(start.heading));
  const SketchPoint from(at + right * width_at(survey.tunnel, 0) / 4);
  layer.add(Dot{at, 0.0007, colours::kBlue});
  layer.add(Arrow{from, {from.model, along * 0.016}, {colours::kBlue, kWide, {}}});
  layer.add(
      Words{.text = "drive, heading " +
                    format_number(degrees(grid_heading_from_world(survey.grid, start.heading)), 4) +
                    "\u00b0",
            .at = {from.model, along * 0.0175},
            .height = 0.0018,
            .angle = std::atan2(along.y(), along.x()),
            .level = TextLevel::middle,
            .colour = colours::kBlue});
}

// The grid's origin with its axes, where it lies in or beside the strip.
void draw_origin(SketchLayer& layer, const Survey& survey, const PlanStrip& strip) {
  const Centerline& line = survey.tunnel.centerline;
  const CenterlineAddress address = line.locate(Vector2d(0, 0));
  const double beside = greatest_width(survey.tunnel);
  if (address.chainage < strip.from - beside || address.chainage > strip.to + beside) return;
  if (std::abs(address.offset) > 2 * beside) return;
  const Vector2d origin = strip.view_from_world * Vector2d(0, 0);
  const ViewAxes axes = plan_axes(survey, strip);
  layer.add(Ellipse{
      .at = origin, .semi_axes = {0.0012, 0.0012}, .on_paper = true, .line = {.width = kWide}});
  layer.add(Arrow{origin, {origin, axes.x * 0.012}, {colours::kRed, kWide, {}}});
  layer.add(Arrow{origin, {origin, axes.y * 0.012}, {colours::kGreen, kWide, {}}});
  // Over the strip, which they would lengthen on its other side.
  const Vector2d middle = strip.in_view(line.at((strip.from + strip.to) / 2).position);
  const bool before = origin.x() < middle.x();
  layer.add(Words{.text = "origin of the grid",
                  .at = {origin, Vector2d(before ? 0.002 : -0.002, -0.0035)},
                  .height = 0.0018,
                  .align = before ? TextAlign::left : TextAlign::right});
}

DrawingView annotated_plan(const Survey& survey, const PlanStrip& strip, bool first) {
  const Centerline& line = survey.tunnel.centerline;
  DrawingView view = plan_view(survey, strip);
  view.title += "; center line from " + point_text(survey, line.at(strip.from).position) + " to " +
                point_text(survey, line.at(strip.to).position);
  draw_origin(view.sketch.layer("grid"), survey, strip);
  if (first) draw_start(view.sketch.layer("grid"), survey, strip);
  return view;
}

// Where a wall's points lie when it is unrolled.
class Unrolled {
 public:
  Unrolled(const Survey& survey, const PlanStrip& strip, Side side)
      : survey_(survey), strip_(strip), side_(side) {}

  double across(double chainage) const {
    return side_ == Side::left ? chainage - strip_.from : strip_.to - chainage;
  }

  // A point of a tag's plate, metres right of and below P.
  Vector2d on_plate(const PlacedTag& tag, double right, double down) const {
    const Pose& pose = tag.world_from_plate;
    const double middle = plate_middle(survey_.tag_template);
    const Eigen::Vector3d centre = pose * Eigen::Vector3d(middle, 0, 0);
    const double chainage = survey_.tunnel.centerline.locate(centre.head<2>()).chainage;
    if (tag.attitude) {
      const Eigen::Vector3d from_centre = pose * Eigen::Vector3d(right, down, 0) - centre;
      const Eigen::Vector3d along = direction_of(survey_.tunnel.centerline.at(chainage).heading);
      const double rightwards = side_ == Side::left ? 1.0 : -1.0;
      return {across(chainage) + rightwards * along.dot(from_centre),
              height_of_p(survey_, tag) + centre.z() - pose.translation.z() + from_centre.z()};
    }
    return {across(chainage) + right - middle, height_of_p(survey_, tag) - down};
  }

 private:
  const Survey& survey_;
  const PlanStrip& strip_;
  Side side_;
};

std::vector<SketchPoint> box(const Unrolled& wall, const PlacedTag& tag,
                             const Rectangle& on_plate) {
  std::vector<SketchPoint> points;
  for (const auto& [right, down] : corners_of(on_plate)) {
    points.emplace_back(wall.on_plate(tag, right, down));
  }
  return points;
}

// The roof over the strip as it is unrolled, from its start.
std::vector<SketchPoint> roof_line(const Survey& survey, const PlanStrip& strip,
                                   const Unrolled& wall) {
  const ChainageProfile& height = survey.tunnel.height;
  std::vector<SketchPoint> line{Vector2d(wall.across(strip.from), height.at(strip.from))};
  for (const double chainage : height.breaks(strip.from, strip.to)) {
    line.emplace_back(Vector2d(wall.across(chainage), height.before(chainage)));
    line.emplace_back(Vector2d(wall.across(chainage), height.at(chainage)));
  }
  line.emplace_back(Vector2d(wall.across(strip.to), height.before(strip.to)));
  return line;
}

void draw_plate(Sketch& sketch, const Survey& survey, const Unrolled& wall, const PlacedTag& tag) {
  const TagTemplate& plate = survey.tag_template;
  const LineStyle line{.width = kNarrow};
  const auto outline = box(wall, tag, plate_outline(plate));
  sketch.layer("tags").add(Area{outline, colours::kWhite});
  sketch.layer("tags").add(Polyline{outline, line, true});
  sketch.layer("tags").add(Polyline{
      box(wall, tag, {0, 0, plate.frame_inner_length, plate.frame_inner_height}), line, true});
  sketch.layer("tags").add(Dot{wall.on_plate(tag, 0, 0), 0.0005, colours::kRed});
}

void draw_wall(Sketch& sketch, const Survey& survey, const PlanStrip& strip, const Unrolled& wall) {
  const double from = wall.across(strip.from);
  const double to = wall.across(strip.to);
  const std::vector<SketchPoint> floor{Vector2d(from, 0), Vector2d(to, 0)};
  const std::vector<SketchPoint> roof = roof_line(survey, strip, wall);
  std::vector<SketchPoint> room = floor;
  room.insert(room.end(), roof.rbegin(), roof.rend());
  sketch.layer("floor").add(Area{room, {0.95, 0.95, 0.93}});
  for (const auto& line : {floor, roof}) {
    sketch.layer("walls").add(Polyline{line, {.width = kWide}});
  }
  for (const double chainage : plan_ticks(strip)) {
    const Vector2d foot(wall.across(chainage), 0);
    sketch.layer("centerline")
        .add(Polyline{{foot, {foot, Vector2d(0, -0.0012)}}, {colours::kBlue, kNarrow, {}}});
    sketch.layer("centerline")
        .add(Words{.text = format_number(chainage, 3),
                   .at = {foot, Vector2d(0.0006, -0.0017)},
                   .height = 0.0014,
                   .level = TextLevel::top,
                   .colour = colours::kBlue});
  }
}

// The tunnel's height; spacing and plate length below the first two plates.
void draw_dimensions(SketchLayer& layer, const Survey& survey, const Unrolled& wall,
                     const std::vector<const PlacedTag*>& tags, double left_end,
                     double chainage_there) {
  const double height = survey.tunnel.height.at(chainage_there);
  add_dimension(layer, {left_end, 0}, {left_end, height}, 0.010, metres(height));
  if (tags.size() < 2) return;
  const PlacedTag& tag = *tags.front();
  const double left = plate_outline(survey.tag_template).x;
  const double right = left + survey.tag_template.plate_length;
  const Vector2d a = wall.on_plate(tag, left, 0);
  const Vector2d b = wall.on_plate(tag, right, 0);
  const Vector2d c = wall.on_plate(*tags[1], left, 0);
  const Vector2d d = wall.on_plate(*tags[1], right, 0);
  const bool leftwards = c.x() < a.x();
  const double gap_from = leftwards ? d.x() : b.x();
  const double gap_to = leftwards ? a.x() : c.x();
  add_dimension(layer, {gap_from, 0}, {gap_to, 0}, -0.0075, "W_B " + metres(gap_to - gap_from));
  add_dimension(layer, {a.x(), 0}, {b.x(), 0}, -0.0125, "plate " + metres(b.x() - a.x()));
}

// The distance that a tape shows from P to P; on a curve it is neither the chainage's nor the
// unrolled wall's.
double distance(const PlacedTag& a, const PlacedTag& b) {
  return (a.p_in_grid - b.p_in_grid).norm();
}

constexpr double kChain = 0.0112;  // of distances below the floor, with room for upright ones

// The distance to the strip's first place on a wall from the last one before the strip, which
// another sheet may show.
void add_distance_before(SketchLayer& layer, const Unrolled& wall, const PlanStrip& strip,
                         const SettingOut& first, std::span<const SettingOut> places) {
  const SettingOut* before = nullptr;
  for (const SettingOut& place : places) {
    if (place.tag->side != first.tag->side || strip.has(*place.tag)) continue;
    if (place.chainage >= first.chainage) continue;
    if (before == nullptr || place.chainage > before->chainage) before = &place;
  }
  if (before == nullptr) return;
  const bool from_left = first.tag->side == Side::left;
  const Vector2d back(from_left ? -1 : 1, 0);
  const Vector2d foot(wall.on_plate(*first.tag, 0, 0).x(), 0);
  const Vector2d down(0, -kChain);
  layer.add(Arrow{{foot, down + 0.020 * back}, {foot, down}, {.width = kNarrow}});
  layer.add(Words{
      .text = to_millimetre(distance(*before->tag, *first.tag)) + " from " + before->tag->name,
      .at = {foot, down + 0.003 * back + Vector2d(0, 0.0007)},
      .align = from_left ? TextAlign::right : TextAlign::left});
}

}  // namespace

DrawingPart drive_by_strips(const Survey& survey, Paper paper, const WallView& wall_view,
                            const PlanLegibility& least,
                            const std::function<bool(const PlanStrip&)>& wanted) {
  DrawingPart part{{}, {paper, coarsest_plan_scale(survey, least)}};
  for (const PlanStrip& strip : plan_strips(survey, paper, least)) {
    if (wanted && !wanted(strip)) continue;
    const bool first = part.views.empty();
    part.views.push_back(annotated_plan(survey, strip, first));
    for (const Side side : {Side::left, Side::right}) {
      part.views.push_back(wall_view(strip, side, first));
    }
  }
  return part;
}

DrawingView wall_elevation(const Survey& survey, const PlanStrip& strip, Side side,
                           bool dimensions) {
  const Unrolled wall(survey, strip, side);
  DrawingView view;
  view.title = side == Side::left ? "Left wall, seen facing it: the drive runs to the right"
                                  : "Right wall, seen facing it: the drive runs to the left";
  view.new_row = true;
  draw_wall(view.sketch, survey, strip, wall);
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : survey.tags) {
    if (!strip.has(tag) || tag.side != side) continue;
    tags.push_back(&tag);
    draw_plate(view.sketch, survey, wall, tag);
    const Vector2d middle = wall.on_plate(tag, plate_middle(survey.tag_template), 0);
    view.sketch.layer("names").add(
        Words{.text = tag.name,
              .at = {{middle.x(), survey.tunnel.height.at(tag.chainage)}, {0, 0.001}},
              .angle = std::numbers::pi / 2,
              .level = TextLevel::middle});
  }
  if (dimensions) {
    const double left_end = std::min(wall.across(strip.from), wall.across(strip.to));
    const double chainage = left_end == wall.across(strip.from) ? strip.from : strip.to;
    draw_dimensions(view.sketch.layer("dimensions"), survey, wall, tags, left_end, chainage);
  }
  return view;
}

DrawingView setting_out_elevation(const Survey& survey, const PlanStrip& strip, Side side,
                                  std::span<const SettingOut> places) {
  DrawingView view = wall_elevation(survey, strip, side, false);
  view.title += "; below: chainage and height of P, straight distances from P to P";
  const Unrolled wall(survey, strip, side);
  SketchLayer& layer = view.sketch.layer("dimensions");
  std::vector<SettingOut> along;  // from neighbour to neighbour, whatever the survey's order
  std::ranges::copy_if(places, std::back_inserter(along), [&](const SettingOut& place) {
    return strip.has(*place.tag) && place.tag->side == side;
  });
  std::ranges::stable_sort(
      along, {}, [&](const SettingOut& place) { return wall.on_plate(*place.tag, 0, 0).x(); });
  constexpr double kLines = 0.0127;
  std::optional<Vector2d> last;  // foot
  const PlacedTag* last_tag = nullptr;
  for (const SettingOut& place : along) {
    const Vector2d p = wall.on_plate(*place.tag, 0, 0);
    const Vector2d foot(p.x(), 0);
    layer.add(Polyline{{p, {foot, Vector2d(0, -kLines)}}, {.width = kExtraNarrow}});
    layer.add(Words{.text = to_millimetre(place.chainage) + " h " + to_millimetre(place.height),
                    .at = {foot, Vector2d(0, -kLines - kWordsHeight / 2)},
                    .angle = std::numbers::pi / 2,
                    .align = TextAlign::right,
                    .level = TextLevel::middle,
                    .in_row = true});
    if (last) {
      layer.add(Dimension{.from = *last,
                          .to = foot,
                          .offset = -kChain,
                          .text = to_millimetre(distance(*last_tag, *place.tag)),
                          .in_chain = true});
    }
    last = foot;
    last_tag = place.tag;
  }
  if (along.empty()) return view;
  const SettingOut& first = side == Side::left ? along.front() : along.back();
  add_distance_before(layer, wall, strip, first, places);
  return view;
}

}  // namespace tagsmith::detail
