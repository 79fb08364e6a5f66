// SPDX-License-Identifier: Apache-2.0
// A run: a CSV file with one row a measurement.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// What one camera saw: an image, or a distance already measured to a named tag.
struct CameraMeasurement {
  std::filesystem::path image;     // empty = none; absolute or relative to the working directory
  std::optional<std::string> tag;  // name or digits of the tag whose distance was measured
  std::optional<double> distance;  // from the camera to the tag's P, metres (the paper's D)
};

struct Measurement {
  std::string id;
  int line = 0;                                      // in the run file
  std::map<std::string, CameraMeasurement> cameras;  // by the rig's camera names
  std::map<std::string, double> ranges;              // by the rig's range names, metres
  std::optional<Eigen::Vector3d> truth_in_grid;
  std::optional<double> truth_heading;  // radians from +y towards +x, grid frame
  std::optional<double> time;           // seconds
};

struct Run {
  std::filesystem::path file;
  std::vector<Measurement> measurements;
};

// Columns as docs/formats.md says; a column that is neither one of them nor named after the rig's
// cameras and ranges is an error, as are numbers that are not numbers. The message names
// file:line:column of every fault found (column = the field's number).
Result<Run> load_run(const std::filesystem::path& path, const Rig& rig);

// The photos of all cameras, row by row.
std::vector<std::filesystem::path> photos_of(const std::vector<Measurement>& measurements);

// A run of a rig past the tags of a survey.
struct SurveyedRun {
  Survey survey;
  Rig rig;
  Run run;
};

// From their three files.
Result<SurveyedRun> load_surveyed_run(const std::filesystem::path& survey,
                                      const std::filesystem::path& rig,
                                      const std::filesystem::path& run);

}  // namespace tagsmith::detail
