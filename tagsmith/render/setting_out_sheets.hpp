// SPDX-License-Identifier: Apache-2.0
// The installer's papers: the table of places, the plan, the elevation of each wall.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/drawing_title.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {

// Upright sheets of Letter or else of A4 with a row a tag: name, side, chainage, offset, height, x,
// y, z, tolerance, digits, and a box to tick; below it a row for a plate that does not hang as its
// wall says. The head says what each column means.
std::vector<Sheet> setting_out_table(const Survey& survey, std::span<const SettingOut> list,
                                     const std::string& revision, Paper paper = Paper::a3);

// Sheets of this paper: the plan and the elevation of each wall by strips, with the chainage, the
// height and the distance from its neighbour of each place; only the strips of the drive that have
// a place of the list. Fails as lay_out_sheets does.
Result<std::vector<Sheet>> setting_out_drawing(const Survey& survey,
                                               std::span<const SettingOut> list,
                                               const std::string& revision,
                                               Paper paper = Paper::a3);

}  // namespace tagsmith::detail
