// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_template.hpp"

#include <cstdlib>
#include <system_error>
#include <utility>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/allowances.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith {
namespace fs = std::filesystem;
namespace {

constexpr double kLargestPlate = 10.0;  // metres
constexpr double kMostModules = 1000.0;

struct Size {
  double width = 0;
  double height = 0;
};

std::optional<Size> read_size(const YamlNode* node, const std::string& name, FindingLog& log) {
  const auto values = read_numbers(node, name, 2, above_zero(kLargestPlate, "m"), log);
  if (!values) return std::nullopt;
  return Size{(*values)[0], (*values)[1]};
}

void read_feature_frame(const MapReader& frame, TagTemplate& tag) {
  FindingLog& log = frame.log();
  const auto inner = read_size(frame.need("inner", "inner: [length, height] in metres"),
                               frame.name_of("inner"), log);
  if (inner) {
    tag.frame_inner_length = inner->width;
    tag.frame_inner_height = inner->height;
  }
  tag.frame_stroke = frame.number("stroke", above_zero(1, "m")).value_or(0);
  const auto offset = read_numbers(frame.find("offset"), frame.name_of("offset"), 2,
                                   between(-kLargestPlate, kLargestPlate, "m"), log);
  if (offset) {
    tag.frame_offset_right = (*offset)[0];
    tag.frame_offset_up = (*offset)[1];
  }
}

void read_symbol(const MapReader& symbol, TagTemplate& tag) {
  tag.quiet_zone_modules =
      symbol.number("quiet_zone", between(kQuietZoneModules, kMostModules, "modules"))
          .value_or(tag.quiet_zone_modules);
  tag.margin_modules =
      symbol.number("margin", between(0, kMostModules, "modules")).value_or(tag.margin_modules);
}

void read_label(const MapReader& label, TagTemplate& tag) {
  tag.label.shown =
      read_bool(label.find("shown"), label.name_of("shown"), label.log()).value_or(true);
  constexpr double kMillimetre = 1e-3;
  tag.label.text_height =
      kMillimetre * label.number_or("text_height_mm", tag.label.text_height / kMillimetre,
                                    above_zero(1000, "mm"));
}

void check_dimensions(const TagTemplate& tag, const MapReader& file) {
  const double needed_length =
      tag.frame_inner_length + 2 * tag.frame_stroke + 2 * std::abs(tag.frame_offset_right);
  const double needed_height =
      tag.frame_inner_height + 2 * tag.frame_stroke + 2 * std::abs(tag.frame_offset_up);
  constexpr double kRounding = 1e-9;
  const Place frame = file.find("feature_frame")->place;
  if (needed_length > tag.plate_length + kRounding ||
      needed_height > tag.plate_height + kRounding) {
    file.log().error(frame, "frame-outside-plate",
                     "the feature frame needs a plate of " + format_number(needed_length) + " x " +
                         format_number(needed_height) + " m, the plate is " +
                         format_number(tag.plate_length) + " x " + format_number(tag.plate_height) +
                         " m",
                     "a larger plate, a smaller inner size or a thinner stroke");
  }
  if (bar_height(tag) <= 0) {
    file.log().error(
        file.find("symbol")->place, "no-bars",
        "the bars would be " + format_number(bar_height(tag)) + " m high, expected more than 0",
        "a smaller margin or a higher inner frame");
  }
}

TagTemplate read_tag(const YamlNode& root, FindingLog& log) {
  const MapReader file(&root, "", {"tag", "plate", "feature_frame", "symbol", "label"}, log);
  TagTemplate tag;
  tag.name = read_name(file.need("tag", "tag: NAME"), "tag", log).value_or("");
  const auto plate =
      read_size(file.need("plate", "plate: [length, height] in metres"), "plate", log);
  if (plate) {
    tag.plate_length = plate->width;
    tag.plate_height = plate->height;
  }
  const MapReader frame(
      file.need("feature_frame", "feature_frame: { inner: [0.343, 0.168], stroke: 0.012 }"),
      "feature_frame", {"inner", "stroke", "offset"}, log);
  read_feature_frame(frame, tag);
  const MapReader symbol(file.need("symbol", "symbol: { quiet_zone: 9, margin: 9 }"), "symbol",
                         {"quiet_zone", "margin"}, log);
  read_symbol(symbol, tag);
  read_label(MapReader(file.find("label"), "label", {"shown", "text_height_mm"}, log), tag);
  if (!log.has_errors()) check_dimensions(tag, file);
  return tag;
}

bool holds_data(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "templates", ignored) &&
         fs::is_directory(folder / "surveys", ignored);
}

std::optional<fs::path> file_if_there(const fs::path& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_directory(path, ignored)) return path;
  return std::nullopt;
}

}  // namespace

Result<TemplateReading> read_template(const fs::path& path) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  FindingLog log(path.string());
  TemplateReading reading;
  if (const std::optional<YamlNode> root = parse_yaml(*text, log)) {
    reading.tag = read_tag(*root, log);
  }
  if (log.has_errors()) reading.tag.reset();
  reading.diagnostics = without_allowed(log.sorted(), *text, path.string());
  return reading;
}

std::optional<fs::path> find_template(const std::string& name, const fs::path& survey_folder) {
  if (name.find('/') != std::string::npos || name.ends_with(".yaml")) {
    return file_if_there(survey_folder / name);
  }
  const std::string file = name + ".yaml";
  if (auto found = file_if_there(survey_folder / file)) return found;
  return file_if_there(data_directory() / "templates" / file);
}

fs::path data_directory() {
  if (const char* named = std::getenv("TAGSMITH_DATA"); named != nullptr && *named != '\0') {
    return named;
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (fs::path folder = program.parent_path(); !folder.empty(); folder = folder.parent_path()) {
    for (const fs::path& candidate : {folder, folder / "share/tagsmith"}) {
      if (holds_data(candidate)) return candidate;
    }
    if (folder == folder.root_path()) break;
  }
  return TAGSMITH_SOURCE_FOLDER;
}

}  // namespace tagsmith
