// SPDX-License-Identifier: Apache-2.0
// The part of locate.hpp that loads pictures: who has them in memory needs no decoder.
#include <deque>
#include <utility>

#include "decoder/localize/locate.hpp"
#include "decoder/localize/repeated_pictures.hpp"

namespace tagsmith::detail {

Fix locate(const Measurement& measurement, const std::vector<Survey>& surveys, const Rig& rig,
           const std::optional<PosePrior>& prior, PictureMemory* memory) {
  Observation observation{measurement.id, {}, measurement.ranges, {}};
  observation.time = measurement.time;
  std::deque<GrayImage> loaded;
  std::vector<CameraImage> images;
  for (const RigCamera& camera : rig.cameras) {
    const auto seen = measurement.cameras.find(camera.name);
    if (seen == measurement.cameras.end() || seen->second.image.empty()) continue;
    std::optional<GrayImage> image = load_observed(seen->second.image, observation);
    if (!image) continue;
    loaded.push_back(std::move(*image));
    images.push_back({&camera, loaded.back().view(), seen->second.image.string()});
  }
  if (memory != nullptr) images = memory->new_ones(images, observation);
  return locate_with(std::move(observation), images, surveys, rig, prior);
}

}  // namespace tagsmith::detail
