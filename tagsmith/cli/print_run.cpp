// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tagsmith/render/cut_file.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/setting_out_sheets.hpp"
#include "tagsmith/render/text.hpp"
#include "tagsmith/render/zip_file.hpp"
#include "tagsmith/survey/compare.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// ---- The manifest.

namespace {

constexpr const char* kManifestJson = "manifest.json";
constexpr const char* kManifestCsv = "manifest.csv";

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

// The places of a plate's tiles: tile (column, row) shows its window of the page `step` further
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

// Micrometres per metre: finer than the stability of paper.
Json printer_json(const PrintJob& job) {
  const PrinterScale scale = job.printer_scale();
  return {{"profile", job.style.printer->name},
          {"scale", {to_micrometre(scale.right), to_micrometre(scale.down)}}};
}

void add_lengths(const TagTemplate& tag, Json& json) {
  for (const PrintedLength& length : printed_lengths()) {
    const double millimetres = mm(length.of(tag));
    if (length.index) {
      json[length.key].push_back(millimetres);
    } else {
      json[length.key] = millimetres;
    }
  }
}

// What all files of a print have in common.
Json common_json(const PrintJob& job) {
  const TagTemplate& tag = job.printed;
  const Page page = typical_page(job);
  Json common{{"survey", job.survey->name},
              {"survey_file", job.survey->file.string()},
              {"revision", job.style.revision},
              {"template", tag.name},
              {"template_revision", template_revision(job.survey->tag_template)},
              {"check_digit", to_string(job.survey->code.check)},
              {"page_mm", {mm(page.width), mm(page.height)}}};
  add_lengths(tag, common);
  common.update(Json{{"white_on_black", tag.white_on_black},
                     {"quiet_zone_modules", to_micrometre(tag.quiet_zone_modules)},
                     {"dots_per_inch", job.dots_per_inch()},
                     {"png_dots_per_inch", job.png_dots_per_inch()},
                     {"tiled", job.style.tiled},
                     {"rounding", job.rounding},
                     {"bar_adjustment_mm", mm(job.style.bar_adjustment)},
                     {"material", tag.material},
                     {"paper", job.style.paper ? job.style.paper->name : ""},
                     {"tiles", job.tiles ? tiles_json(*job.tiles) : Json()},
                     {"printer", job.style.printer ? printer_json(job) : Json()}});
  return common;
}

// Of a tag as the manifest has it: its row in manifest.csv, from the name to the files.
std::vector<std::string> fields_of(const Json& item) {
  std::vector<std::string> fields{item.at("tag"), item.at("side"), item.at("digits")};
  for (const char* point : {"position", "coded_position", "rounding"}) {
    for (const double coordinate : item.at(point).get<std::array<double, 3>>()) {
      fields.push_back(format_number(coordinate));
    }
  }
  const auto files = item.at("files").get<std::vector<std::string>>();
  fields.push_back(format_number(item.at("chainage").get<double>()));
  fields.push_back(fmt::format("{}", fmt::join(files, ";")));
  return fields;
}

// The tags of earlier prints into the folder, and what this print changes of them.
struct EarlierTags {
  Json kept = Json::array();                       // all of whose files are still there
  std::map<std::string, std::string> kept_sha256;  // of these files
  std::set<std::string> same;          // names of those whose plates are the same in the survey now
  std::vector<std::string> gone;       // names of those whose files this print replaces
  std::vector<std::string> changed;    // files of those that differ in the survey now
  std::vector<std::string> again;      // files of those that this print has, too
  std::vector<std::string> left_over;  // files that no manifest lists any longer
  // What the kept ones share, where nothing else is printed; null = the present values.
  Json common;
};

void take_earlier(Json tag, const Json& earlier, const std::filesystem::path& folder,
                  const Survey& survey, const PrintRecord& record, EarlierTags& tags) {
  fields_of(tag);  // throws where one lacks, or is of another type
  const auto name = tag.at("tag").get<std::string>();
  const auto files = tag.at("files").get<std::vector<std::string>>();
  const bool is_printed = std::ranges::any_of(
      record.tags, [&](const PrintedTag& printed) { return printed.tag->name == name; });
  std::error_code ignored;
  for (const std::string& file : files) {
    if (std::filesystem::path(file).filename() != file) return;  // it is not in this folder
    if (record.sha256.contains(file)) {
      if (!is_printed) tags.gone.push_back(name);
      return;
    }
    if (!std::filesystem::exists(folder / file, ignored)) return;
  }
  if (files.empty()) return;
  for (const std::string& file : files) {
    tags.kept_sha256[file] = earlier.at("sha256").at(file).get<std::string>();
  }
  const PlacedTag* now = find_tag(survey, name);
  if (is_printed) {
    tags.again.push_back(files.front());
  } else if (now == nullptr || to_string(now->digits) != tag.at("digits").get<std::string>()) {
    tags.changed.push_back(files.front());
  } else {
    tags.same.insert(name);
  }
  if (!tag.contains("revision")) tag["revision"] = earlier.at("revision");
  tags.kept.push_back(std::move(tag));
}

// Whether both prints share the values that a manifest states once for all tags. Pages of a roll
// are as long as their plates; where nothing is printed, there are none.
bool is_of_one_kind(const PrintJob& job, const Json& earlier, const Json& common) {
  const bool any_page = job.units.empty();
  for (const auto& [key, value] : common.items()) {
    const bool of_plate = key == "survey" || key == "template_revision";
    const bool may_differ = key == "survey_file" || key == "revision" ||
                            (job.roll && key == "page_mm") || (any_page && !of_plate);
    if (!may_differ && earlier.value(key, Json()) != value) return false;
  }
  return true;
}

// The values that the earlier manifest states for all its tags, for this state of the survey.
Json common_of(const Json& earlier, Json common) {
  for (auto& [key, value] : common.items()) {
    if (key != "survey_file" && key != "revision") value = earlier.value(key, Json());
  }
  return common;
}

// Files of an earlier print that no manifest lists any longer, such as the contours of other pages.
void find_left_over(const Json& earlier, const std::filesystem::path& folder,
                    const PrintRecord& record, EarlierTags& tags) {
  std::error_code ignored;
  for (const auto& [name, hash] : earlier.at("sha256").items()) {
    const bool is_known = record.sha256.contains(name) || tags.kept_sha256.contains(name);
    const bool is_name = std::filesystem::path(name).filename() == name;
    if (is_known || !is_name || !std::filesystem::exists(folder / name, ignored)) continue;
    tags.left_over.push_back(name);
  }
}

std::vector<std::string> warnings_of(const EarlierTags& tags) {
  std::vector<std::string> warnings;
  const auto warn = [&](const std::vector<std::string>& names, std::string_view words) {
    if (!names.empty()) warnings.push_back(fmt::format(fmt::runtime(words), listed(names)));
  };
  warn(tags.gone,
       "no file of the folder has {} any more, as this print took their place: print "
       "them, too");
  warn(tags.changed, "{}: the survey has other digits or no such tag now: print again or remove");
  warn(tags.left_over,
       "{}: of an earlier print that was made otherwise, and no longer in the manifest: remove, or "
       "print into a folder of its own");
  warn(tags.again,
       "{}: an earlier print of tags that are printed again: remove, so that no plate "
       "is made twice");
  return warnings;
}

// Keeps the entries of the folder's manifest for files that this print does not change, so that
// `verify` still knows whether they are stale. Nothing of a manifest of another survey, template,
// printer or kind of print.
EarlierTags earlier_tags(const PrintJob& job, const std::filesystem::path& folder,
                         const PrintRecord& record) {
  constexpr std::uintmax_t kMostBytes = 16U << 20U;
  const Result<std::string> bytes = read_file(folder / kManifestJson, kMostBytes);
  if (!bytes) return {};
  try {
    const Json earlier = Json::parse(*bytes);
    EarlierTags tags;
    const Json common = common_json(job);
    if (is_of_one_kind(job, earlier, common)) {
      if (job.units.empty()) tags.common = common_of(earlier, common);
      for (const Json& tag : earlier.at("tags")) {
        take_earlier(tag, earlier, folder, *job.survey, record, tags);
      }
    }
    find_left_over(earlier, folder, record, tags);
    return tags;
  } catch (const nlohmann::json::exception&) {
    return {};  // No manifest, or damaged: verify then names the files that no manifest lists.
  }
}

// manifest.json: the survey and its revision, how it was printed, the sizes common to all tags,
// each tag, each file's SHA-256, and the proof.
std::string manifest_json(const PrintJob& job, const PrintRecord& record, const Json& tags,
                          const EarlierTags& earlier) {
  Json manifest = earlier.common.is_null() ? common_json(job) : earlier.common;
  for (const char* key : {"tiles", "printer"}) {
    if (manifest.at(key).is_null()) manifest.erase(key);
  }
  manifest["tags"] = tags;
  manifest["documents"] = record.documents;
  std::map<std::string, std::string> hashes = record.sha256;
  hashes.insert(earlier.kept_sha256.begin(), earlier.kept_sha256.end());
  manifest["sha256"] = hashes;
  if (job.roll) manifest["roll"] = roll_json(*job.roll);
  if (record.proofs) manifest["proof"] = proofs_json(*record.proofs);
  return json_text(manifest, 2) + "\n";
}

// manifest.csv: the tags, one a row (RFC 4180).
std::string manifest_csv(const PrintJob& job, const Json& tags) {
  const TagTemplate& tag = job.printed;
  const Survey& survey = *job.survey;
  const Page page = typical_page(job);
  std::string csv = csv_row(split(
      "survey,survey_file,tag,side,digits,x,y,z,coded_x,coded_y,coded_z,rounding_x,rounding_y,"
      "rounding_z,chainage,files,template,check_digit,page_width_mm,page_height_mm,plate_length_mm,"
      "plate_height_mm,frame_inner_length_mm,frame_inner_height_mm,module_mm,revision",
      ','));
  for (const Json& item : tags) {
    std::vector<std::string> fields{survey.name, survey.file.string()};
    std::ranges::move(fields_of(item), std::back_inserter(fields));
    fields.insert(fields.end(), {tag.name, to_string(survey.code.check)});
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

// The two of them, added to the files.
Result<void> add_manifests(const PrintJob& job, const PrintRecord& record,
                           const EarlierTags& earlier, const StagedFiles& files) {
  Json tags = json_list(record.tags, [](const auto& item) { return tag_json(item, {}); });
  for (const Json& kept : earlier.kept) tags.push_back(kept);
  auto added = files.add(kManifestJson, manifest_json(job, record, tags, earlier));
  return added ? files.add(kManifestCsv, manifest_csv(job, tags)) : added;
}

// ---- The files for a sign maker beside the print files.

constexpr const char* kOrderPdf = "order.pdf";

std::string cut_file_of(const PrintUnit& unit) { return unit.name + "-cut.dxf"; }

struct OrderLine {
  std::string name;
  std::string value;
};

std::string holes_text(const TagTemplate& tag) {
  if (tag.holes.empty()) return "none";
  std::set<std::string> diameters;
  for (const DrillHole& hole : tag.holes) diameters.insert(mm_text(hole.diameter));
  std::string text = fmt::format("{} a plate, diameter", tag.holes.size());
  for (const std::string& diameter : diameters) text += " " + diameter;
  return text + " mm";
}

std::string paper_text(const PrintJob& job) {
  if (job.roll) {
    return fmt::format("{}: {} m, {} % of it waste", job.style.paper->name,
                       format_number(job.roll->length, 2),
                       format_number(job.roll->waste() * 100, 0));
  }
  return job.style.paper ? job.style.paper->name : "a page a plate";
}

std::size_t page_count(const PrintJob& job) {
  return job.units.size() * pages_in_files(job, 0).size() / job.style.formats.size();
}

std::string contours_text(const PrintJob& job) {
  if (job.tiles) return "by the crop marks";
  const bool has_pdf = std::ranges::count(job.style.formats, SheetFormat::pdf) > 0;
  if (job.printed.cut.contour && has_pdf) {
    return "spot colour CutContour in the PDF files, and the DXF files";
  }
  return "the DXF files; the other files have crop marks";
}

// Pages of a roll are as long as their plates.
std::string pages_text(const PrintJob& job) {
  const Page page = typical_page(job);
  const std::size_t count = page_count(job);
  return fmt::format("{} of {} x {}{} mm, bleed {} mm", count, mm_text(page.width),
                     job.roll && count > 1 ? "at most " : "", mm_text(page.height),
                     mm_text(job.style.bleed));
}

std::vector<OrderLine> order_lines(const PrintJob& job, const PrintRecord& record) {
  const TagTemplate& tag = job.printed;
  std::vector<OrderLine> lines{
      {"Survey",
       job.survey->name + (job.style.revision.empty() ? "" : ", revision " + job.style.revision)},
      {"Plates", fmt::format("{}, each different", record.tags.size())},
      {"Plate", fmt::format("{}: {} x {} mm", tag.name, mm_text(tag.plate_length),
                            mm_text(tag.plate_height))},
      {"Material", tag.material.empty() ? "to be agreed: matt, flat, rigid" : tag.material},
      {"Corners",
       tag.cut.corner_radius > 0 ? "radius " + mm_text(tag.cut.corner_radius) + " mm" : "square"},
      {"Holes", holes_text(tag)},
      {"Feature frame inside",
       fmt::format("{} x {} mm: measure it on the first print", mm_text(tag.frame_inner_length),
                   mm_text(tag.frame_inner_height))},
      {"Paper", paper_text(job)},
      {"Pages", pages_text(job)},
      {"Print", "at 100 %, no fitting to the page, black ink alone"},
      {"Contours", contours_text(job)}};
  if (job.style.printer)
    lines.push_back({"Printer", job.style.printer->name + " only: the PDF "
                                                          "files are scaled for it"});
  return lines;
}

Sheet order_sheet(const PrintJob& job, const PrintRecord& record) {
  constexpr double kLeft = 0.020;
  constexpr double kValues = 0.065;
  constexpr double kRight = 0.190;
  constexpr double kHeight = 0.0025;
  constexpr double kStep = 0.0085;
  Sheet sheet{0.210, 0.297, job.survey->name + " order", "Order of position tags", {}};
  SheetLayer layer{"order", {}};
  const auto add = [&](const std::string& text, double x, double y, double height, double width) {
    layer.items.push_back(
        SheetText{.text = text, .at = {x, y}, .height = height, .max_width = width});
  };
  double y = 0.030;
  add("Order of position tags: " + job.survey->name, kLeft, y, 0.0042, kRight - kLeft);
  for (const OrderLine& line : order_lines(job, record)) {
    y += kStep;
    add(line.name, kLeft, y, kHeight, kValues - kLeft - 0.003);
    for (const std::string& part : lines_of(line.value, kRight - kValues, kHeight)) {
      add(part, kValues, y, kHeight, kRight - kValues);
      y += 1.8 * kHeight;
    }
    y -= 1.8 * kHeight;
  }
  sheet.layers.push_back(std::move(layer));
  return sheet;
}

// Names of the order's files: order.pdf, and a cut file for each page. None if no order is
// requested; tiles have no cut files, because their plates are larger than a page.
std::vector<std::string> order_files(const PrintJob& job) {
  if (!job.style.order) return {};
  std::vector<std::string> names{kOrderPdf};
  if (job.tiles) return names;
  for (const PrintUnit& unit : job.units) names.push_back(cut_file_of(unit));
  return names;
}

// Makes these files.
Result<void> write_order(const PrintJob& job, const PrintRecord& record, const StagedFiles& files) {
  if (!job.style.order) return {};
  const Sheet sheet = order_sheet(job, record);
  const Result<std::string> pdf = render_pdf({&sheet, 1});
  if (!pdf) return fail(pdf);
  auto added = files.add(kOrderPdf, *pdf);
  if (job.tiles) return added;
  for (const PrintUnit& unit : job.units) {
    if (!added) return added;
    added = files.add(cut_file_of(unit), render_cut_file(nominal_pages(job, unit).front()));
  }
  return added;
}

// ---- The run.

constexpr const char* kSettingOutList = "setting-out.csv";
constexpr const char* kSettingOutPdf = "setting-out.pdf";

std::string coordinate(double metres) { return fmt::format("{:.4f}", metres + 0.0); }

// Surveyors' P,E,N,Z,D or P,N,E,Z,D: the header names the columns.
std::string setting_out_csv(const Survey& survey, std::span<const SettingOut> list,
                            bool northing_first) {
  const char* plane = northing_first ? "y,x" : "x,y";
  std::string csv = csv_row(split(fmt::format("tag,{},z,description,side,chainage,offset,height,"
                                              "tolerance,digits,survey",
                                              plane),
                                  ','));
  for (const SettingOut& place : list) {
    const PlacedTag& tag = *place.tag;
    std::array<std::string, 2> xy{coordinate(tag.p_in_grid.x()), coordinate(tag.p_in_grid.y())};
    if (northing_first) std::swap(xy[0], xy[1]);
    csv +=
        csv_row({tag.name, xy[0], xy[1], coordinate(tag.p_in_grid.z()),
                 tag.attitude ? "corner P; the plate " + attitude_text(*tag.attitude) : "corner P",
                 to_string(tag.side), coordinate(place.chainage), coordinate(place.offset),
                 coordinate(place.height), coordinate(place.tolerance), to_string(tag.digits),
                 survey.name});
  }
  return csv;
}

Result<std::string> setting_out_pdf(const Survey& survey, std::span<const SettingOut> list,
                                    const PrintStyle& style) {
  std::vector<Sheet> sheets =
      setting_out_table(survey, list, style.revision, style.setting_out_paper);
  Result<std::vector<Sheet>> drawing =
      setting_out_drawing(survey, list, style.revision, style.setting_out_paper);
  if (!drawing) return fail(drawing);
  std::ranges::move(*drawing, std::back_inserter(sheets));
  return render_pdf(sheets);
}

// In the survey's order: the tags that the folder holds plates of, with the survey's digits, and
// those whose plates move.
std::vector<const PlacedTag*> tags_to_hang(const PrintJob& job, const PrintRecord& record,
                                           const EarlierTags& earlier) {
  std::set<std::string> names = job.style.moved;
  names.insert(earlier.same.begin(), earlier.same.end());
  for (const PrintedTag& printed : record.tags) names.insert(printed.tag->name);
  std::vector<const PlacedTag*> tags;
  for (const PlacedTag& tag : job.survey->tags) {
    if (names.contains(tag.name)) tags.push_back(&tag);
  }
  return tags;
}

Result<void> write_setting_out(const PrintJob& job, const PrintRecord& record,
                               const EarlierTags& earlier, const StagedFiles& files) {
  if (!job.style.setting_out) return {};
  const Survey& survey = *job.survey;
  const std::vector<const PlacedTag*> tags = tags_to_hang(job, record, earlier);
  const double tolerance = job.style.tolerance > 0 ? job.style.tolerance : usual_tolerance(survey);
  const std::vector<SettingOut> list = setting_out(survey, tags, tolerance);
  auto added = files.add(kSettingOutList, setting_out_csv(survey, list, job.style.northing_first));
  if (!added) return added;
  const Result<std::string> pdf = setting_out_pdf(survey, list, job.style);
  return pdf ? files.add(kSettingOutPdf, *pdf) : fail(pdf);
}

Result<std::vector<TagProof>> prove_unit(const PrintJob& job, const StagedFiles& files,
                                         std::size_t unit) {
  const double adjustment = drawn_adjustment(job.style.bar_adjustment, job.dots_per_inch());
  const std::vector<Page> pages = nominal_pages(job, job.units[unit]);
  const std::vector<PageInFile> places = pages_in_files(job, unit);
  std::vector<TagProof> proofs;
  for (const SheetFormat format : job.style.formats) {
    std::vector<ProofPage> list;
    for (const PageInFile& place : places) {
      if (place.format != format) continue;
      list.push_back({files.staged(place.file), place.number, &pages[place.index], adjustment,
                      format == SheetFormat::pdf ? job.printer_scale() : PrinterScale{}});
    }
    Result<std::vector<TagProof>> more =
        job.style.prove(*job.survey, list, job.png_dots_per_inch());
    if (!more) return more;
    std::ranges::move(*more, std::back_inserter(proofs));
  }
  return proofs;
}

Result<void> prove_all(const PrintJob& job, const StagedFiles& files, PrintRecord& record) {
  if (!job.style.prove) return {};
  record.proofs.emplace();
  Result<void> all;
  const auto prove = [&](std::size_t i) { return prove_unit(job, files, i); };
  const auto take = [&](std::size_t, Result<std::vector<TagProof>>& proofs) {
    if (proofs) std::ranges::move(*proofs, std::back_inserter(*record.proofs));
    if (!proofs && all) all = fail(proofs);
  };
  run_below_bar("pages proved", job.units.size(), job.style.jobs, prove, take);
  return all;
}

// The job's tags and the files that show them.
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

// Tags, documents and the names of all files that hold them, still without checksums.
PrintRecord planned_record(const PrintJob& job) {
  PrintRecord record{printed_tags(job), {}};
  if (job.style.setting_out) record.documents = {kSettingOutList, kSettingOutPdf};
  std::ranges::move(order_files(job), std::back_inserter(record.documents));
  for (const std::string& name : record.documents) record.sha256[name];
  for (const PrintedTag& printed : record.tags) {
    for (const std::string& name : printed.files) record.sha256[name];
  }
  return record;
}

// The folder's files, and the ZIP of all that its manifest has.
Result<void> publish_with_zip(const PrintJob& job, const std::filesystem::path& folder,
                              const PrintRecord& record, const EarlierTags& earlier,
                              StagedFiles& files) {
  std::vector<ZipEntry> entries;
  for (const auto& [name, hash] : record.sha256) entries.push_back({name, files.staged(name)});
  for (const auto& [name, hash] : earlier.kept_sha256) entries.push_back({name, folder / name});
  for (const char* name : {kManifestJson, kManifestCsv}) {
    entries.push_back({name, files.staged(name)});
  }
  const std::filesystem::path& zip = job.style.zip;
  Result<StagedFiles> beside = StagedFiles::begin(zip.has_parent_path() ? zip.parent_path() : ".");
  if (!beside) return fail(beside);
  if (auto written = write_zip(beside->staged(zip.filename()), entries); !written) return written;
  // The ZIP first: it may be on a full disk, and then the folder stays unchanged.
  if (auto published = beside->publish(); !published) return published;
  return files.publish();
}

Result<void> write_all(const PrintJob& job, const std::filesystem::path& folder, StagedFiles& files,
                       PrintRecord& record) {
  {
    ProgressBar bar("printed", job.units.size());
    auto written = write_print(job, files, [&] { bar.advance([] {}); });
    if (!written) return written;
  }
  const EarlierTags earlier = earlier_tags(job, folder, record);
  record.warnings = warnings_of(earlier);
  if (auto written = write_setting_out(job, record, earlier, files); !written) return written;
  if (auto written = write_order(job, record, files); !written) return written;
  if (auto proved = prove_all(job, files, record); !proved || has_problems(record)) return proved;
  for (auto& [name, hash] : record.sha256) {
    const Result<std::string> found = sha256_of_file(files.staged(name));
    if (!found) return fail(found);
    hash = *found;
  }
  auto added = add_manifests(job, record, earlier, files);
  if (!added || job.style.zip.empty()) return added ? files.publish() : added;
  return publish_with_zip(job, folder, record, earlier, files);
}

}  // namespace

std::string printed_tag_json(const PrintedTag& printed, const std::string& folder) {
  return json_text(tag_json(printed, folder));
}

bool has_problems(const PrintRecord& record) {
  return record.proofs && std::ranges::any_of(*record.proofs, [](const TagProof& proof) {
           return !proof.problem.empty();
         });
}

Result<PrintRecord> run_print(const PrintJob& job, const std::filesystem::path& folder,
                              CommandFiles files) {
  PrintRecord record = planned_record(job);
  for (const auto& [name, hash] : record.sha256) files.writes(folder / name, "--output");
  for (const char* name : {kManifestJson, kManifestCsv}) files.writes(folder / name, "--output");
  files.writes(job.style.zip, "--zip");
  if (auto usable = files.check(); !usable) return fail(usable);
  Result<StagedFiles> staged = StagedFiles::begin(folder);
  if (!staged) return fail(staged);
  const Result<void> written = write_all(job, folder, *staged, record);
  return written ? Result<PrintRecord>(std::move(record)) : fail(written);
}

}  // namespace tagsmith::detail
