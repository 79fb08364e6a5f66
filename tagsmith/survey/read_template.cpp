// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/read_template.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <dlfcn.h>
#include <link.h>
#include <system_error>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/survey/read_plate_parts.hpp"
#include "tagsmith/survey/read_tag_geometry.hpp"
#include "tagsmith/survey/yaml_file.hpp"
#include "tagsmith/survey/yaml_reader.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

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

TagTemplate read_tag(const YamlNode& root, const fs::path& path, FindingLog& log) {
  const MapReader file(&root, "",
                       {"tag", "plate", "feature_frame", "symbol", "label", "holes", "patches",
                        "logo", "qr", "cut", "material", "white_on_black"},
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
  read_plate_parts(file, path.parent_path(), tag);
  tag.white_on_black =
      read_bool(file.find("white_on_black"), "white_on_black", log).value_or(false);
  tag.material = read_text(file.find("material"), "material", log).value_or("");
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
  const auto read_root = [&](const YamlNode& root, FindingLog& log) {
    TagTemplate tag = read_tag(root, path, log);
    tag.file = path;
    return tag;
  };
  return read_file(path).map([&](const std::string& text) {
    return read_yaml_file<TagTemplate>(path, text, "tag", read_root);
  });
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
