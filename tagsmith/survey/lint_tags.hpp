// SPDX-License-Identifier: Apache-2.0
// What is unlikely about tags that are placed, although it could be built: warnings that a
// colleague of the person who drew the survey would give. Internal to tagsmith/survey.
#pragma once

#include <vector>

#include "tagsmith/survey/check_tags.hpp"
#include "tagsmith/survey/finding_log.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Logs an error when hardly any surveyed tag lies at its wall, but nearly all do in the mirror
// image of the grid or with x and y exchanged. True when it did: findings about single tags would
// then be of no use.
bool check_grid(const Survey& survey, const std::vector<SourcedTag>& tags, Place placed,
                FindingLog& log);

// Surveyed tags that are off the place given by their neighbours or the design, along the drive, in
// height, or from the other plate of their pair. Takes O(n log n) time for n tags.
void lint_places(const Survey& survey, const std::vector<SourcedTag>& tags, FindingLog& log);

// Codes of tags near each other that differ by likely misreadings alone, and positions that come
// near the end of the code's range.
void lint_codes(const Survey& survey, const std::vector<SourcedTag>& tags, Place code_place,
                FindingLog& log);

// A series whose theta makes the method of Xu et al. (2017) useless, and a plate without room for
// its label.
void lint_series(const Survey& survey, Place tags_place, FindingLog& log);

// Plates that follow listed walls which are rougher under them than `angle_sigma` says.
void lint_walls(const Survey& survey, Place tags_place, FindingLog& log);

}  // namespace tagsmith::detail
