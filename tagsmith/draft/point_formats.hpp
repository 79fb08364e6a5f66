// SPDX-License-Identifier: Apache-2.0
// Points as instruments, field books and CAD write them, distinguished by content. Internal to
// tagsmith/survey: point_list.hpp combines them in one list.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/draft/designed_line.hpp"
#include "tagsmith/survey/table_row.hpp"

namespace tagsmith::detail {

// More are refused: each point takes some hundred bytes of memory.
inline constexpr std::size_t kMostPoints = 1'000'000;

enum class PointFormat { table, landxml, gsi, rw5, dxf };

// By the first lines. Fails for what is certainly none of them: other XML, binary files, UTF-16.
Result<PointFormat> format_of_points(std::string_view text);

struct RawPoint {
  int line = 0;
  std::string name;
  std::string description;
  Eigen::Vector3d in_grid = Eigen::Vector3d::Zero();  // x, y, z in the file's unit
  bool has_height = true;
  bool of_alignment = false;  // sampled from a center line, not surveyed
  std::string digits{};       // where the file has a field for those of a tag; may be anything
};

struct RawPoints {
  std::vector<RawPoint> points;
  // Of the alignment, where its elements join without gaps and bends; in the file's unit.
  std::optional<DesignedLine> alignment;
  std::optional<double> metres_per_unit;  // where the file says it
  bool in_some_feet = false;              // the file says feet, but not which
  bool unit_is_advice = false;            // --units may overrule it: DXF headers are often wrong
  std::string unknown_unit;               // the file's word for it, where it is no known unit
  std::string epsg_code;                  // where the file names its grid
  // What the file says of all its tags, by the columns of an own list; and on which line.
  std::map<std::string, std::string> listed;
  int listed_line = 0;
};

// Every fault is logged. A description is the first of those named that the format has.

// LandXML 1.x: CgPoints (code, desc, or name or desc of their group); the one Alignment as points
// CL at most half a metre apart, with the heights of its one profile as far as that goes. `ignore`:
// alignments and profiles left out.
RawPoints landxml_points(std::string_view text, const std::vector<std::string>& ignore,
                         FindingLog& log);

// Leica GSI-8 and GSI-16: blocks with words 81, 82, 83; description by word 71 or by blocks 41,
// which precede their points where the file begins with one, and follow them elsewhere; the digits
// of a tag in word 72.
RawPoints gsi_points(std::string_view text, FindingLog& log);

// Whether layers, attributes and notes with this text say what a point is (point_list.cpp).
bool is_point_description(std::string_view text);

// Carlson and TDS RW5: records SP. Points that only other records describe are left out, with a
// warning.
RawPoints rw5_points(std::string_view text, FindingLog& log);

// ASCII DXF: POINT, ends of LINE, vertices of LWPOLYLINE and POLYLINE and points on their arcs, at
// most 2 mm of sagitta apart, INSERT. Description by an attribute (CODE, DESC, DESCRIPTION, KIND)
// or the layer. Layers and kinds of entities without a meaning are left out, with a warning.
// `metres_per_unit`: as the user states.
RawPoints dxf_points(std::string_view text, const std::optional<double>& metres_per_unit,
                     FindingLog& log);

// "CIRCLE (2), HATCH (1)": the names with their counts, the first ten.
std::string counted_text(const std::map<std::string, int>& counts);

// Adds the point; false, with a finding, when there are too many.
bool add_point(RawPoints& points, RawPoint point, FindingLog& log);

}  // namespace tagsmith::detail
