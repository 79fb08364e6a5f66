// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/expected_place.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kOnWall = 0.1;          // metres that a plate may be off its wall's plane
constexpr double kLeastScatter = 0.05;   // metres
constexpr std::size_t kNeighbours = 3;   // on either side
constexpr std::size_t kLeastOnWall = 5;  // tags from which a wall's usual values are determined

struct Habit {
  std::vector<PlateAddress> addresses;
  double pitch = 0;  // chainage a pair
};

Habit habit_of(const Survey& survey, const std::vector<const SourcedTag*>& wall) {
  Habit habit;
  std::vector<double> pitches;
  for (const SourcedTag* entry : wall) {
    habit.addresses.push_back(plate_address(survey, entry->tag.side, entry->tag.p_in_grid));
  }
  for (std::size_t i = 1; i < wall.size(); ++i) {
    pitches.push_back((habit.addresses[i].chainage - habit.addresses[i - 1].chainage) /
                      (wall[i]->tag.pair - wall[i - 1]->tag.pair));
  }
  habit.pitch = median(std::move(pitches));
  return habit;
}

// From the tags on either side of the i-th.
ExpectedPlace by_neighbours(const std::vector<const SourcedTag*>& wall, const Habit& habit,
                            std::size_t i) {
  std::vector<double> chainages;
  std::vector<double> heights;
  const std::size_t begin = i > kNeighbours ? i - kNeighbours : 0;
  const std::size_t end = std::min(wall.size(), i + kNeighbours + 1);
  for (std::size_t j = begin; j < end; ++j) {
    if (j == i) continue;
    const int pairs = wall[i]->tag.pair - wall[j]->tag.pair;
    chainages.push_back(habit.addresses[j].chainage + habit.pitch * pairs);
    heights.push_back(habit.addresses[j].height);
  }
  return {median(std::move(chainages)), median(std::move(heights))};
}

std::optional<ExpectedPlace> by_design(const Survey& survey, const PlacedTag& tag) {
  if (!tag.design_in_grid) return std::nullopt;
  const PlateAddress address = plate_address(survey, tag.side, *tag.design_in_grid);
  return ExpectedPlace{address.chainage, address.height};
}

void set_tolerances(const std::vector<PlateAddress>& addresses, double pitch,
                    std::vector<std::optional<ExpectedPlace>>& places) {
  constexpr double kOfPitch = 0.25;
  std::vector<double> along;
  std::vector<double> high;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i]) continue;
    along.push_back(std::abs(addresses[i].chainage - places[i]->chainage));
    high.push_back(std::abs(addresses[i].height - places[i]->height));
  }
  if (along.empty()) return;
  const double of_pitch = std::isfinite(pitch) ? kOfPitch * std::abs(pitch) : 0;
  const double scatter = std::max(kLeastScatter, kScatterTolerance * median(std::move(along)));
  const double chainage = std::max({kLeastTolerance, of_pitch, scatter});
  const double height = std::max(kLeastTolerance, kScatterTolerance * median(std::move(high)));
  for (std::optional<ExpectedPlace>& place : places) {
    if (!place) continue;
    place->chainage_tolerance = chainage;
    place->height_tolerance = height;
    place->chainage_scatter = scatter;
  }
}

// Coordinates that may have been meant.
struct Slip {
  Eigen::Vector3d p_in_grid;
  std::string words;
};

std::string coordinate(double value) { return fmt::format("{}", value); }

std::vector<Slip> slips_of_axis(const Eigen::Vector3d& p, int axis) {
  std::vector<Slip> slips;
  const std::string text = coordinate(p[axis]);
  const auto add = [&](double value, const char* why) {
    if (value == p[axis]) return;
    Slip slip{p, fmt::format("{} = {} instead of {} would fit: {}", kAxisNames[axis],
                             coordinate(value), text, why)};
    slip.p_in_grid[axis] = value;
    slips.push_back(std::move(slip));
  };
  add(-p[axis], "the sign");
  add(10 * p[axis], "the decimal point");
  add(p[axis] / 10, "the decimal point");
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    // The decimal point may stand between the two digits.
    const std::size_t next = text[i + 1] == '.' ? i + 2 : i + 1;
    std::string swapped = text;
    if (next >= text.size()) continue;
    std::swap(swapped[i], swapped[next]);
    const auto value = parse_number(swapped);
    if (value && swapped.size() == text.size()) add(*value, "two digits exchanged");
  }
  return slips;
}

bool fits(const Survey& survey, Side side, const Eigen::Vector3d& p_in_grid,
          const ExpectedPlace& expected) {
  const PlateAddress address = plate_address(survey, side, p_in_grid);
  return std::abs(address.behind_wall) < kOnWall &&
         std::abs(address.chainage - expected.chainage) < expected.chainage_scatter &&
         fits_in_height(address, expected);
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

PlateAddress plate_address(const Survey& survey, Side side, const Eigen::Vector3d& p_in_grid) {
  const Tunnel& tunnel = survey.tunnel;
  const Eigen::Vector3d p = world_from_grid(survey.grid, p_in_grid);
  const Pose world_from_plate = plate_on_wall(tunnel, survey.tag_template, side, p);
  const Eigen::Vector3d middle =
      world_from_plate * Eigen::Vector3d(survey.tag_template.frame_inner_length / 2, 0, 0);
  const CenterlineAddress address = tunnel.centerline.locate(middle.head<2>());
  const double floor = tunnel.centerline.at(address.chainage).position.z();
  return {address.chainage, behind_wall(tunnel, side, address), p.z() - floor};
}

std::vector<std::optional<ExpectedPlace>> expected_places(
    const Survey& survey, const std::vector<const SourcedTag*>& wall) {
  std::vector<std::optional<ExpectedPlace>> places(wall.size());
  const Habit habit = habit_of(survey, wall);
  for (std::size_t i = 0; i < wall.size(); ++i) {
    places[i] = by_design(survey, wall[i]->tag);
    if (!places[i] && wall.size() >= kLeastOnWall) places[i] = by_neighbours(wall, habit, i);
  }
  set_tolerances(habit.addresses, habit.pitch, places);
  return places;
}

bool fits_along(const PlateAddress& address, const ExpectedPlace& expected) {
  return std::abs(address.chainage - expected.chainage) <= expected.chainage_tolerance;
}

bool fits_in_height(const PlateAddress& address, const ExpectedPlace& expected) {
  return std::abs(address.height - expected.height) <= expected.height_tolerance;
}

std::optional<std::string> likely_slip(const Survey& survey, const PlacedTag& tag,
                                       const ExpectedPlace& expected) {
  const Eigen::Vector3d& p = tag.p_in_grid;
  std::vector<Slip> slips{{{p.y(), p.x(), p.z()}, "x and y exchanged would fit"}};
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::move(slips_of_axis(p, axis), std::back_inserter(slips));
  }
  std::erase_if(
      slips, [&](const Slip& slip) { return !fits(survey, tag.side, slip.p_in_grid, expected); });
  if (slips.size() != 1) return std::nullopt;
  return std::move(slips.front().words);
}

}  // namespace tagsmith::detail
