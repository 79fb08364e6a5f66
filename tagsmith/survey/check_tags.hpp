// SPDX-License-Identifier: Apache-2.0
// Faults of tags that are placed: of their codes and of their space on the walls. Internal to
// tagsmith/survey.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A tag and its place in the survey file.
struct SourcedTag {
  PlacedTag tag;
  Place place;
  bool printed_digits = false;  // `digits` was given, not derived from the position
  bool coded = false;           // false: the code cannot represent its position, `digits` are void
};

// Of coordinates.
inline constexpr const char* kAxisNames[] = {"x", "y", "z"};

// How far off its wall a plate may be, metres; walls are rough, those of a survey are smooth.
inline constexpr double kOffWall = 0.1;

// A length as findings say it, to the millimetre: 1.25 m.
std::string length_text(double metres);

// Positions that the code cannot represent; one finding an axis for the regular tags together, one
// for each surveyed tag. The survey's own `tags` are not used.
void check_code_range(const Survey& survey, const std::vector<SourcedTag>& tags, Place code_place,
                      FindingLog& log);

// Two tags with one code, and coding that rounds more than the survey's accuracy allows.
void check_codes(const Survey& survey, const std::vector<SourcedTag>& tags, Place code_place,
                 FindingLog& log);

// The keys that say where regular tags hang; of those that the survey file does not have, the place
// of its section `tags`.
struct SeriesPlaces {
  Place height;
  Place spacing;
  Place first;
  Place count;  // pairs, or to
};

// Plates that extend beyond the tunnel, hang off their wall, or overlap on one wall. Takes O(n log
// n) time for n tags. Findings about regular tags are placed at the key to change.
void check_walls(const Survey& survey, const std::vector<SourcedTag>& tags,
                 const SeriesPlaces& series, FindingLog& log);

}  // namespace tagsmith::detail
