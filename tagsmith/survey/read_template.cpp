// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_template.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <dlfcn.h>
#include <link.h>
#include <system_error>
#include <utility>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/allowances.hpp"
#include "tagsmith/survey/file_kind.hpp"
#include "tagsmith/survey/read_tag_geometry.hpp"
#include "tagsmith/survey/yaml_reader.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tagsmith/tag/printer_dots.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

constexpr double kMillimetre = 1e-3;

void read_label(const MapReader& label, TagTemplate& tag) {
  tag.label.shown =
      read_bool(label.find("shown"), label.name_of("shown"), label.log()).value_or(true);
  tag.label.text_height =
      kMillimetre * label.number_or("text_height_mm", tag.label.text_height / kMillimetre,
                                    above_zero(1000, "mm"));
}

double read_millimetres(const MapReader& map, std::string_view key, double fallback) {
  return kMillimetre * map.number_or(key, fallback / kMillimetre, above_zero(1000, "mm"));
}

// Four holes, so far from the plate's edges.
std::vector<DrillHole> corner_holes(const TagTemplate& tag, double inset, double diameter) {
  const double right = tag.plate_length / 2 - inset;
  const double up = tag.plate_height / 2 - inset;
  return {{-right, up, diameter},
          {right, up, diameter},
          {right, -up, diameter},
          {-right, -up, diameter}};
}

void read_holes(const MapReader& holes, TagTemplate& tag) {
  constexpr std::size_t kMostHoles = 100;
  FindingLog& log = holes.log();
  holes.exclude_each_other({"inset_mm", "at"});
  const auto diameter = holes.number("diameter_mm", above_zero(1000, "mm"));
  if (!diameter) return;
  if (holes.has("inset_mm")) {
    tag.holes = corner_holes(tag, read_millimetres(holes, "inset_mm", 0), kMillimetre * *diameter);
    return;
  }
  const YamlNode* at = holes.need("at", "at: [[right, up], ...] in metres, or inset_mm: 12");
  if (at == nullptr) return;
  const auto* points = read_list(at, holes.name_of("at"), log);
  if (points == nullptr) return;
  if (points->size() > kMostHoles) {
    log.error(at->place, "out-of-range", "more than 100 holes, expected at most 100", "");
    return;
  }
  for (const YamlNode& node : *points) {
    const auto point = read_numbers(&node, holes.name_of("at"), 2,
                                    between(-kLargestPlate, kLargestPlate, "m"), log);
    if (point) tag.holes.push_back({(*point)[0], (*point)[1], kMillimetre * *diameter});
  }
}

void read_cut(const MapReader& cut, TagTemplate& tag) {
  tag.cut.contour =
      read_bool(cut.find("contour"), cut.name_of("contour"), cut.log()).value_or(false);
  tag.cut.corner_radius =
      kMillimetre * cut.number_or("corner_radius_mm", 0, between(0, 1000, "mm"));
}

// True when the disk and the rectangle have a point in common.
bool touches(const HoleOutline& hole, const Rectangle& box) {
  const double right = std::max({box.x - hole.centre.x, hole.centre.x - box.x - box.width, 0.0});
  const double down = std::max({box.y - hole.centre.y, hole.centre.y - box.y - box.height, 0.0});
  return std::hypot(right, down) < hole.radius;
}

bool lies_inside(const HoleOutline& hole, const Rectangle& box) {
  return hole.centre.x - hole.radius >= box.x && hole.centre.y - hole.radius >= box.y &&
         hole.centre.x + hole.radius <= box.x + box.width &&
         hole.centre.y + hole.radius <= box.y + box.height;
}

Rectangle grown(const Rectangle& box, double by) {
  return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by};
}

// Holes belong on the plate, off everything that is printed there.
void check_holes(const TagTemplate& tag, const MapReader& file) {
  constexpr double kRounding = 1e-9;
  const TagDrawing drawing = draw_tag(tag, Digits{});
  const Rectangle plate = grown(drawing.plate, kRounding - kEdgeClearance);
  const Rectangle frame = grown(drawing.frame_outer, label_clearance(tag));
  for (std::size_t i = 0; i < drawing.holes.size(); ++i) {
    const HoleOutline& hole = drawing.holes[i];
    std::string problem;
    if (!lies_inside(hole, plate)) problem = "is less than 3 mm from the plate's edge";
    if (touches(hole, frame)) problem = "lies on the feature frame or too near to it";
    if ((tag.label.shown || drawing.patches) && touches(hole, strip_below_frame(tag))) {
      problem = "lies in the strip of the label, below the feature frame";
    }
    if (problem.empty()) continue;
    file.log().error(file.find("holes")->place, "hole-misplaced",
                     "hole " + std::to_string(i + 1) + ", " +
                         format_number(tag.holes[i].right * 1e3) + " mm right of the plate's " +
                         "middle and " + format_number(tag.holes[i].up * 1e3) + " mm up, " +
                         problem,
                     "holes go between the feature frame and the plate's edge");
  }
}

// What is drawn beside frame and symbol has its place.
void check_extras(const TagTemplate& tag, const MapReader& file) {
  const double least_side = std::min(tag.plate_length, tag.plate_height);
  if (tag.cut.corner_radius > least_side / 2) {
    file.log().error(file.find("cut")->place, "corner-radius",
                     "corners of " + format_number(tag.cut.corner_radius * 1e3) +
                         " mm radius, expected at most half the plate's shorter side",
                     "");
  }
  if (tag.patch_size > 0 && !draw_tag(tag, Digits{}).patches) {
    const double room = std::max(strip_below_frame(tag).height, 0.0);
    file.log().error(file.find("patches")->place, "no-room-for-patches",
                     "the reference patches need " + format_number(tag.patch_size * 1e3) +
                         " mm below the feature frame, there are " + format_number(room * 1e3, 1),
                     "smaller patches, or feature_frame.offset that moves the frame up");
  }
  check_holes(tag, file);
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
  check_symbol(tag, file);
}

TagTemplate read_tag(const YamlNode& root, FindingLog& log) {
  const MapReader file(&root, "",
                       {"tag", "plate", "feature_frame", "symbol", "label", "holes", "patches",
                        "cut", "material", "white_on_black"},
                       log);
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
                         {"quiet_zone", "margin", "dots_per_inch"}, log);
  read_symbol(symbol, tag);
  read_label(MapReader(file.find("label"), "label", {"shown", "text_height_mm"}, log), tag);
  if (file.has("holes")) {
    read_holes(MapReader(file.find("holes"), "holes", {"diameter_mm", "inset_mm", "at"}, log), tag);
  }
  if (file.has("patches")) {
    const MapReader patches(file.find("patches"), "patches", {"size_mm"}, log);
    tag.patch_size = kMillimetre * patches.number("size_mm", above_zero(1000, "mm")).value_or(0);
  }
  read_cut(MapReader(file.find("cut"), "cut", {"contour", "corner_radius_mm"}, log), tag);
  tag.white_on_black =
      read_bool(file.find("white_on_black"), "white_on_black", log).value_or(false);
  tag.material = read_text(file.find("material"), "material", log).value_or("");
  if (!log.has_errors()) check_dimensions(tag, file);
  if (!log.has_errors()) check_extras(tag, file);
  return tag.dots_per_inch > 0 && !log.has_errors() ? fitted_to_dots(tag, tag.dots_per_inch) : tag;
}

bool holds_data(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "templates", ignored) &&
         fs::is_directory(folder / "surveys", ignored);
}

// The program, or the shared library, that this code is part of.
fs::path own_file() {
  Dl_info info{};
  void* found = nullptr;
  const void* here = reinterpret_cast<const void*>(&holds_data);
  std::error_code error;
  if (dladdr1(here, &info, &found, RTLD_DL_LINKMAP) != 0 && found != nullptr) {
    // The program itself has no name there.
    const fs::path library = static_cast<const link_map*>(found)->l_name;
    if (!library.empty()) return fs::canonical(library, error);
  }
  return fs::read_symlink("/proc/self/exe", error);
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
  const std::optional<YamlNode> root = parse_yaml(*text, log);
  if (root && !is_other_kind(*root, "tag", log)) {
    reading.tag = read_tag(*root, log);
    if (reading.tag) reading.tag->file = path;
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

std::string own_templates() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(data_directory() / "templates", error)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

fs::path data_directory() {
  if (const char* named = std::getenv("TAGSMITH_DATA"); named != nullptr && *named != '\0') {
    return named;
  }
  for (fs::path folder = own_file().parent_path(); !folder.empty(); folder = folder.parent_path()) {
    for (const fs::path& candidate : {folder, folder / "share/tagsmith"}) {
      if (holds_data(candidate)) return candidate;
    }
    if (folder == folder.root_path()) break;
  }
  // Where the system does not tell the program's file, or the build lies outside the sources.
  return holds_data(TAGSMITH_INSTALLED_DATA) ? TAGSMITH_INSTALLED_DATA : TAGSMITH_SOURCE_FOLDER;
}

}  // namespace tagsmith::detail
