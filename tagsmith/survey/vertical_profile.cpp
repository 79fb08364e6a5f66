// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/vertical_profile.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

constexpr double kMostChords = 500;  // of one curve: bounds the work

double grade_between(const Vector2d& from, const Vector2d& to) {
  return (to.y() - from.y()) / (to.x() - from.x());
}

int chords(double count) {
  return static_cast<int>(std::ceil(std::clamp(count, 1.0, kMostChords)));
}

// Two parabolas that meet above the change of grade with one tangent, as long as it says before and
// behind it; of equal lengths they are one.
VerticalProfile parabola(const GradeChange& change, double grade_before, double grade_behind,
                         double sag) {
  const auto& [at, before, behind, radius, length] = change;
  const double middle = before * behind * (grade_behind - grade_before) / (2 * (before + behind));
  const int count = chords(std::sqrt(std::abs(middle) / (4 * sag)));
  VerticalProfile points;
  for (int i = -count; i <= count; ++i) {
    const double share = std::abs(i) / static_cast<double>(count);  // of the way from the change
    const double along = share * (i < 0 ? -before : behind);
    const double tangent = at.y() + along * (i < 0 ? grade_before : grade_behind);
    points.emplace_back(at.x() + along, tangent + middle * (1 - share) * (1 - share));
  }
  return points;
}

Result<VerticalProfile> arc(const GradeChange& change, double grade_before, double grade_behind,
                            double sag) {
  constexpr double kSame = 0.01;
  const double radius = std::abs(*change.radius);
  const double from = std::atan(grade_before);
  const double turned = std::atan(grade_behind) - from;
  const double length = std::abs(turned) * radius;
  if (change.arc_length && std::abs(*change.arc_length - length) > kSame * length) {
    return fail("its length is " + format_number(*change.arc_length, 3) +
                ", but its radius makes " + format_number(length, 3));
  }
  const double side = turned < 0 ? -1 : 1;
  const double tangent = radius * std::tan(std::abs(turned) / 2);
  const Vector2d start = change.at - tangent * Vector2d(std::cos(from), std::sin(from));
  const Vector2d centre = start + side * radius * Vector2d(-std::sin(from), std::cos(from));
  const int count = chords(std::abs(turned) * std::sqrt(radius / (8 * sag)));
  VerticalProfile points;
  for (int i = 0; i <= count; ++i) {
    const double angle = from + turned * i / count;
    points.push_back(centre + side * radius * Vector2d(std::sin(angle), -std::cos(angle)));
  }
  return points;
}

// What the change of grade at the index adds to the profile.
Result<VerticalProfile> points_of(const std::vector<GradeChange>& changes, std::size_t index,
                                  double sag) {
  const GradeChange& change = changes[index];
  if (!change.radius && change.before + change.behind == 0) return VerticalProfile{change.at};
  if (index == 0 || index + 1 == changes.size()) {
    return fail("a vertical curve needs a point of the profile before and behind it");
  }
  const double before = grade_between(changes[index - 1].at, change.at);
  const double behind = grade_between(change.at, changes[index + 1].at);
  if (change.radius) return arc(change, before, behind, sag);
  return parabola(change, before, behind, sag);
}

}  // namespace

Result<VerticalProfile> profile_of_grades(const std::vector<GradeChange>& changes, double sag) {
  constexpr double kSame = 1e-3;  // between the end of one curve and the begin of the next
  for (std::size_t i = 1; i < changes.size(); ++i) {
    if (changes[i].at.x() > changes[i - 1].at.x()) continue;
    return fail("station " + format_number(changes[i].at.x(), 3) + " does not lie behind " +
                format_number(changes[i - 1].at.x(), 3));
  }
  VerticalProfile profile;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const std::string place = "at station " + format_number(changes[i].at.x(), 3) + ": ";
    const Result<VerticalProfile> points = points_of(changes, i, sag);
    if (!points) return fail(place + points.error().message);
    if (!profile.empty() && points->front().x() < profile.back().x() - kSame) {
      return fail(place + "vertical curves overlap");
    }
    for (const Vector2d& point : *points) {
      if (profile.empty() || point.x() > profile.back().x()) profile.push_back(point);
    }
  }
  return profile;
}

bool reaches(const VerticalProfile& profile, double station, double slack) {
  return !profile.empty() && station >= profile.front().x() - slack &&
         station <= profile.back().x() + slack;
}

double height_at(const VerticalProfile& profile, double station) {
  const auto next =
      std::ranges::find_if(profile, [&](const Vector2d& p) { return p.x() >= station; });
  if (next == profile.begin()) return profile.front().y();
  if (next == profile.end()) return profile.back().y();
  const Vector2d& before = *std::prev(next);
  return before.y() + (station - before.x()) * grade_between(before, *next);
}

}  // namespace tagsmith::detail
