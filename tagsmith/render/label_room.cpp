// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/label_room.hpp"

#include <algorithm>
#include <cmath>

namespace tagsmith::detail {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

AlignedBox2d bounds_of(const TurnedBox& box) {
  AlignedBox2d bounds;
  for (const Vector2d& side : {Vector2d(0, 0), box.along, box.up, Vector2d(box.along + box.up)}) {
    bounds.extend(Vector2d(box.corner + side));
  }
  return bounds;
}

// True when a line in the direction of a side of `a` lies between the two (separating axes).
bool side_separates(const TurnedBox& a, const TurnedBox& b) {
  for (const Vector2d& side : {a.along, a.up}) {
    const double length = side.squaredNorm();
    const double from = (b.corner - a.corner).dot(side);
    const double along = b.along.dot(side);
    const double up = b.up.dot(side);
    const double least = from + std::min(along, 0.0) + std::min(up, 0.0);
    const double most = from + std::max(along, 0.0) + std::max(up, 0.0);
    if (least >= length || most <= 0) return true;
  }
  return false;
}

// Calls the function with the key of each cell of a grid that the box may reach.
template <class Function>
void for_each_cell(const TurnedBox& box, const Function& function) {
  constexpr double kCell = 0.010;  // metres on paper
  const AlignedBox2d bounds = bounds_of(box);
  const auto cell = [](double at) { return static_cast<std::int64_t>(std::floor(at / kCell)); };
  constexpr double kFarthest = 1e4;  // metres; nothing is drawn so far away
  if (!(bounds.min().cwiseAbs().maxCoeff() < kFarthest)) return;
  if (!(bounds.max().cwiseAbs().maxCoeff() < kFarthest) || bounds.sizes().maxCoeff() > 1) return;
  for (std::int64_t x = cell(bounds.min().x()); x <= cell(bounds.max().x()); ++x) {
    for (std::int64_t y = cell(bounds.min().y()); y <= cell(bounds.max().y()); ++y) {
      function((x << 32) ^ (y & 0xffffffff));
    }
  }
}

}  // namespace

bool LabelRoom::is_free(const TurnedBox& box) const {
  bool free = true;
  for_each_cell(box, [&](std::int64_t cell) {
    const auto found = taken_by_cell_.find(cell);
    if (!free || found == taken_by_cell_.end()) return;
    free = std::ranges::all_of(found->second, [&](std::size_t i) {
      return side_separates(box, taken_[i]) || side_separates(taken_[i], box);
    });
  });
  return free;
}

Vector2d LabelRoom::take(const TurnedBox& box, std::span<const Vector2d> moves) {
  TurnedBox placed = box;
  if (!is_free(box)) {
    const auto found = std::ranges::find_if(moves, [&](const Vector2d& move) {
      return is_free({box.corner + move, box.along, box.up});
    });
    if (found != moves.end()) placed.corner += *found;
  }
  for_each_cell(placed, [&](std::int64_t cell) { taken_by_cell_[cell].push_back(taken_.size()); });
  taken_.push_back(placed);
  return placed.corner - box.corner;
}

}  // namespace tagsmith::detail
