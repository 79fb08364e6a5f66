// SPDX-License-Identifier: Apache-2.0
// Which part of a drawing is taken by words, so that none stand over others. Internal to
// tagsmith/render.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

namespace tagsmith::detail {

// A rectangle at any angle: a corner and the two sides from there, metres on paper.
struct TurnedBox {
  Eigen::Vector2d corner{0, 0};
  Eigen::Vector2d along{0, 0};
  Eigen::Vector2d up{0, 0};
};

class LabelRoom {
 public:
  // The first of the moves that brings the box where nothing is; none = the box stays. The box is
  // taken where it then is.
  Eigen::Vector2d take(const TurnedBox& box, std::span<const Eigen::Vector2d> moves);

 private:
  bool is_free(const TurnedBox& box) const;

  std::vector<TurnedBox> taken_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> taken_by_cell_;
};

}  // namespace tagsmith::detail
