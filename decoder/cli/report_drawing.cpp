// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "decoder/cli/report_files.hpp"
#include "decoder/image/load.hpp"
#include "decoder/verify/verify_merge.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/render/tunnel_plan.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {

// ---- The tunnel from above with a mark on every tag, coloured and shaped by its status.

namespace {

// The statuses that status_of returns.
Colour status_colour(const std::string& status) {
  if (status == "ok") return colours::kGreen;
  if (status == "poor") return colours::kOrange;
  return status == "faulty" ? colours::kRed : colours::kGrey;
}

// Adds the mark of that status: a disc, a diamond for `faulty`, a ring for `unseen`.
void add_status_mark(SketchLayer& layer, const SketchPoint& at, const std::string& status) {
  constexpr double kRadius = 0.002;
  const Colour colour = status_colour(status);
  if (status != "faulty") {
    layer.add(Dot{at, kRadius, colour});
    if (status == "unseen") layer.add(Dot{at, 0.6 * kRadius, colours::kWhite});
    return;
  }
  constexpr double kReach = 1.3 * kRadius;
  Area diamond{{}, colour};
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(kReach, 0), Eigen::Vector2d(0, kReach),
                                        Eigen::Vector2d(-kReach, 0), Eigen::Vector2d(0, -kReach)}) {
    diamond.points.emplace_back(at.model, at.paper + corner);
  }
  layer.add(std::move(diamond));
}

// A view for each strip of the tunnel; the marks are in the layer `status`.
std::vector<DrawingView> report_map(const Survey& survey, const VerifyMerge& merged) {
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : plan_strips(survey)) {
    DrawingView view = plan_view(survey, strip);
    SketchLayer& layer = view.sketch.layer("status");
    for (const PlacedTag& tag : survey.tags) {
      if (tag.chainage < strip.from || tag.chainage > strip.to) continue;
      const Eigen::Vector2d at =
          strip.view_from_world * Eigen::Vector2d(tag.world_from_plate.translation.head<2>());
      add_status_mark(layer, at, status_of(record_of(merged, tag.name)));
    }
    views.push_back(std::move(view));
  }
  return views;
}

// ---- The drawing.
// The report of verified files as a document.

constexpr std::size_t kMostShownFaults = 400;
constexpr std::size_t kMostStretches = 12;
constexpr std::size_t kMostDrawnNotes = 6;
constexpr std::size_t kMostRemarks = 8;

DrawingView summary_view(const Survey& survey, const VerifyMerge& merged) {
  const Completeness covered = completeness_of(survey, merged);
  DrawingView view;
  view.title = "Summary";
  view.scale = 1;
  SketchLayer& layer = view.sketch.layer("summary");
  double y = 0;
  const std::map<std::string, const char*> words{{"ok", "in order"},
                                                 {"poor", "print poorly (worst grade below 1.5)"},
                                                 {"faulty", "faulty"},
                                                 {"unseen", "not seen"}};
  for (const auto& [status, count] : status_counts(covered)) {
    add_status_mark(layer, on_paper(0.002, y + 0.0012), status);
    layer.add(Words{.text = fmt::format("{} tags {}", count, words.at(status)),
                    .at = on_paper(0.006, y),
                    .height = 0.0025});
    y -= 0.0055;
  }
  std::vector<std::string> lines = completeness_words(covered, kMostStretches);
  lines.insert(lines.begin(), fmt::format("{} verified, {} found", counted(merged.files, "file"),
                                          counted(merged.fault_count, "fault")));
  if (merged.other_revisions > 0) {
    lines.push_back(fmt::format("{} files were verified against another state of the survey",
                                merged.other_revisions));
  }
  std::ranges::move(unchecked_and_notes_words(covered, merged, kMostDrawnNotes),
                    std::back_inserter(lines));
  const std::vector<std::string>& remarks = merged.hanging_remarks;
  for (std::size_t i = 0; i < std::min(remarks.size(), kMostRemarks); ++i) {
    lines.push_back("where the tags hang: " + remarks[i]);
  }
  if (remarks.size() > kMostRemarks) {
    lines.push_back(
        fmt::format("and {} more remarks, on standard error", remarks.size() - kMostRemarks));
  }
  for (const std::string& line : lines) {
    y = add_lines(layer, lines_of(line, 0.17, kWordsHeight), y);
  }
  return view;
}

// The fault's picture scaled to fit the box; nothing when there is none.
std::optional<Picture> picture_of(const FaultRecord& fault, double width, double height) {
  if (fault.picture.jpeg.empty()) return std::nullopt;
  Result<GrayImage> image = decode_gray_image("crop", fault.picture.jpeg);
  if (!image) return std::nullopt;
  const double scale = std::min(width / image->width, height / image->height);
  return Picture{.width = scale * image->width,
                 .height = scale * image->height,
                 .columns = image->width,
                 .rows = image->height,
                 .samples = std::move(image->samples),
                 .jpeg = fault.picture.jpeg};
}

// A card: picture, where, what is wrong, what to do.
DrawingView fault_view(const FaultRecord& fault, std::size_t number) {
  constexpr double kWidth = 0.085;
  constexpr double kPictureHeight = 0.05;
  DrawingView view;
  view.title = fmt::format("{}. {}", number, fault_heading(fault));
  view.scale = 1;
  double y = 0;
  // The card is as wide as the others, whatever its text.
  SketchLayer& frame = view.sketch.layer("cards");
  frame.add(Polyline{{on_paper(0, y), on_paper(kWidth, y)}, {colours::kGrey, kExtraNarrow, {}}});
  if (std::optional<Picture> picture = picture_of(fault, kWidth, kPictureHeight)) {
    y -= 0.0015;
    picture->at = on_paper(0, y);
    y -= picture->height;
    view.sketch.layer("pictures").add(std::move(*picture));
  }
  y -= 0.0045;
  SketchLayer& layer = view.sketch.layer("faults");
  const auto add = [&](const std::string& text, const Colour& colour) {
    y = add_lines(layer, lines_of(text, kWidth, kWordsHeight), y, colour);
  };
  add(fault.file, colours::kGrey);
  if (!fault.no_picture.empty()) add("No picture: " + fault.no_picture + ".", colours::kGrey);
  add(fault.message, colours::kRed);
  if (const Rule* rule = find_verify_rule(fault.rule)) {
    add(std::string(rule->remedy), colours::kBlack);
  }
  return view;
}

constexpr std::array<ViewColumn, 8> kTagColumns{{{"tag", 0.0},
                                                 {"status", 0.018},
                                                 {"chainage", 0.032},
                                                 {"seen", 0.048},
                                                 {"faults", 0.057},
                                                 {"best", 0.068},
                                                 {"worst", 0.077},
                                                 {"blame", 0.087}}};

std::vector<std::string> cells_of(const PlacedTag& tag, const TagRecord& record) {
  std::vector<std::string> cells{tag.name,
                                 status_of(record),
                                 fmt::format("{:.2f}", tag.chainage),
                                 std::to_string(record.seen),
                                 std::to_string(record.faults),
                                 grade_text(record.best, "-"),
                                 grade_text(record.worst, "-")};
  if (!record.blame.empty()) cells.push_back(record.blame);
  return cells;
}

std::vector<DrawingView> tag_tables(const Survey& survey, const VerifyMerge& merged) {
  std::vector<ViewRow> rows;
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    const std::string status = status_of(record);
    rows.push_back(
        {cells_of(tag, record), status == "ok" ? colours::kBlack : status_colour(status)});
  }
  return table_views(kTagColumns, TextAlign::left, kWordsLine, rows, DrawingStyle{}.paper);
}

constexpr std::array<ViewColumn, 9> kHangingColumns{{{"tag", 0.0},
                                                     {"hangs", 0.018},
                                                     {"right, mm", 0.042},
                                                     {"up, mm", 0.060},
                                                     {"out, mm", 0.078},
                                                     {"clockwise, °", 0.096},
                                                     {"right edge out, °", 0.114},
                                                     {"top out, °", 0.137},
                                                     {"seen", 0.155}}};

// As seen by a viewer who faces the wall, with standard deviations.
std::vector<DrawingView> hanging_tables(const VerifyMerge& merged) {
  std::vector<ViewRow> rows;
  for (const auto& [name, tag] : merged.hung) {
    std::vector<std::string> cells{name, verdict_text(tag)};
    std::ranges::copy(placement_cells(tag), std::back_inserter(cells));
    cells.push_back(std::to_string(tag.stations));
    rows.push_back({std::move(cells), tag.verdict == HangVerdict::fits  ? colours::kBlack
                                      : tag.verdict == HangVerdict::off ? colours::kRed
                                                                        : colours::kOrange});
  }
  std::vector<DrawingView> views =
      table_views(kHangingColumns, TextAlign::left, kWordsLine, rows, DrawingStyle{}.paper);
  for (DrawingView& view : views) view.title = "Where they hang: " + view.title;
  return views;
}

DrawingPart fault_part(const VerifyMerge& merged) {
  DrawingPart part;
  const std::vector<FaultRecord> faults = faults_by_plate(merged);
  for (const FaultRecord& fault : faults) {
    if (part.views.size() == kMostShownFaults) break;
    part.views.push_back(fault_view(fault, part.views.size() + 1));
  }
  if (faults.size() <= part.views.size() && merged.fault_count == merged.faults.size()) return part;
  DrawingView rest;
  rest.title =
      fmt::format("and {} more faults: they are in the JSON lines",
                  merged.fault_count - merged.faults.size() + faults.size() - part.views.size());
  rest.scale = 1;
  rest.new_row = true;
  part.views.push_back(std::move(rest));
  return part;
}

}  // namespace

Result<std::vector<Sheet>> draw_report(const Survey& survey, const VerifyMerge& merged) {
  DrawingPart first{{summary_view(survey, merged)},
                    {.coarsest_scale = coarsest_plan_scale(survey)}};
  std::ranges::move(report_map(survey, merged), std::back_inserter(first.views));
  std::vector<DrawingPart> parts{std::move(first)};
  if (!merged.faults.empty()) parts.push_back(fault_part(merged));
  DrawingPart tables{tag_tables(survey, merged)};
  std::ranges::move(hanging_tables(merged), std::back_inserter(tables.views));
  if (!tables.views.empty()) parts.push_back(std::move(tables));
  const TitleBlock block{"Verification of " + survey.name,
                         "What photos and print files say of the survey's tags",
                         {{"Survey", survey.file.filename().string()},
                          {"Revision", survey_revision(survey)},
                          {"Files", std::to_string(merged.files)}}};
  return lay_out_sheets(block, parts);
}

}  // namespace tagsmith::detail
