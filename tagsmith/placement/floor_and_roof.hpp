// SPDX-License-Identifier: Apache-2.0
// Floor and roof of a tunnel where its grade or its height changes: over a crest, through a sag and
// under a lower roof they hide what stands behind.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A line of sight leaves the tunnel's room between two places of it.
struct RoomExit {
  double last_inside = 0;    // in lengths of the ray's direction vector
  double first_outside = 0;  // likewise
  bool through_floor = false;
};

// The changes of grade and of the roof's height within `reach` metres of a chainage. Between two of
// them floor and roof rise evenly with the chainage, so that a ray with both ends in the room can
// leave it at a change only; exact where the center line is straight, and in a bend to what a ray's
// chainage departs from evenness between two changes. World frame.
class FloorAndRoof {
 public:
  FloorAndRoof(const Tunnel& tunnel, double chainage, double reach = 60);

  // True when no ray can leave the room: neither grade nor height changes.
  bool is_even() const { return changes_.empty(); }

  // Where the ray from a point in the room first lies below the floor or above the roof at a
  // change, up to `way` lengths of its direction vector.
  std::optional<RoomExit> first_exit(const Eigen::Vector3d& origin,
                                     const Eigen::Vector3d& direction, double way) const;

 private:
  struct Change {
    Eigen::Vector3d place;  // of the center line, on the floor
    Eigen::Vector2d along;  // of the drive there
    double roof_above_floor = 0;
  };
  // Where a ray meets the cross section of a change.
  struct Crossing {
    double way = 0;
    bool below = false;  // the floor
    bool above = false;  // the roof
  };

  std::optional<Crossing> crossing(const Change& change, const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction, double way) const;

  std::vector<Change> changes_;
  double greatest_offset_ = 0;
};

}  // namespace tagsmith::detail
