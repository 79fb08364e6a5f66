// SPDX-License-Identifier: Apache-2.0
// A picture read once, for everything that is to be said of it.
#pragma once

#include <functional>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/reading.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

// What reads a picture: read_tags, or what a test puts around it.
using PictureReading = std::function<ReadResult(const GrayView&, const ReadOptions&)>;

// How the tags of a survey are read in a picture that may show others: as any code, so that a tag
// that should not be there is seen for what it is; what is refused so, as one of the survey's, for
// tags too small or too worn otherwise; and, where no tag is read by its frame, the survey's by
// their bars. `camera`: what took the picture, used if the picture has its size; null = not known.
ReadOptions options_for_survey(const GrayView& image, const Survey& survey,
                               const Camera* camera = nullptr);

// The picture read so, without_repeats.
ReadResult read_for_survey(const GrayView& image, const Survey& survey,
                           const Camera* camera = nullptr, const PictureReading& read = read_tags);

// A result without refusals that lie on any reading. Of refusals that lie on each other one is
// kept, that which came nearest to a reading.
ReadResult without_repeats(ReadResult result);

}  // namespace tagsmith
