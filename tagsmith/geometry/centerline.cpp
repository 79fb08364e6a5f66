// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/centerline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace tagsmith::detail {

namespace {

// True when the arc between two starts, of less than half a turn, has no place abreast of the
// point: the nearest one is then an end, which is known without an angle.
bool is_nearest_at_an_end(const CenterlineElement& arc, const Eigen::Vector2d& from_start,
                          const Eigen::Vector2d& along_start, const Eigen::Vector2d& from_end,
                          const Eigen::Vector2d& along_end) {
  if (arc.curvature == 0 || std::abs(arc.curvature) * arc.length >= std::numbers::pi) return false;
  return from_start.dot(along_start) < 0 || from_end.dot(along_end) > 0;
}

}  // namespace

Centerline::Start::Start(const CenterlinePoint& at)
    : point(at), along(direction_of(at.heading)), right(along.y(), -along.x(), 0.0) {}

CenterlinePoint Centerline::advance(const Start& start, const CenterlineElement& element,
                                    double distance) {
  CenterlinePoint end = start.point;
  end.grade = element.grade;
  end.curvature = element.curvature;
  end.position.z() += element.grade * distance;
  if (element.curvature == 0) {
    end.position += distance * start.along;
    return end;
  }
  const double radius = 1.0 / element.curvature;
  end.heading = start.point.heading + distance * element.curvature;
  end.position += radius * (start.right - right_of(end.heading));
  return end;
}

double Centerline::nearest_length(const Start& start, const CenterlineElement& element,
                                  const Eigen::Vector2d& point, double low, double high) {
  const Eigen::Vector2d along = start.along.head<2>();
  const Eigen::Vector2d from_start = point - start.point.position.head<2>();
  if (element.curvature == 0) return std::clamp(from_start.dot(along), low, high);
  const Eigen::Vector2d right = start.right.head<2>();
  const double radius = std::abs(1.0 / element.curvature);
  const double towards_centre = element.curvature > 0 ? 1.0 : -1.0;
  const Eigen::Vector2d from_centre = from_start - towards_centre * radius * right;
  double angle = std::atan2(from_centre.dot(along), -towards_centre * from_centre.dot(right));
  if (angle * radius < low - 1e-12) {
    // Behind the start: the far end is nearer when the arc comes round beyond half a turn.
    const double turned = angle + 2.0 * std::numbers::pi;
    angle = (turned * radius - high < low - angle * radius) ? turned : angle;
  }
  return std::clamp(angle * radius, low, high);
}

Eigen::Vector3d direction_of(double heading) { return {std::sin(heading), std::cos(heading), 0.0}; }

Eigen::Vector3d right_of(double heading) { return {std::cos(heading), -std::sin(heading), 0.0}; }

Centerline::Centerline(const Eigen::Vector3d& start, double heading,
                       std::vector<CenterlineElement> elements)
    : elements_(std::move(elements)) {
  CenterlinePoint point;
  point.position = start;
  point.heading = heading;
  for (const CenterlineElement& element : elements_) {
    point.grade = element.grade;
    point.curvature = element.curvature;
    starts_.emplace_back(point);
    chainages_.push_back(length_);
    point = advance(starts_.back(), element, element.length);
    length_ += element.length;
  }
  starts_.emplace_back(point);
  chainages_.push_back(length_);
}

CenterlinePoint Centerline::at(double chainage) const {
  if (elements_.empty()) return {};
  if (chainage < 0) return advance(starts_.front(), {1, 0, elements_.front().grade}, chainage);
  if (chainage >= length_) {
    return advance(starts_.back(), {1, 0, elements_.back().grade}, chainage - length_);
  }
  const std::size_t index = element_at(chainage);
  return advance(starts_[index], elements_[index], chainage - chainages_[index]);
}

std::size_t Centerline::element_at(double chainage) const {
  const auto next = std::upper_bound(chainages_.begin(), chainages_.end(), chainage);
  return static_cast<std::size_t>(std::distance(chainages_.begin(), next)) - 1;
}

double Centerline::distance_to_a_start(const Eigen::Vector2d& point) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < elements_.size();) {
    const double away = (point - starts_[i].point.position.head<2>()).norm();
    least = std::min(least, away);
    i = std::max(element_at(chainages_[i] + away), i + 1);
  }
  return least;
}

CenterlineAddress Centerline::locate(const Eigen::Vector2d& point) const {
  CenterlineAddress nearest;
  double least = std::numeric_limits<double>::infinity();
  const auto from_start = [&](std::size_t i) -> Eigen::Vector2d {
    return point - starts_[i].point.position.head<2>();
  };
  const auto is_nearer = [&](const Eigen::Vector2d& across) {
    if (across.norm() >= least - 1e-12) return false;
    least = across.norm();
    return true;
  };
  const auto consider_start = [&](std::size_t i, const Eigen::Vector2d& across) {
    if (is_nearer(across)) nearest = {chainages_[i], across.dot(starts_[i].right.head<2>())};
  };
  const auto consider = [&](const Start& start, const CenterlineElement& element,
                            double chainage_at_start, double low, double high) {
    const double length = nearest_length(start, element, point, low, high);
    const CenterlinePoint foot = advance(start, element, length);
    const Eigen::Vector2d across = point - foot.position.head<2>();
    if (!is_nearer(across)) return;
    const bool is_straight = element.curvature == 0;
    const Eigen::Vector3d right = is_straight ? start.right : right_of(foot.heading);
    nearest = {chainage_at_start + length, across.dot(right.head<2>())};
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (elements_.empty()) return nearest;
  consider(starts_.front(), {1, 0, 0}, 0, -kInfinity, 0);
  const double bound = distance_to_a_start(point);
  for (std::size_t i = 0; i < elements_.size();) {
    // No place nears the point by more than the chainage between them: up to here none is nearer.
    const Eigen::Vector2d before = from_start(i);
    const double clear = chainages_[i] + std::max(0.0, before.norm() - std::min(least, bound));
    const std::size_t next = element_at(clear);
    if (next == i) {
      const Eigen::Vector2d beyond = from_start(i + 1);
      if (is_nearest_at_an_end(elements_[i], before, starts_[i].along.head<2>(), beyond,
                               starts_[i + 1].along.head<2>())) {
        consider_start(i, before);
        consider_start(i + 1, beyond);
      } else {
        consider(starts_[i], elements_[i], chainages_[i], 0, elements_[i].length);
      }
    }
    i = std::max(next, i + 1);
  }
  consider(starts_.back(), {1, 0, 0}, length_, 0, kInfinity);
  return nearest;
}

// ---- Clothoids.

std::vector<CenterlineElement> arcs_of_clothoid(double length, double from, double to, int number) {
  // Between its arcs a pair is off by about change * span^3 / 150.
  constexpr double kMostOff = 2e-5;  // metres
  constexpr double kMostPairs = 500;
  const double change = std::abs(to - from) / length;
  const double pairs =
      std::clamp(std::ceil(length * std::cbrt(change / (150 * kMostOff))), 1.0, kMostPairs);
  std::vector<CenterlineElement> arcs;
  for (int i = 0; i < static_cast<int>(pairs); ++i) {
    // Two arcs of half the span have the span's turn and its way aside when their curvatures are
    // those at a sixth and at five sixths of it.
    for (const double share : {1.0 / 6, 5.0 / 6}) {
      const double curvature = from + (to - from) * (i + share) / pairs;
      arcs.push_back({length / (2 * pairs), curvature, 0, number});
    }
  }
  return arcs;
}

std::optional<Clothoid> clothoid_of(std::span<const CenterlineElement> arcs) {
  constexpr double kSame = 1e-6;  // metres
  if (arcs.empty() || arcs.front().clothoid == 0 || arcs.size() % 2 != 0) return std::nullopt;
  Clothoid clothoid;
  for (const CenterlineElement& arc : arcs) {
    if (std::abs(arc.length - arcs.front().length) > kSame) return std::nullopt;
    clothoid.length += arc.length;
  }
  const double by_pair = 1.5 * (arcs[1].curvature - arcs[0].curvature);  // from 1/6 to 5/6 of it
  const double change = by_pair * static_cast<double>(arcs.size()) / 2;
  const auto without_rounding = [&](double curvature) {
    return std::abs(curvature) < 1e-9 * std::abs(change) ? 0 : curvature;
  };
  clothoid.from = without_rounding(arcs[0].curvature - by_pair / 6);
  clothoid.to = without_rounding(clothoid.from + change);
  return clothoid;
}

std::span<const CenterlineElement> leading_part(std::span<const CenterlineElement> elements) {
  const auto of_other = std::ranges::find_if(elements, [&](const CenterlineElement& element) {
    return element.clothoid != elements.front().clothoid;
  });
  const auto arcs = elements.first(static_cast<std::size_t>(of_other - elements.begin()));
  return clothoid_of(arcs) ? arcs : elements.first(std::min<std::size_t>(1, elements.size()));
}

}  // namespace tagsmith::detail
