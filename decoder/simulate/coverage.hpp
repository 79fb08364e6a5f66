// SPDX-License-Identifier: Apache-2.0
// Exact area coverage of polygons on a grid of cells.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace tagsmith::detail {

// Sums of weighted polygon areas. Cell (x, y) is the square [x, x+1] x [y, y+1]. Use: add polygons,
// then integrate once, then read rows; clear begins again.
class CoverageGrid {
 public:
  CoverageGrid(int width, int height);

  void clear();

  // Adds weight * (area of the polygon within the cell) to every cell; positive for a polygon whose
  // corners go clockwise on the screen (x right, y down). Exact up to float rounding. Parts outside
  // the grid are cut off.
  void add(std::span<const Eigen::Vector2d> polygon, double weight);

  // Turns the sums gathered by `add` into areas.
  void integrate();

  int width() const { return width_; }
  int height() const { return height_; }
  const float* row(int y) const { return cells_.data() + static_cast<std::size_t>(y) * stride_; }

 private:
  void add_edge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double weight);
  void add_edge_in_row(float* row, double x_first, double x_last, double rise);

  static constexpr std::size_t kRows = 4;  // that are integrated side by side

  int width_ = 0;
  int height_ = 0;
  std::size_t stride_ = 0;
  std::vector<float> cells_;  // differences between neighbouring cells until integrated
};

}  // namespace tagsmith::detail
