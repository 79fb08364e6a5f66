// SPDX-License-Identifier: Apache-2.0
// Lists of surveyed points, as surveyors and `tagsmith export` write them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/draft/designed_line.hpp"
#include "tagsmith/survey/listed_survey.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

enum class PointKind {
  left_tag,    // TL, or the name of a tag: corner P
  right_tag,   // TR
  left_wall,   // WL, on the plane of the plates
  right_wall,  // WR
  centerline,  // CL, on the floor below the middle of the tunnel
  floor,       // FL
  roof,        // RF
};

std::string to_string(PointKind kind);

struct SurveyedPoint {
  std::string name;
  PointKind kind = PointKind::floor;
  Eigen::Vector3d in_grid = Eigen::Vector3d::Zero();
  bool has_height = true;          // false: z has no meaning
  bool of_alignment = false;       // sampled from a designed center line, not surveyed
  int line = 0;                    // in the file
  std::optional<TagName> tag;      // nothing: to be numbered along the drive
  std::string digits;              // as printed; empty = not given
  std::optional<double> height;    // above the floor, where the list says it
  std::optional<double> chainage;  // where the list says it
  std::optional<double> offset;    // from the center line, where the list says it
  // Height of the roof above the floor there, where the list says it.
  std::optional<double> tunnel_height;
  std::optional<PlateAttitude> attitude;  // where the list says it
  std::optional<double> sigma;
  bool control = false;
  std::string date;
  std::optional<Eigen::Vector3d> design_in_grid;
};

// "line 30: point 30 (right wall)".
std::string in_words(const SurveyedPoint& point);

// TL, TR or the name of a tag.
inline bool is_tag(const SurveyedPoint& point) {
  return point.kind == PointKind::left_tag || point.kind == PointKind::right_tag;
}

inline Side wall_of(const SurveyedPoint& tag) {
  return tag.kind == PointKind::left_tag ? Side::left : Side::right;
}

struct PointList {
  std::vector<SurveyedPoint> points;
  std::optional<ListedSurvey> survey;       // of lists of `tagsmith export`
  bool unit_is_known = false;               // stated by file or user, not assumed to be metres
  double metres_per_unit = 1;               // of the file's numbers
  int epsg = 0;                             // where the file names its grid
  std::optional<DesignedLine> alignment{};  // the center line, where the file has it whole; metres
};

// The columns of an own list.
std::vector<std::string> own_columns();

struct PointListOptions {
  // Of tables, letters of the columns in the order of the file: P name, E or X, N or Y, Z, D
  // description, `-` a column that is skipped; or `own`, the CSV of `tagsmith export`. Empty for
  // other files.
  std::string order;
  bool header = false;                    // the first line names the columns (own lists always do)
  std::vector<std::string> ignore;        // descriptions that are left out, and names of alignments
  std::optional<double> metres_per_unit;  // as the user states; else from the file, or 1
};

// A table with commas, semicolons or tabs, whichever gives enough columns, LandXML, Leica GSI, RW5
// or ASCII DXF, distinguished by content. With semicolons and tabs a decimal comma is accepted.
// Descriptions are compared by their first word, in any case of letters. Where there is an
// alignment, points CL of the file are floor points. Fails when the file cannot be read, is of no
// such kind, or the order names no usable columns.
Result<Diagnosed<PointList>> read_point_list(const std::filesystem::path& path,
                                             const PointListOptions& options);

}  // namespace tagsmith::detail
