// SPDX-License-Identifier: Apache-2.0
// Which state of a survey something was made from.
#pragma once

#include <string>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Twelve hexadecimal digits: the first of the SHA-256 of what the survey says. Comments, order of
// keys and the file's name do not change it; a millimetre, a digit, the template's sizes do.
// Lengths count to the micrometre, angles to 1e-9 rad.
std::string survey_revision(const Survey& survey);

// The same for what the template draws; its name, and the content of logo files, do not count.
std::string template_revision(const TagTemplate& tag);

}  // namespace tagsmith::detail
