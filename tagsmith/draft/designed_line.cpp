// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/designed_line.hpp"

namespace tagsmith::detail {

DesignedLine scaled(DesignedLine line, double factor) {
  line.start *= factor;
  for (Clothoid& element : line.elements) {
    element = {element.length * factor, element.from / factor, element.to / factor};
  }
  return line;
}

Centerline line_in_world(const DesignedLine& line, const Grid& grid) {
  const double sign = grid.x_axis_left ? -1 : 1;
  std::vector<CenterlineElement> elements;
  int clothoids = 0;
  for (const auto& [length, from, to] : line.elements) {
    if (from == to) {
      elements.push_back({length, sign * from, 0});
      continue;
    }
    const std::vector<CenterlineElement> arcs =
        arcs_of_clothoid(length, sign * from, sign * to, ++clothoids);
    elements.insert(elements.end(), arcs.begin(), arcs.end());
  }
  const Eigen::Vector3d start(line.start.x(), line.start.y(), 0);
  return {world_from_grid(grid, start), world_heading_from_grid(grid, line.heading), elements};
}

}  // namespace tagsmith::detail
