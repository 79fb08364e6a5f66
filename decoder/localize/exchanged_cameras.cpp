// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/exchanged_cameras.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "decoder/localize/joint_method.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

bool shows_tags_of(const Observation& row, const std::string& camera) {
  return std::ranges::any_of(row.tags, [&](const SeenTag& seen) {
    return seen.camera == camera && seen.seen_corners && !seen.is_part;
  });
}

// Rows that show tags in both cameras: a single photo fits a place in either.
std::vector<Observation> compared_rows(const std::vector<Observation>& rows, const std::string& one,
                                       const std::string& other) {
  constexpr std::size_t kMost = 40;
  std::vector<Observation> both;
  std::ranges::copy_if(rows, std::back_inserter(both), [&](const Observation& row) {
    return shows_tags_of(row, one) && shows_tags_of(row, other);
  });
  return evenly_taken(std::move(both), kMost);
}

std::size_t count_explained(const std::vector<Observation>& rows,
                            const std::vector<Survey>& surveys, const Rig& rig) {
  const auto is_explained = [&](const Observation& row) {
    const Fix fix = localize_jointly(row, surveys, rig);
    const bool has_dropped_tag = std::ranges::any_of(
        fix.dropped, [](const Dropped& dropped) { return !dropped.camera.empty(); });
    return fix.position_in_grid && !has_dropped_tag;
  };
  return static_cast<std::size_t>(std::ranges::count_if(rows, is_explained));
}

std::vector<Observation> exchanged(std::vector<Observation> rows, const std::string& one,
                                   const std::string& other) {
  for (Observation& row : rows) {
    for (SeenTag& seen : row.tags) {
      if (seen.camera == one) {
        seen.camera = other;
      } else if (seen.camera == other) {
        seen.camera = one;
      }
    }
    row.parts.clear();
  }
  return rows;
}

bool are_exchanged(const std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                   const Rig& rig, const std::string& one, const std::string& other) {
  constexpr std::size_t kLeastRows = 3;
  constexpr double kLeastShare = 0.7;
  const std::vector<Observation> both = compared_rows(rows, one, other);
  if (both.size() < kLeastRows) return false;
  const auto count = static_cast<double>(both.size());
  const std::size_t as_stated = count_explained(both, surveys, rig);
  if (static_cast<double>(as_stated) > count / 2) return false;
  const std::size_t once_exchanged = count_explained(exchanged(both, one, other), surveys, rig);
  return once_exchanged >= kLeastRows && once_exchanged >= 2 * as_stated &&
         static_cast<double>(once_exchanged) >= kLeastShare * count;
}

}  // namespace

std::string leave_out_exchanged(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                                const Rig& rig) {
  for (auto one = rig.cameras.begin(); one != rig.cameras.end(); ++one) {
    for (auto other = std::next(one); other != rig.cameras.end(); ++other) {
      if (!are_exchanged(rows, surveys, rig, one->name, other->name)) continue;
      std::string why = fmt::format(
          "the photos of the cameras {} and {} are exchanged: exchange these columns of the run, "
          "or their places in the rig",
          one->name, other->name);
      for (Observation& row : rows) leave_out_pictures(row, {one->name, other->name}, why);
      return why;
    }
  }
  return {};
}

}  // namespace tagsmith::detail
