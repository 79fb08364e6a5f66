// SPDX-License-Identifier: Apache-2.0
// Why no tag is found where there should be one.
#pragma once

#include <optional>
#include <vector>

#include "decoder/reader/reading.hpp"
#include "decoder/verify/finding.hpp"
#include "decoder/verify/rasterize.hpp"
#include "decoder/verify/read_for_survey.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// For a page, or a scan of known resolution, on which no tag was found: what it holds if it was
// printed white on black (rule `inverted`), if its bars grew or shrank by more than the reader
// follows (`bars-grown`), or if the feature frame is missing (`no-frame`), as the page's own
// reading tells (`frameless`). Nothing when it is none of these. Reads the page's negative, and the
// page with more ink and with less.
std::optional<TagFinding> find_hidden_tag(const Survey& survey, const PageImage& page,
                                          const FramelessResult& frameless,
                                          const PictureReading& read);

// For a photo in which no tag was read by its frame: the survey's tags in it that are printed white
// on black (`inverted`), or, where there are none, whose bars read without a feature frame
// (`no-frame`; `cut-off` where the frame may lie outside of the photo), as the photo's own reading
// tells (`frameless`). Tags of no survey are left out: a photo shows many things. Those that were
// found and refused at the same place give way to an inverted one; to bars that read they are told
// by name. `camera`: as in read_for_survey. Reads the photo's negative.
void find_hidden_tags(const Survey& survey, const GrayView& photo, const Camera* camera,
                      const FramelessResult& frameless, const PictureReading& read,
                      std::vector<TagFinding>& findings);

}  // namespace tagsmith
