// SPDX-License-Identifier: Apache-2.0
// The parts of observation.hpp and localize_images.hpp that load pictures: who has them in memory
// needs no decoder.
#include <deque>
#include <utility>

#include <fmt/core.h>

#include "decoder/image/load.hpp"
#include "decoder/localize/localize_images.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/repeated_pictures.hpp"

namespace tagsmith::detail {
namespace {

void add_distance(Observation& observation, const RigCamera& camera, const CameraMeasurement& seen,
                  const std::vector<Survey>& surveys) {
  const std::string& name = seen.tag.value();
  const std::optional<Digits> digits = parse_digits(name);
  auto found = find_tags(surveys, std::string_view(name));
  if (found.empty() && digits) found = find_tags(surveys, *digits);
  if (found.size() != 1) {
    observation.faults.push_back(fmt::format("{}_tag is {}, {}", camera.name, name,
                                             found.empty()
                                                 ? "expected a tag of the survey"
                                                 : "which several surveys have: give digits"));
    return;
  }
  const auto& [survey, tag] = found.front();
  observation.tags.push_back({camera.name, survey, *tag, std::nullopt, seen.distance});
}

// The camera's picture of the measurement, where there is one. Damage that the decoder repaired is
// a fault of the observation, and so is a file that cannot be read; there is no picture of that.
std::optional<GrayImage> load_picture(const CameraMeasurement& seen, Observation& observation) {
  if (seen.image.empty()) return std::nullopt;
  Result<DecodedImage> loaded = load_image(seen.image);
  if (!loaded) {
    observation.faults.push_back(loaded.error().message);
    observation.lacks_picture = true;
    return std::nullopt;
  }
  if (!loaded->warning.empty()) {
    observation.faults.push_back(seen.image.string() + ": " + damaged_in_words(loaded->warning));
  }
  return std::move(loaded->image);
}

// The measurement's id, time and ranges. For what its cameras saw, `take` is called with each of
// them and its picture, if there is one.
template <typename Take>
Observation observe_by(const Measurement& measurement, const Rig& rig, const Take& take) {
  Observation observation{measurement.id, {}, measurement.ranges, {}};
  observation.time = measurement.time;
  for (const RigCamera& camera : rig.cameras) {
    const auto seen = measurement.cameras.find(camera.name);
    if (seen == measurement.cameras.end()) continue;
    take(observation, camera, seen->second, load_picture(seen->second, observation));
  }
  return observation;
}

}  // namespace

Observation observe(const Measurement& measurement, const std::vector<Survey>& surveys,
                    const Rig& rig, const ReaderChoice& reader,
                    const std::optional<PosePrior>& prior) {
  const auto read = [&](Observation& observation, const RigCamera& camera,
                        const CameraMeasurement& seen, const std::optional<GrayImage>& image) {
    if (image) {
      observation.pictures[camera.name] = fingerprint(image->view());
      observe_image(observation, camera, image->view(), seen.image.string(), surveys, reader,
                    prior);
    }
    if (seen.tag && seen.distance) add_distance(observation, camera, seen, surveys);
  };
  return observe_by(measurement, rig, read);
}

Fix localize_measurement(const Measurement& measurement, const std::vector<Survey>& surveys,
                         const Rig& rig, const std::optional<PosePrior>& prior,
                         PictureMemory& memory, Observation& seen) {
  std::deque<GrayImage> loaded;
  std::vector<CameraImage> images;
  const auto keep = [&](const Observation&, const RigCamera& camera,
                        const CameraMeasurement& measured, std::optional<GrayImage> image) {
    if (!image) return;
    loaded.push_back(std::move(*image));
    images.push_back({&camera, loaded.back().view(), measured.image.string()});
  };
  seen = observe_by(measurement, rig, keep);
  images = memory.new_ones(images, seen);
  return localize_images(seen, images, surveys, rig, prior);
}

}  // namespace tagsmith::detail
