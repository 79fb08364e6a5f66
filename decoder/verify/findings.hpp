// SPDX-License-Identifier: Apache-2.0
// What is wrong with the tags of a picture: one function for each kind of finding, here or, where
// it needs more than a picture's evidence, in hanging.hpp and frame_bow.hpp. To add one, write it,
// name it in the list in findings.cpp, and describe its rule in docs/verify-rules.md, which the
// build takes into the program.
#pragma once

#include <optional>

#include "decoder/verify/evidence.hpp"
#include "decoder/verify/verified_file.hpp"

namespace tagsmith::detail {

// Looks at one tag of which none of the findings before it in the list was made. `status` of the
// picture's other tags is what those findings left.
using FindFault = std::optional<Finding> (*)(const PictureEvidence&, const TagEvidence&);

// Makes one finding at most of every tag: the first of the list, in its order of precedence.
void find_faults(PictureEvidence& evidence);

std::optional<Finding> find_stranger(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_duplicate(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_cut_off(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_unread(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_mirrored(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_wrong_scale(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_repeated(const PictureEvidence& evidence, const TagEvidence& seen);
std::optional<Finding> find_other_file(const PictureEvidence& evidence, const TagEvidence& seen);

}  // namespace tagsmith::detail
