// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/read_for_survey.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "decoder/reader/survey_options.hpp"
#include "decoder/verify/outline.hpp"

namespace tagsmith {

ReadOptions options_for_survey(const GrayView& image, const Survey& survey, const Camera* camera) {
  ReadOptions options = read_options_for(std::span(&survey, 1));
  options.check.reset();
  options.likely_codes = std::exchange(options.code_book, {});
  if (camera != nullptr && camera->width == image.width && camera->height == image.height) {
    options.camera = *camera;
  }
  options.frameless = Frameless::fallback;
  return options;
}

ReadResult read_for_survey(const GrayView& image, const Survey& survey, const Camera* camera,
                           const PictureReading& read) {
  return without_repeats(read(image, options_for_survey(image, survey, camera)));
}

ReadResult without_repeats(ReadResult result) {
  std::vector<Rejection> kept;
  for (Rejection& rejection : result.rejected) {
    const auto lies_on = [&](const auto& other) {
      return overlap(other.corners, rejection.corners);
    };
    if (std::ranges::any_of(result.tags, lies_on)) continue;
    const auto same = std::ranges::find_if(kept, lies_on);
    if (same == kept.end()) {
      kept.push_back(std::move(rejection));
    } else if (rejection.reason == RejectionReason::doubtful &&
               same->reason != RejectionReason::doubtful) {
      *same = std::move(rejection);
    }
  }
  result.rejected = std::move(kept);
  return result;
}

}  // namespace tagsmith
