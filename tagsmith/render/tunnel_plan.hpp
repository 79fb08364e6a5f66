// SPDX-License-Identifier: Apache-2.0
// The tunnel and its tags seen from above: the base of plans, run drawings and maps.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/sketch.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// A piece of the tunnel that is drawn in one view, turned so that the drive runs from left to
// right. The view is never mirrored: a grid with x to the left shows as its axes.
struct PlanStrip {
  double from = 0;  // chainage
  double to = 0;
  Eigen::Isometry2d view_from_world = Eigen::Isometry2d::Identity();

  // A point, and a direction, of the world as the view shows it.
  Eigen::Vector2d in_view(const Eigen::Vector3d& point) const;
  Eigen::Vector2d turned(const Eigen::Vector3d& direction) const;

  bool has(const PlacedTag& tag) const { return tag.chainage >= from && tag.chainage < to; }
};

// The line `offset` metres to the right of the center line as the strip's view shows it, in
// straight pieces that miss it by at most `sag` metres.
std::vector<SketchPoint> line_in_view(const PlanStrip& strip, const Centerline& line,
                                      const ChainageProfile& offset, double from, double to,
                                      double sag);

// The sizes at which a plan can be read, metres on paper.
struct PlanLegibility {
  double name_pitch = 0.0030;  // from tag to tag of a wall
  double plate = 0;            // length of a plate
};

// The least scale (its denominator) at which the tags' names do not overlap and the walls can be
// distinguished.
double coarsest_plan_scale(const Survey& survey, const PlanLegibility& least = {});

inline constexpr int kMostStrips = 400;

// The strip between two chainages.
PlanStrip plan_strip(const Survey& survey, double from, double to);

// The tunnel, and its ends beyond where tags hang there, in as few readable strips as possible: one
// when it fits the paper at coarsest_plan_scale or better, else pieces of a sheet's width that end
// at round chainages; at most kMostStrips, which makes a very long tunnel's scale less.
std::vector<PlanStrip> plan_strips(const Survey& survey, Paper paper = Paper::a3,
                                   const PlanLegibility& least = {});

// Layers `floor`, `walls`, `centerline` (with chainage ticks), `tags` (plates,
// corner P as a dot, an arrow for the way they face) and `names`. Points are in the strip's view:
// view_from_world * point. Tags with a chainage outside the strip are left out.
Sketch tunnel_plan(const Survey& survey, const PlanStrip& strip);

// Words that continue the tag's name away from its wall, in their line.
Words words_beyond_name(const Survey& survey, const PlanStrip& strip, const PlacedTag& tag,
                        std::string text);

// The round chainages that the strip marks.
std::vector<double> plan_ticks(const PlanStrip& strip);

// The plate's edges in the plate frame.
Rectangle plate_outline(const TagTemplate& tag);

// The middle of a plate along its length, metres to the right of P.
double plate_middle(const TagTemplate& tag);

// The grid's axes as the strip's view shows them.
ViewAxes plan_axes(const Survey& survey, const PlanStrip& strip);

// The strip's plan as a view of a drawing, titled with its chainages. Functions that draw more onto
// it add to its sketch, with points as given by strip.view_from_world.
DrawingView plan_view(const Survey& survey, const PlanStrip& strip);

}  // namespace tagsmith::detail
