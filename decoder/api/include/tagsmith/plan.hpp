// SPDX-License-Identifier: Apache-2.0
// A drive before it is driven: which tags are read, and how accurate the positions will be.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tagsmith/export.hpp>
#include <tagsmith/rig.hpp>
#include <tagsmith/survey.hpp>

namespace tagsmith {

struct PlanOptions {
  std::optional<double> from;   // chainage, metres; absent = the center line's start
  std::optional<double> to;     // absent = its end
  double step = 0.05;           // of the chainage, metres
  int lateral_offsets = 5;      // spread over the rig's envelope, odd
  int headings = 5;             // likewise
  std::optional<double> speed;  // metres a second; absent = the envelope's, or standing still
  std::optional<double> corner_sigma_px;  // of a corner's coordinate; absent = as measured
  int jobs = 0;                           // threads at most; 0 = all cores
};

// Shares of all poses, 0 to 1.
struct WallShares {
  double both = 0;  // tags of both walls are read
  double one = 0;
  double none = 1;
};

// A part of the drive, chainages.
struct Stretch {
  double from = 0;
  double to = 0;
};

// Standard deviations over the poses that have a position.
struct SigmaRange {
  double median = 0;
  double high = 0;  // 95 % are below
  double worst = 0;
};

// A tag without which some poses have no position.
struct CriticalTag {
  std::string tag;
  double length = 0;    // of the drive that then has poses without a position, metres more
  Stretch longest_gap;  // of the drive without this tag, where it touches the tag's own
};

struct PlanSummary {
  WallShares read;                              // with the survey as code book
  WallShares read_plain;                        // without it
  double covered_share = 0;                     // of the chainages whose poses all have a position
  std::vector<Stretch> gaps;                    // with poses that have no position
  std::optional<SigmaRange> plane_sigma;        // metres, on the center line
  std::optional<SigmaRange> height_sigma;       // metres
  std::optional<SigmaRange> heading_sigma;      // radians
  std::optional<SigmaRange> worst_plane_sigma;  // metres, over the envelope
  // Greatest speed (metres a second) at which all poses that have a position standing still keep
  // it, and 99 % of them; infinite without exposure times.
  double speed_all = 0;
  double speed_most = 0;
  std::vector<std::string> unread_tags;    // not read from anywhere on the center line
  double covered_share_one_lost = 0;       // whichever single tag is lost
  std::vector<CriticalTag> critical_tags;  // the longest first
};

// Fails with ErrorCode::invalid_argument on options out of their range, with ErrorCode::failed when
// options, survey and rig do not fit each other. The time is linear in the number of poses.
TAGSMITH_EXPORT PlanSummary plan(const Survey& survey, const Rig& rig,
                                 const PlanOptions& options = {});

}  // namespace tagsmith
