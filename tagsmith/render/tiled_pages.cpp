// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/tiled_pages.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kWaste = 0.008;      // shown beyond the plate's edge
constexpr double kCrossArm = 0.0025;  // half the length of an alignment cross's lines
constexpr double kLeastStep = 0.05;   // of new plate on every further sheet

// Sheets along one side of the plate.
struct Tiling {
  int count = 0;
  double first = 0;  // plate frame
  double step = 0;
};

Tiling tile_along(double start, double length, double window, double overlap, int dots_per_inch) {
  const double needed = length + 2 * kWaste;
  Tiling tiling;
  tiling.step = at_dot(window - overlap, dots_per_inch);
  constexpr double kRounding = 1e-9;
  const double further = std::ceil((needed - window) / tiling.step - kRounding);
  tiling.count = 1 + static_cast<int>(std::max(further, 0.0));
  const double total = (tiling.count - 1) * tiling.step + window;
  tiling.first = at_dot(start - kWaste - (total - needed) / 2, dots_per_inch);
  return tiling;
}

TilePlan plan_on(const Rectangle& plate, double width, double height, double overlap,
                 int dots_per_inch) {
  TilePlan plan{0, 0, width, height, overlap};
  const Rectangle area = content_area(width, height);
  plan.window = {at_dot(area.x, dots_per_inch), at_dot(area.y, dots_per_inch), area.width,
                 area.height};
  if (std::min(area.width, area.height) < overlap + kLeastStep) return plan;
  const Tiling across = tile_along(plate.x, plate.width, area.width, overlap, dots_per_inch);
  const Tiling down = tile_along(plate.y, plate.height, area.height, overlap, dots_per_inch);
  plan.columns = across.count;
  plan.rows = down.count;
  plan.first_in_plate = {across.first, down.first};
  plan.step_right = across.step;
  plan.step_down = down.step;
  return plan;
}

// At true size. A page of the roll is as long as the plate needs.
double page_length(double plate_side, const PrintPaper& paper, double borders, double reach) {
  if (!paper.roll()) return paper.height * reach;
  const double least = kScaleBarLength + borders;
  return std::clamp(plate_side + 2 * kWaste + borders, least, kLongestPage * reach);
}

PlatePoint window_in_plate(const TilePlan& plan, int column, int row) {
  return {plan.first_in_plate.x + column * plan.step_right,
          plan.first_in_plate.y + row * plan.step_down};
}

// Adds the part of a horizontal or vertical line that lies in the window.
void add_clipped(Page& page, const Rectangle& window, PlatePoint from, PlatePoint to) {
  const double right = window.x + window.width;
  const double bottom = window.y + window.height;
  if (std::max(from.x, to.x) < window.x || std::min(from.x, to.x) > right) return;
  if (std::max(from.y, to.y) < window.y || std::min(from.y, to.y) > bottom) return;
  const auto clip = [&](PlatePoint& point) {
    point = {std::clamp(point.x, window.x, right), std::clamp(point.y, window.y, bottom)};
  };
  clip(from);
  clip(to);
  page.lines.push_back({from, to});
}

void add_plate_edge(Page& page, const Rectangle& plate, const Rectangle& window) {
  const std::array<PlatePoint, 4> corners = corners_of(plate);
  for (std::size_t i = 0; i < 4; ++i) {
    add_clipped(page, window, corners[i], corners[(i + 1) % 4]);
  }
}

// Crosses in the waste at both ends of every seam; plate frame.
std::vector<PlatePoint> alignment_crosses(const TilePlan& plan, const Rectangle& plate) {
  std::vector<PlatePoint> crosses;
  for (int column = 1; column < plan.columns; ++column) {
    const double x = window_in_plate(plan, column, 0).x + plan.overlap / 2;
    crosses.push_back({x, plate.y - kWaste / 2});
    crosses.push_back({x, plate.y + plate.height + kWaste / 2});
  }
  for (int row = 1; row < plan.rows; ++row) {
    const double y = window_in_plate(plan, 0, row).y + plan.overlap / 2;
    crosses.push_back({plate.x - kWaste / 2, y});
    crosses.push_back({plate.x + plate.width + kWaste / 2, y});
  }
  return crosses;
}

void add_crosses(Page& page, const TilePlan& plan, const Rectangle& plate,
                 const PlatePoint& page_from_plate) {
  for (const PlatePoint& cross : alignment_crosses(plan, plate)) {
    const double x = cross.x + page_from_plate.x;
    const double y = cross.y + page_from_plate.y;
    add_clipped(page, plan.window, {x - kCrossArm, y}, {x + kCrossArm, y});
    add_clipped(page, plan.window, {x, y - kCrossArm}, {x, y + kCrossArm});
  }
}

// Where the edges of the sheets to the right and below will lie.
void add_overlap_lines(Page& page, const TilePlan& plan, int column, int row) {
  const Rectangle& window = plan.window;
  const double right = window.x + window.width;
  const double bottom = window.y + window.height;
  if (column + 1 < plan.columns) {
    const double x = window.x + plan.step_right;
    page.lines.push_back({{x, window.y}, {x, bottom}, true});
  }
  if (row + 1 < plan.rows) {
    const double y = window.y + plan.step_down;
    page.lines.push_back({{window.x, y}, {right, y}, true});
  }
}

std::string neighbours_text(const TilePlan& plan, int column, int row) {
  std::string text;
  if (column + 1 < plan.columns) text += "right of it " + tile_address(column + 1, row);
  if (row + 1 < plan.rows) {
    text += (text.empty() ? "below it " : ", below it ") + tile_address(column, row + 1);
  }
  return text;
}

std::string cut_text(int column, int row) {
  if (column > 0 && row > 0) return "cut off left and upper border";
  if (column > 0) return "cut off left border";
  return row > 0 ? "cut off upper border" : "";
}

void add_tile_texts(Page& page, const std::string& name, const TagDrawing& tag,
                    const TilePlan& plan, int column, int row) {
  constexpr double kAddressHeight = 0.006;
  page.texts.push_back({.text = page.name,
                        .x = plan.window.x + 0.003,
                        .y = 0.0125,
                        .height = kAddressHeight,
                        .max_width = 0.03});
  std::string place = neighbours_text(plan, column, row);
  const std::string cut = cut_text(column, row);
  place += (place.empty() || cut.empty() ? "" : "  \u00b7  ") + cut;
  add_paper_notes(page,
                  page.notes.title + "  \u00b7  " + name + " sheet " + page.name + " of " +
                      tile_address(0, 0) + " to " + tile_address(plan.columns - 1, plan.rows - 1) +
                      (place.empty() ? "" : "  \u00b7  " + place),
                  what_to_measure(tag), page.width - 2 * (plan.window.x + 0.018));
}

Page blank_page(const std::string& name, const PageNotes& notes, const TilePlan& plan) {
  return {.name = name,
          .width = plan.page_width,
          .height = plan.page_height,
          .line_width = 0.0001,
          .notes = notes};
}

Page lay_out_tile(const std::string& name, const TagDrawing& tag, const PageNotes& notes,
                  const TilePlan& plan, int column, int row) {
  Page page = blank_page(tile_address(column, row), notes, plan);
  const PlatePoint corner = window_in_plate(plan, column, row);
  const PlatePoint page_from_plate{plan.window.x - corner.x, plan.window.y - corner.y};
  TagDrawing drawing = moved(tag, page_from_plate.x, page_from_plate.y);
  drawing.cut_contour = false;  // a cutting plotter cannot use a plate in pieces
  add_plate_edge(page, drawing.plate, plan.window);
  page.tags.push_back({name, std::move(drawing), plan.window});
  add_crop_marks(page, plan.window, kPaperMarkGap, kPaperMarkLength);
  add_overlap_lines(page, plan, column, row);
  add_crosses(page, plan, tag.plate, page_from_plate);
  add_tile_texts(page, name, tag, plan, column, row);
  add_scale_bars(page, 0.0065, page.height - 0.0055);
  return page;
}

std::vector<std::string> instructions(const TagDrawing& tag, const TilePlan& plan) {
  const double diagonal = std::hypot(tag.frame_inner.width, tag.frame_inner.height);
  return {
      "1. Print all " + std::to_string(plan.tiles()) +
          " sheets at 100 %, without fitting to the page. Measure both 100 mm bars on each.",
      // NOLINTNEXTLINE(bugprone-suspicious-missing-comma): one instruction.
      "2. Cut off the left border of every sheet from column 2 on, and the upper border of every "
      "sheet from row B on, at the corner marks.",
      "3. Row by row: lay each sheet on its left neighbour, its cut edge on the dashed line, the "
      "crosses on each other. Glue.",
      "4. Lay each row on the one above it in the same way. Glue.",
      "5. Glue the whole on a flat, rigid, matt board. Cut the plate out along its edge line.",
      "6. Measure with a tape: feature frame inside " + mm_text(tag.frame_inner.width, 1) +
          " \u00d7 " + mm_text(tag.frame_inner.height, 1) + " mm, both diagonals inside " +
          mm_text(diagonal, 1) + " mm. More than 1 mm off: print again."};
}

void add_instructions(Page& page, const std::vector<std::string>& lines, double baseline) {
  constexpr double kHeight = 0.0026;
  for (const std::string& line : lines) {
    page.texts.push_back({.text = line,
                          .x = PaperBorder::kLeft,
                          .y = baseline,
                          .height = kHeight,
                          .max_width = page.width - PaperBorder::kLeft - PaperBorder::kRight});
    baseline += 2 * kHeight;
  }
}

// The middle of the part of another span that a span shows, or of all of it when the part is too
// small for a text.
double shown_middle(double from, double to, double shown_from, double shown_to) {
  constexpr double kText = 0.012;
  const double first = std::max(from, shown_from);
  const double last = std::min(to, shown_to);
  return last - first >= kText ? (first + last) / 2 : (from + to) / 2;
}

// The sheets' windows over the reduced plate: `at` is the plate frame's origin on the page. Their
// addresses stand inside the frame, where the bars are left out.
void add_tile_map(Page& page, const TilePlan& plan, const PlatePoint& at, double scale,
                  const Rectangle& frame_inner) {
  constexpr double kAddressHeight = 0.006;
  for (int row = 0; row < plan.rows; ++row) {
    for (int column = 0; column < plan.columns; ++column) {
      const PlatePoint corner = window_in_plate(plan, column, row);
      const Rectangle shown{at.x + scale * corner.x, at.y + scale * corner.y,
                            scale * plan.window.width, scale * plan.window.height};
      const std::array<PlatePoint, 4> corners = corners_of(shown);
      for (std::size_t i = 0; i < 4; ++i) {
        page.lines.push_back({corners[i], corners[(i + 1) % 4], true});
      }
      page.texts.push_back({.text = tile_address(column, row),
                            .x = shown_middle(shown.x, shown.x + shown.width, frame_inner.x,
                                              frame_inner.x + frame_inner.width),
                            .y = shown_middle(shown.y, shown.y + shown.height, frame_inner.y,
                                              frame_inner.y + frame_inner.height) +
                                 kAddressHeight / 2,
                            .height = kAddressHeight,
                            .max_width = 0.03,
                            .centred = true});
    }
  }
}

Page lay_out_assembly(const std::string& name, const TagDrawing& tag, const PageNotes& notes,
                      const TilePlan& plan) {
  Page page = blank_page("assembly", notes, plan);
  const std::vector<std::string> lines = instructions(tag, plan);
  const double text_room = 0.0055 * static_cast<double>(lines.size()) + 0.006;
  const Rectangle area = content_area(page.width, page.height);
  const double map_width = (plan.columns - 1) * plan.step_right + plan.window.width;
  const double map_height = (plan.rows - 1) * plan.step_down + plan.window.height;
  const double scale =
      std::min({1.0, area.width / map_width, (area.height - text_room) / map_height});
  const PlatePoint at{area.x + (area.width - scale * map_width) / 2 - scale * plan.first_in_plate.x,
                      area.y - scale * plan.first_in_plate.y};
  TagDrawing reduced = moved(tag, at.x, at.y, scale);
  reduced.cut_contour = false;
  reduced.bars.clear();  // the addresses stand in their place
  reduced.label.clear();
  reduced.patches.reset();
  reduced.holes.clear();
  const Rectangle frame_inner = reduced.frame_inner;
  add_plate_edge(page, reduced.plate, area);
  page.tags.push_back({name, std::move(reduced), std::nullopt, false});
  add_tile_map(page, plan, at, scale, frame_inner);
  add_instructions(page, lines, area.y + scale * map_height + 0.008);
  add_paper_notes(page, notes.title + "  \u00b7  " + notes.subject,
                  "how the sheets of " + name + " go together; not to scale",
                  page.width - PaperBorder::kLeft - PaperBorder::kRight);
  return page;
}

}  // namespace

Result<TilePlan> plan_tiles(const Rectangle& plate, const PrintPaper& paper, double overlap,
                            int dots_per_inch) {
  const double down_borders = PaperBorder::kTop + PaperBorder::kBottom;
  const double across_borders = PaperBorder::kLeft + PaperBorder::kRight;
  const PrinterScale& reach = paper.reach;
  const TilePlan upright =
      plan_on(plate, paper.width * reach.right,
              page_length(plate.height, paper, down_borders, reach.down), overlap, dots_per_inch);
  TilePlan across = plan_on(plate, page_length(plate.width, paper, across_borders, reach.down),
                            paper.width * reach.right, overlap, dots_per_inch);
  across.lies = true;
  if (upright.tiles() == 0 && across.tiles() == 0) {
    return fail("--paper " + paper.name + ": too small for tiles that overlap by " +
                format_number(overlap * 1000) + " mm: less overlap or a larger paper");
  }
  if (upright.tiles() == 0) return across;
  return across.tiles() == 0 || upright.tiles() <= across.tiles() ? upright : across;
}

std::string tile_address(int column, int row) {
  std::string letters;
  for (int rest = row + 1; rest > 0; rest = (rest - 1) / 26) {
    letters.insert(letters.begin(), static_cast<char>('A' + (rest - 1) % 26));
  }
  return letters + std::to_string(column + 1);
}

std::vector<std::string> tile_page_names(const TilePlan& plan) {
  std::vector<std::string> names{"assembly"};
  for (int tile = 0; tile < plan.tiles(); ++tile) {
    names.push_back(tile_address(tile % plan.columns, tile / plan.columns));
  }
  return names;
}

std::vector<Page> lay_out_tiles(const std::string& name, const TagDrawing& tag,
                                const PageNotes& notes, const TilePlan& plan) {
  std::vector<Page> pages{lay_out_assembly(name, tag, notes, plan)};
  for (int tile = 0; tile < plan.tiles(); ++tile) {
    pages.push_back(lay_out_tile(name, tag, notes, plan, tile % plan.columns, tile / plan.columns));
  }
  return pages;
}

}  // namespace tagsmith::detail
