// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/run.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/limits.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestField = 4096;

// The columns of a run file by name; npos = not there.
class Columns {
 public:
  explicit Columns(std::vector<std::string> names) : names_(std::move(names)) {}

  std::size_t size() const { return names_.size(); }
  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const { return std::ranges::count(names_, name) > 0; }

  std::optional<std::size_t> find(const std::string& name) const {
    const auto found = std::ranges::find(names_, name);
    if (found == names_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names_.begin());
  }

 private:
  std::vector<std::string> names_;
};

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
    const std::string& name = columns.names()[i];
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
    if (columns.has(name)) return;
    log.error({line, 0}, "missing-column", "the column `" + name + "` is missing" + why);
  };
  need("id", "");
  bool observes = false;
  for (const RigCamera& camera : rig.cameras) {
    const std::string tag = camera.name + "_tag";
    const std::string distance = camera.name + "_distance";
    if (columns.has(tag)) need(distance, ", expected with `" + tag + "`");
    if (columns.has(distance)) need(tag, ", expected with `" + distance + "`");
    observes = observes || columns.has(camera.name) || columns.has(tag);
  }
  if (!observes && !columns.has("truth_x")) {
    log.error({line, 0}, "missing-column",
              "no column of a camera, expected one named after a camera of the rig " + rig.name);
  }
  const std::array<std::string, 3> truth = {"truth_x", "truth_y", "truth_z"};
  if (std::ranges::any_of(truth, [&](const auto& name) { return columns.has(name); })) {
    for (const std::string& name : truth) need(name, ", expected truth_x, truth_y and truth_z");
  }
}

// One row and its place, for typed access by column name.
class Row {
 public:
  Row(const Columns& columns, const std::vector<std::string>& fields, int line, FindingLog& log)
      : columns_(columns), fields_(fields), line_(line), log_(log) {}

  // The field; empty when the column does not exist.
  std::string text(const std::string& column) const {
    const auto index = columns_.find(column);
    return index ? fields_[*index] : std::string();
  }

  std::optional<double> number(const std::string& column, double low, double high) const {
    const std::string field = text(column);
    if (field.empty()) return std::nullopt;
    const std::optional<double> value = parse_number(field);
    if (!value) {
      std::string point = field;
      std::ranges::replace(point, ',', '.');
      error(column, "wrong-type",
            column + " is `" + field.substr(0, 60) + "`, expected a finite number",
            field != point ? "the decimal sign is a point" : "");
      return std::nullopt;
    }
    if (*value >= low && *value <= high) return value;
    error(column, "out-of-range",
          column + " is " + field.substr(0, 60) + ", expected " + format_number(low) + " to " +
              format_number(high));
    return std::nullopt;
  }

  void error(const std::string& column, std::string code, std::string message,
             std::string hint = {}) const {
    const auto index = columns_.find(column);
    log_.error({line_, index ? static_cast<int>(*index) + 1 : 0}, std::move(code),
               std::move(message), std::move(hint));
  }

 private:
  const Columns& columns_;
  const std::vector<std::string>& fields_;
  int line_;
  FindingLog& log_;
};

CameraMeasurement read_camera(const Row& row, const std::string& name, const fs::path& folder) {
  CameraMeasurement measured;
  const std::string image = row.text(name);
  if (!image.empty()) measured.image = folder / image;
  const std::string tag = row.text(name + "_tag");
  if (!tag.empty()) measured.tag = tag;
  constexpr double kShortest = 1e-3;
  constexpr double kLongest = 1e4;
  measured.distance = row.number(name + "_distance", kShortest, kLongest);
  if (measured.tag && row.text(name + "_distance").empty()) {
    row.error(name + "_distance", "missing-value", "a tag without its distance");
  }
  if (measured.distance && !measured.tag) {
    row.error(name + "_tag", "missing-value", "a distance without its tag");
  }
  return measured;
}

void read_truth(const Row& row, Measurement& measurement) {
  const auto x = row.number("truth_x", -kFarthest, kFarthest);
  const auto y = row.number("truth_y", -kFarthest, kFarthest);
  const auto z = row.number("truth_z", -kFarthest, kFarthest);
  if (x && y && z) measurement.truth_in_grid = Eigen::Vector3d(*x, *y, *z);
  const bool some = !(row.text("truth_x") + row.text("truth_y") + row.text("truth_z")).empty();
  const bool all =
      !row.text("truth_x").empty() && !row.text("truth_y").empty() && !row.text("truth_z").empty();
  if (some && !all) {
    row.error("truth_x", "missing-value",
              "truth_x, truth_y, truth_z in part, expected all or none");
  }
  const auto heading = row.number("truth_heading", -360, 360);
  if (heading) measurement.truth_heading = radians(*heading);
}

Measurement read_measurement(const Row& row, int line, const Rig& rig, const fs::path& folder) {
  Measurement measurement;
  measurement.id = row.text("id");
  measurement.line = line;
  if (measurement.id.empty()) row.error("id", "missing-value", "the id is empty");
  for (const RigCamera& camera : rig.cameras) {
    CameraMeasurement measured = read_camera(row, camera.name, folder);
    if (!measured.image.empty() || measured.tag) {
      measurement.cameras.emplace(camera.name, std::move(measured));
    }
  }
  constexpr double kLongestRange = 1e4;
  for (const RigRange& range : rig.ranges) {
    const auto value = row.number(range.name, 0, kLongestRange);
    if (value) measurement.ranges.emplace(range.name, *value);
  }
  read_truth(row, measurement);
  measurement.time = row.number("time", -1e12, 1e12);
  return measurement;
}

// The fields of a line that has some; nothing for an empty line and for a faulty one, which is
// logged.
std::optional<std::vector<std::string>> read_line(std::string_view line, int number,
                                                  FindingLog& log) {
  if (trim(line).empty()) return std::nullopt;
  auto fields = split_csv(line);
  if (!fields) {
    log.error({number, 0}, "bad-quotes", "a quote that is not closed or inside a field",
              "put the whole field into quotes and double the quotes inside it");
    return std::nullopt;
  }
  for (const std::string& field : *fields) {
    if (field.size() <= kLongestField && is_plain_text(field)) continue;
    log.error({number, 0}, "bad-text", "a field that is no text or too long",
              field.find('\t') != std::string::npos   ? "separate the columns by commas"
              : field.find('\r') != std::string::npos ? "end lines with LF or CR LF"
                                                      : "save the table as CSV with UTF-8 text");
    return std::nullopt;
  }
  return fields;
}

std::vector<Measurement> read_rows(std::string_view text, const fs::path& path, const Rig& rig,
                                   FindingLog& log) {
  std::vector<Measurement> measurements;
  std::optional<Columns> columns;
  std::map<std::string, int> ids;
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto fields = read_line(line, ++number, log);
    if (!fields) continue;
    if (!columns) {
      columns.emplace(*fields);
      check_known(*columns, rig, number, log);
      check_complete(*columns, rig, number, log);
      if (log.has_errors()) return {};
      continue;
    }
    if (fields->size() != columns->size()) {
      log.error({number, 0}, "wrong-length",
                std::to_string(fields->size()) + " fields, expected " +
                    std::to_string(columns->size()) + " as in the first line",
                "a decimal comma splits a field; leave absent values empty");
      continue;
    }
    Measurement measurement =
        read_measurement(Row(*columns, *fields, number, log), number, rig, path.parent_path());
    const auto [first, is_new] = ids.emplace(measurement.id, number);
    if (!is_new) {
      log.error({number, 0}, "duplicate-id",
                "the id `" + measurement.id.substr(0, 60) +
                    "` a second time, the first is on line " + std::to_string(first->second));
    }
    measurements.push_back(std::move(measurement));
  }
  if (!columns && !log.has_errors())
    log.error({1, 0}, "empty-file", "the file is empty, expected a line of column names");
  if (columns && measurements.empty() && !log.has_errors())
    log.error({}, "empty-file", "no rows after the column names");
  return measurements;
}

}  // namespace

Result<Run> load_run(const fs::path& path, const Rig& rig) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return fail(bytes);
  std::string_view text = *bytes;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  FindingLog log(path.string());
  Run run;
  run.file = path;
  run.measurements = read_rows(text, path, rig, log);
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
