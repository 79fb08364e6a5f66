// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/plan_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/placement/tunnel_surfaces.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/tunnel_plan.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

constexpr double kCoverageWidth = 0.0012;  // of the coloured center line, metres on paper
constexpr double kProfileHeight = 0.050;   // of the profile, metres on paper
constexpr double kProfileRoom = 0.055;     // beside it, for the words of its axes

LineStyle line_in(const Colour& colour) { return {colour, kCoverageWidth, {}}; }

void draw_coverage(const Survey& survey, const DrivePlan& plan, const PlanStrip& strip,
                   Sketch& sketch) {
  constexpr double kSag = 0.001;  // metres that straight pieces miss a bend by
  for (const ServiceRun& run : service_runs(plan, strip.from, strip.to)) {
    const double from = plan.columns[run.first].chainage;
    const double to = plan.columns[run.last].chainage;
    Polyline line{line_in_view(strip, survey.tunnel.centerline, 0, from, to, kSag),
                  line_in(style_of(run.service).colour)};
    if (line.points.size() > 1) sketch.layer("coverage").add(std::move(line));
  }
}

double usual_reach(const Survey& survey, const DrivePlan& plan) {
  std::vector<double> distances;
  for (const TagUse& use : plan.tags) {
    if (use.is_read) distances.push_back(use.first.distance);
  }
  if (distances.empty()) return least_width(survey.tunnel);
  std::ranges::sort(distances);
  return distances[distances.size() / 2];
}

void draw_fields(const std::vector<std::vector<Eigen::Vector3d>>& fields, const PlanStrip& strip,
                 Sketch& sketch) {
  for (const auto& field : fields) {
    Polyline outline{{}, {colours::kBlue, kNarrow, dashed()}, true};
    for (const Eigen::Vector3d& corner : field) {
      outline.points.emplace_back(strip.in_view(corner));
    }
    sketch.layer("fields of view").add(std::move(outline));
  }
}

struct LegendEntry {
  LineStyle line;
  const char* text;
};

// Lines with their meaning, beside each other; `y`: of the words, metres on paper.
void draw_legend(SketchLayer& layer, const std::vector<LegendEntry>& entries, double y,
                 double room) {
  double x = 0;
  for (const auto& [line, text] : entries) {
    layer.add(Polyline{{on_paper(x, y + 0.001), on_paper(x + 0.010, y + 0.001)}, line});
    layer.add(Words{text, on_paper(x + 0.012, y), 0.0018});
    x += std::min(0.070, room / static_cast<double>(entries.size()));
  }
}

// The profile's own axes: chainage by paper length, sigma by its logarithm.
struct ProfileAxes {
  double from = 0;
  double to = 1;
  double least = 1e-3;  // metres, the lowest decade
  int decades = 3;
  double length = 0;  // on paper

  SketchPoint at(double chainage, double sigma) const {
    const double x = length * (chainage - from) / (to - from);
    const double above = std::clamp(std::log10(sigma / least), 0.0, static_cast<double>(decades));
    return on_paper(x, kProfileHeight * above / decades);
  }
};

std::string sigma_text(double metres) {
  return metres < 0.999 ? format_number(1000 * metres, 2) + " mm" : format_number(metres, 2) + " m";
}

void draw_axes(const ProfileAxes& axes, Sketch& sketch) {
  SketchLayer& layer = sketch.layer("axes");
  for (int decade = 0; decade <= axes.decades; ++decade) {
    const double sigma = axes.least * std::pow(10.0, decade);
    layer.add(Polyline{{axes.at(axes.from, sigma), axes.at(axes.to, sigma)},
                       {colours::kPale, kExtraNarrow, {}}});
    SketchPoint place = axes.at(axes.from, sigma);
    place.paper.x() -= 0.002;
    layer.add(Words{sigma_text(sigma), place, 0.0018, 0, TextAlign::right, TextLevel::middle});
  }
  const double step = round_step((axes.to - axes.from) / 10);
  const double first = std::ceil(axes.from / step) * step;
  for (int i = 0; first + i * step <= axes.to + 1e-9; ++i) {
    const double chainage = first + i * step;
    SketchPoint place = axes.at(chainage, axes.least);
    place.paper.y() -= 0.004;
    layer.add(Words{format_number(chainage, 2) + " m", place, 0.0018, 0, TextAlign::centre,
                    TextLevel::top});
  }
}

// Coverage below the axis, as on the center line.
void draw_coverage_strip(const DrivePlan& plan, const ProfileAxes& axes, Sketch& sketch) {
  for (const ServiceRun& run : service_runs(plan, axes.from, axes.to)) {
    Polyline line{{}, line_in(style_of(run.service).colour)};
    for (const std::size_t column : {run.first, run.last}) {
      line.points.push_back(axes.at(plan.columns[column].chainage, axes.least));
      line.points.back().paper.y() -= 0.002;
    }
    sketch.layer("coverage").add(std::move(line));
  }
}

// A curve of steps, because it jumps each time that a tag appears or disappears: the value of a
// column applies up to the next. Broken where there is no value; at most 2000 steps, each the
// greatest of its columns.
void draw_curve(const DrivePlan& plan, const ProfileAxes& axes, const LineStyle& style,
                const std::function<double(const PlanColumn&)>& value, Sketch& sketch) {
  const std::size_t stride = std::max<std::size_t>(1, plan.columns.size() / 2000);
  Polyline line{{}, style};
  const auto finish = [&] {
    if (line.points.size() > 1) sketch.layer("sigma").add(line);
    line.points.clear();
  };
  for (std::size_t i = 0; i < plan.columns.size(); i += stride) {
    double most = -1;
    for (std::size_t j = i; j < std::min(i + stride, plan.columns.size()); ++j) {
      if (const double v = value(plan.columns[j]); std::isfinite(v)) most = std::max(most, v);
    }
    if (most < 0) {
      finish();
      continue;
    }
    const std::size_t next = std::min(i + stride, plan.columns.size() - 1);
    line.points.push_back(axes.at(plan.columns[i].chainage, most));
    line.points.push_back(axes.at(plan.columns[next].chainage, most));
  }
  finish();
}

// Whole decades around everything that is drawn.
ProfileAxes profile_axes(const DrivePlan& plan, double room) {
  constexpr int kMostDecades = 5;
  constexpr double kFinest = 1e-6;
  double least = 1e-3;
  double most = 1;
  for (const PlanColumn& column : plan.columns) {
    for (const double sigma :
         {column.nominal.plane, column.worst.plane, column.paper.sigma.plane}) {
      if (!std::isfinite(sigma)) continue;
      least = std::min(least, std::max(sigma, kFinest));
      most = std::max(most, sigma);
    }
  }
  const double lowest = std::floor(std::log10(least));
  const int decades = static_cast<int>(
      std::min(std::ceil(std::log10(most)) - lowest, static_cast<double>(kMostDecades)));
  return {plan.columns.front().chainage, plan.columns.back().chainage, std::pow(10.0, lowest),
          decades, room - kProfileRoom};
}

// `room`: of the sheet from side to side, metres on paper.
DrawingView profile_view(const DrivePlan& plan, double room) {
  const ProfileAxes axes = profile_axes(plan, room);
  DrawingView view;
  view.title = "Standard deviation in the plane along the chainage";
  view.new_row = true;
  draw_axes(axes, view.sketch);
  draw_coverage_strip(plan, axes, view.sketch);
  const LineStyle paper{colours::kGrey, kNarrow, dashed()};
  const LineStyle worst{colours::kOrange, kNarrow, {}};
  const LineStyle nominal{colours::kBlue, kWide, {}};
  const auto draw = [&](const LineStyle& style, const auto& value) {
    draw_curve(plan, axes, style, value, view.sketch);
  };
  draw(paper, [](const PlanColumn& column) { return column.paper.sigma.plane; });
  draw(worst, [](const PlanColumn& column) { return column.worst.plane; });
  draw(nominal, [](const PlanColumn& column) { return column.nominal.plane; });
  draw_legend(view.sketch.layer("legend"),
              {{nominal, "on the center line"},
               {worst, "worst pose of the envelope"},
               {paper, "the paper's method"}},
              kProfileHeight + 0.0042, room);
  return view;
}

}  // namespace

Service service_of(const DrivePlan& plan, const PlanColumn& column) {
  if (column.read.both == plan.poses_per_column) return Service::both_walls;
  if (column.confirmed == plan.poses_per_column) return Service::confirmed;
  if (column.read.any() == plan.poses_per_column) return Service::one_tag;
  return column.read.any() > 0 ? Service::some_poses : Service::none;
}

std::vector<ServiceRun> service_runs(const DrivePlan& plan, double from, double to) {
  std::vector<ServiceRun> all;
  for (std::size_t i = 0; i < plan.columns.size(); ++i) {
    const PlanColumn& column = plan.columns[i];
    if (column.chainage < from || column.chainage > to) continue;
    const Service service = service_of(plan, column);
    if (all.empty() || all.back().service != service) {
      if (!all.empty()) all.back().last = i;
      all.push_back({i, i, service});
    }
    all.back().last = i;
  }
  return all;
}

std::vector<std::vector<Eigen::Vector3d>> fields_of_view(const Survey& survey, const Rig& rig,
                                                         const DrivePlan& plan, double from,
                                                         double to) {
  const VehiclePose pose = vehicle_on_floor(survey.tunnel.centerline.at(from + (to - from) / 3),
                                            {.height = rig.vehicle_height});
  const double reach = usual_reach(survey, plan);
  const TunnelWalls walls(survey.tunnel, survey.tunnel.stand_off,
                          survey.tunnel.centerline.locate(pose.position.head<2>()).chainage,
                          2 * reach);
  std::vector<std::vector<Eigen::Vector3d>> fields;
  for (const RigCamera& rig_camera : rig.cameras) {
    const Pose world_from_camera = world_from_vehicle(pose) * rig_camera.vehicle_from_camera;
    const Camera& camera = rig_camera.camera;
    std::vector<Eigen::Vector3d> outline{world_from_camera.translation};
    constexpr int kRays = 32;
    for (int i = 0; i <= kRays; ++i) {
      const Vector2d pixel((camera.width - 1) * i / static_cast<double>(kRays), camera.cy);
      const std::optional<Eigen::Vector3d> ray = ray_through(camera, pixel);
      if (!ray) continue;
      const Eigen::Vector3d way = reach * (world_from_camera.rotation * ray->normalized());
      const auto hit = walls.first_hit(world_from_camera.translation.head<2>(), way.head<2>());
      outline.push_back(world_from_camera.translation + std::min(hit ? hit->way : 1, 1.0) * way);
    }
    fields.push_back(std::move(outline));
  }
  return fields;
}

Result<std::vector<Sheet>> draw_plan(const Survey& survey, const Rig& rig, const DrivePlan& plan,
                                     Paper paper) {
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : plan_strips(survey, paper)) {
    DrawingView view = plan_view(survey, strip);
    draw_coverage(survey, plan, strip, view.sketch);
    const double from = std::max(strip.from, plan.columns.front().chainage);
    const double to = std::min(strip.to, plan.columns.back().chainage);
    if (from < to) draw_fields(fields_of_view(survey, rig, plan, from, to), strip, view.sketch);
    views.push_back(std::move(view));
  }
  const double room = drawing_area(paper).x();
  DrawingView legend;
  legend.title = "Position along the center line";
  legend.new_row = true;
  std::vector<LegendEntry> entries;
  for (const ServiceStyle& style : kServiceStyles) {
    entries.push_back({line_in(style.colour), style.words});
  }
  draw_legend(legend.sketch.layer("legend"), entries, 0, room);
  views.push_back(std::move(legend));
  views.push_back(profile_view(plan, room));
  const TitleBlock block{
      "Plan of the drive " + survey.name,
      "What the cameras of " + rig.name + " read, and the expected accuracy",
      {{"Chainage", fmt::format("{:.2f} to {:.2f} m", plan.columns.front().chainage,
                                plan.columns.back().chainage)},
       {"Tags", fmt::format("{}", survey.tags.size())},
       {"Speed", plan.speed > 0 ? format_number(plan.speed, 2) + " m/s" : "standing still"}}};
  return lay_out_sheets(block, views, {paper, coarsest_plan_scale(survey)});
}

}  // namespace tagsmith::detail
