// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/run.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/limits.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/table_row.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestField = 4096;

using Columns = std::vector<std::string>;

bool has_column(const Columns& columns, const std::string& name) {
  return std::ranges::count(columns, name) > 0;
}

std::vector<std::string> known_columns(const Rig& rig) {
  std::vector<std::string> known = {"id", "time", "truth_x", "truth_y", "truth_z", "truth_heading"};
  for (const RigCamera& camera : rig.cameras) {
    for (const char* suffix : {"", "_tag", "_distance"}) known.push_back(camera.name + suffix);
  }
  for (const RigRange& range : rig.ranges) known.push_back(range.name);
  return known;
}

void check_known(const Columns& columns, const Rig& rig, int line, FindingLog& log) {
  const std::vector<std::string> known = known_columns(rig);
  std::set<std::string> seen;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& name = columns[i];
    const Place place{line, static_cast<int>(i) + 1};
    if (std::ranges::count(known, name) == 0) {
      const auto near = nearest_word(name, known);
      const bool other_separator = name.find_first_of(";\t") != std::string::npos;
      log.error(place, "unknown-column", "unknown column `" + name.substr(0, 60) + "`",
                other_separator ? "separate the columns by commas"
                : near          ? "did you mean `" + *near + "`?"
                                : "the rig " + rig.name + " has no camera or range of this name");
    } else if (!seen.insert(name).second) {
      log.error(place, "duplicate-column", "the column `" + name + "` a second time");
    }
  }
}

void check_complete(const Columns& columns, const Rig& rig, int line, FindingLog& log) {
  const auto need = [&](const std::string& name, const std::string& why) {
    if (has_column(columns, name)) return;
    log.error({line, 0}, "missing-column", "the column `" + name + "` is missing" + why);
  };
  need("id", "");
  bool observes = false;
  for (const RigCamera& camera : rig.cameras) {
    const std::string tag = camera.name + "_tag";
    const std::string distance = camera.name + "_distance";
    if (has_column(columns, tag)) need(distance, ", expected with `" + tag + "`");
    if (has_column(columns, distance)) need(tag, ", expected with `" + distance + "`");
    observes = observes || has_column(columns, camera.name) || has_column(columns, tag);
  }
  if (!observes && !has_column(columns, "truth_x")) {
    log.error({line, 0}, "missing-column",
              "no column of a camera, expected one named after a camera of the rig " + rig.name);
  }
  const std::array<std::string, 3> truth = {"truth_x", "truth_y", "truth_z"};
  if (std::ranges::any_of(truth, [&](const auto& name) { return has_column(columns, name); })) {
    for (const std::string& name : truth) need(name, ", expected truth_x, truth_y and truth_z");
  }
}

// The number in the column; nothing when there is none, and where it is faulty, which is logged.
std::optional<double> number_in(const TableRow& row, const std::string& column, double low,
                                double high) {
  const std::string& field = row.text(column);
  if (field.empty()) return std::nullopt;
  const std::optional<double> value = parse_number(field);
  if (!value) {
    return row.error(column, "wrong-type",
                     column + " is `" + field.substr(0, 60) + "`, expected a finite number",
                     field.find(',') != std::string::npos ? "the decimal sign is a point" : "");
  }
  if (*value >= low && *value <= high) return value;
  return row.error(column, "out-of-range",
                   column + " is " + field.substr(0, 60) + ", expected " + format_number(low) +
                       " to " + format_number(high));
}

CameraMeasurement read_camera(const TableRow& row, const std::string& name,
                              const fs::path& folder) {
  CameraMeasurement measured;
  const std::string& image = row.text(name);
  if (!image.empty()) measured.image = folder / image;
  const std::string& tag = row.text(name + "_tag");
  if (!tag.empty()) measured.tag = tag;
  constexpr double kShortest = 1e-3;
  constexpr double kLongest = 1e4;
  measured.distance = number_in(row, name + "_distance", kShortest, kLongest);
  if (measured.tag && row.text(name + "_distance").empty()) {
    row.error(name + "_distance", "missing-value", "a tag without its distance");
  }
  if (measured.distance && !measured.tag) {
    row.error(name + "_tag", "missing-value", "a distance without its tag");
  }
  return measured;
}

void read_truth(const TableRow& row, Measurement& measurement) {
  const auto x = number_in(row, "truth_x", -kFarthest, kFarthest);
  const auto y = number_in(row, "truth_y", -kFarthest, kFarthest);
  const auto z = number_in(row, "truth_z", -kFarthest, kFarthest);
  if (x && y && z) measurement.truth_in_grid = Eigen::Vector3d(*x, *y, *z);
  const auto is_given = [&](const char* column) { return !row.text(column).empty(); };
  const auto given = std::ranges::count_if(std::array{"truth_x", "truth_y", "truth_z"}, is_given);
  if (given == 1 || given == 2) {
    row.error("truth_x", "missing-value",
              "truth_x, truth_y, truth_z in part, expected all or none");
  }
  const auto heading = number_in(row, "truth_heading", -360, 360);
  if (heading) measurement.truth_heading = radians(*heading);
}

Measurement read_measurement(const TableRow& row, const Rig& rig, const fs::path& folder) {
  Measurement measurement;
  measurement.id = row.text("id");
  measurement.line = row.line();
  if (measurement.id.empty()) row.error("id", "missing-value", "the id is empty");
  std::map<fs::path, std::string> cameras;  // by photo
  for (const RigCamera& camera : rig.cameras) {
    CameraMeasurement measured = read_camera(row, camera.name, folder);
    const auto [other, is_new] = cameras.emplace(measured.image, camera.name);
    if (!is_new && !measured.image.empty()) {
      row.error(camera.name, "duplicate-photo",
                "the photo of " + camera.name + " is that of " + other->second,
                "name the photo that each camera took");
    }
    if (!measured.image.empty() || measured.tag) {
      measurement.cameras.emplace(camera.name, std::move(measured));
    }
  }
  constexpr double kLongestRange = 1e4;
  for (const RigRange& range : rig.ranges) {
    const auto value = number_in(row, range.name, 0, kLongestRange);
    if (value) measurement.ranges.emplace(range.name, *value);
  }
  read_truth(row, measurement);
  measurement.time = number_in(row, "time", -1e12, 1e12);
  return measurement;
}

// The fields of a line; nothing for a faulty one, which is logged.
std::optional<std::vector<std::string>> read_fields(std::string_view line, int number,
                                                    FindingLog& log) {
  auto fields = split_csv(line);
  if (!fields) {
    return log.error({number, 0}, "bad-quotes", "a quote that is not closed or inside a field",
                     "put the whole field into quotes and double the quotes inside it");
  }
  for (const std::string& field : *fields) {
    if (field.size() <= kLongestField && is_plain_text(field)) continue;
    return log.error({number, 0}, "bad-text", "a field that is no text or too long",
                     field.find('\t') != std::string::npos ? "separate the columns by commas"
                     : field.find('\r') != std::string::npos
                         ? "end lines with LF or CR LF"
                         : "save the table as CSV with UTF-8 text");
  }
  return fields;
}

std::vector<Measurement> read_rows(std::string_view text, const fs::path& path, const Rig& rig,
                                   FindingLog& log) {
  std::vector<Measurement> measurements;
  std::optional<Columns> columns;  // of the first line
  std::map<std::string, int> ids;
  for_each_line(text, [&](int number, std::string_view line) {
    auto fields = read_fields(line, number, log);
    if (!fields) return true;
    if (!columns) {
      columns = *fields;
      check_known(*columns, rig, number, log);
      check_complete(*columns, rig, number, log);
      return !log.has_errors();
    }
    if (fields->size() != columns->size()) {
      log.error({number, 0}, "wrong-length",
                std::to_string(fields->size()) + " fields, expected " +
                    std::to_string(columns->size()) + " as in the first line",
                "a decimal comma splits a field; leave absent values empty");
      return true;
    }
    Measurement measurement = read_measurement(TableRow(*columns, std::move(*fields), number, log),
                                               rig, path.parent_path());
    const auto [first, is_new] = ids.emplace(measurement.id, number);
    if (!is_new) {
      log.error({number, 0}, "duplicate-id",
                "the id `" + measurement.id.substr(0, 60) +
                    "` a second time, the first is on line " + std::to_string(first->second));
    }
    measurements.push_back(std::move(measurement));
    return true;
  });
  if (!columns && !log.has_errors())
    log.error({1, 0}, "empty-file", "the file is empty, expected a line of column names");
  if (columns && measurements.empty() && !log.has_errors())
    log.error({}, "empty-file", "no rows after the column names");
  return measurements;
}

}  // namespace

Result<Run> load_run(const fs::path& path, const Rig& rig) {
  const Result<std::string> text = read_file(path);
  if (!text) return fail(text);
  FindingLog log(path.string());
  Run run;
  run.file = path;
  run.measurements = read_rows(*text, path, rig, log);
  if (log.has_errors()) return fail(to_string(log.sorted(), true));
  return run;
}

std::vector<std::filesystem::path> photos_of(const std::vector<Measurement>& measurements) {
  std::vector<std::filesystem::path> photos;
  for (const Measurement& measurement : measurements) {
    for (const auto& [name, seen] : measurement.cameras) {
      if (!seen.image.empty()) photos.push_back(seen.image);
    }
  }
  return photos;
}

Result<SurveyedRun> load_surveyed_run(const std::filesystem::path& survey,
                                      const std::filesystem::path& rig,
                                      const std::filesystem::path& run) {
  Result<Survey> surveyed = load_survey(survey);
  if (!surveyed) return fail(surveyed);
  Result<Rig> driven = load_rig(rig);
  if (!driven) return fail(driven);
  return load_run(run, *driven).map([&](Run rows) {
    return SurveyedRun{std::move(*surveyed), std::move(*driven), std::move(rows)};
  });
}

}  // namespace tagsmith::detail
