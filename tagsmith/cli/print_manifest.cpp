// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_manifest.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/text.hpp"

namespace tagsmith {
namespace {

using Json = nlohmann::ordered_json;

// Micrometres are finer than anything surveyed or printed; more digits would be rounding noise.
double micrometre(double metres) { return std::round(metres * 1e6) / 1e6; }
double mm(double metres) { return std::round(metres * 1e9) / 1e6; }

Json point_json(const Eigen::Vector3d& point) {
  return {micrometre(point.x()), micrometre(point.y()), micrometre(point.z())};
}

Json tag_json(const PrintedTag& printed, const std::string& folder) {
  const PlacedTag& tag = *printed.tag;
  Json files = Json::array();
  for (const std::string& file : printed.files) files.push_back(folder + file);
  return {{"tag", tag.name},
          {"side", to_string(tag.side)},
          {"digits", to_string(tag.digits)},
          {"position", point_json(tag.p_in_grid)},
          {"coded_position", point_json(tag.coded_in_grid)},
          {"rounding", point_json(tag.coded_in_grid - tag.p_in_grid)},
          {"chainage", micrometre(tag.chainage)},
          {"files", files}};
}

std::string dump(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

void append_point(std::vector<std::string>& fields, const Eigen::Vector3d& point) {
  for (const double coordinate : point) fields.push_back(format_number(coordinate));
}

std::string joined(const std::vector<std::string>& files) {
  std::string text;
  for (const std::string& file : files) text += (text.empty() ? "" : ";") + file;
  return text;
}

std::string mm_text(double metres) { return format_number(metres * 1000, 6); }

}  // namespace

std::string printed_tag_json(const PrintedTag& printed, const std::string& folder) {
  return dump(tag_json(printed, folder), -1);
}

std::string print_manifest_json(const Survey& survey, const Page& page,
                                const std::vector<PrintedTag>& printed) {
  const TagTemplate& tag = survey.tag_template;
  Json tags = Json::array();
  for (const PrintedTag& item : printed) tags.push_back(tag_json(item, {}));
  const Json manifest{
      {"survey", survey.name},
      {"survey_file", survey.file.string()},
      {"template", tag.name},
      {"check_digit", to_string(survey.code.check)},
      {"page_mm", {mm(page.width), mm(page.height)}},
      {"plate_mm", {mm(tag.plate_length), mm(tag.plate_height)}},
      {"feature_frame_inner_mm", {mm(tag.frame_inner_length), mm(tag.frame_inner_height)}},
      {"module_mm", mm(module_width(tag))},
      {"tags", tags}};
  return dump(manifest, 2) + "\n";
}

std::string print_manifest_csv(const Survey& survey, const Page& page,
                               const std::vector<PrintedTag>& printed) {
  const TagTemplate& tag = survey.tag_template;
  std::string csv = csv_row(split(
      "survey,survey_file,tag,side,digits,x,y,z,coded_x,coded_y,coded_z,rounding_x,rounding_y,"
      "rounding_z,chainage,files,template,check_digit,page_width_mm,page_height_mm,plate_length_mm,"
      "plate_height_mm,frame_inner_length_mm,frame_inner_height_mm,module_mm",
      ','));
  for (const PrintedTag& item : printed) {
    std::vector<std::string> fields{survey.name, survey.file.string(), item.tag->name,
                                    to_string(item.tag->side), to_string(item.tag->digits)};
    append_point(fields, item.tag->p_in_grid);
    append_point(fields, item.tag->coded_in_grid);
    append_point(fields, item.tag->coded_in_grid - item.tag->p_in_grid);
    fields.insert(fields.end(), {format_number(item.tag->chainage), joined(item.files), tag.name,
                                 to_string(survey.code.check)});
    for (const double length :
         {page.width, page.height, tag.plate_length, tag.plate_height, tag.frame_inner_length,
          tag.frame_inner_height, module_width(tag)}) {
      fields.push_back(mm_text(length));
    }
    csv += csv_row(fields);
  }
  return csv;
}

}  // namespace tagsmith
