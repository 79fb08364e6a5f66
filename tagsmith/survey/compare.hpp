// SPDX-License-Identifier: Apache-2.0
// What must be done with the plates when a survey changes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

enum class TagChange {
  print,    // a new tag
  reprint,  // the text or the drawing of its plate differs
  move,     // the same plate hangs elsewhere, or turned
  remove,   // the tag is gone: an old plate gives a wrong position
};

std::string to_string(TagChange change);

struct TagDifference {
  std::string tag;
  TagChange change = TagChange::print;
  double distance =
      0;               // between the old and the new place of P, metres; 0 for new and removed tags
  std::string reason;  // in words
  // Of the plate, as a viewer sees it: clockwise, right edge out, top out; radians.
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
};

// Places nearer to each other than this are the same, metres.
inline constexpr double kSamePlace = 0.0005;

// Attitudes that differ by less than this are the same, radians: a plate of 0.4 m is then within
// 1 mm.
inline constexpr double kSameDirection = 0.0025;

// The tasks in the order of the new survey, then the removed tags. Labels count only where the
// plate is reprinted anyway: the code identifies a plate.
std::vector<TagDifference> compare_surveys(const Survey& before, const Survey& after);

// A plate that hangs by the old survey and that the new one takes for a tag which hangs elsewhere;
// not one that was measured anew (`placed` with a date): it hangs where the new survey says.
struct ReadElsewhere {
  std::string tag;      // in the old survey
  std::string read_as;  // in the new one
  double distance = 0;  // from where it hangs to where the new survey has it, metres
};

// As long as these plates are not moved or taken down, positions by the new survey are wrong.
std::vector<ReadElsewhere> read_elsewhere(const Survey& before, const Survey& after);

// A printed length of a plate: plates that agree in all of these, and in their colours, are drawn
// alike except for their labels.
struct PrintedLength {
  const char* name;
  const char* key;                   // in a print's manifest.json, millimetres
  std::optional<std::size_t> index;  // there, of a list
  double (*of)(const TagTemplate&);  // metres
};
std::span<const PrintedLength> printed_lengths();

// The differences between two templates in what is printed, in words; empty when there are none.
std::string describe_template_change(const TagTemplate& before, const TagTemplate& after);

}  // namespace tagsmith::detail
