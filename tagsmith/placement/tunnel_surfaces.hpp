// SPDX-License-Identifier: Apache-2.0
// Walls, floor and roof of a tunnel, which hide what stands behind them.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// ---- The vertical walls of a tunnel, seen from above.

// Where a line of sight, seen from above, first meets a wall.
struct WallHit {
  double way = 0;       // in lengths of the ray's direction vector
  double chainage = 0;  // metres
  Side side = Side::left;
  double cosine = 1;  // of the angle between the ray, seen from above, and the wall's normal
};

// The walls along a tunnel's center line, continued straight before its start and beyond its end.
// World frame.
class TunnelWalls {
 public:
  // Walls that stand `standoff` metres (at least the tunnel's own) behind the plates' planes, as
  // far as `reach` metres along the tunnel before and after `chainage`. The inner wall of an arc
  // that leaves it no radius is left out.
  TunnelWalls(const Tunnel& tunnel, double standoff, double chainage, double reach = 60);

  std::optional<WallHit> first_hit(const Eigen::Vector2d& origin,
                                   const Eigen::Vector2d& direction) const;

 private:
  struct Straight {
    Eigen::Vector2d start;
    Eigen::Vector2d along;
    Eigen::Vector2d across;  // to the right of the drive
    double length;
    double chainage;
    double stretch;  // chainage for a metre of the wall
    Side side;
  };
  struct Arc {
    Eigen::Vector2d centre;
    Eigen::Vector2d from_centre;  // unit, to the start
    double radius;
    double curvature;  // of the center line
    double length;     // of the center line
    double chainage;
    Side side;
  };

  void add_parallel(const Centerline& line, Side side, double offset, double first, double last);
  void add(const CenterlinePoint& start, double curvature, double length, double chainage,
           Side side, double offset);
  void add_pieces(const Centerline& line, Side side, const ChainageProfile& offset, double first,
                  double last);
  static void meet(const Straight& wall, const Eigen::Vector2d& origin,
                   const Eigen::Vector2d& direction, std::optional<WallHit>& nearest);
  static void meet(const Arc& wall, const Eigen::Vector2d& origin, const Eigen::Vector2d& direction,
                   std::optional<WallHit>& nearest);

  std::vector<Straight> straights_;
  std::vector<Arc> arcs_;
};

// How far the walls must stand behind the plates' planes so that no plate within the reach of
// `chainage` sinks into them: 10 mm more than the plate corner that lies farthest out (flat plates
// stick out of the planes' curve on the outer side of an arc, surveyed ones anywhere); at most
// 0.5 m.
double wall_standoff(const Survey& survey, double chainage, double reach = 60);

// The same for plates of which the farthest corner lies `farthest` metres behind the planes.
double standoff_behind(double farthest);

// ---- Floor and roof where the grade or the height changes: over a crest, through a sag and under
// a lower roof they hide what stands behind.

// A line of sight leaves the tunnel's room between two places of it.
struct RoomExit {
  double last_inside = 0;    // in lengths of the ray's direction vector
  double first_outside = 0;  // likewise
  bool through_floor = false;
};

// The changes of grade and of the roof's height within `reach` metres of a chainage. Between two of
// them floor and roof rise evenly with the chainage, so that a ray with both ends in the tunnel can
// leave it only at a change; exact where the center line is straight, and in a bend except for the
// unevenness of a ray's chainage between two changes. World frame.
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
