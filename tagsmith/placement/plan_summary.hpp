// SPDX-License-Identifier: Apache-2.0
// A plan in a few numbers: the answers that people ask for.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "tagsmith/placement/drive_plan.hpp"

namespace tagsmith::detail {

// Shares of all poses, 0 to 1.
struct WallShare {
  double both = 0;
  double one = 0;
  double none = 1;
};

// A part of the drive, from the first of its columns to the last.
struct Stretch {
  double from = 0;  // chainages
  double to = 0;

  double length() const { return to - from; }
};

// Of the poses' standard deviations, metres; nothing without a position.
struct SigmaRange {
  double median = 0;
  double high = 0;  // 95 % are below
  double worst = 0;
};

// A tag without which some poses have no position.
struct CriticalTag {
  std::size_t tag = 0;  // index in survey.tags
  double length = 0;    // of the drive that then has poses without a position, metres more
  Stretch longest_gap;  // of the drive without this tag, where it touches the tag's own
};

struct ReadingDistances {
  double least = 0;  // metres from the camera to the tag at its first reading
  double median = 0;
  double most = 0;
};

struct PaperSummary {
  double share = 0;                 // of the columns that have a pair at the nominal pose
  std::optional<SigmaRange> plane;  // nothing where no measurement has a solution
  std::optional<SigmaRange> height;
  double magnification = 0;      // 1 / tan(theta), the median
  double no_solution_share = 0;  // of measurements, the mean
};

struct PlanSummary {
  WallShare seen;
  WallShare read_plain;
  WallShare read;
  double covered_share = 0;    // of the columns whose poses all have a position
  double wall_pair_share = 0;  // of the columns whose poses all read tags on both walls
  std::vector<Stretch> gaps;   // columns with poses that have no position
  std::optional<Stretch> longest_gap;
  std::optional<SigmaRange> nominal_plane;
  std::optional<SigmaRange> nominal_height;
  std::optional<SigmaRange> nominal_heading;  // radians
  std::optional<SigmaRange> worst_plane;      // over the envelope
  std::optional<Stretch> worst_stretch;       // the metre of the greatest mean of it
  double worst_stretch_sigma = 0;             // the greatest plane sigma there
  // Ways of the vehicle during the exposure (metres), and speeds, at which all poses that have a
  // position standing still keep it, and 99 % of them.
  double travel_all = std::numeric_limits<double>::infinity();
  double travel_most = travel_all;
  double speed_all = travel_all;
  double speed_most = travel_all;
  std::optional<ReadingDistances> first_reading;
  std::vector<std::size_t> unread_tags;  // not read from anywhere on the nominal drive
  double covered_share_one_lost = 0;     // of the columns, whichever single tag is lost
  double confirmed_share = 0;            // of the columns whose poses all read two tags, one whole
  std::vector<CriticalTag> critical_tags;    // the longest first
  std::optional<SigmaRange> one_lost_plane;  // nominal, the tag lost that costs most
  std::optional<PaperSummary> paper;
};

PlanSummary summarize(const DrivePlan& plan);

// True when every pose of the column has a position.
bool is_covered(const DrivePlan& plan, const PlanColumn& column);

}  // namespace tagsmith::detail
