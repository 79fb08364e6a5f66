// SPDX-License-Identifier: Apache-2.0
// The texts of a survey's tag for people.
#pragma once

#include <string>

#include "tagsmith/render/page.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// To the millimetre, never "-0.000".
std::string to_millimetre(double metres);

// The digits in groups: one an axis, then the check digit: "0190 0000 040 4".
std::string grouped_digits(const PositionCode& code, const Digits& digits);

// The label on the plate: the template's lines, in which digits stand in groups; or name, side and
// digits; chainage and grid coordinates of P in metres; survey and its revision
// (survey/revision.hpp), which is left out when empty.
TagText tag_text(const Survey& survey, const PlacedTag& tag, const std::string& revision = {});

// The text of the template's QR symbol for this tag.
std::string qr_content(const Survey& survey, const PlacedTag& tag, const std::string& revision);

// The notes in the page's margin: the survey, the tag, what the plate is made of.
PageNotes page_notes(const Survey& survey, const PlacedTag& tag, const std::string& revision = {});

// Survey and revision, for the metadata of files.
std::string survey_keywords(const Survey& survey, const std::string& revision);

}  // namespace tagsmith::detail
