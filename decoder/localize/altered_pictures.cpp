// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/altered_pictures.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/localize/joint_method.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

using Cameras = std::set<std::string>;

// What may have been done to a run's photos.
struct Alteration {
  Cameras cameras;         // whose photos it is about
  bool needs_all = false;  // of them to show tags in a row that can tell
  std::function<void(SeenTag&)> undo;
  std::string words;
};

bool shows_tags_of(const Observation& row, const std::string& camera) {
  return std::ranges::any_of(row.tags, [&](const SeenTag& seen) {
    return seen.camera == camera && seen.seen_corners && !seen.is_part;
  });
}

// Rows that can contradict it: that show several tags, one or more of them in its cameras. Without
// parts of tags, which are not compared.
std::vector<Observation> compared_rows(const std::vector<Observation>& rows,
                                       const Alteration& alteration) {
  constexpr std::size_t kMost = 40;
  std::vector<Observation> chosen;
  std::ranges::copy_if(rows, std::back_inserter(chosen), [&](const Observation& row) {
    const auto shows = [&](const std::string& camera) { return shows_tags_of(row, camera); };
    return row.tags.size() > 1 &&
           (alteration.needs_all ? std::ranges::all_of(alteration.cameras, shows)
                                 : std::ranges::any_of(alteration.cameras, shows));
  });
  chosen = evenly_taken(std::move(chosen), kMost);
  for (Observation& row : chosen) row.parts.clear();
  return chosen;
}

// How many rows fit a place of the vehicle with all their tags, and how well.
struct Explained {
  std::size_t rows = 0;
  double chi_square = 0;  // of these
};

Explained explained(const std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                    const Rig& rig) {
  Explained result;
  for (const Observation& row : rows) {
    const Fix fix = localize_jointly(row, surveys, rig);
    const bool has_dropped_tag = std::ranges::any_of(
        fix.dropped, [](const Dropped& dropped) { return !dropped.camera.empty(); });
    if (!fix.position_in_grid || has_dropped_tag) continue;
    ++result.rows;
    result.chi_square += fix.chi_square;
  }
  return result;
}

std::vector<Observation> undone(std::vector<Observation> rows, const Alteration& alteration) {
  for (Observation& row : rows) {
    for (SeenTag& seen : row.tags) {
      if (alteration.cameras.contains(seen.camera)) alteration.undo(seen);
    }
  }
  return rows;
}

// The rows that can tell of alterations, and how many of them fit as stated.
struct Compared {
  std::vector<Observation> rows;
  std::size_t as_stated = 0;

  // Whether so many rows that fit mean an alteration.
  bool is_told_by(const Explained& undone) const {
    constexpr std::size_t kLeastRows = 3;
    constexpr double kLeastShare = 0.7;
    return undone.rows >= kLeastRows && undone.rows >= 2 * as_stated &&
           static_cast<double>(undone.rows) >= kLeastShare * static_cast<double>(rows.size());
  }
};

Alteration exchange(const std::string& one, const std::string& other) {
  const auto undo = [=](SeenTag& seen) { seen.camera = seen.camera == one ? other : one; };
  return {{one, other},
          true,
          undo,
          fmt::format("the photos of the cameras {} and {} are exchanged: exchange these columns "
                      "of the run, or their places in the rig",
                      one, other)};
}

// The corners as they were before the picture's columns (across) or rows (down) were reversed. A
// reader takes one mirror image of a plate for the plate upside down: with one of the two reversed,
// what it calls the upper edge is the lower one.
void reverse(SeenCorners& seen, const Camera& camera, bool across, bool down) {
  Eigen::Matrix<double, 8, 8> turn = Eigen::Matrix<double, 8, 8>::Zero();
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t from = across == down ? i : 3 - i;
    const PixelPoint corner = seen.corners[from];
    corners[i] = {across ? camera.width - 1 - corner.x : corner.x,
                  down ? camera.height - 1 - corner.y : corner.y};
    const auto row = static_cast<Eigen::Index>(2 * i), column = static_cast<Eigen::Index>(2 * from);
    turn(row, column) = across ? -1 : 1;
    turn(row + 1, column + 1) = down ? -1 : 1;
  }
  seen.corners = corners;
  seen.covariance = turn * seen.covariance * turn.transpose();
}

Alteration reversal(const Cameras& cameras, const Rig& rig, bool across, bool down) {
  const auto undo = [&rig, across, down](SeenTag& seen) {
    const RigCamera* camera = find_camera(rig, seen.camera);
    if (camera != nullptr && seen.seen_corners) {
      reverse(*seen.seen_corners, camera->camera, across, down);
    }
  };
  const char* what = !across
                         ? "mirrored top to bottom: mirror them back, or vehicle.height is wrong"
                     : !down ? "mirrored left to right: mirror them back"
                             : "turned by 180 degrees: turn them, or state the camera's roll";
  const std::string whose = cameras.size() == rig.cameras.size()
                                ? "all photos"
                                : "the photos of camera " + *cameras.begin();
  return {cameras, false, undo, whose + " are " + what};
}

std::vector<Alteration> alterations(const Rig& rig) {
  std::vector<Alteration> all;
  Cameras every;
  for (auto one = rig.cameras.begin(); one != rig.cameras.end(); ++one) {
    every.insert(one->name);
    for (auto other = std::next(one); other != rig.cameras.end(); ++other) {
      all.push_back(exchange(one->name, other->name));
    }
  }
  std::vector<Cameras> reversed{every};
  for (const std::string& camera : every) reversed.push_back({camera});
  if (every.size() < 2) reversed.pop_back();
  for (const Cameras& cameras : reversed) {
    all.push_back(reversal(cameras, rig, true, true));
    all.push_back(reversal(cameras, rig, true, false));
    all.push_back(reversal(cameras, rig, false, true));
  }
  return all;
}

// An alteration that the rows tell.
struct Told {
  Alteration alteration;
  Explained by;
};

std::vector<Told> told_by(const std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                          const Rig& rig) {
  std::map<std::pair<Cameras, bool>, Compared> of_cameras;
  std::vector<Told> told;
  for (const Alteration& alteration : alterations(rig)) {
    const auto [entry, is_new] = of_cameras.try_emplace({alteration.cameras, alteration.needs_all});
    Compared& compared = entry->second;
    if (is_new) {
      compared.rows = compared_rows(rows, alteration);
      compared.as_stated = explained(compared.rows, surveys, rig).rows;
    }
    if (2 * compared.as_stated > compared.rows.size()) continue;
    const Explained by = explained(undone(compared.rows, alteration), surveys, rig);
    if (compared.is_told_by(by)) told.push_back({alteration, by});
  }
  return told;
}

// Those that explain most rows, with a chi-square that exceeds the least by no more than chance
// does once in a hundred: a camera's photos mirrored top to bottom differ from the other camera's
// mirrored so by the vehicle's height alone.
void keep_likeliest(std::vector<Told>& told) {
  constexpr double kAsLikely = 9.2;
  std::size_t rows = 0;
  for (const Told& one : told) rows = std::max(rows, one.by.rows);
  std::erase_if(told, [&](const Told& one) { return one.by.rows < rows; });
  double least = std::numeric_limits<double>::infinity();
  for (const Told& one : told) least = std::min(least, one.by.chi_square);
  std::erase_if(told, [&](const Told& one) { return one.by.chi_square > least + kAsLikely; });
}

}  // namespace

std::string leave_out_altered(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                              const Rig& rig) {
  std::vector<Told> told = told_by(rows, surveys, rig);
  keep_likeliest(told);
  Cameras cameras;
  std::vector<std::string> words;
  for (const Told& one : told) {
    cameras.insert(one.alteration.cameras.begin(), one.alteration.cameras.end());
    words.push_back(one.alteration.words);
  }
  std::string why = fmt::format("{}", fmt::join(words, "; or "));
  if (why.empty()) return {};
  for (Observation& row : rows) leave_out_pictures(row, cameras, why);
  return why;
}

}  // namespace tagsmith::detail
