// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_manifest.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/json_text.hpp"

namespace tagsmith::detail {
namespace {

using Json = nlohmann::ordered_json;

// Micrometres are finer than anything surveyed or printed; more digits would be rounding noise.
double to_micrometre(double metres) { return with_decimals(metres, 6); }
double mm(double metres) { return std::round(metres * 1e9) / 1e6; }

Json rounded_point(const Eigen::Vector3d& point) {
  return {to_micrometre(point.x()), to_micrometre(point.y()), to_micrometre(point.z())};
}

Json tag_json(const PrintedTag& printed, const std::string& folder) {
  const PlacedTag& tag = *printed.tag;
  return {{"tag", tag.name},
          {"side", to_string(tag.side)},
          {"digits", to_string(tag.digits)},
          {"position", rounded_point(tag.p_in_grid)},
          {"coded_position", rounded_point(tag.coded_in_grid)},
          {"rounding", rounded_point(tag.coded_in_grid - tag.p_in_grid)},
          {"chainage", to_micrometre(tag.chainage)},
          {"files", json_list(printed.files, [&](const auto& file) { return folder + file; })}};
}

void append_point(std::vector<std::string>& fields, const Eigen::Vector3d& point) {
  for (const double coordinate : point) fields.push_back(format_number(coordinate));
}

// Where the tiles of a plate belong: tile (column, row) shows its window of the page `step` further
// right and down for each column and row.
Json tiles_json(const TilePlan& plan) {
  const Rectangle& window = plan.window;
  return {{"columns", plan.columns},
          {"rows", plan.rows},
          {"overlap_mm", mm(plan.overlap)},
          {"window_mm", {mm(window.x), mm(window.y), mm(window.width), mm(window.height)}},
          {"first_mm", {mm(plan.first_in_plate.x), mm(plan.first_in_plate.y)}},
          {"step_mm", {mm(plan.step_right), mm(plan.step_down)}}};
}

Json proofs_json(const std::vector<TagProof>& proofs) {
  return json_list(proofs, [](const TagProof& proof) -> Json {
    return {{"tag", proof.tag},
            {"file", proof.file},
            {"dots_per_inch", with_decimals(proof.dots_per_inch, 2)},
            {"digits", proof.digits},
            {"length_error_mm", mm(proof.length_error)},
            {"height_error_mm", mm(proof.height_error)},
            {"corner_error_mm", mm(proof.corner_error)},
            {"zbar", proof.zbar},
            {"problem", proof.problem}};
  });
}

Json roll_json(const RollUse& roll) {
  return {{"length_m", with_decimals(roll.length, 3)},
          {"waste_percent", std::round(roll.waste() * 1e3) / 10}};
}

// Micrometres on a metre: finer than paper keeps.
Json printer_json(const PrinterProfile& printer) {
  return {{"profile", printer.name},
          {"scale", {to_micrometre(printer.scale.right), to_micrometre(printer.scale.down)}}};
}

}  // namespace

std::string printed_tag_json(const PrintedTag& printed, const std::string& folder) {
  return json_text(tag_json(printed, folder), -1);
}

std::vector<PrintedTag> printed_tags(const PrintJob& job) {
  std::vector<PrintedTag> printed;
  for (std::size_t unit = 0; unit < job.units.size(); ++unit) {
    std::vector<std::string> files;
    for (const PageInFile& page : pages_in_files(job, unit)) {
      if (std::ranges::count(files, page.file) == 0) files.push_back(page.file);
    }
    for (const PlacedTag* tag : job.units[unit].tags) printed.push_back({tag, files});
  }
  return printed;
}

std::string print_manifest_json(const PrintJob& job, const PrintRecord& record) {
  const TagTemplate& tag = job.printed;
  const Page page = pages_of(job, job.units.front()).back();
  const auto one_tag = [](const PrintedTag& item) { return tag_json(item, {}); };
  Json manifest{
      {"survey", job.survey->name},
      {"survey_file", job.survey->file.string()},
      {"revision", job.style.revision},
      {"template", tag.name},
      {"check_digit", to_string(job.survey->code.check)},
      {"page_mm", {mm(page.width), mm(page.height)}},
      {"plate_mm", {mm(tag.plate_length), mm(tag.plate_height)}},
      {"feature_frame_inner_mm", {mm(tag.frame_inner_length), mm(tag.frame_inner_height)}},
      {"module_mm", mm(module_width(tag))},
      {"quiet_zone_modules", to_micrometre(tag.quiet_zone_modules)},
      {"dots_per_inch", job.dots_per_inch()},
      {"png_dots_per_inch", job.png_dots_per_inch()},
      {"tiled", job.style.tiled},
      {"rounding", job.rounding},
      {"bar_adjustment_mm", mm(job.style.bar_adjustment)},
      {"material", tag.material},
      {"paper", job.style.paper ? job.style.paper->name : ""},
      {"tags", json_list(record.tags, one_tag)},
      {"documents", record.documents},
      {"sha256", record.sha256}};
  if (job.tiles) manifest["tiles"] = tiles_json(*job.tiles);
  if (job.style.printer) manifest["printer"] = printer_json(*job.style.printer);
  if (job.roll) manifest["roll"] = roll_json(*job.roll);
  if (record.proofs) manifest["proof"] = proofs_json(*record.proofs);
  return json_text(manifest, 2) + "\n";
}

std::string print_manifest_csv(const PrintJob& job, const PrintRecord& record) {
  const TagTemplate& tag = job.printed;
  const Survey& survey = *job.survey;
  const Page page = pages_of(job, job.units.front()).back();
  std::string csv = csv_row(split(
      "survey,survey_file,tag,side,digits,x,y,z,coded_x,coded_y,coded_z,rounding_x,rounding_y,"
      "rounding_z,chainage,files,template,check_digit,page_width_mm,page_height_mm,plate_length_mm,"
      "plate_height_mm,frame_inner_length_mm,frame_inner_height_mm,module_mm,revision",
      ','));
  for (const PrintedTag& item : record.tags) {
    std::vector<std::string> fields{survey.name, survey.file.string(), item.tag->name,
                                    to_string(item.tag->side), to_string(item.tag->digits)};
    append_point(fields, item.tag->p_in_grid);
    append_point(fields, item.tag->coded_in_grid);
    append_point(fields, item.tag->coded_in_grid - item.tag->p_in_grid);
    fields.insert(fields.end(),
                  {format_number(item.tag->chainage), fmt::format("{}", fmt::join(item.files, ";")),
                   tag.name, to_string(survey.code.check)});
    for (const double length :
         {page.width, page.height, tag.plate_length, tag.plate_height, tag.frame_inner_length,
          tag.frame_inner_height, module_width(tag)}) {
      fields.push_back(mm_text(length, 6));
    }
    fields.push_back(job.style.revision);
    csv += csv_row(fields);
  }
  return csv;
}

}  // namespace tagsmith::detail
