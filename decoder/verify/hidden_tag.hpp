// SPDX-License-Identifier: Apache-2.0
// Why no tag is found on a page that should hold one.
#pragma once

#include <optional>

#include "decoder/verify/finding.hpp"
#include "decoder/verify/rasterize.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// For a page, or a scan of known resolution, on which no tag was found: what it holds if it was
// printed white on black (rule `inverted`), if its bars grew or shrank by more than the reader
// follows (`bars-grown`), or if the feature frame is missing (`no-frame`). Nothing when it is none
// of these. Reads the page up to four times.
std::optional<TagFinding> find_hidden_tag(const Survey& survey, const PageImage& page);

}  // namespace tagsmith
