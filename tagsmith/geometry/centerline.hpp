// SPDX-License-Identifier: Apache-2.0
// The tunnel's center line on the floor: straight lines, circular arcs and clothoids, with grades.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace tagsmith::detail {

// One piece of the center line. Lengths are horizontal, as chainages are.
struct CenterlineElement {
  double length = 0;     // metres, > 0
  double curvature = 0;  // 1/radius, positive when the drive turns right, 0 for a line
  double grade = 0;      // rise per horizontal metre
  int clothoid = 0;      // number of the clothoid that it is a part of (clothoid_of); 0 = of none
};

// A place on the center line.
struct CenterlinePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // on the floor
  double heading = 0;  // radians from +y towards +x (clockwise seen from above)
  double grade = 0;
  double curvature = 0;  // as CenterlineElement's
};

// A point's address relative to the center line.
struct CenterlineAddress {
  double chainage = 0;  // metres along the line; below 0 or beyond the length off its ends
  double offset = 0;    // metres across, positive to the right of the drive
};

// Right-handed frame, z up. Before its start and beyond its end the line goes on straight, so that
// a vehicle that has not yet entered has an address too.
class Centerline {
 public:
  Centerline() = default;
  Centerline(const Eigen::Vector3d& start, double heading, std::vector<CenterlineElement> elements);

  double length() const { return length_; }
  const std::vector<CenterlineElement>& elements() const { return elements_; }

  CenterlinePoint at(double chainage) const;

  // The address of the nearest point of the line; of several, the one with the least chainage.
  CenterlineAddress locate(const Eigen::Vector2d& point) const;

 private:
  // Where an element starts, or the line ends.
  struct Start {
    explicit Start(const CenterlinePoint& at);

    CenterlinePoint point;
    Eigen::Vector3d along;  // direction_of and right_of the heading there
    Eigen::Vector3d right;
  };

  // The place `distance` further along an element; either sign.
  static CenterlinePoint advance(const Start& start, const CenterlineElement& element,
                                 double distance);

  // Length along the element, from its start, of the point nearest to `point`, within [low, high].
  static double nearest_length(const Start& start, const CenterlineElement& element,
                               const Eigen::Vector2d& point, double low, double high);

  // Index of the element at a chainage >= 0; their number beyond the end.
  std::size_t element_at(double chainage) const;

  // The distance to the start of one of the elements that lie near the point: some bound on the
  // least one, found without looking at all of them.
  double distance_to_a_start(const Eigen::Vector2d& point) const;

  std::vector<CenterlineElement> elements_;
  std::vector<Start> starts_;      // of each element, and last the end of the line
  std::vector<double> chainages_;  // of starts_
  double length_ = 0;
};

// Unit vector along the drive, horizontal, for a heading.
Eigen::Vector3d direction_of(double heading);

// Unit vector to the right of the drive, horizontal, for a heading.
Eigen::Vector3d right_of(double heading);

// ---- Clothoids, whose curvature grows in proportion to the length: transitions of roads and
// railways.

// Level arcs that follow a clothoid of this length (metres) from one curvature to another
// (1/metres, positive to the right) within a twentieth of a millimetre; they end where it ends,
// with its heading. `number`: of the clothoid in its line, from 1 (CenterlineElement::clothoid).
std::vector<CenterlineElement> arcs_of_clothoid(double length, double from, double to, int number);

// A clothoid of this length (metres) from one curvature to another.
struct Clothoid {
  double length = 0;
  double from = 0;
  double to = 0;
};

// The clothoid that these are all arcs of, as arcs_of_clothoid made them; nothing for other
// elements and where arcs are cut or missing.
std::optional<Clothoid> clothoid_of(std::span<const CenterlineElement> arcs);

// The first element, or all arcs of the clothoid that it begins.
std::span<const CenterlineElement> leading_part(std::span<const CenterlineElement> elements);

}  // namespace tagsmith::detail
