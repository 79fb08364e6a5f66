// SPDX-License-Identifier: Apache-2.0
// The proof of a print by our own reader and, for standard codes, by zbar.
#pragma once

#include <span>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/print_proof.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// What ProvePages asks for (tagsmith/cli/print_proof.hpp). Tags are read as cameras will read them:
// by the survey's template, but without its list of codes. A tag fails when its digits are not the
// survey's, or a corner or a side of the frame is off by more than 0.15 mm or 1.5 pixels. zbar
// reads gs1 codes as well when it is installed.
Result<std::vector<TagProof>> prove_pages(const Survey& survey, std::span<const ProofPage> pages,
                                          int dots_per_inch);

}  // namespace tagsmith::detail
