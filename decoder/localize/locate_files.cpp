// SPDX-License-Identifier: Apache-2.0
// The part of locate.hpp that loads pictures: who has them in memory needs no decoder.
#include <deque>
#include <utility>

#include "decoder/localize/locate.hpp"
#include "decoder/localize/repeated_pictures.hpp"

namespace tagsmith::detail {

Fix locate(const Measurement& measurement, const std::vector<Survey>& surveys, const Rig& rig,
           const std::optional<PosePrior>& prior, PictureMemory& memory, Observation& seen) {
  seen = {measurement.id, {}, measurement.ranges, {}};
  seen.time = measurement.time;
  std::deque<GrayImage> loaded;
  std::vector<CameraImage> images;
  for (const RigCamera& camera : rig.cameras) {
    const auto picture = measurement.cameras.find(camera.name);
    if (picture == measurement.cameras.end() || picture->second.image.empty()) continue;
    std::optional<GrayImage> image = load_observed(picture->second.image, seen);
    if (!image) continue;
    loaded.push_back(std::move(*image));
    images.push_back({&camera, loaded.back().view(), picture->second.image.string()});
  }
  images = memory.new_ones(images, seen);
  return locate_with(seen, images, surveys, rig, prior);
}

}  // namespace tagsmith::detail
