// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_manifest.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/file.hpp"
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

// What all files of a print have in common.
Json common_json(const PrintJob& job) {
  const TagTemplate& tag = job.printed;
  const Page page = pages_of(job, job.units.front()).back();
  return {{"survey", job.survey->name},
          {"survey_file", job.survey->file.string()},
          {"revision", job.style.revision},
          {"template", tag.name},
          {"check_digit", to_string(job.survey->code.check)},
          {"page_mm", {mm(page.width), mm(page.height)}},
          {"plate_mm", {mm(tag.plate_length), mm(tag.plate_height)}},
          {"feature_frame_inner_mm", {mm(tag.frame_inner_length), mm(tag.frame_inner_height)}},
          {"frame_offset_mm", {mm(tag.frame_offset_right), mm(tag.frame_offset_up)}},
          {"module_mm", mm(module_width(tag))},
          {"quiet_zone_modules", to_micrometre(tag.quiet_zone_modules)},
          {"dots_per_inch", job.dots_per_inch()},
          {"png_dots_per_inch", job.png_dots_per_inch()},
          {"tiled", job.style.tiled},
          {"rounding", job.rounding},
          {"bar_adjustment_mm", mm(job.style.bar_adjustment)},
          {"material", tag.material},
          {"paper", job.style.paper ? job.style.paper->name : ""}};
}

Json tags_json(const PrintRecord& record) {
  Json tags = json_list(record.tags, [](const auto& item) { return tag_json(item, {}); });
  for (const Json& kept : Json::parse(record.kept_tags)) tags.push_back(kept);
  return tags;
}

// A tag of an earlier print all of whose files are still there.
void keep_tag(Json tag, const Json& earlier, const std::filesystem::path& folder,
              PrintRecord& record, Json& kept) {
  const auto files = tag.at("files").get<std::vector<std::string>>();
  std::error_code ignored;
  const auto is_there = [&](const std::string& file) {
    return !record.sha256.contains(file) && std::filesystem::exists(folder / file, ignored);
  };
  if (files.empty() || !std::ranges::all_of(files, is_there)) return;
  for (const std::string& file : files) {
    record.kept_sha256[file] = earlier.at("sha256").at(file).get<std::string>();
  }
  if (!tag.contains("revision")) tag["revision"] = earlier.at("revision");
  kept.push_back(std::move(tag));
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
  Json manifest = common_json(job);
  manifest["tags"] = tags_json(record);
  manifest["documents"] = record.documents;
  std::map<std::string, std::string> hashes = record.sha256;
  hashes.insert(record.kept_sha256.begin(), record.kept_sha256.end());
  manifest["sha256"] = hashes;
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
  for (const Json& item : tags_json(record)) {
    std::vector<std::string> fields{survey.name, survey.file.string(), item.at("tag"),
                                    item.at("side"), item.at("digits")};
    for (const char* point : {"position", "coded_position", "rounding"}) {
      for (const Json& coordinate : item.at(point)) fields.push_back(format_number(coordinate));
    }
    const auto files = item.at("files").get<std::vector<std::string>>();
    fields.insert(fields.end(),
                  {format_number(item.at("chainage")), fmt::format("{}", fmt::join(files, ";")),
                   tag.name, to_string(survey.code.check)});
    for (const double length :
         {page.width, page.height, tag.plate_length, tag.plate_height, tag.frame_inner_length,
          tag.frame_inner_height, module_width(tag)}) {
      fields.push_back(mm_text(length, 6));
    }
    fields.push_back(item.value("revision", job.style.revision));
    csv += csv_row(fields);
  }
  return csv;
}

void keep_earlier_tags(const PrintJob& job, const std::filesystem::path& folder,
                       PrintRecord& record) {
  constexpr std::uintmax_t kMostBytes = 16U << 20U;
  const Result<std::string> bytes = read_file(folder / "manifest.json", kMostBytes);
  if (!bytes) return;
  try {
    const Json earlier = Json::parse(*bytes);
    const Json common = common_json(job);
    for (const auto& [key, value] : common.items()) {
      const bool may_differ = key == "survey_file" || key == "revision";
      if (!may_differ && earlier.value(key, Json()) != value) return;
    }
    Json kept = Json::array();
    for (const Json& tag : earlier.at("tags")) {
      keep_tag(tag, earlier, folder, record, kept);
    }
    record.kept_tags = json_text(kept);
  } catch (const nlohmann::json::exception&) {
    // It is none of ours, or damaged: verify then names the files that no manifest lists.
    record.kept_sha256.clear();
  }
}

}  // namespace tagsmith::detail
