// SPDX-License-Identifier: Apache-2.0
// The views that the drawing of a survey is made of. Internal to tagsmith/render.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/tunnel_plan.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A length in words of a drawing: to the millimetre, without zeros at its end; a point as its
// coordinates in the grid.
std::string metres(double length);
std::string point_text(const Survey& survey, const Eigen::Vector3d& point_in_world);

// Adds a dimension between two points of the ground; `offset` as Dimension's.
void add_dimension(SketchLayer& layer, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                   double offset, const std::string& text, const Colour& colour = colours::kBlack);

// The plan and the elevation of each wall by strips, at a scale at which `least` can be read; only
// the strips that are `wanted`, where that is given. The first plan shows the start of the drive
// with its coordinates and heading, and each the grid's origin where it is near.
using WallView = std::function<DrawingView(const PlanStrip& strip, Side side, bool first)>;
DrawingPart drive_by_strips(const Survey& survey, Paper paper, const WallView& wall_view,
                            const PlanLegibility& least = {},
                            const std::function<bool(const PlanStrip&)>& wanted = {});

// A wall seen from inside the tunnel, unrolled along the chainage, heights above the floor. Facing
// the left wall the drive runs to the right, facing the right wall to the left. `dimensions` adds
// spacing, plate length and tunnel height.
DrawingView wall_elevation(const Survey& survey, const PlanStrip& strip, Side side,
                           bool dimensions);

// As wall_elevation, with the chainage and the height of corner P of each of these places below it,
// and its distance from the one before. Tags should be kSettingOutPitch apart on paper.
inline constexpr double kSettingOutPitch = 0.008;
DrawingView setting_out_elevation(const Survey& survey, const PlanStrip& strip, Side side,
                                  std::span<const SettingOut> places);

// A left and a right tag of one pair.
struct TagPair {
  PlacedTag left;
  PlacedTag right;
};

// The first pair that has both; nothing when there is none.
std::optional<TagPair> first_pair(const Survey& survey);

// The tunnel across, seen along the drive, at a tag.
DrawingView cross_section(const Survey& survey, const PlacedTag& tag,
                          const std::optional<Rig>& rig);

// A pair from above: theta, stagger, width.
DrawingView pair_plan(const Survey& survey, const TagPair& pair);

// A plate seen facing it, with P, F and Q.
DrawingView plate_view(const Survey& survey, const PlacedTag& tag);

// The vehicle from above between the walls: where its cameras look and its ranges measure.
DrawingView rig_view(const Survey& survey, const Rig& rig);

// What the file means, in words.
DrawingView survey_notes(const Survey& survey, const std::optional<Rig>& rig);

// All tags with side, digits, position, chainage and height above the floor, by columns.
std::vector<DrawingView> tag_tables(const Survey& survey, Paper paper);

}  // namespace tagsmith::detail
