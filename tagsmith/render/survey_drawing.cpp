// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/survey_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/survey_views.hpp"
#include "tagsmith/render/tag_text.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/check_together.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {

// ---- The words of a survey's drawing: what the file means, and the table of tags.

namespace {

constexpr double kRow = 0.0034;

std::string element_text(const CenterlineElement& element) {
  const std::string grade =
      element.grade == 0 ? "" : ", grade " + format_number(100 * element.grade, 2) + " %";
  if (element.curvature == 0) return "line " + metres(element.length) + " m" + grade;
  const double angle = element.length * std::abs(element.curvature);
  return "arc of radius " + metres(std::abs(1 / element.curvature)) + " m to the " +
         (element.curvature > 0 ? "right" : "left") + ", " + format_number(degrees(angle), 3) +
         "\u00b0" + grade;
}

// A clothoid counts as one, whatever number of arcs it consists of.
std::vector<std::string> element_texts(std::span<const CenterlineElement> elements) {
  std::vector<std::string> texts;
  while (!elements.empty()) {
    const std::span<const CenterlineElement> part = leading_part(elements);
    elements = elements.subspan(part.size());
    const std::optional<Clothoid> clothoid = clothoid_of(part);
    if (!clothoid) {
      texts.push_back(element_text(part.front()));
      continue;
    }
    const double turned = clothoid->length * (clothoid->from + clothoid->to) / 2;
    texts.push_back(fmt::format("clothoid, {} m, {}\u00b0 to the {}", metres(clothoid->length),
                                format_number(degrees(std::abs(turned)), 3),
                                turned > 0 ? "right" : "left"));
  }
  return texts;
}

void add_grid_words(std::vector<std::string>& lines, const Survey& survey) {
  lines.push_back(survey.grid.x_axis_left
                      ? "Grid: x to the left of +y, z up (left-handed; the plan shows it so)"
                      : "Grid: x to the right of +y, z up (right-handed)");
  lines.push_back("Headings: from +y towards +x, degrees");
  lines.push_back("Left and right: of somebody who looks along the drive");
}

void add_tunnel_words(std::vector<std::string>& lines, const Survey& survey) {
  constexpr std::size_t kMostElements = 10;
  const Centerline& line = survey.tunnel.centerline;
  const CenterlinePoint start = line.at(0);
  lines.push_back(
      fmt::format("Center line: from {} on the floor, heading {}\u00b0, {} m long",
                  point_text(survey, start.position),
                  format_number(degrees(grid_heading_from_world(survey.grid, start.heading)), 4),
                  metres(line.length())));
  const std::vector<std::string> elements = element_texts(line.elements());
  for (std::size_t i = 0; i < std::min(kMostElements, elements.size()); ++i) {
    lines.push_back("    " + elements[i]);
  }
  if (elements.size() > kMostElements) {
    lines.push_back(fmt::format("    and {} more elements", elements.size() - kMostElements));
  }
  lines.push_back("W_T: " + width_text(survey.tunnel) +
                  " m between the planes of the left and right plates; roof at " +
                  height_text(survey.tunnel) + " m");
  if (survey.tunnel.stand_off > 0) {
    lines.push_back("    Plates stand " + metres(survey.tunnel.stand_off) +
                    " m off the rock; walls are drawn as the rock runs");
  }
}

// Plates that do not hang as their wall says.
void add_attitude_words(std::vector<std::string>& lines, const Survey& survey) {
  constexpr int kMostNamed = 8;
  if (const std::string usual = usual_attitudes_text(survey); !usual.empty()) {
    lines.push_back("    " + usual);
  }
  int count = 0;
  for (const PlacedTag& tag : survey.tags) {
    if (!has_own_attitude(survey, tag) || ++count > kMostNamed) continue;
    lines.push_back("    " + tag.name + " " + attitude_text(*tag.attitude));
  }
  if (count > kMostNamed) {
    lines.push_back(
        fmt::format("    and {} more with an attitude of their own", count - kMostNamed));
  }
}

// How well coordinates are surveyed; the worst counts.
std::string accuracy_words(const Survey& survey) {
  if (!states_every_sigma(survey)) {
    return fmt::format("survey accuracy not stated: {} mm assumed",
                       format_number(1000 * survey.sigma));
  }
  double worst = 0;
  for (const PlacedTag& tag : survey.tags) worst = std::max(worst, tag.sigma);
  return "a coordinate is surveyed to " + metres(worst) + " m";
}

void add_tag_words(std::vector<std::string>& lines, const Survey& survey) {
  lines.push_back("P: upper left inner corner of the feature frame, seen facing the plate;");
  lines.push_back("    the tag's position is the position of P");
  if (survey.series && survey.series->pairs > 0) {
    const TagSeries& series = *survey.series;
    const double facing = facing_pair_angle(survey, left_middle(survey, 0));
    lines.push_back(fmt::format(
        "Regular pairs: {}; first P at chainage {} m, W_B {} m clear, H_P {} m", series.pairs,
        metres(series.first), metres(series.spacing), metres(series.mount_height)));
    lines.push_back(fmt::format("\u03b8: {}\u00b0{}",
                                format_number(degrees(series.pair_angle.value_or(facing)), 3),
                                series.pair_angle ? "; facing plates have atan(L_CI / W_T) = " +
                                                        format_number(degrees(facing), 3) + "\u00b0"
                                                  : " = atan(L_CI / W_T): plates face each other"));
  }
  add_attitude_words(lines, survey);
  const auto surveyed = std::ranges::count_if(survey.tags, &PlacedTag::surveyed);
  lines.push_back(fmt::format("Tags: {}, of them {} from `placed`; {}", survey.tags.size(),
                              surveyed, accuracy_words(survey)));
}

void add_code_words(std::vector<std::string>& lines, const Survey& survey) {
  const PositionCode& code = survey.code;
  lines.push_back("Code: check digit " + to_string(code.check));
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = coded_range(code, static_cast<int>(axis));
    lines.push_back(fmt::format("    {}: {} digits of {} m, from {} to {} m", kAxes[axis],
                                code.digit_counts[axis], format_number(code.resolution[axis], 6),
                                metres(low), metres(high)));
  }
}

void add_rig_words(std::vector<std::string>& lines, const Rig& rig) {
  lines.push_back("Rig " + rig.name + ": O " + metres(rig.vehicle_height) + " m above the floor");
  for (const RigRange& range : rig.ranges) {
    lines.push_back("    " + range.name + ": least horizontal distance from O to the " +
                    to_string(range.wall) + " wall, " + metres(range.min) + " to " +
                    metres(range.max) + " m");
  }
}

constexpr std::array<ViewColumn, 8> kColumns{{{"tag", 0.011},
                                              {"digits", 0.039},
                                              {"x", 0.057},
                                              {"y", 0.075},
                                              {"z", 0.089},
                                              {"chainage", 0.104},
                                              {"height", 0.115},
                                              {"", 0.118}}};  // right ends

std::vector<std::string> cells_of(const Survey& survey, const PlacedTag& tag) {
  return {tag.name,
          grouped_digits(survey.code, tag.digits),
          to_millimetre(tag.p_in_grid.x()),
          to_millimetre(tag.p_in_grid.y()),
          to_millimetre(tag.p_in_grid.z()),
          to_millimetre(tag.chainage),
          to_millimetre(height_of_p(survey, tag)),
          tag.surveyed ? "*" : ""};
}

}  // namespace

DrawingView survey_notes(const Survey& survey, const std::optional<Rig>& rig) {
  std::vector<std::string> lines;
  add_grid_words(lines, survey);
  add_tunnel_words(lines, survey);
  add_tag_words(lines, survey);
  add_code_words(lines, survey);
  if (rig) add_rig_words(lines, *rig);
  DrawingView view;
  view.title = "What the file says";
  add_lines(view.sketch.layer("notes"), lines, 0, colours::kBlack, kWordsHeight, kRow);
  view.scale = 1;
  return view;
}

std::vector<DrawingView> tag_tables(const Survey& survey, Paper paper) {
  std::vector<ViewRow> rows;
  for (const PlacedTag& tag : survey.tags) rows.push_back({cells_of(survey, tag)});
  std::vector<DrawingView> views = table_views(kColumns, TextAlign::right, kRow, rows, paper);
  if (!views.empty()) views.front().title += "; position of P in the grid, * as built";
  return views;
}

// ---- The drawing.

namespace {

DrawingPart plan_part(const Survey& survey, Paper paper) {
  return drive_by_strips(survey, paper, [&](const PlanStrip& strip, Side side, bool first) {
    return wall_elevation(survey, strip, side, first);
  });
}

DrawingPart detail_part(const Survey& survey, const std::optional<Rig>& rig, Paper paper) {
  DrawingPart part{{}, {.paper = paper}};
  const std::optional<TagPair> pair = first_pair(survey);
  if (!survey.tags.empty()) {
    part.views.push_back(cross_section(survey, pair ? pair->left : survey.tags.front(), rig));
  }
  if (pair) part.views.push_back(pair_plan(survey, *pair));
  if (rig) part.views.push_back(rig_view(survey, *rig));
  if (!survey.tags.empty()) part.views.push_back(plate_view(survey, survey.tags.front()));
  part.views.push_back(survey_notes(survey, rig));
  return part;
}

// The whole plan of the survey, in world axes.
PlanStrip whole_as_it_lies(const Survey& survey) {
  const std::vector<PlanStrip> strips = plan_strips(survey);
  return {strips.front().from, strips.back().to, Eigen::Isometry2d::Identity()};
}

void add_all(Sketch& sketch, const Sketch& other) {
  for (const SketchLayer& layer : other.layers) {
    std::vector<SketchItem>& items = sketch.layer(layer.name).items;
    items.insert(items.end(), layer.items.begin(), layer.items.end());
  }
}

void name_drive(Sketch& sketch, const Survey& survey) {
  const CenterlinePoint start = survey.tunnel.centerline.at(0);
  const Eigen::Vector2d at = start.position.head<2>();
  const Eigen::Vector2d along = direction_of(start.heading).head<2>();
  sketch.layer("grid").add(Dot{at, 0.0009, colours::kBlue});
  sketch.layer("grid").add(Arrow{at, {at, 0.012 * along}, {colours::kBlue, kWide, {}}});
  sketch.layer("grid").add(Words{.text = survey.name,
                                 .at = {at, -0.004 * along},
                                 .height = 0.0025,
                                 .align = along.x() > 0 ? TextAlign::right : TextAlign::left,
                                 .level = TextLevel::middle,
                                 .colour = colours::kBlue});
}

}  // namespace

Result<std::vector<Sheet>> draw_together(const std::vector<Survey>& surveys, Paper paper) {
  if (const auto one = check_one_grid(surveys); !one) return fail(one);
  DrawingView view;
  double coarsest = std::numeric_limits<double>::infinity();
  TitleBlock block{"Drives", "Several surveys in one plan", {}};
  for (const Survey& survey : surveys) {
    add_all(view.sketch, tunnel_plan(survey, whole_as_it_lies(survey)));
    name_drive(view.sketch, survey);
    coarsest = std::min(coarsest, coarsest_plan_scale(survey));
    block.fields.push_back({"Survey", survey.name});
  }
  const Eigen::Vector2d room = drawing_area(paper);
  const Eigen::Vector2d extent = model_extent(view.sketch).value_or(room);
  const double scale = (extent.array() / room.array()).maxCoeff();
  if (scale > coarsest) {
    for (const char* layer : {"names", "centerline"}) {
      std::erase_if(view.sketch.layer(layer).items,
                    [](const SketchItem& item) { return std::holds_alternative<Words>(item); });
    }
  }
  view.title = "All drives from above";
  view.axes = plan_axes(surveys.front(), whole_as_it_lies(surveys.front()));
  const std::vector<DrawingPart> parts{{{std::move(view)}, {.paper = paper}}};
  return lay_out_sheets(block, parts);
}

Result<std::vector<Sheet>> draw_survey(const Survey& survey, const std::optional<Rig>& rig,
                                       const SurveyDrawingStyle& style) {
  TitleBlock block{survey.name, "What the survey means", {}};
  block.fields.push_back({"Survey", survey.file.filename().string()});
  if (!style.revision.empty()) block.fields.push_back({"Revision", style.revision});
  block.fields.push_back({"Template", survey.tag_template.name});
  if (rig) block.fields.push_back({"Rig", rig->name});
  std::vector<DrawingPart> parts{plan_part(survey, style.paper),
                                 detail_part(survey, rig, style.paper)};
  if (!survey.tags.empty() && survey.tags.size() <= kMostListedTags) {
    parts.push_back({tag_tables(survey, style.paper), {.paper = style.paper}});
  }
  return lay_out_sheets(block, parts);
}

}  // namespace tagsmith::detail
