// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/coverage.hpp"

#include <algorithm>
#include <array>

namespace tagsmith::detail {
namespace {

// Mean of max(0, u - x) for x uniform in [low, high]: the running integral over u of the part of
// an edge that lies left of u.
double mean_excess(double u, double low, double high) {
  if (u <= low) return 0;
  if (u >= high) return u - 0.5 * (low + high);
  return (u - low) * (u - low) / (2.0 * (high - low));
}

}  // namespace

// One cell more than the width: an edge's last difference may fall just right of the grid. Rows to
// the next multiple of kRows.
CoverageGrid::CoverageGrid(int width, int height)
    : width_(width),
      height_(height),
      stride_(static_cast<std::size_t>(width) + 2),
      cells_(stride_ * ((static_cast<std::size_t>(height) + kRows - 1) / kRows * kRows)) {}

void CoverageGrid::clear() { std::ranges::fill(cells_, 0.0F); }

void CoverageGrid::add(std::span<const Eigen::Vector2d> polygon, double weight) {
  if (polygon.size() < 3) return;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    add_edge(polygon[i], polygon[(i + 1) % polygon.size()], weight);
  }
}

// A cell's area is the sum over the edges of the area between the edge and the cell's right end,
// signed by the edge's direction; edges going up (on a clockwise polygon: its left side) add.
void CoverageGrid::add_edge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double weight) {
  const bool up = to.y() < from.y();
  const Eigen::Vector2d& top = up ? to : from;
  const Eigen::Vector2d& bottom = up ? from : to;
  const double first = std::max(top.y(), 0.0);
  const double last = std::min(bottom.y(), static_cast<double>(height_));
  if (first >= last) return;
  const double slope = (bottom.x() - top.x()) / (bottom.y() - top.y());
  const double sign = up ? weight : -weight;
  const int last_row = std::min(static_cast<int>(last), height_ - 1);
  for (int y = static_cast<int>(first); y <= last_row; ++y) {
    const double y_first = std::max(first, static_cast<double>(y));
    const double y_last = std::min(last, y + 1.0);
    if (y_last <= y_first) continue;
    add_edge_in_row(cells_.data() + static_cast<std::size_t>(y) * stride_,
                    top.x() + (y_first - top.y()) * slope, top.x() + (y_last - top.y()) * slope,
                    sign * (y_last - y_first));
  }
}

void CoverageGrid::add_edge_in_row(float* row, double x_first, double x_last, double rise) {
  double low = std::min(x_first, x_last);
  double high = std::max(x_first, x_last);
  if (low >= width_) return;
  if (high <= 0) {
    row[0] += static_cast<float>(rise);
    return;
  }
  if (low < 0 || high > width_) {
    const double length = high - low;
    const double left = std::max(0.0, -low) / length;
    const double right = std::max(0.0, high - width_) / length;
    row[0] += static_cast<float>(rise * left);
    rise *= 1.0 - left - right;
    low = std::max(low, 0.0);
    high = std::min(high, static_cast<double>(width_));
  }
  const int first = static_cast<int>(low);
  const int last = std::min(static_cast<int>(high), width_);
  if (first == last) {
    const double right_part = 0.5 * (low + high) - first;
    row[first] += static_cast<float>(rise * (1.0 - right_part));
    row[first + 1] += static_cast<float>(rise * right_part);
    return;
  }
  double before = 0;
  double area_before = 0;
  for (int cell = first; cell <= last; ++cell) {
    const double after = mean_excess(cell + 1.0, low, high);
    const double area = after - before;
    row[cell] += static_cast<float>(rise * (area - area_before));
    before = after;
    area_before = area;
  }
  row[last + 1] += static_cast<float>(rise * (1.0 - area_before));
}

// Four rows at a time: each row's sum depends on the one before, four of them side by side do not.
void CoverageGrid::integrate() {
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t first = 0; first < cells_.size(); first += kRows * stride_) {
    float* cells = cells_.data() + first;
    std::array<float, kRows> sums{};
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t row = 0; row < kRows; ++row) {
        sums[row] += cells[row * stride_ + x];
        cells[row * stride_ + x] = sums[row];
      }
    }
  }
}

}  // namespace tagsmith::detail
