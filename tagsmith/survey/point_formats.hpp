// SPDX-License-Identifier: Apache-2.0
// Points as instruments, field books and CAD write them, told apart by content. Internal to
// tagsmith/survey: point_list.hpp makes the one list of them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/designed_line.hpp"
#include "tagsmith/survey/finding_log.hpp"

namespace tagsmith::detail {

// More are refused: what is made of a point takes some hundred bytes.
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
};

struct RawPoints {
  std::vector<RawPoint> points;
  // Of the alignment, where its elements join without gaps and bends; in the file's unit.
  std::optional<DesignedLine> alignment;
  std::optional<double> metres_per_unit;  // where the file says it
  bool in_some_feet = false;              // the file says feet, but not which
  bool unit_is_advice = false;            // --units may contradict it: DXF headers are often wrong
  int epsg = 0;                           // where the file names its grid
};

// Of each, what is wrong is logged. A description is the first that the format has of those given.

// LandXML 1.x: CgPoints (code, desc, or name or desc of their group); the one Alignment as points
// CL at most half a metre apart, with the heights of its profile. `ignore`: alignments left out.
RawPoints landxml_points(std::string_view text, const std::vector<std::string>& ignore,
                         FindingLog& log);

// Leica GSI-8 and GSI-16: blocks with words 81, 82, 83; description by word 71 or by blocks 41,
// which precede their points where the file begins with one, and follow them elsewhere.
RawPoints gsi_points(std::string_view text, FindingLog& log);

// Carlson and TDS RW5: records SP.
RawPoints rw5_points(std::string_view text, FindingLog& log);

// Whether layers and attributes of this text say what a point is.
using IsDescription = std::function<bool(std::string_view)>;

// ASCII DXF: POINT, ends of LINE, vertices of LWPOLYLINE and POLYLINE, INSERT. Description by an
// attribute (CODE, DESC, DESCRIPTION, KIND) or the layer. Layers and kinds of entities that say
// nothing are left out, with a warning.
RawPoints dxf_points(std::string_view text, const IsDescription& is_description, FindingLog& log);

// Calls `use(number, line)` for each line that is not blank, until it returns false. Numbers count
// from 1; a byte order mark is left out.
template <class Use>
void for_each_line(std::string_view text, Use use) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (line.find_first_not_of(" \t\r") != std::string_view::npos && !use(number, line)) return;
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

// Adds the point; false, with a finding, when there are too many.
bool add_point(RawPoints& points, RawPoint point, FindingLog& log);

}  // namespace tagsmith::detail
