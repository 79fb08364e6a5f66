// SPDX-License-Identifier: Apache-2.0
// What is wrong with the tags of a picture: one function for each kind of finding, in findings.cpp
// or, where it measures much, in frame_bow.hpp or hanging.hpp. To add one, write it, name it in the
// list in findings.cpp, and describe its rule in docs/verify-rules.md, which the build takes into
// the program. What it needs to have seen of a tag is a member of TagEvidence (evidence.hpp).
#pragma once

#include <optional>

#include "decoder/verify/evidence.hpp"
#include "decoder/verify/verified_file.hpp"

namespace tagsmith::detail {

// Makes at most one finding for every tag: the first of the list, in its order of precedence.
void find_faults(PictureEvidence& evidence);

// The printed size and shape, on a page or in a scan.
std::optional<Finding> find_wrong_scale(const PictureEvidence& evidence, const TagEvidence& seen);

}  // namespace tagsmith::detail
