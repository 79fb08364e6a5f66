// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_template.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <dlfcn.h>
#include <link.h>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/yaml_file.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tagsmith/tag/label_fields.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {

// ---- Feature frame and symbol.

namespace {

constexpr double kLargestPlate = 10.0;  // metres
constexpr double kMostModules = 1000.0;
// Modules: with less space between bars and frame tags are not read as plans say, and bars lower
// than this are not read reliably at any width of the modules (`./dev bench limits symbols`,
// docs/accuracy.md).
constexpr double kLeastMargin = 3;
constexpr double kLeastBars = 6;
constexpr int kLeastDotsPerInch = 50;
constexpr int kMostDotsPerInch = 10'000;

}  // namespace

void read_feature_frame(const MapReader& frame, TagTemplate& tag) {
  const auto inner = read_numbers(frame.need("inner", "inner: [length, height] in metres"), 2,
                                  above_zero(kLargestPlate, "m"));
  if (inner) {
    tag.frame_inner_length = (*inner)[0];
    tag.frame_inner_height = (*inner)[1];
  }
  tag.frame_stroke = frame.number("stroke", above_zero(1, "m")).value_or(0);
  const auto offset =
      read_numbers(frame.at("offset"), 2, between(-kLargestPlate, kLargestPlate, "m"));
  if (offset) {
    tag.frame_offset_right = (*offset)[0];
    tag.frame_offset_up = (*offset)[1];
  }
}

void read_symbol(const MapReader& symbol, TagTemplate& tag) {
  // At most as wide as the symbol itself: then a module is a third of what the frame has room for.
  tag.quiet_zone_modules =
      symbol.number("quiet_zone", between(kQuietZoneModules, kModuleCount, "modules"))
          .value_or(tag.quiet_zone_modules);
  tag.margin_modules =
      symbol.number("margin", between(0, kMostModules, "modules")).value_or(tag.margin_modules);
  tag.dots_per_inch =
      read_integer(symbol.at("dots_per_inch"), kLeastDotsPerInch, kMostDotsPerInch).value_or(0);
}

void check_symbol(const TagTemplate& tag, const MapReader& file) {
  constexpr double kRounding = 1e-6;  // of lengths written in decimals
  const YamlValue symbol = file.at("symbol");
  const double least_bars = kLeastBars * module_width(tag);
  if (bar_height(tag) < (1 - kRounding) * least_bars) {
    symbol.error("no-bars",
                 fmt::format("the bars would be {} mm high, expected at least {} modules, {} mm",
                             format_number(bar_height(tag) * 1e3, 1), kLeastBars,
                             format_number(least_bars * 1e3, 1)),
                 "a smaller margin or a higher inner frame");
  }
  if (tag.margin_modules < kLeastMargin) {
    symbol.warning("narrow-margin",
                   fmt::format("the bars' margin is {} modules, expected at least {}",
                               format_number(tag.margin_modules), format_number(kLeastMargin)),
                   "bars so near the frame are read at shorter range than plans say, with worse "
                   "corners");
  }
  if (tag.frame_stroke < (1 - kRounding) * module_width(tag)) {
    // Plates that hang may have it: they are read at short range, and plans reckon with that.
    file.at("feature_frame")
        .warning("thin-stroke",
                 fmt::format("the feature frame's stroke is {} mm, expected at least a module, {} "
                             "mm",
                             mm_text(tag.frame_stroke), mm_text(module_width(tag))),
                 "strokes are given in metres; the shipped templates have 3 to 4 modules");
  }
  if (tag.dots_per_inch > 0 &&
      module_width(tag) < (1 - kRounding) * kMetresPerInch / tag.dots_per_inch) {
    symbol.error("no-dots",
                 "a module is narrower than one dot of " + std::to_string(tag.dots_per_inch) +
                     " dots per inch",
                 "a longer inner frame or a finer printer");
  }
}

// ---- The parts beside feature frame and symbol.

namespace {

namespace fs = std::filesystem;

double read_millimetres(const MapReader& map, std::string_view key, double fallback,
                        const NumberRange& range = above_zero(1000, "mm")) {
  return kMillimetre * map.number_or(key, fallback / kMillimetre, range);
}

// Text of which every field is known.
std::optional<std::string> read_fields(const YamlValue& value) {
  std::optional<std::string> text = read_text(value);
  const std::optional<std::string> unknown = text ? unknown_field(*text) : std::nullopt;
  if (!unknown) return text;
  std::string known;
  for (const std::string_view field : kLabelFields) known += fmt::format(" {{{}}}", field);
  return value.error("unknown-field", value.name + " has " + *unknown + ", which is no field",
                     "the fields are" + known);
}

void read_label(const MapReader& label, TagTemplate& tag) {
  constexpr std::size_t kMostLines = 6;
  tag.label.shown = read_bool(label.at("shown")).value_or(true);
  // Nobody reads capital letters lower than a millimetre.
  tag.label.text_height =
      read_millimetres(label, "text_height_mm", tag.label.text_height, between(1, 1000, "mm"));
  tag.label.left = read_text(label.at("left")).value_or(tag.label.left);
  tag.label.right = read_text(label.at("right")).value_or(tag.label.right);
  const YamlValue value = label.at("lines");
  const auto lines = read_list(value);
  if (!lines) return;
  if (lines->empty() || lines->size() > kMostLines) {
    value.error(
        "out-of-range",
        fmt::format("label.lines has {} lines, expected 1 to {}", lines->size(), kMostLines),
        lines->empty() ? "label: { shown: false } for plates without a label" : "");
  }
  for (const YamlValue& line : *lines) {
    if (auto text = read_fields({line.node, value.name, value.log})) {
      tag.label.lines.push_back(std::move(*text));
    }
  }
}

void read_logo(const MapReader& logo, const fs::path& template_folder, TagTemplate& tag) {
  const YamlValue file = logo.need("file", "file: logo.svg, beside the template");
  const auto name = read_text(file);
  const auto sides =
      read_numbers(logo.need("size_mm", "size_mm: [width, height]"), 2, above_zero(1000, "mm"));
  if (!name || !sides) return;
  tag.logo = {template_folder / *name, kMillimetre * (*sides)[0], kMillimetre * (*sides)[1]};
  std::error_code ignored;
  if (fs::is_regular_file(tag.logo.file, ignored)) return;
  // Only print needs it.
  file.warning("no-logo", "there is no file " + tag.logo.file.string(),
               "an SVG file; its name is relative to the template's folder");
}

void read_qr(const MapReader& qr, TagTemplate& tag) {
  tag.qr.size = kMillimetre * qr.number("size_mm", above_zero(1000, "mm")).value_or(0);
  tag.qr.content = read_fields(qr.at("content")).value_or(tag.qr.content);
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
  holes.exclude_each_other({"inset_mm", "at"});
  const auto diameter = holes.number("diameter_mm", above_zero(1000, "mm"));
  if (!diameter) return;
  if (holes.has("inset_mm")) {
    tag.holes = corner_holes(tag, read_millimetres(holes, "inset_mm", 0), kMillimetre * *diameter);
    return;
  }
  const YamlValue at = holes.need("at", "at: [[right, up], ...] in metres, or inset_mm: 12");
  const auto points = read_list(at);
  if (!points) return;
  if (points->size() > kMostHoles) {
    at.error("out-of-range", "more than 100 holes, expected at most 100");
    return;
  }
  for (const YamlValue& each : *points) {
    const auto point =
        read_numbers({each.node, at.name, at.log}, 2, between(-kLargestPlate, kLargestPlate, "m"));
    if (point) tag.holes.push_back({(*point)[0], (*point)[1], kMillimetre * *diameter});
  }
}

void read_cut(const MapReader& cut, TagTemplate& tag) {
  tag.cut.contour = read_bool(cut.at("contour")).value_or(false);
  tag.cut.corner_radius = read_millimetres(cut, "corner_radius_mm", 0, between(0, 1000, "mm"));
}

// How far inside the plate's edge a point lies; negative outside. The plate's corners are rounded.
double inside_edge(const TagDrawing& drawing, const PlatePoint& at) {
  const Rectangle& plate = drawing.plate;
  const double radius = drawing.corner_radius;
  const double right = std::abs(at.x - plate.x - plate.width / 2) - plate.width / 2 + radius;
  const double down = std::abs(at.y - plate.y - plate.height / 2) - plate.height / 2 + radius;
  return radius - std::hypot(std::max(right, 0.0), std::max(down, 0.0)) -
         std::min(std::max(right, down), 0.0);
}

Rectangle grown(const Rectangle& box, double by) {
  return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by};
}

// Holes belong on the plate, off everything that is printed there.
void check_holes(const TagTemplate& tag, const TagDrawing& drawing, const MapReader& file) {
  constexpr double kRounding = 1e-9;
  const Rectangle frame = grown(drawing.frame_outer, label_clearance(tag));
  for (std::size_t i = 0; i < drawing.holes.size(); ++i) {
    const HoleOutline& hole = drawing.holes[i];
    std::string problem;
    if (inside_edge(drawing, hole.centre) - hole.radius < kEdgeClearance - kRounding) {
      problem = "is less than 3 mm from the plate's edge";
    }
    if (touches(hole, frame)) problem = "lies on the feature frame or too near to it";
    const bool strip_is_used = tag.label.shown || drawing.patches || drawing.qr || drawing.logo;
    if (strip_is_used && touches(hole, strip_below_frame(tag))) {
      problem = "lies in the strip of the label, below the feature frame";
    }
    if (problem.empty()) continue;
    file.at("holes").error(
        "hole-misplaced",
        fmt::format("hole {}, {} mm right of the plate's middle and {} mm up, {}", i + 1,
                    mm_text(tag.holes[i].right, 6), mm_text(tag.holes[i].up, 6), problem),
        "holes go between the feature frame and the plate's edge");
  }
}

// Each of the parts beside the label has its room in the strip below the feature frame.
void check_strip(const TagTemplate& tag, const TagDrawing& drawing, const MapReader& file) {
  const Rectangle strip = strip_below_frame(tag);
  const auto check = [&](const char* key, const char* rule, const char* what, bool stands,
                         double width, double height) {
    if (!file.has(key) || stands) return;
    file.at(key).error(
        rule,
        fmt::format("{} of {} x {} mm: the strip below the feature frame is {} mm high, and each "
                    "part beside the label may take half of its free length",
                    what, mm_text(width, 1), mm_text(height, 1),
                    mm_text(std::max(strip.height, 0.0), 1)),
        fmt::format("a smaller {}, or feature_frame.offset that moves the frame up", key));
  };
  check("patches", "no-room-for-patches", "the reference patches", drawing.patches.has_value(),
        2 * tag.patch_size, tag.patch_size);
  check("qr", "no-room-for-qr", "the QR symbol", drawing.qr.has_value(), tag.qr.size, tag.qr.size);
  check("logo", "no-room-for-logo", "the logo", drawing.logo.has_value(), tag.logo.width,
        tag.logo.height);
}

// Label, holes, patches, logo, QR symbol and cut; the logo's file is sought in the folder.
void read_plate_parts(const MapReader& file, const fs::path& template_folder, TagTemplate& tag) {
  read_label({file.at("label"), {"shown", "text_height_mm", "lines", "left", "right"}}, tag);
  read_holes({file.at("holes"), {"diameter_mm", "inset_mm", "at"}}, tag);
  const MapReader patches(file.at("patches"), {"size_mm"});
  tag.patch_size = kMillimetre * patches.number("size_mm", above_zero(1000, "mm")).value_or(0);
  read_logo({file.at("logo"), {"file", "size_mm"}}, template_folder, tag);
  read_qr({file.at("qr"), {"size_mm", "content"}}, tag);
  read_cut({file.at("cut"), {"contour", "corner_radius_mm"}}, tag);
}

// The plate's rounded corners leave the feature frame whole.
void check_corners(const TagTemplate& tag, const TagDrawing& drawing, const MapReader& file) {
  constexpr double kRounding = 1e-9;
  const Rectangle& frame = drawing.frame_outer;
  double least = 0;
  for (const double x : {frame.x, frame.x + frame.width}) {
    for (const double y : {frame.y, frame.y + frame.height}) {
      least = std::min(least, inside_edge(drawing, {x, y}));
    }
  }
  if (least >= -kRounding) return;
  file.at("cut").error(
      "corner-radius",
      fmt::format("corners of {} mm radius cut {} mm off the corners of the feature frame",
                  mm_text(tag.cut.corner_radius, 6), mm_text(-least, 1)),
      "a smaller radius, or a larger plate");
}

// Everything on the plate has its place there.
void check_plate_parts(const TagTemplate& tag, const MapReader& file) {
  const double least_side = std::min(tag.plate_length, tag.plate_height);
  if (tag.cut.corner_radius > least_side / 2) {
    file.at("cut").error("corner-radius",
                         "corners of " + mm_text(tag.cut.corner_radius, 6) +
                             " mm radius, expected at most half the plate's shorter side");
  }
  const TagDrawing drawing = draw_tag(tag, Digits{});
  check_corners(tag, drawing, file);
  check_strip(tag, drawing, file);
  check_holes(tag, drawing, file);
}

// ---- The file.

void check_dimensions(const TagTemplate& tag, const MapReader& file) {
  const double needed_length =
      tag.frame_inner_length + 2 * tag.frame_stroke + 2 * std::abs(tag.frame_offset_right);
  const double needed_height =
      tag.frame_inner_height + 2 * tag.frame_stroke + 2 * std::abs(tag.frame_offset_up);
  constexpr double kRounding = 1e-9;
  if (needed_length > tag.plate_length + kRounding ||
      needed_height > tag.plate_height + kRounding) {
    file.at("feature_frame")
        .error("frame-outside-plate",
               fmt::format("the feature frame needs a plate of {} x {} m, the plate is {} x {} m",
                           format_number(needed_length), format_number(needed_height),
                           format_number(tag.plate_length), format_number(tag.plate_height)),
               "a larger plate, a smaller inner size or a thinner stroke");
  }
  check_symbol(tag, file);
}

TagTemplate read_template_tree(const YamlValue& root, const fs::path& path) {
  const FindingLog& log = *root.log;
  const MapReader file(root, {"tag", "plate", "feature_frame", "symbol", "label", "holes",
                              "patches", "logo", "qr", "cut", "material", "white_on_black"});
  TagTemplate tag;
  tag.file = path;
  tag.name = read_name(file.need("tag", "tag: NAME")).value_or("");
  const auto plate = read_numbers(file.need("plate", "plate: [length, height] in metres"), 2,
                                  above_zero(kLargestPlate, "m"));
  if (plate) {
    tag.plate_length = (*plate)[0];
    tag.plate_height = (*plate)[1];
  }
  read_feature_frame(
      {file.need("feature_frame", "feature_frame: { inner: [0.343, 0.168], stroke: 0.012 }"),
       {"inner", "stroke", "offset"}},
      tag);
  read_symbol({file.need("symbol", "symbol: { quiet_zone: 9, margin: 9 }"),
               {"quiet_zone", "margin", "dots_per_inch"}},
              tag);
  read_plate_parts(file, path.parent_path(), tag);
  tag.white_on_black = read_bool(file.at("white_on_black")).value_or(false);
  tag.material = read_text(file.at("material")).value_or("");
  if (!log.has_errors()) check_dimensions(tag, file);
  if (!log.has_errors()) check_plate_parts(tag, file);
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

Result<Diagnosed<TagTemplate>> read_template(const fs::path& path) {
  return read_yaml_file<TagTemplate>(
      path, "tag", [&](const YamlValue& root) { return read_template_tree(root, path); });
}

Result<TagTemplate> load_template(const fs::path& path) {
  return value_without_errors(read_template(path));
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
  return fmt::format("{}", fmt::join(names, ", "));
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
  // Where the system does not give the program's file, or the build lies outside the sources.
  return holds_data(TAGSMITH_INSTALLED_DATA) ? TAGSMITH_INSTALLED_DATA : TAGSMITH_SOURCE_FOLDER;
}

}  // namespace tagsmith::detail
