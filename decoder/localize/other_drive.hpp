// SPDX-License-Identifier: Apache-2.0
// Photos of another drive than the surveys': their tags are read, but their codes are in no survey.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// "None of the 14 codes read is of survey corridor: ..."; nothing when fewer than two were read,
// since one may be a misprint.
std::string other_drive_in_words(const std::vector<std::string>& surveys,
                                 const std::set<std::string>& codes);

// The same for measurements that show no tag of the surveys. A sample of their photos is read once
// more, without the surveys' codes. Nothing when that shows a code of the surveys, too.
std::string other_drive_in_words(const std::vector<Measurement>& measurements,
                                 const std::vector<Survey>& surveys);

}  // namespace tagsmith::detail
